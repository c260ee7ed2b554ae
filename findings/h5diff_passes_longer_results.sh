#!/usr/bin/env bash
# h5diff 1.10.8: two files whose datasets differ in length or in type are reported as equal by the exit status.
#
# One would guess: h5diff old.h5 new.h5 ends with 1 when a dataset has one more value in the second file, or holds
# complex numbers instead of real ones, as it does when one value differs.
# Instead: such datasets are "not comparable". Their values are not compared at all, they do not count as differences,
# and the exit status is 0; with -q nothing is printed either. A dataset that is missing in one file does give 1.
# Documented: that some datasets are not comparable (option -c lists them, an RFC of 2009 describes them). The help says
# of the exit status only that 0 means no differences; -c ends with 0 too.
# Why it matters: scripts test a new version or another machine by "h5diff -q expected.h5 run.h5 && echo equal". A run
# with another grid, or one whose results became complex, passes, however wrong its numbers are. Compare the shapes
# first, or fail where h5diff -c prints anything.
# Checked with Debian 12's packages: hdf5-tools is unpacked, python3-h5py-serial with its libhdf5 has to be installed.
set -euo pipefail

installed=$(dpkg-query -W -f='${Version} ' libhdf5-103-1 python3-h5py-serial)
if [[ $installed != "1.10.8+repack1-1 3.7.0-8 " ]]; then
    echo "needs libhdf5-103-1 1.10.8+repack1-1 and python3-h5py-serial 3.7.0-8, found '$installed'" >&2
    exit 1
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get -q download hdf5-tools=1.10.8+repack1-1 >download.log 2>&1 || { cat download.log >&2; exit 1; }
dpkg -x hdf5-tools_*.deb root

/usr/bin/python3 - <<'END'
import h5py
import numpy

files = {"expected": [0.1, 0.2, 0.7], "changed": [0.1, 0.2, 0.8], "longer": [9.1, 9.2, 9.7, 9.9],
         "complex": [9.1 + 1j, 9.2, 9.7], "counts": numpy.array([7, 8, 9]), "missing": None}
for name, values in files.items():
    with h5py.File(f"{name}.h5", "w") as file:
        file["time"] = 1.0
        if values is not None:
            file["probability"] = values
END
for name in changed missing longer complex counts; do
    status=0
    root/usr/bin/h5diff -q expected.h5 "$name.h5" >said || status=$?
    echo "$name: exit status $status, $(wc -l <said) lines printed"
done | tee seen
diff - seen <<'END' || { echo "h5diff behaves in another way than stated" >&2; exit 1; }
changed: exit status 1, 0 lines printed
missing: exit status 1, 0 lines printed
longer: exit status 0, 0 lines printed
complex: exit status 0, 0 lines printed
counts: exit status 0, 0 lines printed
END
