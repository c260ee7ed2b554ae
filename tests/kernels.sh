#!/usr/bin/env bash
# What is built must pass its tests with every BLAS: with the kernels that OpenBLAS has for other
# processors, with the reference BLAS, and beside other work. Each rounds, or takes its time, otherwise.
#   tests/kernels.sh BUILD_FOLDER [KERNEL ...] [-- CTEST OPTIONS]
# KERNEL is a core type of OpenBLAS, `reference`, or `busy`, which keeps all processors at work; without
# one all are tried. Kernels that this processor cannot run are left out. Without options of ctest the
# first tier is run, but for what does not compute.
set -euo pipefail
build=${1:?a build folder with tests}
shift
kernels=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do
  kernels+=("$1")
  shift
done
[ ${#kernels[@]} -gt 0 ] ||
  kernels=(Prescott Nehalem Sandybridge Haswell Zen SkylakeX Cooperlake reference busy)
tests=("${@:2}")
[ ${#tests[@]} -gt 0 ] || tests=(--label-exclude second --exclude-regex '^lint:')

# Whether this processor has the instructions of a kernel.
can_run() {
  local needed
  case $1 in
    SkylakeX) needed=avx512vl ;;
    Cooperlake) needed=avx512_bf16 ;;
    Haswell | Zen) needed=avx2 ;;
    Sandybridge) needed=avx ;;
    *) return 0 ;;
  esac
  grep -qw "$needed" /proc/cpuinfo
}

# The variables of the environment that choose a kernel.
choice_of() {
  local blas lapack
  case $1 in
    busy) ;;
    reference)
      blas=$(echo /usr/lib/*/blas) lapack=$(echo /usr/lib/*/lapack)
      [ -e "$blas/libblas.so.3" ] || { echo "no reference BLAS: install libblas3" >&2; return 1; }
      echo "LD_LIBRARY_PATH=$blas:$lapack"
      ;;
    *) echo "OPENBLAS_CORETYPE=$1" ;;
  esac
}

others=()
stop_others() {
  [ ${#others[@]} -eq 0 ] || kill "${others[@]}"
  others=()
}
trap stop_others EXIT

failed=()
for kernel in "${kernels[@]}"; do
  if ! can_run "$kernel"; then
    echo "$kernel: not on this processor"
    continue
  fi
  variable=$(choice_of "$kernel")
  if [ "$kernel" = busy ]; then
    for _ in $(seq "$(nproc)"); do
      while :; do :; done &
      others+=($!)
    done
  fi
  echo "$kernel:"
  env ${variable:+"$variable"} ctest --test-dir "$build" --output-on-failure -j "$(nproc)" "${tests[@]}" ||
    failed+=("$kernel")
  stop_others
done
[ ${#failed[@]} -eq 0 ] || { echo "failed with ${failed[*]}" >&2; exit 1; }
