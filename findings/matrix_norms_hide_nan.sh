#!/usr/bin/env bash
# PETSc 3.18.5: MatNorm of a matrix with a NaN is an ordinary number, and the LU solve with it counts as converged.
#
# One would guess: a NaN in a matrix makes each of its norms NaN, as VecNorm does for a vector, so that a finite norm
# shows that the matrix is in order.
# Instead: NORM_INFINITY and NORM_1 leave out each row or column that has a NaN, as a comparison with NaN is false;
# only NORM_FROBENIUS is NaN. The direct solve (KSPPREONLY with PETSc's own LU) then reports KSP_CONVERGED_ITS, raises
# nothing although KSPSetErrorIfNotConverged asks for it, and returns NaN next to numbers that look right. MUMPS fails.
# Documented: no; the page of MatNorm names the norms and does not speak of NaN.
# Why it matters: one coefficient that is 0/0, such as a drag at zero velocity, puts a NaN into the generator. A check
# of the infinity norm passes, and quantities that do not touch the bad unknown look fine. Check the Frobenius norm of
# the matrix and the norm of the solution.
# Checked with Debian 12's libpetsc-real3.18-dev, which has to be installed.
set -euo pipefail

installed=$(dpkg-query -W -f='${Version}' libpetsc-real3.18-dev) || exit 1
if [[ $installed != 3.18.5+dfsg1-1* ]]; then
    echo "needs Debian's libpetsc-real3.18-dev 3.18.5+dfsg1-1, found '$installed'" >&2
    exit 1
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

cat >"$folder/norms.c" <<'END'
#include <petscksp.h>

int main(int argc, char **argv) {
  Mat matrix;
  Vec x, b;
  KSP ksp;
  PC pc;
  PetscReal rows, columns, frobenius, vector;
  KSPConvergedReason reason;
  const PetscScalar zero = 0, *values;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, 3, 3, 2, NULL, &matrix));
  for (PetscInt i = 0; i < 3; ++i) PetscCall(MatSetValue(matrix, i, i, i + 1, INSERT_VALUES));
  PetscCall(MatSetValue(matrix, 1, 0, zero / zero, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatNorm(matrix, NORM_INFINITY, &rows));
  PetscCall(MatNorm(matrix, NORM_1, &columns));
  PetscCall(MatNorm(matrix, NORM_FROBENIUS, &frobenius));

  PetscCall(MatCreateVecs(matrix, &x, &b));
  PetscCall(VecSet(b, 1));
  PetscCall(KSPCreate(PETSC_COMM_SELF, &ksp));
  PetscCall(KSPSetOperators(ksp, matrix, matrix));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(KSPSetErrorIfNotConverged(ksp, PETSC_TRUE));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(VecNorm(x, NORM_INFINITY, &vector));
  PetscCall(VecGetArrayRead(x, &values));

  printf("matrix: infinity norm %g, 1-norm %g, Frobenius norm %s\n", rows, columns,
         PetscIsNanReal(frobenius) ? "nan" : "a number");
  printf("LU solve: %s, x = %g %s %.4f\n", KSPConvergedReasons[reason], values[0],
         PetscIsNanReal(values[1]) ? "nan" : "a number", values[2]);
  printf("vector: infinity norm %s\n", PetscIsNanReal(vector) ? "nan" : "a number");
  return 0;
}
END
export PKG_CONFIG_PATH=/usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real/lib/pkgconfig
read -ra flags <<<"$(pkg-config --cflags --libs PETSc)"
mpicc -w -o "$folder/norms" "$folder/norms.c" "${flags[@]}"
"$folder/norms" | tee "$folder/seen"
diff - "$folder/seen" <<'END' || { echo "PETSc behaves in another way than stated" >&2; exit 1; }
matrix: infinity norm 3, 1-norm 3, Frobenius norm nan
LU solve: CONVERGED_ITS, x = 1 nan 0.3333
vector: infinity norm nan
END
