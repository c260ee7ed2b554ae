"""Newmark's sliding block, by closed forms."""

import unittest
import warnings

import numpy
from test_package import PNG, Case, stickslip

G = 9.80665


class Newmark(Case):
    def test_a_rectangular_pulse(self):
        """Ground at -a for the time T, beside a yield acceleration y: the block goes on to v = (a - y) T, and stops after
        v/y more; its path is v T/2 + v^2/(2 y) in the positive direction. The other pulse pushes it back."""
        a, y, T = 0.4, 0.1, 0.5
        end = numpy.array([0, T, 6, 6 + T, 12])
        record = stickslip.Record(end, [-a, 0, a, 0, 0], "g")
        v = (a - y) * G * T
        path = v * T / 2 + v**2 / (2 * y * G)
        for given in ("0.1g", "0.1 g", f"{y * G} m/s^2", f"{100 * y * G} gal"):
            r = stickslip.newmark(record, given, force_interpolation="constant")
            self.assertAlmostEqual(r["slip_displacement"].value[0], path, delta=1e-12 * path)
            self.assertAlmostEqual(r["final_displacement"].value, 0, delta=1e-12 * path)
            numpy.testing.assert_allclose(r["slip_end"].value, [T + v / (y * G), 6 + T + v / (y * G)], rtol=1e-13)
            self.assertAlmostEqual(r["largest_speed"].value, v, delta=1e-12)
        self.assertEqual([r[key].unit for key in ("final_displacement", "largest_speed", "slip_end")], ["m", "m/s", "s"])
        for sign, slips in ((1, 1), (-1, 1)):
            one = stickslip.newmark(record.scaled(sign), "0.1g", one_way=True, force_interpolation="constant")
            self.assertAlmostEqual(one["final_displacement"].value, path, delta=1e-12 * path)
            self.assertEqual(one["slip_count"].value, slips)

    def test_vertical_accelerations(self):
        """Half of gravity downwards halves friction, whatever the scale of the horizontal ones."""
        time, value = [0, 0.5, 8], numpy.array([-0.4, 0, 0])
        record = stickslip.Record(time, value, "g", vertical=[-0.5] * 3)
        half = stickslip.newmark(record, "0.1g", force_interpolation="constant")
        other = stickslip.newmark(stickslip.Record(time, value, "g"), "0.05g", force_interpolation="constant")
        self.assertAlmostEqual(half["final_displacement"].value, other["final_displacement"].value, delta=1e-12)
        with self.assertRaisesRegex(stickslip.BadInput, "lifts the body off the ground at time 0, .*-force_gravity = 9.80665"):
            stickslip.newmark(record.scaled(3), "0.1g")
        self.assertRaisesRegex(ValueError, "vertical: shape", stickslip.Record, time, value, vertical=[1])

    def test_units_that_do_not_fit(self):
        record = stickslip.Record([0, 1, 2], [0, 2, 0])
        self.assertAlmostEqual(stickslip.newmark(record, 2)["slip_count"].value, 0)
        for given, message in (("0.1g", "is in g, and the record has no unit"), ("much", "must be a number"),
                               ("3 s", "is in s")):
            self.assertRaisesRegex(stickslip.BadInput, message, stickslip.newmark, record, given)

    def test_a_number_without_a_unit_beside_a_record_that_was_in_g(self):
        time, value = [0, 1, 2], [0, 0.3, 0]
        with self.assertWarnsRegex(UserWarning, 'yield_acceleration = 0.1: is taken in m/s.2.*write "0.1g"') as place:
            r = stickslip.newmark(stickslip.Record(time, value, "g"), 0.1)
        self.assertEqual(place.filename, __file__)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for record in (stickslip.Record(time, G * numpy.array(value), "m/s^2"), stickslip.Record(time, G * numpy.array(value))):
                same = stickslip.newmark(record, 0.1)["final_displacement"].value
                self.assertAlmostEqual(same, r["final_displacement"].value, delta=1e-12)
            stickslip.newmark(stickslip.Record(time, value, "g"), "0.1g")

    def test_the_picture_shows_what_was_run(self):
        record = stickslip.Record([0, 1, 2], [0, -2, 0], "m/s^2", source="Kobe.AT2: AT2 of PEER")
        figure = stickslip.newmark(record, 1, one_way=True).plot()["given_force"]
        title, labels = figure._suptitle.get_text(), [axes.get_ylabel() for axes in figure.axes]
        for part in ("Kobe", "one way", "$b(v) = 0$"):
            self.assertIn(part, title)
        for part in ("delta", "tau", "1e+09"):
            self.assertNotIn(part, title)
        self.assertEqual([label.partition("\n")[2] for label in labels], ["[m/s$^2$]", "[m/s]", "[m]"])
        self.assertEqual(figure.axes[-1].get_xlabel(), "time $t$  [s]")
        swept = stickslip.sweep(quantities="given_force", force_file=record, mu_d=1, drag="none", force_scale=[1, 2])
        axes = swept.plot(kind="final_displacement")["final_displacement"].axes[0]
        for part in ("delta", "tau"):
            self.assertNotIn(part, axes.get_title())
        self.assertIn("[m]", axes.get_ylabel())

    def test_command_line(self):
        (self.folder / "shaking.csv").write_text("t (s),a (g)\n0,0\n1,-0.4\n2,0\n9,0\n")
        done = self.python("-m", "stickslip", "newmark", "shaking.csv", "--yield", "0.1g", "--one-way")
        self.assertEqual(done.returncode, 0, done.stderr)
        r = stickslip.newmark(self.folder / "shaking.csv", "0.1g", True)
        for part in (repr(r["final_displacement"]), "displacement [m]", f"{r['slip_end'].value[0]:.6g}",
                     "with the sign of the record reversed: final_displacement = 0", "peak 3.9227 m/s^2 at 1 s"):
            self.assertIn(part, done.stdout)
        self.assertTrue((self.folder / "shaking_newmark.png").read_bytes().startswith(PNG))
        path = stickslip.load(self.folder / "shaking_newmark.csv")
        numpy.testing.assert_array_equal(path["path_displacement"].value, r["path_displacement"].value)
        done = self.python("-m", "stickslip", "newmark", "shaking.csv", "--yield", "0.1 N")
        self.assertEqual(done.returncode, 2)
        self.assertIn("is in N, and the record is in m/s^2", done.stderr)


if __name__ == "__main__":
    unittest.main()
