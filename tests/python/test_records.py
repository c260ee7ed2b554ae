"""Records read from files of every kind, which the tests write themselves."""

import codecs
import dataclasses
import os
import pathlib
import sys
import tempfile
import types
import unittest
import unittest.mock
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
        for head in ("t,a x 10^-3 g", "t,a*1000 [g]", "t,a (1e-3 g)"):
            self.assertIn("values are as in the file", " ".join(self.read(columns(head=head)).notes))
        self.same(self.read(columns(head="t,force [N]")), "N")
        self.same(self.read(columns(head="t,a"), unit="gal"), "m/s^2", 0.01)
        self.same(self.read(columns(head="# made today\n# time [s], a [g]")), "m/s^2", G)
        self.same(self.read(columns(" ", head="time [s] a [g]")), "m/s^2", G)
        self.same(self.read(columns(head="time,a\n[s],[g]")), "m/s^2", G)

    def test_units_and_steps_that_are_in_doubt_are_said(self):
        for text, options, note in ((columns(head="t,a"), {}, 'no unit is named: .*unit="g"'),
                                    (columns(head="t,a"), {"unit": "bananas"}, "bananas is none of g, mg, ug, %g, g/10, gal"),
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
        self.refused("is packed, or a spreadsheet: unpack it", b"PK\3\4" + b"\0\1\2" * 50, "a.zip")
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

    def test_a_bad_line_of_many_numbers_takes_no_time(self):
        """A pattern that reads digits in several ways would try 6^40 of them before it gives up."""
        self.refused("", "x\n" + "123456 " * 40 + "?\n" + "1 2 3\n" * 3, layout="rows", column=5)

    def test_marks_of_missing_values(self):
        for mark in ("9999", "-999.25", "99999.9"):
            marked = columns(head="t,a [g]").replace("0.1250", mark)
            self.assertRegex(" ".join(self.read(marked).notes), f"1 samples are {mark.strip('-')} in size, as marks of missing")
            self.assertIn("1 samples are no numbers", str(self.read(marked.replace(mark, "nan"))))
        self.assertNotIn("marks", str(self.read(columns().replace("0.1250", "999").replace("2.2500", "-800"))))

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
            self.refused("holds 24 of the 99 samples that NPTS announces",
                         text.replace("24,", "99,").replace("   24 ", "   99 "), "b.AT2")

        lacking = text.replace(line, "NPTS= 24")
        self.same(self.read(lacking, "d.AT2", step=0.02), "m/s^2", G, 0.02 * numpy.arange(24), long, 1e-6)
        self.refused("the file has no times; .* step=0.01", lacking, "e.AT2")
        self.refused("line 4: NPTS: needs NPTS= and DT=, such as", text.replace(line, "NPTS"), "f.AT2")

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


def fixed(values, form, wide):
    """Lines of numbers of a Python format, so many in each."""
    pieces = [format(v, form) for v in values]
    return "".join("".join(pieces[n:n + wide]) + "\n" for n in range(0, len(pieces), wide))


class Descriptions(Case):
    """Files as the published description of each format has them, each with a second one of other counts and packing."""

    def cosmos(self, values=VALUE, step=20.0, text=13, counts=(100, 100), form=("5F15.6", "15.6f", 5),
               samples=("8F10.5", "10.5f", 8),
               seconds=0, what="acceleration", unit="cm/sec2(04)", direction="90 Deg", recorder=-999.0, duration=-999.0,
               facts=None):
        real = numpy.full(counts[1], -999.0)
        for place, value in {33: recorder, 61: step, 62: duration, **(facts or {})}.items():
            real[place] = value
        words = [f"Corrected acceleration    (Format v01.20 with {text:2d} text lines)", *["words, 1 to 2 of 3"] * (text - 1)]
        words[8] = f"Sta Chan   1: {direction} (Rcrdr Chan  1) Location: Roof" if direction else words[8]
        integers = fixed([-999] * counts[0], "8d", 10)
        numbers = fixed(real, form[1], form[2])
        return ("\n".join(words) + f"\n {counts[0]} Integer-header values follow on {integers.count(chr(10)):3d} lines, Format= (10I8)\n"
                + integers + f" {counts[1]} Real-header values follow on {numbers.count(chr(10)):3d} lines, Format= ({form[0]})\n" + numbers
                + f'    1 Comment line(s) follow, each starting with a "|":\n| words\n{len(values):8d} {what} pts, approx {seconds:4d} '
                f"secs, units={unit},Format=({samples[0]})\n" + fixed(values,
                                                                      *samples[1:]) + "End-of-data for Chan  1 acceleration\n")

    def test_cosmos(self):
        large = VALUE * 100 - 500  # numbers without a space between them
        self.same(self.read(self.cosmos(large), "a.v2"), "m/s^2", 0.01, value=large, within=1e-6)
        other = self.cosmos(text=15, counts=(120, 110), form=("6F13.6", "13.6f", 6), samples=("1E15.6", "15.6e", 1),
                            unit="g.     (02)",
                            duration=0.16)
        self.same(self.read(other, "b.v1"), "m/s^2", G, within=1e-6)
        self.same(self.read(self.cosmos(numpy.round(1e6 * VALUE), samples=("10I8", "8.0f", 10), what="raw accel.  ",
                                        unit="counts (50)"),
                            "c.V0c"), "counts", 1e6)
        raw = {"samples": ("10I8", "8.0f", 10), "what": "raw accel.  ", "unit": "counts (50)"}
        for facts, factor in (((0.298, 1.25, -999), 1), ((0.5, 2.5, 4), 0.5 / 2.5 / 4 / 0.298 * 1.25)):
            text = self.cosmos(numpy.round(1e6 * VALUE), facts=dict(zip((21, 41, 46), facts)), **raw)
            record = self.read(text, "c.V0c")
            self.same(record, "m/s^2", 0.298 / 1.25 * G * factor)
            self.assertRegex(" ".join(record.notes), f"counts became g: times {facts[0]} uV over {facts[1]} V/g")
        self.same(self.read(self.cosmos(step=-999.0, recorder=0.02), "d.v2"), "m/s^2", 0.01, within=1e-7)
        two = self.cosmos() + self.cosmos(-VALUE, direction="Up")
        self.refused(r"2 columns of values; take one of 0 \(Chan 1: 90 Deg\), 1 \(Chan 1: Up\)", two, "e.v2")
        for chosen in ({"column": 1}, {"channel": "Up"}, {"column": "chan 1: up"}):
            self.same(self.read(two, "f.v2", **chosen), "m/s^2", -0.01, within=1e-7)

    def test_cosmos_that_contradicts_itself(self):
        short = numpy.tile(VALUE, 25)
        for text in (self.cosmos(short, step=9e6, seconds=4), self.cosmos(short, step=0.02, seconds=4),
                     self.cosmos(short, step=-999.0, recorder=20.0, seconds=4), self.cosmos(step=20.0, duration=3.0)):
            self.refused("real header: a sampling interval of .* s does not make .* samples last .*step=0.01", text, "a.v2")
        self.same(self.read(text, "b.v2", step=0.02), "m/s^2", 0.01, within=1e-7)
        whole = self.cosmos()
        self.refused("holds 8 of the 9 samples", whole.replace("       8 acc", "       9 acc"), "c.v2")
        self.refused("holds 8 of the 7 samples", whole.replace("       8 acc", "       7 acc"), "d.v2")
        self.refused("the unit is g, its code 04 stands for cm/s", self.cosmos(unit="g(04)"), "e.v2")
        self.refused('no whole file of COSMOS, which has a line "... Real-header', whole.replace("Real-header", "header"),
                     "f.v2")

    def csmip(self, values, direction="90 Deg",
              line="{count:5d} points of {kind} data equally spaced at  .020 sec, in {unit}. (8f10.3)",
              form=("10.3f", 8)):
        """Acceleration and velocity of a channel."""
        text = f"Corrected accelerogram   1-2      Chan  1: {direction}     from\n" + "words, 5 points of 3\n" * 5
        for kind, unit, factor in (("accel", "cm/sec2", 1), ("veloc", "cm/sec", 7)):
            text += line.format(count=len(values), kind=kind, unit=unit) + "\n" + fixed(factor * values, *form)
        return text + "/&  ----------  End of data for channel  1  ----------\n"

    def test_csmip(self):
        value = numpy.round(VALUE, 3) - 800
        self.same(self.read(self.csmip(value), "a.V2"), "m/s^2", 0.01, value=value)
        older = "{count:5d} POINTS OF {kind} DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: {unit})"
        self.same(self.read(self.csmip(value, line=older, form=("9.3f", 7)), "b.V2"), "m/s^2", 0.01, value=value)
        three = "".join(self.csmip(n * value, way, *more).replace("Chan  1", f"Chan  {n}") for n, way, more in (
            (1, "360 Deg", ("{count:5d} points of {kind} data equally spaced at  .020 sec, in {unit}.",)), (2, "Up", ()),
                                                                                                                (3, "90 Deg",
                                                                                                                 ())))
        self.refused(r"take one of 0 \(Chan 1: 360 Deg\), 1 \(Chan 2: Up\), 2 \(Chan 3: 90 Deg\)", three, "c.V2")
        for n, chosen in ((3, {"channel": "90 Deg"}), (3, {"channel": "3"}), (1, {"channel": "360"}), (1, {"column": 0}),
                          (2, {"channel": "up"})):
            self.same(self.read(three, "d.V2", **chosen), "m/s^2", 0.01 * n, value=value)
        self.refused("needs the number of points, their interval and unit",
                     three.replace("spaced at  .020 sec, in", "spaced, in", 1),
                     "e.V2")

    def test_csmip_volume_1(self):
        head = "Uncorrected Accelerogram Data\n" + "words\n" * 5 + "Chan  1: 360 Deg\nNo. of Points =  {}  Record Length = 0.16 sec\n"
        numbers = fixed([1] * 100, "5d", 16) + fixed([2.5] * 50, "10.3f", 8)
        new = head.format(8) + "Units of uncor data are sec and g .\n" + numbers + \
            "     8 Accelerogram points at  50 pts/sec in units of g .      Format: (8f9.6)\n" + fixed(VALUE, "9.6f",
                                                                                                       8) + "/& ---\n"
        self.same(self.read(new, "a.V1"), "m/s^2", G)
        time = 99.96 + TIME  # seven characters without a blank
        caltech = ("FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:\nwords   21\nCOMP S05W    9\n"
                   "NO. OF POINTS =      8      DURATION =    .160 SEC\nUNITS ARE SEC AND G/10    22\n" + fixed([1] * 100, "5d", 16)
                   + fixed([2.5] * 50, "10.3f", 8))
        record = self.read(caltech + fixed(numpy.column_stack([TIME, VALUE]).ravel(), "8.3f", 10), "c.e0a")
        self.same(record, "m/s^2", G / 10, within=1e-3 * G)
        self.assertIn("column S05W", record.source)
        rounded = fixed(numpy.column_stack([[0, 0.02, 0.02, *TIME[3:]], VALUE]).ravel(), "8.3f", 10)
        record = self.read(caltech + rounded, "d.e0a")
        self.same(record, "m/s^2", G / 10, numpy.delete(TIME, 2), numpy.delete(VALUE, 2), 1e-3 * G)
        self.assertIn("1 samples at the times of others, which are rounded, were left out", record.notes)
        second = ("CORRECTED ACCELEROGRAM  IIB 87.420.0 COMP S05W\n" + caltech + "PEAK ACCELERATION =   2.25 CMS/SEC/SEC AT .1 SEC.\n"
                  "     8 POINTS OF ACC DATA EQUALLY SPACED AT   .020 SEC.\n" + fixed(VALUE, "10.4f", 8)
                  + "     8 POINTS OF VEL DATA EQUALLY SPACED AT   .020 SEC.\n" + fixed(7 * VALUE, "10.4f", 8))
        self.same(self.read(second, "e.s0a"), "m/s^2", 0.01)
        pairs = fixed(numpy.column_stack([time, 10 * VALUE]).ravel(), "7.3f", 10)
        old = head.format(8).upper() + "UNITS OF UNCOR ACCEL ARE SEC AND G/10.   MAX = 1 G\n" + numbers + pairs + "/& ---\n"
        self.same(self.read(old, "b.RAW"), "m/s^2", G, time=time, within=1e-3 * G)

    def geonet(self, values, component, velocity=True):
        held = [len(values), len(values) * velocity, len(values) * velocity]
        integers = [0] * 33 + held + [0] * 4
        words = [f"{'C' if velocity else 'Unc'}orrected accelerogram 2001_X GNS Science", *["words"] * 8,
                 f"Number of points {len(values):5d}    Duration {0.02 * len(values):.2f} sec",
                 "Instrument corrected data at 0.020 sec intervals" if velocity else
                 "Raw readings in units of 0.10 mm/s/s  at intervals of 0.020 s", "words",
                 f"Component {component}  Longitudinal"]
        return ("\n".join(words) + "\nwords\nwords\nwords\n" + fixed(integers, "8d", 10) + fixed([0.5] * 60, "8.2f", 10)
                + fixed(values, "8.1f", 10) + (fixed(7 * values, "8.2f", 10) + fixed(values, "8.3f", 10) if velocity else ""))

    def test_geonet(self):
        value = numpy.round(1000 * numpy.tile(VALUE, 3), 1) - 9000
        time = 0.02 * numpy.arange(24)
        for velocity, factor in ((True, 1e-3), (False, 1e-4)):
            text = self.geonet(value, "N28W", velocity) + self.geonet(-value, "Up", velocity)
            self.refused(r"0 \(N28W\), 1 \(Up\)", text, "a.V2A")
            self.same(self.read(text, "b.V2A", channel="Up"), "m/s^2", -factor, time, value)
        self.refused("do not fit together", text.replace("      24", "      25"), "c.V1A")
        self.refused("0.02 s does not make 24 samples last 0.98 s.*step=0.01", text.replace("Duration 0.4", "Duration 0.9"), "e.V1A",
                     column=0)
        self.refused('no whole file of GeoNet V1A or V2A, which has a line "Component', text.replace("Component", "words"),
                     "d.V1A")

    def test_blocks_of_a_format_that_is_not_whole(self):
        """What the refusal names reads the numbers."""
        blocks = "Corrected accelerogram\nInstrument corrected data at 0.02 sec intervals\n" + fixed(VALUE, "10.4f", 3) + \
            "Corrected accelerogram, second\n" + fixed(-VALUE, "10.4f", 3)
        self.refused(r'no whole file of GeoNet V1A or V2A, which has a line "Number of points.* and a line "Component.*layout="rows" '
                     r"\(.*\) with step=, unit= and column= of 0 \(Instrument.*: 8\), 1 \(Corrected accelerogram, second: 8\)",
                     blocks, "a.V2A")
        self.same(self.read(blocks, "b.V2A", layout="rows", step=0.02, unit="mm/s^2", column=1), "m/s^2", -1e-3)
        cut = self.csmip(numpy.round(VALUE, 3)).replace("    8 points", "    9 points")
        self.refused(r'CSMIP: holds 8 of the 9 samples.*layout="rows".* 0 \(.*in cm/se: 8\)', cut, "c.V2")
        self.same(self.read(cut, "d.V2", layout="rows", step=0.02, unit="gal", column=0), "m/s^2", 0.01,
                  value=numpy.round(VALUE, 3))

    def smc(self, values, title="2 CORRECTED ACCELEROGRAM", rate=50.0, comments=3):
        integers, real = numpy.full(48, -32768), numpy.full(50, 1.7e38)
        integers[[15, 16]], real[1] = (comments, len(values)), rate
        text = [title, "*", "0001A", "     2001   1   1    0004 Somewhere", "Moment Mag= 7.1",
                "station = A, B  component=    360",
                "epicentral dist = 89.0", "inst type=SMA-1      data source = USGS", "*", "*", "*"]
        pieces = [f"{v:10.4E}".replace("E+0", "E+").replace("E-0", "E-") for v in values]
        return ("\n".join(text) + "\n" + fixed(integers, "10d", 8) + fixed(real, "15.7E", 5) + "|5 comments of 3\n" * comments
                + "".join("".join(f"{piece:>10}" for piece in pieces[n:n + 8]) + "\n" for n in range(0, len(pieces), 8)))

    def test_smc(self):
        record = self.read(self.smc(VALUE), "a.smc")
        self.same(record, "m/s^2", 0.01, within=1e-7)
        self.assertIn("column 360", record.source)
        pairs = numpy.column_stack([TIME, VALUE]).ravel()
        self.same(self.read(self.smc(pairs, "1 UNCORRECTED ACCELEROGRAM", 1.7e38, 11), "b.smc"), "m/s^2", 0.01, within=1e-7)
        remains = "\0" * 40 + "\r\n" + fixed([9.75, -1] * 4, "10.4f", 8)
        long = numpy.tile(VALUE, 4000)
        self.same(self.read(self.smc(long) + remains, "e.smc"), "m/s^2", 0.01, 0.02 * numpy.arange(len(long)), long, 1e-7)
        self.same(self.read(self.smc(VALUE, "0 UNKNOWN"), "f.smc", unit="gal"), "m/s^2", 0.01, within=1e-7)
        self.refused("is a spectrum", self.smc(VALUE, "5 RESPONSE"), "g.smc")
        numbered = self.smc(VALUE).replace("|5 comments of 3\n", "").split("\n")  # no comments, and a year alone on a line
        numbered[2], numbered[12] = "1979", numbered[12].replace(f"{numbered[12].split()[-1]:>10}", f"{0:>10}")
        self.same(self.read("\n".join(numbered), "h.smc"), "m/s^2", 0.01, within=1e-7)
        self.refused("holds 7 of the 8 samples", self.smc(VALUE).replace(" 6.2500E-2", ""), "c.smc")
        self.refused("360: is a velocity, no force or acceleration; differentiate=True", self.smc(VALUE, "3 VELOCITY"), "d.smc")

    def knet(self, direction="E-W", rate="100Hz", scale="3920(gal)/6182761", counts=None, wide=8):
        counts = numpy.round(VALUE * 1e5 + 12000).astype(int) if counts is None else counts
        return (f"Origin Time       2018/01/24 19:51:00\nLat.              41.0\nStation Code      AOM001\nSampling Freq(Hz) {rate}\n"
                f"Duration Time(s)  {max(round(len(counts) / float(rate[:-2])), 0)}\nDir.              {direction}\nScale Factor      {scale}\n"
                "Max. Acc. (gal)   4.078\nStation Height(m) 39\nMemo.             \n" + fixed(counts, "9d", wide))

    def test_knet(self):
        factor = 0.01 * 3920 / 6182761 * 1e5
        for text, name, scale in ((self.knet(rate="50Hz"), "E-W", factor),
                                  (self.knet("4", "50Hz", "2000(gal)/8388608", wide=5), "N-S surface", 20 / 8388608 * 1e5)):
            record = self.read(text, "a.EW")
            self.same(record, "m/s^2", scale, value=VALUE - VALUE.mean(), within=1e-9)
            self.assertRegex(" ".join(record.notes), "the mean, .* gal, was taken off")
            self.assertIn(f"column {name}", record.source)
        many = numpy.arange(500)
        self.refused("a sampling interval of 0.02 s does not make 500 samples last 99 s",
                     self.knet(rate="50Hz", counts=many).replace("Time(s)  10", "Time(s)  99"), "b.EW")
        self.refused('no whole file of K-NET or KiK-net, which has a line "Scale Factor"',
                     self.knet().replace("Scale Factor", "Scale"), "c.EW")

    def test_csv_of_knet(self):
        """As the agency writes it, a value below its key, and in a short form; the samples have an offset there, too."""
        way = ("N-S", "E-W", "U-D")
        for names, head, clock in (
                (way, "#K-NET CSV\n#Event\n#OriginTime,Latitude\n#2019/01/02 17:47:00,36.708\n#Record\n#SamplingFrequency(Hz)\n"
                 "#50\n#DurationTime(s)\n#0\n#Offset\n#N-S(gal),E-W(gal),U-D(gal)\n#-18.60,-1.40,26.10\n"
                 "#Time,RelativeTime(s),N-S(gal),E-W(gal),U-D(gal)\n", ",{:.2f}"),
                (range(1, 7), "#K-NET CSV\n#SamplingFrequency(Hz)\n#50\n#Time,RelativeTime(s),1(gal),2(gal),3(gal),4(gal),5(gal),"
                 "6(gal)\n", ",{:.2f}"),
                (way, "#Sampling Freq(Hz),50\n#Time,N-S(gal),E-W(gal),U-D(gal)\n", "")):
            text = head + "".join(f"2001/01/01 23:59:59.{20 * n + 90:03d}{clock.format(0.02 * n)},"
                                  + ",".join(f"{v * (n + 1) + 7}" for n in range(len(names))) + "\n" for n, v in enumerate(VALUE))
            record = self.read(text, "a.csv", channel="E-W" if len(names) == 3 else "E-W surface")
            self.same(record, "m/s^2", 0.02 if len(names) == 3 else 0.05, value=VALUE - VALUE.mean())
            self.assertRegex(" ".join(record.notes), "the mean, .* gal, was taken off")
        self.refused("does not make 7 samples last 0.14 s", text.replace("Freq(Hz),50", "Freq(Hz),100"), "b.csv", column=0)
        self.refused('no whole file of CSV of K-NET or KiK-net, which has a line "#Sampling', text.replace("Freq", ""), "c.csv")

    def cwa(self, sequence="Time U(+); N(+); E(+)", form="4F10.3", unit="gal. DCoffset(corr)"):
        rows = [[t] * ("Time" in sequence) + [v, 2 * v, 3 * v] for t, v in zip(TIME, numpy.round(VALUE, 3))]
        width = int(form[2:].split(".")[0])
        return (f"#StationCode: XYZ\n#RecordLength(sec): 0\n#SampleRate(Hz): 50\n#AmplitudeUnit:  {unit}\n#AmplitudeMAX. U:   10.0~  -10.0\n"
                f"#AmplitudeMAX. E:   30.0~  -30.0\n#DataSequence: {sequence}\n#Data: {form}\n"
                + "".join(fixed(row, f"{width}.3f", 9) for row in rows))

    def test_cwa(self):
        value = numpy.round(VALUE, 3)
        for text in (self.cwa(), self.cwa("N(+); U(+); E(+)", "3F8.3"), self.cwa(form="4F12.3", unit="cm/s^2")):
            self.same(self.read(text, "a.dat", channel="E"), "m/s^2", 0.03, value=value)
        self.refused(r"take one of 0 \(U\(\+\)\), 1 \(N", self.cwa(), "b.dat")
        self.refused("does not make 8 samples last 60 s", self.cwa().replace("(sec): 0", "(sec): 60"), "c.dat", column=0)
        self.refused('no whole file of CWA, which has a line "#SampleRate', self.cwa().replace("SampleRate", "Rate"), "d.dat")

    def test_esm_and_afad(self):
        head = "EVENT_NAME: X\nVS30_M/S: \nSAMPLING_INTERVAL_S: {}\nNDATA: {}\nSTREAM: HNE\nUNITS: {}\nDATA_TYPE: {}\nUSER5: \n"
        body = fixed(VALUE, "15.6f", 1)
        self.same(self.read(head.format(0.02, 8, "cm/s^2", "ACCELERATION") + body, "a.asc"), "m/s^2", 0.01, within=1e-9)
        self.same(self.read("EVENT_ID: 3\n" + head.format("0.020000", 8, "mg", "ACCELERATION") + body, "b.asc"), "m/s^2",
                  G / 1e3)
        self.refused("HNE: is a velocity", head.format(0.02, 8, "cm/s", "VELOCITY") + body, "c.asc")
        self.refused("HNE: is a spectrum", head.format(0.02, 8, "cm/s^2", "ACCELERATION RESPONSE SPECTRUM") + body, "d.asc")
        self.refused("holds 8 of the 9 samples", head.format(0.02, 9, "cm/s^2", "ACCELERATION") + body, "e.asc")
        self.refused("furlong/s2 is no unit of an acceleration that is known",
                     head.format(0.02, 8, "furlong/s2", "ACCELERATION") + body,
                     "f.asc")
        older = ("STRONG GROUND MOTION RECORDS OF TURKIYE\nRECORD TIME             : 20/07/2017 22:30:58.000000 (GMT)\nNUMBER OF DATA          "
                 ": 8\nSAMPLING INTERVAL (sec) : 0.02\nRAW PGA VALUES (gal)    : (N-S) 13.2 (E-W) 12.1 (U-D) 9.8\nCopyright\n"
                 "       N-S          E-W          U-D\n" + "".join(fixed([v, -v, 2 * v], "13.6f", 3) for v in VALUE))
        self.same(self.read(older, "g.txt", channel="E-W"), "m/s^2", -0.01, within=1e-9)
        other = older.replace("N-S          E-W          U-D", "NS  EW  UD").replace("INTERVAL (sec) :", "INTERVAL :")
        self.same(self.read(other, "h.txt", channel="UD"), "m/s^2", 0.02, within=1e-9)

    def test_csmnc(self):
        head = ("065JZC120103153901\n0120103153957 2012-01-03 15:39:57 BTM\nMAGNITUDE  4.0(Ms)\nCOMP. {}\n"
                "UNCORRECTED {}          UNIT: {}\nNO. OF POINTS:  {}  EQUALLY SPACED INTERVALS OF:  {}  SEC\n"
                "PEAK VALUE:    2.25   AT   .1 SEC    DURATION:  1 SEC\nCSMNC\n\n")
        for unit, wide, factor in (("CM/SEC/SEC", 8, 0.01), ("g", 5, G)):
            text = head.format("EW", "ACCELERATION", unit, 8, "0.02") + fixed(VALUE, "14.6E", wide)
            self.same(self.read(text, "a.dat"), "m/s^2", factor, within=1e-6)
        self.refused("EW: is a velocity", text.replace("ACCELERATION", "VELOCITY").replace(": g", ": cm/s"), "b.dat")
        self.refused("holds 8 of the 9 samples", text.replace("POINTS:  8", "POINTS:  9"), "c.dat")

    def test_geocsv_and_time_series(self):
        stamps = [f"2001-01-01T23:59:59.{900000 + 20000 * n:06d}" for n in range(5)]
        head = "TIMESERIES XX_XYZ_00_HNE_D, {} samples, 50 sps, 2001-01-01T23:59:59.900000, {}, FLOAT, {}\n"
        pairs = [f"{stamp}  {v}\n" for stamp, v in zip(stamps, VALUE)]
        comma = "".join(f"{stamp}Z, {v}\n" for stamp, v in zip(stamps, VALUE))
        geo = "# dataset: GeoCSV 2.0\n# delimiter: ,\n# field_unit: {}, m/s**2\n# field_type: datetime, float\nTime, Sample\n"
        single = ("# dataset: GeoCSV 2.0\n# SID: A_B\n# sample_count: 5\n# sample_rate_hz: 50\n# start_time: 2001-01-01T00:00:00.5Z\n"
                  "# field_unit: m/s**2\n# field_type: float\nSample\n" + "".join(f"{v}\n" for v in VALUE[:5]))
        for text in (head.format(5, "TSPAIR", "m/s**2") + "".join(pairs), (geo.format("ISO_8601") + comma).upper(),
                     head.format(5, "SLIST", "M/S**2") + "0.1\t-0.25\t0.5\n0.125\t-1.5\n",
                     geo.format("ISO_8601") + comma, geo.format("UTC") + comma, single,
                     head.format(2, "TSPAIR", "m/s**2") + "".join(pairs[:2]) + head.format(3, "TSPAIR",
                                                                                           "m/s**2") + "".join(pairs[2:])):
            record = self.read(text, "a.txt")
            self.same(record, "m/s^2", 1, TIME[:5], VALUE[:5])
            self.assertRegex(" ".join(record.notes), "times are from the first sample, 2001-01-01T")
        three = "# dataset: GeoCSV 2.0\n# delimiter: |\n# field_unit: ISO 8601 datetime UTC, m/s**2, g\nTime | E | N\n" + "".join(
            f"{stamp} | {7 * v} | {v}\n" for stamp, v in zip(stamps, VALUE))
        self.same(self.read(three, "c.txt", column="N"), "m/s^2", G, TIME[:5], VALUE[:5])
        self.refused("holds 5 of the 6 samples", head.format(6, "TSPAIR", "m/s**2") + "".join(pairs), "b.txt")

    def test_peer_words_and_other_quantities(self):
        def text(line):
            return f"PEER\nSomewhere, 1/2/1999, Hill, 90\n{line}\nNPTS=     8, DT=   .0200 SEC,\n" + fixed(VALUE, "15.7E", 5)

        for line in ("The units are (g)", "ACCELERATION TIME HISTORY IN UNITS OF (G)", "Units: g",
                     "ACCELERATION IN UNITS OF G.", "Acceleration in g"):
            self.same(self.read(text(line), "a.AT2"), "m/s^2", G, within=1e-6)
        for step in ("DT= 20 MSEC", "dt=20 ms", "DT=.02", "DT= 2.0E-02 SEC", "DT:  .0200 SEC"):
            self.same(self.read(text(line).replace("DT=   .0200 SEC", step), "a.AT2"), "m/s^2", G, within=1e-6)
        self.refused("is a velocity, no force or acceleration; differentiate=True takes its derivative",
                     text("VELOCITY TIME SERIES IN UNITS OF CM/S"),
                     "a.VT2")
        self.refused("velocity: is a velocity", text("The units are (cm/s)"), "c.VT2")
        self.refused("is a displacement.*second derivative", text("DISPLACEMENT TIME SERIES IN UNITS OF CM"), "a.DT2")
        self.refused("unit = g: is one of acceleration, and the file says that velocity is a velocity",
                     text("VELOCITY TIME SERIES IN UNITS OF CM/S"),
                     "b.VT2", unit="g")

    def test_blank_lines_and_doubled_ends(self):
        text = "PEER\nSomewhere, 1940\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS=     8, DT=   .0200 SEC\n" + fixed(VALUE, "15.7E", 5)
        for end in ("\r\n", "\r\r\n", "  \r\n", "\n\n"):
            self.same(self.read(text.replace("\n", end), "a.AT2"), "m/s^2", G, within=1e-6)

    def test_spectra(self):
        first = "Response and Fourier amplitude spectra (86 periods,  .04 - 10.0 sec)   for\n"
        self.refused("holds spectra, no force", first + self.csmip(VALUE), "a.V3")
        for name in ("Period [s]", "period (s)", "Frequency [Hz]"):
            self.refused("a spectrum is no force or acceleration over time", columns(head=f"{name},Sa [g]"))
        self.same(self.read(columns(head="Period [s],a [g]"), time=0), "m/s^2", G)

    def test_derivatives(self):
        """Of t^2 cm/s and t^2 cm by t, with even and uneven steps: 2 t cm/s^2 and 2 cm/s^2."""
        time = numpy.cumsum([0, 1, 1, 2, 1, 1.0])
        for unit, expected in (("cm/s", 0.02 * time), ("cm", numpy.full(6, 0.02))):
            record = self.read(f"t [s],a [{unit}]\n" + "".join(f"{t},{t * t}\n" for t in time), differentiate=True)
            inner = slice(1, -1) if unit == "cm/s" else slice(2, 3)
            numpy.testing.assert_allclose(record.value[inner], expected[inner], atol=2e-3)
            self.assertEqual(record.unit, "m/s^2")
        self.refused("differentiate: a is no velocity", columns(head="t,a [g]"), differentiate=True)


class Times(Case):
    def test_units_of_time(self):
        for factor, spellings in ((1e-3, ("ms", "millisec", "msec", "Milliseconds", "MSEC")),
                                  (1e-6, ("us", "µs", "μs", "microseconds", "usec")),
                                  (1e-9, ("ns", "nanoseconds")), (60, ("min", "minutes", "mins.")),
                                  (3600, ("h", "hrs", "hours")),
                                  (86400, ("d", "days")), (1, ("s", "sec", "SEC.", "seconds", "Sekunden"))):
            for unit in spellings:
                for head in (f"time [{unit}],F", f"t/{unit},F/N", f"time ({unit}),F (N)", f"Time,Force\n{unit},N",
                             f"time in {unit},F",
                             f'"Time, {unit}","F, N"'):
                    record = self.read(columns(head=head))
                    numpy.testing.assert_allclose(record.time, factor * TIME, rtol=1e-12)
        for head in ("t_ms,F", "time ms,F", "timeMs,F", "tms,F", "millis,F", "elapsed_ms,F", "ms;N".replace(";", ","),
                     "timestamp_ms,F", "time..ms.,F", "time.ms,F", "time - ms,F"):
            numpy.testing.assert_allclose(self.read(columns(head=head)).time, 1e-3 * TIME, rtol=1e-12)

    def test_units_of_time_that_are_not_known(self):
        for head in ("time [frames],F", "Time,Force\nticks,N", "t/sampl,F/N", "time msek,F", "time since start,F",
                     "Time\t[0.1 s],F", "t x 10^-3 s,F", "Time*1000,F", "t × 1000 [s],F", "time (10^-3 s),F"):
            self.refused("time_unit", columns(head=head))
            for options in ({"time_unit": "ms", "column": 1}, {"step": 2e-5, "column": 1}):
                self.same(self.read(columns(head=head), **options), self.read(columns(head=head), **options).unit,
                          time=TIME / 1000)
        with self.assertRaisesRegex(ValueError, "time_unit = fortnight: must be one of s, ms"):
            self.read(columns(), time_unit="fortnight")
        self.assertIn("times are read as seconds, which the file does not say", " ".join(self.read(columns(head="t,F")).notes))
        self.assertNotIn("read as seconds", " ".join(self.read(columns(head="t,F"), time_unit="ms").notes))
        stamps = "timestamp,F\n" + "".join(f"{1700000000000 + 20 * n},{v}\n" for n, v in enumerate(VALUE))
        self.refused('begins at 1700000000000 without a unit; give time_unit="ms"', stamps)
        self.same(self.read(stamps, time_unit="ms"))
        for name in ("Sample no.", "#", "", "Unnamed: 0", "index", "ticks"):
            self.refused("counts samples; give the sampling interval", columns(head=f"{name},F"))
        counts = "sample,F\n" + "".join(f"{n},{v}\n" for n, v in enumerate(VALUE))
        self.refused("sample: counts samples; give the sampling interval", counts)
        self.same(self.read(counts, step=0.02, column="F"))

    def test_of_several_lines_of_words_none_names_columns_by_being_last(self):
        rows = "Interval,0.02,Interval,0.02\nChannel name,Force,Channel name,Position\nUnit,V,Unit,V\n" + "".join(
            f"{t:.2f},{v},{t:.2f},{2 * v}\n" for t, v in zip(TIME, VALUE))
        self.refused(r"take one of 1 \(column 1\).*3 lines could name the columns", rows)
        self.refused('time_unit: 3 lines could name.*time_unit="s"', rows, column=1)
        for options in ({"time_unit": "s"}, {"step": 0.02}):
            self.same(self.read(rows, column=1, **options))
        body = "".join(f"{t:.2f} {v} {2 * v}\n" for t, v in zip(TIME, VALUE))
        self.same(self.read("# peaks: 1 2\n# t N E\n" + body, column="N"))
        self.refused("no such column.*2 lines could name", "# t E N\n# U N E\n" + body, column="E")
        self.same(self.read("made up, twice\nTime [ms],F [N]\n" + columns()), "N", time=TIME / 1000)
        self.same(self.read("ms,g\nTime,Acc\n" + columns()), "m/s^2", G, time=TIME / 1000)
        self.refused("time_unit: 3 lines could name", "Time,Acc\ns,g\nms,gal\n" + columns())
        self.same(self.read(columns(head="time_ms,acc_cm_s2")), "m/s^2", 0.01, time=TIME / 1000)
        self.same(self.read(columns(head="t [s],a [cm/(s^2)]")), "m/s^2", 0.01)
        self.refused("no such column", "t [ms] E N\nmore of it\n" + body, column="E")

    def test_dates_count_from_the_first_sample(self):
        for form in ("2024-02-29T23:59:59.{:03d}Z", "2024/02/29 23:59:59.{:03d}", "2024-02-29 23:59:59,{:03d}",
                     "2024-02-29T23:59:59.{:03d}+09:00"):
            for separator in (";", "\t", " "):
                text = separator.join(("date", "a")) + "\n" + "".join(
                    form.format(20 * n) + f"{separator}{v}\n" for n, v in enumerate(VALUE))
                record = self.read(text if "," not in form or separator == ";" else text.replace(",", "."))
                self.same(record)
        self.assertIn("times are from the first sample, 2024-02-29T", " ".join(record.notes))


class Rows(Case):
    def test_samples_in_rows(self):
        long = numpy.tile(VALUE, 3)
        text = fixed(long, "12.5f", 5)
        self.refused(r'layout: 5 columns of one kind without names: layout="rows" .* with step=', text[:300])
        for rows in (text[:300], text, fixed(long, "12.5f", 23),
                     ", ".join(map(str, long[:-1])) + f"\n{long[-1]}\n"):
            for options in ({}, {"step": 0.02}, {"column": 0, "step": 0.02}):
                self.refused("layout", rows, **options)
        for rows in (text, fixed(long, "9.4f", 4), text.replace("   ", " , ")):
            self.same(self.read(rows, layout="rows", step=0.02), time=0.02 * numpy.arange(24), value=long)
        self.same(self.read(fixed(long, "12.5f", 4), layout="columns", column=1, step=0.08), time=0.08 * numpy.arange(6),
                  value=long[1::4])
        self.refused(r"take one of 0 \(block 0 of 2\), 1 \(block 1 of 24\)", "24 0.02\n" + text, layout="rows", step=0.02)
        self.same(self.read("24 0.02\n" + text, layout="rows", step=0.02, column=1), time=0.02 * numpy.arange(24), value=long)
        self.refused("layout = 'row': must be one of columns, rows, pairs", text, layout="row")

    def test_rows_as_wide_as_those_of_other_formats(self):
        """Five numbers of 15 characters begin a SAC file, too; as many words as numbers above the rows name no columns."""
        long = numpy.tile(VALUE, 20)
        rows = fixed(long, "15.7E", 5)
        for text in (rows, "points= 160, step= 0.02 sec\n" + rows, "El Centro 1940 N-S component\n" + rows):
            for options in ({}, {"step": 0.02}, {"step": 0.02, "column": 0}):
                self.refused("layout", text, "a.g3", **options)
            self.same(self.read(text, "b.g3", layout="rows", step=0.02), time=0.02 * numpy.arange(160), value=long, within=1e-6)

    def test_what_cannot_be_read_says_what_can(self):
        text = "* VOL1\nUNITS\n" + fixed(VALUE, "12.5f", 4) + "/&\n"
        self.refused(r'no numbers in columns.*layout="rows" .* with step=, unit= and column= of 0 \(UNITS: 8\)', text)
        self.same(self.read(text, layout="rows", step=0.02, unit="gal", column=0), "m/s^2", 0.01)

    def test_pairs_of_time_and_sample(self):
        text = fixed(numpy.column_stack([TIME, VALUE]).ravel(), "10.4f", 6)
        self.refused('layout="pairs" pairs of time and value', text[:120])
        self.same(self.read(text, layout="pairs", time_unit="s"))
        self.assertIn("times are read as seconds", str(self.read(text, layout="pairs")))
        self.same(self.read(text, layout="pairs", time_unit="ms"), time=TIME / 1000)

    def test_rest(self):
        record = self.read(columns(head="t [s],F [N]"), rest=0.1)
        self.same(record, "N", time=0.02 * numpy.arange(13), value=numpy.append(VALUE, numpy.zeros(5)))
        self.assertIn("0.1 s of no force were appended", str(record))
        appended = columns(head="t [s],F [N]") + "10.14,0\n"
        self.assertIn("rest=10 appends no force in the place of the last sample", str(self.read(appended)))
        for rest, count in ((10, 508), (0.1, 13)):
            record = self.read(appended, rest=rest)
            self.same(record, "N", time=0.02 * numpy.arange(count), value=numpy.append(VALUE, numpy.zeros(count - 8)))
            self.assertEqual(len(record.gaps), 0)
        with self.assertRaisesRegex(ValueError, r"rest = -1: must be in \[0, inf\)"):
            self.read(columns(), rest=-1)


class Readers(Case):
    def test_sac_binary(self):
        for order in "<>":
            numbers, integers = numpy.full(70, -12345.0, f"{order}f4"), numpy.full(40, -12345, f"{order}i4")
            numbers[0], numbers[5] = 0.02, 3
            integers[[6, 9, 16, 35]] = 6, len(VALUE), 8, 1
            data = numbers.tobytes() + integers.tobytes() + b"-12345  " * 24 + VALUE.astype(f"{order}f4").tobytes()
            self.same(self.read(data, "a.sac", unit="mm/s^2"), "m/s^2", 1e-3, 3 + TIME, within=1e-7)

    def test_miniseed_by_obspy(self):
        data = b"000001D " + b"XYZ  00HNEXX" + b"\0" * 500
        with unittest.mock.patch.dict(sys.modules, obspy=None), self.assertRaisesRegex(ImportError,
                                                                                       "needs obspy.*pip install obspy"):
            self.read(data, "a.mseed")
        traces = [types.SimpleNamespace(id=f"XX.XYZ.00.HN{way}", data=(sign * VALUE).astype("f4"),
                                        stats=types.SimpleNamespace(delta=0.02))
                  for way, sign in (("E", 1), ("N", -1))]
        with unittest.mock.patch.dict(sys.modules, obspy=types.SimpleNamespace(read=lambda path: traces)):
            self.same(self.read(data, "a.mseed", channel="XX.XYZ.00.HNN", unit="g"), "m/s^2", -G, within=1e-6)
            self.refused(r"2 columns of values; take one of 0 \(XX.XYZ.00.HNE\)", data, "b.mseed")

    def test_units_of_every_spelling(self):
        for spellings, factor in ((("g", "G", "g.", "g's"), G), (("milli-g", "mg"), G / 1000),
                                  (("gal", "Gals", "cm/sec2", "cm/s/s", "CM/SEC/SEC",
                                  "cm s-2", "cm·s⁻²", "cm/s^{2}", "cm.s^-2", "centimetres per second squared", "cm/sec.^2",
                                  "cm/(s^2)", "cm_s2", "cmss", "in gal"), 0.01),
                                  (("m/s²", "m/s**2", "m / s^2", "m/sec/sec", "meters/second^2", "m s⁻²", "mps2", "ms2"), 1),
                                  (("ft/sec^2",), 0.3048)):
            for unit in spellings:
                self.same(self.read(columns(), unit=unit), "m/s^2", factor)


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
                read = self.read(columns(head="t (s),a"), unit=unit or None)
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
