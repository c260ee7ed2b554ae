#!/usr/bin/env bash
# pandas 1.5.3: read_fwf cuts signs and leading digits off a record that is quiet at first.
#
# One would guess: read_fwf finds where the columns of a fixed-width record are, or fails where it cannot.
# Instead: it looks at the first 100 rows only, and takes each column as wide as its widest number there. What a later
# row writes further to the left is dropped: -307.250 is read as 7.250. No error, no warning, columns of numbers.
# Documented: that the first 100 rows are looked at (infer_nrows); not that characters of later rows are dropped.
# Why it matters: a record of ground motion starts with noise before the event, and the strong motion, which decides
# whether a block slips, comes after. It loses its signs and its peak. Give the widths, as below, or split at blanks.
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

PYTHONPATH="$folder/root/usr/lib/python3/dist-packages" /usr/bin/python3 - "$folder/record.txt" <<'END'
import sys
import warnings

import pandas

warnings.simplefilter("error")
samples = [0.125 * (-1) ** i for i in range(120)] + [4.5, -20.75, 180.5, -307.25]
with open(sys.argv[1], "w") as record:
    record.writelines(f"{0.01 * i:10.3f}{sample:10.3f}\n" for i, sample in enumerate(samples))

assert pandas.__version__ == "1.5.3", pandas.__version__
guessed = pandas.read_fwf(sys.argv[1], header=None)
told = pandas.read_fwf(sys.argv[1], header=None, widths=[10, 10])
print("written ", samples[-4:])
print("guessed ", guessed[1].tolist()[-4:], guessed[1].dtype)
print("widths  ", told[1].tolist()[-4:], told[1].dtype)
if told[1].tolist() != samples:
    sys.exit("widths no longer give what was written")
if guessed[1].tolist()[-4:] != [4.5, 20.75, 80.5, 7.25] or guessed[1].dtype != float:
    sys.exit("read_fwf behaves in another way than stated")
END
