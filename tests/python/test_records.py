"""Records read from files of every kind, which the tests write themselves."""

import codecs
import dataclasses
import os
import pathlib
import sys
import tempfile
import unittest
import warnings

import numpy
import scipy.io

SOURCES = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("STICKSLIP_BINARIES", SOURCES / "build"))
os.environ["STICKSLIP"] = str(BINARIES / "stickslip")
sys.path.insert(0, str(SOURCES / "python"))
import stickslip

G = 9.80665
TIME = 0.02 * numpy.arange(8)
VALUE = numpy.array([0.1, -0.25, 0.5, 0.125, -1.5, 2.25, -0.75, 0.0625])


class Case(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="Aufzeichnung µ ")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def written(self, name, text):
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def read(self, text, name="a.csv", **options):
        return stickslip.read_record(self.written(name, text), **options)

    def same(self, record, unit="", factor=1, time=TIME, value=VALUE, within=1e-12):
        numpy.testing.assert_allclose(record.time, time, atol=1e-9)
        numpy.testing.assert_allclose(record.value, factor * value, rtol=0, atol=within)
        self.assertEqual(record.unit, unit)

    def refused(self, message, text, name="a.csv", **options):
        with self.assertRaisesRegex(ValueError, message) as caught:
            self.read(text, name, **options)
        self.assertIn(name, str(caught.exception))


def columns(separator=",", decimal=".", head="", end="\n"):
    rows = [f"{t:.2f}{separator}{v:.4f}".replace(".", decimal) for t, v in zip(TIME, VALUE)]
    return end.join(([head] if head else []) + rows + [""])


