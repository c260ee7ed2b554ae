#!/usr/bin/env bash
# pandas 1.5.3: read_csv reads 0.0000000000000000123456 as 0, and 0.000001234567890123456 with 11 digits of 16.
#
# One would guess: a number that float() reads is read by read_csv with 15 digits at least, however it is written, as
# the 64-bit numbers of its column hold them.
# Instead: it takes 17 digits, and the zeros in front of the first other digit count. So each of these zeros costs a
# digit, in silence. read_fwf, read_table and to_numeric do the same, and so does engine="python". With an exponent, as
# 1.23456e-17, all digits are there.
# Documented: no; issue 39514 of pandas reports it. The page of read_csv names the converters of float_precision, and
# says of none that it loses digits.
# Why it matters: programs in Fortran and spreadsheets write weak motion in fixed form: accelerations in g, slips in m.
# Small samples lose digits or become 0, and are then taken for samples of no force. float_precision="round_trip" reads
# them right, and so does numpy.loadtxt.
# Checked with Debian 12's packages below; python3-numpy is taken as installed.
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
(cd "$folder" && apt-get -q download python3-pandas=1.5.3+dfsg-2 python3-pandas-lib=1.5.3+dfsg-2 \
    python3-dateutil=2.8.2-2 python3-tz=2022.7.1-4 python3-six=1.16.0-4 >download.log 2>&1) || {
    cat "$folder/download.log" >&2
    exit 1
}
for package in "$folder"/*.deb; do
    dpkg -x "$package" "$folder/root"
done

cat >"$folder/read.py" <<'END'
import sys
import warnings

import numpy
import pandas

warnings.simplefilter("error")
assert pandas.__version__ == "1.5.3", pandas.__version__
samples = ["0.001234567890123456", "0.000001234567890123456", "0.000000000000001234567890123456",
           "0.0000000000000000123456", "1.23456e-17"]
with open(sys.argv[1], "w") as record:
    record.write("\n".join(["acceleration", *samples]) + "\n")
read = pandas.read_csv(sys.argv[1]).acceleration
exact = pandas.read_csv(sys.argv[1], float_precision="round_trip").acceleration
for text, one, other, third in zip(samples, read, exact, numpy.loadtxt(sys.argv[1], skiprows=1)):
    print(f"{text}: {float(one)!r}; round_trip and numpy {'right' if other == third == float(text) else 'wrong'}")
others = (pandas.read_table(sys.argv[1]), pandas.read_fwf(sys.argv[1]), pandas.read_csv(sys.argv[1], engine="python"))
print("read_table, read_fwf, engine, to_numeric:", *(float(other.acceleration[1]) for other in others),
      float(pandas.to_numeric(pandas.Series(samples))[1]))
END
export PYTHONPATH="$folder/root/usr/lib/python3/dist-packages"
/usr/bin/python3 "$folder/read.py" "$folder/record.csv" | tee "$folder/seen"
diff - "$folder/seen" <<'END' || { echo "read_csv behaves in another way than stated" >&2; exit 1; }
0.001234567890123456: 0.0012345678901234; round_trip and numpy right
0.000001234567890123456: 1.2345678901e-06; round_trip and numpy right
0.000000000000001234567890123456: 1.2e-15; round_trip and numpy right
0.0000000000000000123456: 0.0; round_trip and numpy right
1.23456e-17: 1.23456e-17; round_trip and numpy right
read_table, read_fwf, engine, to_numeric: 1.2345678901e-06 1.2345678901e-06 1.2345678901e-06 1.2345678901e-06
END
