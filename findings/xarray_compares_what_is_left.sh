#!/usr/bin/env bash
# xarray 2023.1: a difference of two curves leaves out, in silence, each point whose abscissa differs in the last bit.
#
# One would guess: curves over ten frequencies 0.1, 0.2, ..., 1 are subtracted point by point, or refused where their
# frequencies are not the same.
# Instead: only points of equal coordinates, to the bit, are kept. 0.1*3 is not 0.3, so that nine are left of linspace
# beside multiples of 0.1, and none where one file has its frequencies times 1 + 1e-15. The difference of no points
# passes "all are below 1e-9", and its sum is 0. numpy.allclose of the difference passes too.
# Documented: that arithmetic takes the intersection of coordinates ("inner" join); not that this is by bits, for which
# reindex has a tolerance and arithmetic has none.
# Why it matters: results are compared with those of another version, machine or program by the difference of two data
# sets. Frequencies that were computed otherwise, or were written with 15 digits, take the points away that would fail.
# xarray.set_options(arithmetic_join="exact") refuses; xarray.align(..., join="override") goes by position.
# Checked with Debian 12's packages below (python3-xarray says of itself that it is version 999); python3-numpy and
# python3-packaging are taken as installed.
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
(cd "$folder" && apt-get -q download python3-xarray=2023.01.0-1.1 python3-pandas=1.5.3+dfsg-2 \
    python3-pandas-lib=1.5.3+dfsg-2 python3-dateutil=2.8.2-2 python3-tz=2022.7.1-4 python3-six=1.16.0-4 \
    >download.log 2>&1) || {
    cat "$folder/download.log" >&2
    exit 1
}
for package in "$folder"/*.deb; do
    dpkg -x "$package" "$folder/root"
done

cat >"$folder/compare.py" <<'END'
import warnings

import numpy
import xarray

warnings.simplefilter("error")


def curve(omega, value):
    return xarray.DataArray(numpy.full(10, float(value)), {"omega": omega}, ["omega"])


omega = numpy.linspace(0.1, 1, 10)
for name, other in (("the same", omega), ("multiples of 0.1", 0.1 * numpy.arange(1, 11)),
                    ("times 1 + 1e-15", omega * (1 + 1e-15))):
    left = curve(omega, 1) - curve(other, 5)
    print(f"{name}: {left.size} points, all below 1e-9: {bool((abs(left) < 1e-9).all())}, sum {float(left.sum()):g}, "
          f"allclose to 0: {numpy.allclose(left, 0)}")
with xarray.set_options(arithmetic_join="exact"):
    try:
        curve(omega, 1) - curve(other, 5)
        print("exact: subtracted")
    except ValueError:
        print("exact: refused")
END
export PYTHONPATH="$folder/root/usr/lib/python3/dist-packages"
/usr/bin/python3 "$folder/compare.py" | tee "$folder/seen"
diff - "$folder/seen" <<'END' || { echo "xarray behaves in another way than stated" >&2; exit 1; }
the same: 10 points, all below 1e-9: False, sum -40, allclose to 0: False
multiples of 0.1: 9 points, all below 1e-9: False, sum -36, allclose to 0: False
times 1 + 1e-15: 0 points, all below 1e-9: True, sum 0, allclose to 0: True
exact: refused
END