class Text(Case):
    def test_separators_and_decimal_signs(self):
        for separator in (",", ";", "\t", " ", "   ", "|", " ; "):
            self.same(self.read(columns(separator)))
        for separator in (";", "\t", " ", "; "):
            self.same(self.read(columns(separator, ",")))
            self.same(self.read(columns(separator, ",", f"time{separator}force")))

    def test_encodings_and_ends_of_lines(self):
        head = "time [s];Beschleunigung [m/s²]"
        for text in (codecs.BOM_UTF8 + columns(";", ",", head).encode(), columns(";", ",", head).encode("utf-16"),
                     columns(";", ",", head, "\r\n").encode()):
            record = self.read(text)
            self.same(record, "m/s^2")
            self.assertIn("column Beschleunigung", record.source)
        self.same(self.read("\ufeffa;x\n" + columns(";"), time="a"))

    def test_units_are_converted_and_said(self):
        for unit, factor in (("g", G), ("mg", G / 1000), ("gal", 0.01), ("cm/s^2", 0.01), ("CM/SEC/SEC", 0.01),
                             ("mm/s2", 1e-3), ("m/s/s", 1), ("%g", G / 100), ("ft/s/s", 0.3048), ("in s^-2", 0.0254)):
            record = self.read(columns(head=f"time (ms),acc ({unit})"))
            self.same(record, "m/s^2", factor, TIME / 1000)
            self.assertTrue(any("ms became s" in note for note in record.notes))
            self.assertEqual(any(f"{unit} became m/s^2: times {factor:g}" in note for note in record.notes), factor != 1)
        self.same(self.read(columns(head="t,acc_g")), "m/s^2", G)
        self.same(self.read(columns(head="t,force [N]")), "N")
        self.same(self.read(columns(head="t,a"), unit="gal"), "m/s^2", 0.01)
        self.same(self.read(columns(head="# made today\n# time [s], a [g]")), "m/s^2", G)
        self.same(self.read(columns(" ", head="time [s] a [g]")), "m/s^2", G)
        self.same(self.read(columns(head="time,a\n[s],[g]")), "m/s^2", G)

    def test_units_and_steps_that_are_in_doubt_are_said(self):
        for text, options, note in ((columns(head="t,a"), {}, 'no unit is named: .*unit="g"'),
                                    (columns(head="t,a"), {"unit": "milli-g"}, "milli-g is none of g, mg, gal"),
                                    (columns(head="t,a [g]"), {"unit": "gal"}, "the file says g, and was taken to be in gal")):
            self.assertRegex(" ".join(self.read(text, **options).notes), note)
        for head, options in (("t,a [N]", {}), ("t,a [g]", {"unit": "G"}), ("t,a", {"unit": "gal"})):
            self.assertNotRegex(" ".join(self.read(columns(head=head), **options).notes), "none of|no unit|taken to be")

    def test_a_ground_that_does_not_come_to_rest(self):
        """One period of a sine of amplitude 1 m/s^2 reaches the velocity T/pi; the offset adds T times it."""
        time = numpy.linspace(0, 2, 401)

        def notes(offset, unit="m/s2"):
            text = f"t,a [{unit}]\n" + "".join(f"{t!r},{v!r}\n" for t, v in zip(
                time.tolist(), (numpy.sin(numpy.pi * time) + offset).tolist()))
            return " ".join(self.read(text).notes)

        self.assertNotIn("integral", notes(0.9))
        self.assertNotIn("integral", notes(2, "N"))
        self.assertRegex(notes(2), r"its integral ends at 4 m/s, and would reach 0.637 m/s without its mean.*centred\(\)")

    def test_columns_by_name_and_number(self):
        text = "NS,time,EW\n" + "".join(f"{-v},{t},{v}\n" for t, v in zip(TIME, VALUE))
        for column in ("EW", "ew", 2, "2"):
            self.same(self.read(text, column=column))
        self.same(self.read(text, column=0), factor=-1)
        self.same(self.read(text.replace("time", "clock"), column="EW", time="clock"))
        self.refused(r"2 columns of values; take one of 0 \(NS\), 2 \(EW\)", text)
        for name in ("Up (g)", "up [G]", "up"):
            self.same(self.read(columns(head="t,Up (g)"), column=name), "m/s^2", G)
        self.refused(r"column = up: there is no such column; take one of 0 \(NS\)", text, column="up")

    def test_one_column_needs_a_step(self):
        for decimal in (".", ","):
            text = "\n".join(f"{v:.4f}".replace(".", decimal) for v in VALUE)
            self.same(self.read(text, step=0.02))
            self.refused("step: the file has no times.*step=0.01", text)
        with self.assertRaisesRegex(ValueError, r"step = -1: must be in \(0, inf\)"):
            self.read(text, step=-1)

    def test_two_readings_of_a_comma(self):
        text = "0,5\n0,25\n0,125\n"
        numpy.testing.assert_array_equal(self.read(text, step=1).value, [0.5, 0.25, 0.125])
        rising = "1,5\n2,25\n3,125\n"
        numpy.testing.assert_array_equal(self.read(rising).value, [5, 25, 125])
        numpy.testing.assert_array_equal(self.read(rising, decimal=",", step=1).value, [1.5, 2.25, 3.125])

    def test_dates_become_seconds(self):
        text = "date;a\n" + "".join(f"2024-02-29 23:59:{58 + n // 2:02}.{5 * (n % 2)}00;{n}\n" for n in range(4))
        numpy.testing.assert_allclose(numpy.diff(self.read(text).time), 0.5, atol=1e-6)

    def test_what_cannot_be_read(self):
        self.refused("line 4: 'stop,0': needs 2 numbers", "t,a\n0,1\n1,2\nstop,0\n2,3\n3,1\n" + columns())
        self.refused("no numbers in columns", "one\ntwo\nthree\n")
        self.refused("is empty", "\n\n")
        self.refused(r"time\[2\] = 1: must be above time\[1\] = 1; sort", "t,a\n0,1\n1,2\n1,3\n")
        self.refused("binary, in no known format", b"\0\1\2" * 50, "a.sac")
        self.assertRaisesRegex(FileNotFoundError, "none.csv: no such file", stickslip.read_record, self.folder / "none.csv")

    def test_gaps_missing_values_and_drift(self):
        time = 0.01 * numpy.delete(numpy.arange(2000), slice(500, 700))
        noise = numpy.random.default_rng(1).standard_normal(len(time))
        rows = "".join(f"{t:.2f},{v}\n" for t, v in zip(time, noise + time))
        record = self.read("t,a\n" + rows.replace("\n", "\n0.005,nan\n", 1))
        numpy.testing.assert_allclose(record.gaps, [[4.99, 7.00]])
        self.assertEqual([len(part) for part in record.stretches()], [500, 1300])
        text = str(record)
        for part in ("1 samples are no numbers", "1 gaps of 2.01 s in all, the longest from 4.99 to 7 s", "drifts by 2"):
            self.assertIn(part, text)
        drift, error = record.drift
        self.assertLess(abs(drift - 19.99), 4 * error)
        self.assertLess(error, 0.5)
        self.assertIn("drifts by", str(self.read("t,a\n" + "".join(f"{t:.2f},{v}\n" for t, v in zip(time, noise + time / 20)))))
        self.assertNotIn("drift", str(self.read("t,a\n" + "".join(f"{t:.2f},{v}\n" for t, v in zip(time, noise)))))

    def test_uneven_steps(self):
        time = numpy.cumsum(1 + 0.3 * numpy.sin(numpy.arange(100.0)))
        record = self.read("t,a\n" + "".join(f"{t!r},{2 * t!r}\n" for t in time.tolist()))
        self.assertFalse(record.even)
        self.assertIn("steps are uneven", str(record))
        even = record.resampled(0.5)
        self.assertTrue(even.even)
        numpy.testing.assert_allclose(even.value, 2 * even.time)
        self.assertTrue(self.read(columns()).even)


