#!/usr/bin/env bash
# gfortran 12.2: the 1P of (1PE12.4,F10.3) multiplies the second column by ten in the file.
#
# One would guess: 1P belongs to E12.4, where it puts one digit before the point and leaves the value as it is, and
# F10.3 writes the value.
# Instead: the scale factor stays for all that follows, and an F column is written as ten times the value. Read by the
# same format, numbers without an exponent are divided by ten again, so the program that wrote them sees no error.
# Everyone else reads ten times the acceleration. By a format with 1P, a number of another writer is read as a tenth.
# Documented: in manuals of Fortran, at the P edit descriptor; gfortran warns of nothing with -Wall -Wextra.
# Why it matters: tables of time and acceleration are written so by older programs. A factor of ten in the acceleration
# over the friction turns a block that sticks into one that slips. 0P in front of F10.3 ends the scale factor.
# Checked with Debian 12's gfortran-12, which has to be installed.
set -euo pipefail

installed=$(dpkg-query -W -f='${Version}' gfortran-12) || exit 1
if [[ $installed != 12.2.0-14* ]]; then
    echo "needs Debian's gfortran-12 12.2.0-14, found '$installed'" >&2
    exit 1
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

cat >"$folder/scale.f90" <<'END'
program scale
  implicit none
  character(22) :: line, other = '  1.0000E-02     1.234'
  double precision :: time, acceleration
  write (line, '(1PE12.4,F10.3)') 0.01d0, 1.234d0
  print '(2A)', 'written 1.234 as ', line
  read (line, '(1PE12.4,F10.3)') time, acceleration
  print '(A,F7.4)', 'read by the same format:', acceleration
  read (line, *) time, acceleration
  print '(A,F7.4)', 'read without a format:  ', acceleration
  read (other, '(1PE12.4,F10.3)') time, acceleration
  print '(A,F7.4)', 'read by it, 1.234 of another writer:', acceleration
  write (line, '(1PE12.4,0PF10.3)') 0.01d0, 1.234d0
  print '(2A)', 'written with 0P: ', line
end program
END
gfortran-12 -Wall -Wextra -Werror -o "$folder/scale" "$folder/scale.f90"
"$folder/scale" | tee "$folder/seen"
diff - "$folder/seen" <<'END' || { echo "gfortran behaves in another way than stated" >&2; exit 1; }
written 1.234 as   1.0000E-02    12.340
read by the same format: 1.2340
read without a format:  12.3400
read by it, 1.234 of another writer: 0.1234
written with 0P:   1.0000E-02     1.234
END
