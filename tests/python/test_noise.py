"""Chains of stickslip.noise: what is said of them, their files and runs, and chains of records."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy
import scipy.integrate
import scipy.linalg
import scipy.signal
import scipy.stats

SOURCES = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("STICKSLIP_BINARIES", SOURCES / "build"))
os.environ["STICKSLIP"] = str(BINARIES / "stickslip")
sys.path.insert(0, str(SOURCES / "python"))
import stickslip
from stickslip import Record, chains_of_records, gaussian_noise_of_records, noise
from stickslip.record_statistics import Memory

STEP = 0.01


def filtered(count, rate, seed):
    """Real part of dz = -rate z dt + noise at steps of 0.01, with the variance 1."""
    shocks = numpy.random.default_rng(seed).standard_normal((2, count)) * numpy.sqrt(1 - abs(numpy.exp(-rate * STEP)) ** 2)
    return scipy.signal.lfilter([1], [1, -numpy.exp(-rate * STEP)], shocks[0] + 1j * shocks[1]).real


def record_of(values, step=STEP):
    return Record(step * numpy.arange(len(values)), values)


def path_of(x, rates, duration, seed, step=STEP):
    """A record of a chain, which is simulated event by event."""
    generator, rates = numpy.random.default_rng(seed), numpy.asarray(rates, float)
    leaving, below = rates.sum(1), numpy.cumsum(rates, 1) / rates.sum(1)[:, None]
    times, states = [0.0], [0]
    while times[-1] < duration:
        times.append(times[-1] + generator.exponential(1 / leaving[states[-1]]))
        states.append(int(numpy.searchsorted(below[states[-1]], generator.random())))
    samples = step * numpy.arange(round(duration / step))
    return record_of(numpy.asarray(x)[numpy.array(states)[numpy.searchsorted(times, samples, "right") - 1]], step)


ANY = numpy.array([[0, 1.5, 0.2], [0.3, 0, 1.1], [0.9, 0.1, 0]])


class Chains(unittest.TestCase):
    def test_against_dense_algebra(self):
        x, chain = numpy.array([-1.0, 0.5, 2.0]), noise.Chain([-1, 0.5, 2], ANY)
        q = ANY - numpy.diag(ANY.sum(axis=1))
        p = numpy.linalg.solve(numpy.vstack([q.T[:2], [1, 1, 1]]), [0, 0, 1])
        f = x - p @ x
        numpy.testing.assert_allclose(chain.stationary, p, rtol=1e-14)
        self.assertAlmostEqual(chain.mean, p @ x, delta=1e-14)
        self.assertAlmostEqual(chain.deviation**2, p @ f**2, delta=1e-14)
        times = numpy.array([[2.0, 0], [0.3, 1]])
        expected = [[p @ (f * (scipy.linalg.expm(q * t) @ f)) for t in row] for row in times]
        numpy.testing.assert_allclose(chain.covariance(times), expected, rtol=1e-10)
        for w in (0.7, 3):
            self.assertAlmostEqual(float(chain.spectrum(w)), 2 * (p * f @ numpy.linalg.solve(1j * w * numpy.eye(3) - q, f)).real,
                                   delta=1e-13)
        self.assertAlmostEqual(float(chain.spectrum(0)), float(chain.spectrum(1e-6)), delta=1e-10)
        fine = numpy.linspace(0, 25, 201)
        self.assertAlmostEqual(chain.correlation_time, scipy.integrate.simpson(chain.covariance(fine), fine) / chain.deviation**2,
                               delta=1e-5)

    def test_closed_forms(self):
        t, w = numpy.array([0, 0.4, 2]), numpy.array([0, 0.5, 3])
        for chain, deviation, rate in ((noise.ou(0.7, 2, 0.1), 0.7, 0.5), (noise.telegraph(1.5, 0.3), 1.5, 0.6)):
            numpy.testing.assert_allclose(chain.covariance(t), deviation**2 * numpy.exp(-rate * t), rtol=1e-7)
            numpy.testing.assert_allclose(chain.spectrum(w), 2 * deviation**2 * rate / (rate**2 + w**2), rtol=1e-7)
        self.assertAlmostEqual(noise.periodic(2, 3, 16).deviation, 2**0.5, delta=1e-12)

    def test_sums_scales_and_shifts(self):
        a, b = noise.telegraph(1, 0.5), noise.Chain([-1, 0.5, 2], ANY)
        t = numpy.array([0, 0.7])
        both = a + 2 * b + 0.3
        self.assertAlmostEqual(both.mean, 2 * b.mean + 0.3, delta=1e-13)
        numpy.testing.assert_allclose(both.covariance(t), a.covariance(t) + 4 * b.covariance(t), rtol=1e-10)
        numpy.testing.assert_array_equal(both.x[:3], -1 + 2 * b.x + 0.3)  # that of b runs first
        self.assertAlmostEqual((1 + a).mean, 1, delta=1e-14)
        meant = noise.ou(1, 1, 0.5) + 2 * noise.ou(1, 3, 0.5)
        numpy.testing.assert_allclose(meant.meant.covariance(t), numpy.exp(-t) + 4 * numpy.exp(-t / 3))

    def test_what_is_no_chain(self):
        for x, rates, message in (([0, 1], [[0, -1], [1, 0]], r"rates\[0, 1\] = -1: must be in \[0, inf\)"),
                                  ([0, numpy.nan], [[0, 1], [1, 0]], "x = nan"), ([0], [[0]], "at least 2"),
                                  ([0, 1, 2], [[0, 1, 0], [1, 0, 1], [0, 0, 0]], "state 2 and state 0 do not reach"),
                                  ([0, 1], [[0, numpy.inf], [1, 0]], "= inf: must be")):
            self.assertRaisesRegex(ValueError, message, noise.Chain, x, rates)
        for function, values, message in ((noise.ou, (1, -1, 0.5), r"tau = -1: must be in \(0, inf\)"),
                                          (noise.ou, (1, 1, 0.5, 99), r"levels = 99.*\[1, 8\]"),
                                          (noise.ou, (1, 1, 1.5), "a delta of at most 1.41421"),
                                          (noise.periodic, (1, 1, 1), "phases = 1"),
                                          (noise.narrow_band, (1, 0, 1, 0.5), "gamma = 0")):
            self.assertRaisesRegex(ValueError, message, function, *values)

    def test_pictures(self):
        figure = noise.narrow_band(1, 1, 1, 0.5).plot()
        self.assertEqual([len(axes.lines) for axes in figure.axes], [2, 2])
        self.assertEqual([len(axes.lines) for axes in noise.periodic(1, 2, 4).plot(figure.axes).axes], [3, 3])


class Runs(unittest.TestCase):
    """The program with these chains. Expected values are those of another program (dense elements, any chain)."""

    def check(self, chain, expected, **options):
        r = stickslip.run(noise=chain, **options)
        for key, value in expected.items():
            self.assertAlmostEqual(r[key].value, value, delta=2e-9 + r[key].error, msg=key)
        return r

    def test_a_periodic_force_with_noise(self):
        chain = noise.periodic(1.2, 4, 16) + noise.ou(0.7, 1, 0.5, levels=4)
        self.check(chain, {"P_stick": 0.26643150176, "mean_slide": 1.9426508185, "mean_stick": 0.7055692498, "E_V2": 0.156807780853,
                           "E_absV": 0.262851173522, "E_XV": 0.314518484966}, mu_d=0.6, accuracy=1e-8)

    def test_a_narrow_band(self):
        self.check(noise.narrow_band(1, 0.5, 2, 0.5), {"P_stick": 0.460412722, "mean_slide": 1.9094991454}, mu_d=0.5,
                   accuracy=1e-8)

    def test_spectra_are_those_of_the_program(self):
        omega = [0, 0.5, 2]
        for chain in (noise.ou(1, 1, 0.25), noise.narrow_band(1, 0.5, 2, 0.5), noise.periodic(1, 2) + noise.ou(1, 1, 1)):
            r = stickslip.run(noise=chain, quantities="noise_spectrum,noise_law", omega=omega, mu_s=0.9, mu_d=0.5)
            numpy.testing.assert_allclose(chain.spectrum(omega), r["S_x"].value, rtol=1e-10)
            self.assertAlmostEqual(chain.deviation**2, r["E_X2"].value, delta=1e-12)

    def test_fewer_levels_are_those_of_the_program(self):
        asked = {"quantities": "sticking,moments,noise_law,noise_spectrum", "omega": [0, 1], "mu_d": 0.6, "accuracy": 1e-11}
        for deviation, levels in ((1, 3), (1, 6), (1, 8), (0.7, 3)):  # 8 and 3 are all
            options = {"noise_deviation": deviation, "delta": 0.5, "noise_levels": levels}
            of_program, own = (stickslip.run(**asked, **noises) for noises in (
                options, {"noise": noise.ou(deviation, 1, 0.5, levels)}))
            for key in ("P_stick", "mean_slide", "E_V2", "E_XV", "P_X_le_mu_s", "E_X2", "S_x"):
                numpy.testing.assert_allclose(own[key].value, of_program[key].value, rtol=1e-10, err_msg=f"{options} {key}")

    def test_files(self):
        chain = noise.ou(1, 1, 0.5)
        with tempfile.TemporaryDirectory() as folder:
            states, rates, levels = (os.path.join(folder, name) for name in ("s.csv", "r.csv", "l.csv"))
            chain.save(states, rates)
            chain.save(levels)
            found = [stickslip.run(mu_d=0.5, **options)["P_stick"].value for options in (
                {"noise": chain}, {"noise": "chain", "noise_states": states, "noise_rates": rates},
                {"noise": "file", "noise_file": levels}, {"noise": "ou", "delta": 0.5})]
            numpy.testing.assert_allclose(found, found[0], rtol=1e-9)
            self.assertRaisesRegex(ValueError, "jumps beyond its neighbours", noise.periodic(1, 2).save, levels)
            with self.assertRaisesRegex(ValueError, "noise_states = .*leave one out"):
                stickslip.run(noise=chain, noise_states=states)
        sweep = stickslip.sweep(noise=chain, mu_d=[0.25, 0.5])
        self.assertAlmostEqual(sweep["P_stick"].value[1], found[0], delta=1e-12)


class Quiet(unittest.TestCase):
    def setUp(self):
        filters = warnings.catch_warnings()
        filters.__enter__()
        self.addCleanup(filters.__exit__)
        warnings.simplefilter("ignore", UserWarning)


class OfRecords(Quiet):
    def refused(self, message, *words, function=noise.record, **options):
        self.assertRaisesRegex(ValueError, message, function, *words, **options)

    def test_counts_by_hand(self):
        # Level 0 for 2 samples, up to level 2 over one that is not seen, 2 samples there, 1 on level 1, and back.
        record, x = record_of(numpy.tile([0.0, 0, 2, 2, 1], 40), 0.5), numpy.array([0.0, 1, 2])
        self.refused("34 % of the jumps lead over more than one level", record, x, "neighbours",
                     function=chains_of_records._counted)
        spent, jumps, far = chains_of_records._counted(record, x, "any")
        numpy.testing.assert_array_equal(jumps, [[0, 0, 40], [39, 0, 0], [0, 40, 0]])
        numpy.testing.assert_array_equal(spent, [40, 19.5, 40])  # 39 intervals lead from level 1 to 0
        self.assertAlmostEqual(far, 40 / 119)
        # Within its bin a record counts nothing, however it moves; over a level in between it counts both jumps.
        rough = record_of(numpy.tile([0, 0.9, -0.4, 0.9, 1.1, 0.1, 1.9, 2.2, 1.1, 0.9, -0.1] + 30 * [0, 0.1], 20), 1)
        spent, jumps, far = chains_of_records._counted(rough, x, "neighbours")
        numpy.testing.assert_array_equal(jumps, [[0, 20, 0], [20, 0, 20], [0, 20, 0]])
        self.assertEqual((far, spent.sum()), (0, 71 * 20 - 1))

    def test_rates_of_a_chain_lie_in_their_intervals(self):
        x, rates = numpy.array([-1, 0.0, 2]), numpy.array([[0, 2.0, 0], [0.7, 0, 0.5], [0, 1.5, 0]])
        inside = total = 0
        for seed in range(12):
            fit = noise.record(path_of(x, rates, 400, seed)).fit
            where = rates > 0
            inside += ((fit.low < rates) & (rates < fit.high))[where].sum()
            total += where.sum()
            self.assertTrue((fit.low[~where] == 0).all() and (fit.high[~where] == 0).all())
        self.assertGreaterEqual(inside, 0.85 * total)  # 95 % are expected; seeds are fixed
        self.assertLess(((1.3 * rates > fit.low) & (1.3 * rates < fit.high))[where].sum(), where.sum())
        self.assertTrue((noise.record(path_of(x, rates, 400, 0), confidence=0.5).fit.high <= fit.high * 2).all())

    def test_garwood_intervals(self):
        fit = noise.record(path_of([0, 1.0], numpy.array([[0, 1.0], [1, 0]]), 100, 3)).fit
        n, t = fit.jumps[0, 1], fit.spent[0]
        poisson = scipy.stats.poisson
        self.assertAlmostEqual(poisson.sf(n - 1, fit.low[0, 1] * t), 0.025, delta=1e-9)
        self.assertAlmostEqual(poisson.cdf(n, fit.high[0, 1] * t), 0.025, delta=1e-9)

    def test_jumps_of_any_length(self):
        record = path_of(numpy.array([-1, 0.5, 2]), ANY, 2000, 4)
        self.refused("of the jumps lead over more than one level.*jumps=\"any\"", record)
        chain = noise.record(record, jumps="any")
        where = ANY > 0
        numpy.testing.assert_allclose(chain.rates.toarray()[where], ANY[where], atol=0.15)
        self.assertFalse(chain.neighbours_only)

    def test_a_chain_has_the_correlation_time_of_the_record_unless_rates_are_to_be_those_counted(self):
        record = record_of(filtered(200000, 1, 1))
        with self.assertWarnsRegex(UserWarning, "correlation time of the chain is 1.4.* times that of the record"):
            plain = noise.record(record, match_time=False)
        self.assertEqual(plain.fit.factor, 1)
        self.assertTrue(any("match_time=True" in note for note in plain.notes))
        self.assertTrue(all(note.startswith(f"of {plain.name}: ") for note in (2 * (3 * plain) + 1).notes))
        self.assertEqual(len((plain + plain).notes), len(set(plain.notes)))
        self.assertRaisesRegex(ValueError, "factor = 0", lambda: 0 * plain)
        numpy.testing.assert_allclose(plain.rates.toarray(), plain.fit.jumps / plain.fit.spent[:, None])
        self.assertIn("rates are those counted", str(plain))
        matched = noise.record(record)
        self.assertAlmostEqual(matched.correlation_time, matched.fit.correlation_time[1], delta=1e-9)
        self.assertIn(f"all rates were multiplied by {matched.fit.factor:.4g}", str(matched))
        self.assertGreater(matched.fit.factor, 1.2)
        self.assertTrue((matched.fit.low < matched.rates.toarray() + (matched.fit.low == 0)).all())
        self.assertLess(abs(matched.fit.correlation_time[1] - 1), 3 * matched.fit.error)
        for low, high, ratio, error in matched.fit.bands:
            self.assertLess(abs(ratio - 1), 0.1 + 3 * error, (low, high))

    def test_jumps_of_a_record_of_few_values_are_all_seen(self):
        record = path_of([0, 1.0], numpy.array([[0, 1.0], [1, 0]]), 400, 3)
        counted, matched = noise.record(record), noise.record(record, match_time=True)
        self.assertEqual(counted.fit.factor, 1)
        self.assertNotEqual(matched.fit.factor, 1)
        self.assertIn("which gives the chain the correlation time of the record", str(matched))

    def test_the_chain_of_ou_noise_does_what_the_program_has_for_it(self):
        chain = noise.record(record_of(filtered(400000, 1, 5)), 0.4 * numpy.arange(-7, 8))
        ours, theirs = (stickslip.run(mu_d=0.5, accuracy=1e-4, **options)["P_stick"].value
                        for options in ({"noise": chain}, {"delta": 0.4}))
        self.assertLess(abs(ours - theirs), 0.02)  # about 0.01 by the length of the record

    def test_thresholds_lie_halfway_between_levels(self):
        skewed = record_of(numpy.exp(0.5 * filtered(400000, 1, 5)))
        for record, mu_s, sides in ((record_of(filtered(400000, 1, 5)), 0.9, (-1, 1)), (skewed, 1.7, (1,))):
            for levels in (9, 12, 15):
                x = noise.record(record, levels, mu_s=mu_s).x
                self.assertLessEqual(abs(len(x) - levels), 3)
                for side in sides:
                    above = numpy.searchsorted(x, side * mu_s)
                    shares = [scipy.stats.norm.ppf((record.value <= level).mean()) for level in
                              (x[above - 1], side * mu_s, x[above])]
                    self.assertAlmostEqual(shares[1], (shares[0] + shares[2]) / 2, delta=0.01)

    def test_gaps_are_skipped(self):
        one, other = (path_of([0, 1.0], [[0, 1], [2, 0]], 300, seed).value for seed in (1, 2))
        time = numpy.concatenate([STEP * numpy.arange(len(one)), 1000 + STEP * numpy.arange(len(other))])
        fit = noise.record(Record(time, numpy.concatenate([one, other]))).fit
        self.assertAlmostEqual(fit.spent.sum(), STEP * (len(one) + len(other) - 2), delta=1e-9)
        crossings = sum((numpy.diff(part) != 0).sum() for part in (one, other))
        self.assertEqual(fit.jumps.sum(), crossings)

    def test_what_levels_cannot_follow(self):
        swing = filtered(100000, 0.3 + 2j, 7)
        self.refused(r"autocorrelation swings to -0\.6.*narrow_band_of", record_of(swing))
        time = STEP * numpy.arange(4000)
        shaking = filtered(4000, 3 + 12j, 9) * time * numpy.exp(-time / 4)
        self.refused("autocorrelation swings to", record_of(shaking))
        differences = numpy.diff(filtered(50001, 50, 3))  # a force whose integral is bounded
        self.refused("autocorrelation|lead over more", record_of(differences))
        self.refused("levels: 2 jumps from level .* are too few to count, 10 are needed", record_of(filtered(2000, 1, 1)))
        self.refused(r"too few to count, 10 are needed; noise.record\(record\) \(levels\) was tried and serves",
                     record_of(filtered(20000, 1, 2)), [-1, 0, 1, 3.4])
        self.refused("do not change", record_of(numpy.ones(100)))
        self.refused(r"uneven; take record.resampled", Record(numpy.cumsum(1 + 0.3 * numpy.sin(numpy.arange(99.0))),
                                                              numpy.arange(99.0)))
        self.refused("levels = 1: must be at least 2", record_of(filtered(20000, 1, 2)), 1)
        self.refused("two, rising", record_of(filtered(20000, 1, 2)), [1, 0])
        self.refused("neighbours or any", record_of(swing), jumps="all")
        self.refused("less than twice its memory", record_of(numpy.arange(50.0)))

    def test_ways_that_messages_name_were_tried(self):
        """Of a shaking that begins and ends, and of steady records; what is named is done as it stands there."""
        time, records = STEP * numpy.arange(6000), [record_of(filtered(20000, 0.3 + 2j, 7)), record_of(filtered(20000, 2, 4))]
        for seed in (1, 4):
            slow = filtered(6000, 1 + 3j, seed) + filtered(6000, 20 + 10j, seed + 1)
            records.append(record_of(slow * numpy.exp(-((time - 15) / 12) ** 2)))
        said = []
        for record in records:
            for fit in (noise.record, noise.narrow_band_of, noise.filtered_of, noise.gaussian_of):
                try:
                    fit(record)
                except ValueError as refused:
                    said.append((record, str(refused)))
        self.assertGreaterEqual(len(said), 4)
        served = 0
        for record, text in said:
            for call in re.findall(r"noise\.\w+\(record.*?\)(?= \(levels)", text):
                eval(call, {"noise": noise, "record": record})  # raises where it does not serve
                served += 1
            self.assertRegex(text, "was tried and serves|were tried, and none fits .*given_force")
        self.assertGreaterEqual(served, 2)

    def test_a_band_of_no_frequency(self):
        """Correlated noise less a little of its slow part swings slowly by 0.06, of which no frequency can be found."""
        decay, z = numpy.exp(-0.2), numpy.random.default_rng(5).standard_normal(20000)
        fast = scipy.signal.lfilter([1], [1, -decay], z)
        record = Record(0.01 * numpy.arange(20000), fast - 0.5 * scipy.signal.lfilter([0.01], [1, -0.99], fast))
        self.refused(r"does not swing, or the record is too short to show it: omega is \d", record,
                     function=noise.narrow_band_of)

    def test_a_narrow_band(self):
        record = record_of(0.2 + 1.5 * filtered(100000, 0.3 + 2j, 7))
        band, chain = noise.narrow_band_of(record), noise.narrow_band_of(record, delta=0.5)
        numpy.testing.assert_allclose(band.terms, [[chain.fit.deviation**2, chain.fit.gamma, chain.fit.omega, 0]])
        self.assertEqual(band.mean, record.value.mean())
        for name, error, true in zip(("deviation", "gamma", "omega"), chain.fit.errors, (1.5, 0.3, 2)):
            value = getattr(chain.fit, name)
            self.assertLess(abs(value - true), 4 * error, name)
            self.assertLess(error, 0.2 * true, name)
            self.assertIn(f"{name} {value:.4g} +- {error:.1g}", chain.notes[0])
        self.assertAlmostEqual(chain.mean, record.value.mean(), delta=1e-9)
        self.refused("does not swing", record_of(filtered(100000, 1, 1)), function=noise.narrow_band_of)
        two = record_of(filtered(100000, 0.1 + 2j, 1) + filtered(100000, 0.1 + 5j, 2))
        self.refused("leaves that of a narrow band by", two, function=noise.narrow_band_of)

    def test_short_records(self):
        """Ten seconds hold some 14 swings of a ground: too few for three standard errors, enough for a band."""
        def accepted(rate):
            found = []
            for seed in range(12):
                try:
                    found.append(noise.narrow_band_of(record_of(filtered(1000, rate, seed))).fit.omega)
                except ValueError as refused:
                    self.assertRegex(str(refused), "does not swing, or the record is too short|less than twice its memory")
            return numpy.array(found)

        omega = accepted(4 + 9j)
        self.assertGreaterEqual(len(omega), 10)
        self.assertLess(abs(omega.mean() - 9), 3 * omega.std() / len(omega) ** 0.5)
        self.assertLessEqual(len(accepted(4)), 4)
        short = record_of(filtered(1000, 4 + 9j, 0))
        with self.assertWarnsRegex(UserWarning, "swings to -0.*less than three standard errors"):
            noise.narrow_band_of(short)
        self.refused("too few to count.*swings to -0.*narrow_band_of", short)

    def test_a_shaking_that_ends_is_said_to_be_none(self):
        time = STEP * numpy.arange(4000)
        shaking = record_of(filtered(4000, 3 + 12j, 9) * time * numpy.exp(-time / 4))
        with self.assertWarnsRegex(UserWarning, "the deviation goes from .* begin and end of a shaking are not represented"):
            noise.narrow_band_of(shaking)


def drawn(noise, count, seed, step=STEP):
    """A record of Gaussian noise: each term by exact steps in one or two coordinates."""
    generator, values = numpy.random.default_rng(seed), numpy.full(count, float(noise.mean))
    for amplitude, decay, frequency, sine in noise.terms:
        off, turn = sine * frequency, frequency * numpy.hypot(1, sine)
        drift = numpy.array([[decay - off, -turn], [turn, decay + off]]) if frequency else numpy.array([[decay]])
        stay = scipy.linalg.expm(-drift * step)
        size, axes = numpy.linalg.eigh(numpy.eye(len(stay)) - stay @ stay.T)
        shocks = generator.standard_normal((count, len(stay))) @ (axes * size.clip(0) ** 0.5).T
        shocks[0], states = generator.standard_normal(len(stay)), numpy.empty((count, len(stay)))
        states[0] = shocks[0]
        for n in range(1, count):
            states[n] = stay @ states[n - 1] + shocks[n]
        values += amplitude**0.5 * states[:, 0]
    return record_of(values, step)


class GaussianNoise(unittest.TestCase):
    def test_the_spectrum_of_kanai_and_tajimi(self):
        omega, t = numpy.array([0, 1, 14, 16, 80]), numpy.array([0, 0.1, 1])
        for damping in (0.1, 0.6, 1, 1.5):
            found, r = noise.filtered(2, 15.6, damping), omega / 15.6
            expected = (1 + (2 * damping * r) ** 2) / ((1 - r**2) ** 2 + (2 * damping * r) ** 2)
            numpy.testing.assert_allclose(found.spectrum(omega) / found.spectrum(0), expected, rtol=3e-6)
            self.assertAlmostEqual(found.deviation, 2, delta=1e-12)
        many = numpy.linspace(0, 4000, 400001)  # Wiener and Khinchin
        waves = found.spectrum(many) * numpy.cos(numpy.multiply.outer(t, many))
        numpy.testing.assert_allclose(scipy.integrate.simpson(waves, many) / numpy.pi, found.covariance(t), atol=0.03)

    def test_sums_scales_and_shifts(self):
        band, ou, t = noise.narrow_band(1.5, 0.5, 3), noise.ou(0.7, 2), numpy.array([0, 0.7, 3])
        both = 2 * band + (ou + 0.3)
        expected = 9 * numpy.exp(-t / 2) * numpy.cos(3 * t) + 0.49 * numpy.exp(-t / 2)
        numpy.testing.assert_allclose(both.covariance(t), expected)
        self.assertEqual(both.options, {"noise": "gaussian", "covariance": "9.0,0.5,3.0;0.48999999999999994,0.5", "bias": 0.3})
        self.assertAlmostEqual(both.correlation_time, (9 * 0.5 / 9.25 + 0.49 * 2) / 9.49, delta=1e-12)
        self.assertEqual(sum([band, ou]).deviation, (band + ou).deviation)
        for wrong in (lambda: band + noise.telegraph(1, 1), lambda: noise.telegraph(1, 1) + band):
            self.assertRaisesRegex(TypeError, r"narrow band \+ telegraph: is no sum.*lattice\(delta\)", wrong)

    def test_what_is_no_covariance(self):
        for terms, message in (([(1, 1), (1, 0)], r"terms\[1\] = \(1, 0\): must be"), ([1, 1], r"terms\[0\] = 1"),
                               ([(1, 1, 2, 3, 4)], r"terms\[0\]"), ([(1, 1), (-1, 2)], "variance 0"), ([], "variance 0"),
                               ([(1, 1, 1, 1.1)], "spectrum is -.* at the frequency"),
                               ([(2, 1), (-1, 0.4)], "spectrum is -1 at the frequency 0,")):
            self.assertRaisesRegex(ValueError, message, noise.gaussian, terms)
        noise.gaussian([(1, 1, 1, -1)])  # the spectrum is 0 at 0

    def test_the_program_takes_it(self):
        ground, omega = noise.filtered(2, 15.6, 0.6) + noise.ou(0.5, 1), [0, 3, 16]
        with tempfile.TemporaryDirectory() as folder:
            ground.save(pathlib.Path(folder) / "ground.csv")
            asked = {"quantities": "noise_law,noise_spectrum", "omega": omega, "mu_s": 1.5, "mu_d": 0.7, "accuracy": 1e-2}
            for options in ({"noise": ground}, {"noise": "gaussian", "covariance_file": pathlib.Path(folder) / "ground.csv"}):
                r = stickslip.run(**options, **asked)
                numpy.testing.assert_allclose(r["S_x_target"].value, ground.spectrum(omega), rtol=1e-5)
                self.assertAlmostEqual(r["E_X2"].value, 4.25, delta=1e-9)
        force = noise.ou(1, 1) + 0.2
        shifted, biased = (stickslip.run(**options, mu_d=0.5, accuracy=1e-4)["P_stick"].value for options in (
            {"noise": force}, {"noise": "gaussian", "covariance": "1,1", "bias": 0.2}))
        self.assertAlmostEqual(shifted, biased, delta=1e-9)
        for name in ("bias", "covariance", "sweep_bias"):
            with self.assertRaisesRegex(stickslip.BadInput, f"{name} = .*leave it out"):
                stickslip.run(noise=force, **{name: "1"})

    def test_its_lattice(self):
        """Central differences, of second order, halve twice with the step where they can be had."""
        omega = numpy.array([0, 10, 20])
        for made, within in ((noise.filtered(1, 15.6, 0.6), 0.03), (noise.gaussian([(1, 4, 9, -4 / 9)], 0.3), 0.35),
                             (noise.ou(1, 1) + noise.ou(0.5, 0.1), 0.06)):
            chain = made.lattice(0.5, 4)
            self.assertAlmostEqual(chain.mean, made.mean, delta=1e-9)
            self.assertLess(abs(chain.generator.sum(axis=1)).max(), 1e-9)
            power = made.spectrum(omega)
            numpy.testing.assert_allclose(chain.spectrum(omega), power, atol=within * power.max())
            numpy.testing.assert_allclose(chain.meant.spectrum(omega), power)
        self.assertRaisesRegex(ValueError, "amplitude = -0.2", noise.gaussian([(1, 1), (-0.2, 2)]).lattice, 0.5)


class GaussianOfRecords(Quiet):
    def test_an_exact_covariance_gives_its_terms(self):
        t = 0.02 * numpy.arange(400)
        for terms in ([(0.3, 1.2, 0, 0), (0.7, 0.5, 4, -0.1)], [(0.6, 8, 0, 0), (0.4, 0.7, 0, 0)],
                      [(0.2, 0.4, 2, 0), (0.8, 1, 9, 0.05)], [(1, 4, 9, -4 / 9)]):
            swings = sum(row[2] > 0 for row in terms)
            memory = Memory(0.02, noise.gaussian(terms).covariance(t), 0.02, 1.0, 1000.0)
            shape = gaussian_noise_of_records._Shape(len(terms) - swings, swings)
            found = shape.terms(gaussian_noise_of_records._first(shape, memory), memory)
            order = [abs(found[:, 1] - row[1]).argmin() for row in terms]
            numpy.testing.assert_allclose(found[order], terms, atol=1e-4)

    def test_the_terms_of_records(self):
        made = {"ou": noise.ou(1.2, 0.5), "band": noise.narrow_band(1.5, 0.5, 3), "ground": noise.filtered(2, 6, 0.6),
                "ou and band": noise.ou(0.7, 1) + noise.narrow_band(1, 0.5, 4),
                "two bands": noise.narrow_band(1, 0.2, 2) + noise.narrow_band(1, 0.3, 6)}
        for name, true in made.items():
            for seed in (1, 2):
                with self.subTest(name, seed=seed):
                    found = noise.gaussian_of(drawn(true, 20000, seed, 0.02))
                    self.assertEqual(len(found.terms), len(true.terms))
                    parts = [(f"{part}_{n + 1}", value) for n, row in enumerate(true.terms) for part, value in zip(
                        ("amplitude", "decay", "frequency", "sine"), row[:4 if row[2] else 2])]
                    for part, value in parts:
                        error = found.fit.errors[found.fit.names.index(part)]
                        self.assertLess(abs(getattr(found.fit, part) - value), 4 * error, part)
                        self.assertLess(error, max(0.35 * abs(value), 0.15), part)
                    self.assertGreaterEqual(found.spectrum(numpy.linspace(0, 100, 5001)).min(), 0)

    def test_the_number_of_terms(self):
        record = drawn(noise.ou(0.7, 1) + noise.narrow_band(1, 0.5, 4), 20000, 1, 0.02)
        one, two = noise.gaussian_of(drawn(noise.ou(1, 1), 20000, 1, 0.02), 2), noise.gaussian_of(record, 2)
        self.assertEqual((len(one.terms), len(two.terms)), (2, 2))
        self.assertEqual([len(axes.lines) for axes in two.plot().axes], [2, 2])  # the noise beside the record
        self.assertRaisesRegex(ValueError, "terms = 0: must be a whole number", noise.gaussian_of, record, 0)
        with self.assertWarnsRegex(UserWarning, "off by 0.* in the mean square, and by 0.* by chance: these terms do not"):
            noise.gaussian_of(record, 1)
        with self.assertWarnsRegex(UserWarning, "sine_1 is at the end of what is taken: paths may be smoother"):
            noise.gaussian_of(drawn(noise.gaussian([(1, 1, 3, 0.99 / 3)]), 20000, 2, 0.02))
        bands = drawn(noise.narrow_band(1, 0.1, 2) + noise.narrow_band(1, 0.1, 5), 40000, 1, 0.02)
        self.assertRaisesRegex(ValueError, r"leaves that of 1 terms by .*noise.gaussian_of\(record\) \(levels --gaussian\)",
                               noise.gaussian_of, bands, 1)

    def test_a_body_under_the_fit_sticks_as_under_the_noise(self):
        found = noise.filtered_of(drawn(noise.filtered(2, 15.6, 0.6), 80000, 3))
        r = stickslip.run(noise=found, mu_s=1.5, mu_d=0.75, accuracy=0.02, quantities="sticking")
        self.assertAlmostEqual(r["P_stick"].value / 0.057558, 1, delta=0.06)  # that of the true noise by another program

    def test_the_numbers_of_a_ground(self):
        for damping in (0.1, 0.3, 0.6, 0.8):
            fit = noise.filtered_of(drawn(noise.filtered(1.5, 15, damping), 40000, 3))
            for found, error, true in zip((fit.deviation, fit.frequency, fit.damping), fit.errors, (1.5, 15, damping)):
                self.assertLess(abs(found - true), 4 * error)
                self.assertLess(error, 0.15 * true)
            self.assertLess(fit.misfit, 0.05)

    def test_what_is_no_ground(self):
        def refused(message, values):
            with self.assertRaisesRegex(ValueError, message):
                noise.filtered_of(record_of(values))

        refused("decays without a swing, as that of no ground does", filtered(40000, 5, 1))
        refused("leaves that of filtered noise by", filtered(40000, 0.5, 2) + filtered(40000, 3 + 40j, 1))

    def test_means(self):
        shaken = drawn(noise.filtered(1, 15, 0.5), 4000, 1).value
        shaken -= shaken.mean()
        self.assertEqual(noise.filtered_of(record_of(shaken)).mean, 0)
        self.assertAlmostEqual(noise.filtered_of(record_of(shaken + 5)).mean, 5, delta=1e-9)
        doubtful = noise.filtered_of(record_of(shaken + 0.05))
        self.assertIn("the mean of the record, 0.05 +- 0.04, is left out; noise + record.value.mean() has it", str(doubtful))
        self.assertEqual(doubtful.mean, 0)


class CommandLine(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="levels µ ")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def levels(self, *words, status=0, command="levels"):
        done = subprocess.run([sys.executable, "-m", "stickslip", command, *map(str, words)], cwd=self.folder,
                              capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(SOURCES / "python")})
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stdout if status == 0 else done.stderr

    def test_from_a_file_to_numbers(self):
        values = filtered(60000, 1, 1)
        rows = "".join(f"{STEP * n:.2f};{v:.6f}\n".replace(".", ",") for n, v in enumerate(values))
        (self.folder / "wind.csv").write_text("t;north;east\n" + rows.replace("\n", ";0\n"))
        said = self.levels("wind.csv", "--column", "north", "--scale", "2", "--match-time", "--picture", "wind.png")
        for part in ("60000 samples", "values were multiplied by 2", "correlation time: chain", "all rates were multiplied",
                     "-noise file -noise_file wind_levels.csv", "wind.png"):
            self.assertIn(part, said)
        self.assertTrue((self.folder / "wind.png").read_bytes().startswith(b"\x89PNG"))
        r = stickslip.run(noise="file", noise_file=self.folder / "wind_levels.csv", quantities="noise_law", mu_d=0.5)
        self.assertAlmostEqual(r["E_X2"].value, 4, delta=1)
        self.assertIn("2 columns of values", self.levels("wind.csv", status=2))
        self.assertIn("no such file", self.levels("none.csv", status=2))

    def test_chains_take_two_files(self):
        numpy.save(self.folder / "a.npy", path_of(numpy.array([-1, 0.5, 2]), ANY, 500, 4).value)
        said = self.levels("a.npy", "--step", STEP, "--jumps", "any")
        self.assertIn("-noise chain -noise_states a_states.csv -noise_rates a_rates.csv", said)
        r = stickslip.run(noise="chain", noise_states=self.folder / "a_states.csv", noise_rates=self.folder / "a_rates.csv",
                          quantities="sticking", mu_d=0.5)
        self.assertTrue(0 < r["P_stick"].value < 1)
        numpy.save(self.folder / "b.npy", filtered(50000, 1 + 2j, 4))
        self.assertIn("swings to", self.levels("b.npy", "--step", STEP, status=2))
        self.assertIn("gamma", self.levels("b.npy", "--step", STEP, "--narrow-band"))
        numpy.save(self.folder / "c.npy", drawn(noise.filtered(1.5, 15, 0.6), 20000, 5).value)
        for word in ("--filtered", "--gaussian"):  # nearly the same
            self.assertRegex(self.levels("c.npy", "--step", STEP, word, "--picture", "c.png"),
                             r"-noise gaussian -covariance 2\.\d+,\d+\.\d+,\d+\.\d+,-0\.\d+\nc.png\n")


    def test_a_record_for_force_file(self):
        time = 0.01 * numpy.arange(400)
        value = 0.5 + 0.2 * numpy.sin(numpy.pi * time)
        rows = [f"{t:.2f};{v:.9f}".replace(".", ",") for t, v in zip(time, value)]
        rows[200:202] = ["2,00;nan", "2,01;nan"]
        (self.folder / "ground.csv").write_text("Zeit [s];a [g]\n" + "\n".join(rows))

        def force(*words, status=0):
            return self.levels("ground.csv", *words, status=status, command="force")

        self.assertIn("missing in 1 gaps; --fill 0.03 joins them", force(status=2))
        said = force("--fill", 0.03, "--centre", "--scale", -1)
        self.assertIn("-quantities given_force -force_file ground_force.csv", said)
        t, x = numpy.loadtxt(self.folder / "ground_force.csv", delimiter=",", skiprows=1).T
        numpy.testing.assert_allclose(t, time, atol=1e-9)
        numpy.testing.assert_allclose(x, -9.80665 * (value - value.mean()), atol=1e-3)
        force("--between", 0.5, 1, "-o", "part.csv")
        part = stickslip.run(force_file=self.folder / "part.csv", mu_d=0, drag="none", quantities="given_force")
        numpy.testing.assert_allclose(part["path_force"].abscissa[[0, -1]], [0.5, 1])
        self.assertIn("no such column", force("--column", "b", status=2))


class WithoutSciPy(unittest.TestCase):
    def test_one_sentence(self):
        done = subprocess.run([sys.executable, "-c", "import sys; sys.modules['scipy'] = None; import stickslip; "
                               "stickslip.noise"], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": str(SOURCES / "python")})
        self.assertEqual(done.stderr.splitlines()[-1], "ImportError: stickslip needs scipy for this: pip install scipy, or "
                         "on Debian apt-get install python3-scipy")


if __name__ == "__main__":
    unittest.main()