class Formats(Case):
    def test_at2(self):
        long = numpy.tile(VALUE, 3)
        body = "\n".join("".join(f"{v:15.7E}" for v in long[n:n + 5]) for n in range(0, 24, 5))
        for line in ("NPTS=     24, DT=   .0200 SEC,", "   24   .0200    NPTS, DT"):
            text = f"PEER NGA STRONG MOTION DATABASE RECORD\nSomewhere, 1/2/1999, Hill, 90\nACCELERATION TIME SERIES IN UNITS OF G\n{line}\n{body}\n"
            record = self.read(text, "a.AT2")
            self.same(record, "m/s^2", G, 0.02 * numpy.arange(24), long, 1e-6)
            self.assertIn("G became m/s^2", str(record))
            self.assertIn("steps of 0.02 s, and 0.01 s were taken", str(self.read(text, "c.AT2", step=0.01)))
            self.refused("holds 24 samples, NPTS = 99", text.replace("24,", "99,").replace("   24 ", "   99 "), "b.AT2")

        lacking = text.replace(line, "NPTS= 24")
        self.same(self.read(lacking, "d.AT2", step=0.02), "m/s^2", G, 0.02 * numpy.arange(24), long, 1e-6)
        self.refused("the file has no times; .* step=0.01", lacking, "e.AT2")
        self.refused("line 4: NPTS: needs NPTS= and DT=, such as", text.replace(line, "NPTS"), "f.AT2")

    def cosmos(self, step=20.0, values=VALUE):
        real = numpy.full(100, -999.0)
        real[33] = step
        lines = [f"{''.join(f'{x:15.6f}' for x in real[n:n + 5])}" for n in range(0, 100, 5)]
        body = "\n".join("".join(f"{v:10.5f}" for v in values[n:n + 8]) for n in range(0, len(values), 8))
        return ("Corrected acceleration     (Format v01.20 with 13 text lines)\n" + "words\n" * 12
                + " 100 Real-header values follow on  20 lines, Format= (5F15.6)\n" + "\n".join(lines)
                + f"\n    1 Comment line(s) follow, each starting with a \"|\":\n|\n{len(values):8d} acceleration pts, approx   0 "
                f"secs, units=cm/sec2(04),Format=(8F10.5)\n{body}\nEnd-of-data for Chan  1 acceleration\n")

    def test_cosmos_v2(self):
        large = VALUE * 100 - 500  # numbers without a space between them
        self.same(self.read(self.cosmos(values=large), "a.v2"), "m/s^2", 0.01, value=large, within=1e-6)
        self.refused("real header, value 34: .* 9000 s does not make 8 samples last 0 s", self.cosmos(9e6), "b.v2")
        self.refused("holds 8 of the 9 samples", self.cosmos().replace("       8 acc", "       9 acc").partition("End")[0], "c.v2")
        two = self.cosmos() + self.cosmos(values=-VALUE)
        self.refused(r"2 columns of values; take one of 0 \(acceleration 0\), 1 \(acceleration 1\)", two, "d.v2")
        self.same(self.read(two, "e.v2", column=1), "m/s^2", -0.01, within=1e-7)

    def test_csmip_v2(self):
        body = "".join(f"{v:10.3f}" for v in VALUE)
        text = f"Corrected accelerogram\nwords\n    8 points of accel data equally spaced at  .020 sec, in cm/sec2. (8f10.3)\n{body}\n" \
               f"    8 points of veloc data equally spaced at  .020 sec, in cm/sec. (8f10.3)\n{body}\n"
        self.same(self.read(text, "a.V2"), "m/s^2", 0.01, value=numpy.round(VALUE, 3))

    def test_sac(self):
        numbers, integers = numpy.full(70, -12345.0), numpy.full(40, -12345)
        numbers[0], numbers[5] = 0.02, 3
        integers[[9, 16, 35]] = len(VALUE), 8, 1

        def lines(values, form, wide):
            return "".join("".join(form % v for v in values[n:n + wide]) + "\n" for n in range(0, len(values), wide))

        def text():
            return (lines(numbers, "%15.7g", 5) + lines(integers, "%10d", 5) + "-12345  -12345          \n"
                    + "-12345  -12345  -12345  \n" * 7 + lines(VALUE, "%15.7g", 5))

        self.same(self.read(text(), "a.sac"), time=3 + TIME, within=1e-6)
        self.same(self.read(text(), "a.sac", unit="mm/s^2"), "m/s^2", 1e-3, 3 + TIME, within=1e-6)
        integers[35] = 0
        self.refused("LEVEN = 0", text(), "b.sac")

    def test_npy(self):
        for name, array in (("a.npy", numpy.column_stack([TIME, VALUE])), ("b.npy", numpy.stack([TIME, VALUE]))):
            numpy.save(self.folder / name, array)
            self.same(stickslip.read_record(self.folder / name))
        numpy.save(self.folder / "c.npy", VALUE)
        self.same(stickslip.read_record(self.folder / "c.npy", step=0.02))
        numpy.save(self.folder / "d.npy", numpy.array(["one", "two"]))
        self.assertRaisesRegex(ValueError, "d.npy: .*needs numbers", stickslip.read_record, self.folder / "d.npy")

    def test_matlab(self):
        path = self.folder / "a.mat"
        scipy.io.savemat(path, {"t": TIME, "force": VALUE, "note": "words"})
        self.same(stickslip.read_record(path))
        scipy.io.savemat(path, {"acc": VALUE, "fs": 50.0})
        self.same(stickslip.read_record(path, unit="g"), "m/s^2", G)
        path.write_bytes(b"MATLAB 7.3 MAT-file" + b"\0" * 200)
        self.assertRaisesRegex(ValueError, "save.*-v7", stickslip.read_record, path)


