#!/usr/bin/env bash
# netCDF 4.9.0: a complex dataset of an HDF5 file is shown only if the name of its type sorts before its own name.
#
# One would guess: netCDF-4 reads HDF5, has compound types and enumerations, and so shows the complex numbers (a
# compound of r and i) and the booleans (an enumeration) that h5py writes, or says that it cannot.
# Instead: ncdump leaves both out, with exit status 0 and no message, and nccopy copies the rest. Naming the type in
# the file (a committed type) helps by its name: with the type called "complex" the dataset "mode" is shown; with the
# same type called "number" it is absent, as the type comes later in the alphabet than the dataset that uses it.
# Documented: that types without a name are not read is issue 2651 of netcdf-c, opened after this version, where named
# ones are said to be read; that their order decides is not.
# Why it matters: results in HDF5 are passed on to readers built on netCDF (ncdump, nccopy, xarray with netCDF4).
# Complex relaxation modes and masks of what may be trusted vanish on the way, and the copy looks whole. Write real and
# imaginary parts, and integers for booleans, where others read by netCDF.
# Checked with Debian 12's packages: netcdf-bin and libnetcdf19 are unpacked; python3-h5py-serial, libhdf5-103-1,
# libhdf5-hl-100, libcurl3-gnutls and libxml2 have to be installed.
set -euo pipefail

dpkg-query -W libhdf5-hl-100 libcurl3-gnutls libxml2 >/dev/null
installed=$(dpkg-query -W -f='${Version} ' libhdf5-103-1 python3-h5py-serial)
if [[ $installed != "1.10.8+repack1-1 3.7.0-8 " ]]; then
    echo "needs libhdf5-103-1 1.10.8+repack1-1 and python3-h5py-serial 3.7.0-8, found '$installed'" >&2
    exit 1
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get -q download netcdf-bin=1:4.9.0-3+b1 libnetcdf19=1:4.9.0-3+b1 >download.log 2>&1 || {
    cat download.log >&2
    exit 1
}
for package in *.deb; do
    dpkg -x "$package" root
done
export LD_LIBRARY_PATH="$folder/root/usr/lib/x86_64-linux-gnu"

/usr/bin/python3 - <<'END'
import h5py
import numpy

modes = numpy.array([1 + 2j, 3 - 4j])
for name in "unnamed", "complex", "number":
    with h5py.File(f"{name}.h5", "w") as file:
        file["rate"] = [0.5, 0.25]
        file["trusted"] = numpy.array([True, False])
        if name == "unnamed":
            file["mode"] = modes
        else:
            file[name] = modes.dtype
            file.create_dataset("mode", data=modes, dtype=file[name])
END
for name in unnamed complex number; do
    root/usr/bin/nccopy "$name.h5" "$name.nc" 2>said
    for file in "$name.h5" "$name.nc"; do
        root/usr/bin/ncdump "$file" >text 2>>said
        found=$(sed -n 's/^\t[a-z]* \([a-z]*\)(.*/\1/p' text | paste -sd ' ')
        echo "$file: variables $found; $(wc -l <said) lines of messages"
    done
done | tee seen
diff - seen <<'END' || { echo "netCDF behaves in another way than stated" >&2; exit 1; }
unnamed.h5: variables rate; 0 lines of messages
unnamed.nc: variables rate; 0 lines of messages
complex.h5: variables mode rate; 0 lines of messages
complex.nc: variables mode rate; 0 lines of messages
number.h5: variables rate; 0 lines of messages
number.nc: variables rate; 0 lines of messages
END