class Records(Case):
    def test_parts_and_scales(self):
        record = stickslip.Record(TIME, VALUE, "N")
        self.same(record.between(0.02, 0.06), "N", time=TIME[1:4], value=VALUE[1:4])
        self.same(record.scaled(2, "kN"), "kN", 2)
        self.assertIn("multiplied by 2", str(record.scaled(2)))
        self.same(record.centred(), "N", value=VALUE - VALUE.mean())
        self.assertRaisesRegex(ValueError, r"between\(0.06, 0.02\): holds 0 samples; take two times .* from 0 to 0.14",
                               record.between, 0.06, 0.02)

    def test_gaps_are_joined_where_that_is_asked_for(self):
        record = stickslip.Record([0, 1, 2, 4, 5, 6, 9], [0, 1, 2, 4, 5, 6, 9])
        numpy.testing.assert_array_equal(record.resampled(1).time, record.time)
        joined = record.resampled(1, across=2)
        numpy.testing.assert_array_equal(joined.time, [0, 1, 2, 3, 4, 5, 6, 9])
        numpy.testing.assert_allclose(joined.value, joined.time)
        self.assertRaisesRegex(ValueError, r"step = 0: must be in \(0, inf\); take for example 1", record.resampled, 0)

    def test_arrays_with_a_unit_are_as_a_file_with_it(self):
        for unit, factor in (("g", G), ("cm/s^2", 0.01), ("gal", 0.01), ("m/s2", 1), ("", 1)):
            with self.subTest(unit):
                read = self.read(columns(), unit=unit or None)
                made = stickslip.Record(TIME, VALUE, unit)
                self.same(made, read.unit, factor)
                self.assertEqual([note for note in read.notes if "no unit" not in note], list(made.notes))
                self.assertEqual(stickslip.Record(made.time, made.value, made.unit).value.tolist(), made.value.tolist())
        made = stickslip.Record(TIME, VALUE, "g")
        self.assertEqual(made.notes[0], "g became m/s^2: times 9.80665")
        self.assertIn(f"peak {2.25 * G:.5g} m/s^2 at 0.1 s", repr(made))
        # What looks wrong is said of what there is: without its mean, nothing is left of an offset.
        offset = stickslip.Record(TIME, VALUE + 9, "g")
        self.assertIn("would reach", repr(offset))
        self.assertNotIn("would reach", repr(offset.centred()))
        made.save(self.folder / "f.csv")
        self.assertEqual((self.folder / "f.csv").read_text().splitlines()[:2], ["time,force", "# unit: m/s^2"])

    def test_gravity_twice(self):
        record = stickslip.Record(TIME, VALUE, "m/s^2")
        options = {"force_file": record, "drag": "none", "quantities": "given_force"}
        for act in (lambda: record.scaled(-9.81), lambda: stickslip.run(force_scale=9.81, **options)):
            with self.assertWarnsRegex(UserWarning, "in m/s.2 already.*right for g") as caught:
                act()
            self.assertEqual(pathlib.Path(caught.filename).name, "test_records.py")
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            record.scaled(9.81, "m/s^2")
            record.scaled(-1)

    def test_records_where_something_else_is_wanted(self):
        time = numpy.delete(0.01 * numpy.arange(100), [50, 51])
        record = stickslip.Record(time, numpy.sin(time))
        self.assertRaisesRegex(stickslip.BadInput, r"1 gaps, the longest of 0.03 s from 0.49 s on; "
                               r"record.resampled\(0.01, across=0.03\)", stickslip.run, force_file=record)
        self.assertRaisesRegex(stickslip.BadInput, "noise: is a record; .*narrow_band_of", stickslip.run, noise=record)
        for make in (stickslip.noise.record, stickslip.noise.narrow_band_of):
            self.assertRaisesRegex(TypeError, r"record: is a str; stickslip.read_record\(path\)", make, "a.AT2")

    def test_a_record_as_the_given_force(self):
        """A force of 2 for the time 1 moves a body without friction to 1, and leaves it with the velocity 2."""
        record = stickslip.Record([0, 1, 1.5], [2, 0, 0])
        options = {"quantities": "given_force", "drag": "none", "mu_s": 1e-9, "mu_d": 0, "force_interpolation": "constant"}
        one = stickslip.run(force_file=record, **options)
        self.assertAlmostEqual(one["path_displacement"].value[1], 1, delta=1e-12)
        self.assertAlmostEqual(one["final_displacement"].value, 2, delta=1e-12)
        self.assertTrue(one.options["force_file"].endswith("/force.csv"))
        named = dataclasses.replace(record, source="../Kobe.AT2: AT2 of PEER, column acceleration")
        self.assertTrue(stickslip.run(force_file=named, **options).options["force_file"].endswith("/Kobe.csv"))
        swept = stickslip.sweep(force_file=record, force_scale=[1, -3], **options)
        numpy.testing.assert_allclose(swept["final_displacement"].value, [2, -6])
        both = stickslip.map([{"force_file": record}, {"force_file": record.scaled(0.5)}], **options)
        numpy.testing.assert_allclose([r["final_displacement"].value for r in both], [2, 1])

    def test_what_is_no_record(self):
        for time, value, message in (([0, 1], [1, numpy.inf], r"value\[1\] = inf: must be finite"),
                                     ([0, 0], [1, 2], r"time\[1\] = 0: must be above"), ([0], [1], "at least 2"),
                                     ([0, 1, 2], [1, 2], r"shapes \(3,\) and \(2,\)")):
            self.assertRaisesRegex(ValueError, message, stickslip.Record, time, value)


if __name__ == "__main__":
    unittest.main()
