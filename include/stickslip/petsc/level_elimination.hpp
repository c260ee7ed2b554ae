#pragma once
/// Direct solution of systems whose unknowns form a chain of blocks.

#include <petscmat.h>

#include <memory>
#include <utility>
#include <vector>

#include "stickslip/petsc/dense_inverse.hpp"
#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/neighbours.hpp"
#include "stickslip/petsc/preconditioner.hpp"

namespace stickslip::petsc {

/// The local rows of a matrix, arranged as blocks that couple with the block before and the block
/// after alone; the blocks of a rank come between those of the ranks before and after it. Within a
/// block, rows should come before those that they depend on wherever that is possible.
struct Chain {
  std::vector<PetscInt> rows;  ///< local rows, block by block
  std::vector<int> start{0};   ///< of each block in `rows`, and their end
  [[nodiscard]] int blocks() const { return static_cast<int>(start.size()) - 1; }
  [[nodiscard]] int size(int block) const { return start[block + 1] - start[block]; }
};

/// Block elimination from the last block to the first: with A_s the diagonal blocks, D_s (E_s) the
/// coupling of block s to block s + 1 (s - 1),
///
///   S_s = A_s - D_s S_{s+1}^-1 E_{s+1},
///
/// the inverses S_s^-1 being kept. For a generator, S_s is that of the process watched while in
/// block s, killed on leaving inwards. Where what flows out of block s comes back further down in
/// its order, S_s is block upper triangular; the analysis finds the blocks and how far their rows
/// reach, and no other zero is stored or computed with. The blocks of several ranks are eliminated
/// one rank after the other, each of which holds its share of the factors.
class LevelElimination final : public Preconditioner {
 public:
  /// Analysis of the matrix (kept by reference count) for arranged rows. Collective. O(nonzeros).
  LevelElimination(Mat matrix, Chain chain);

  /// Reads the values of the matrix and eliminates. Collective. Throws NotReached for a singular
  /// block, NoMemory when the factors do not fit.
  void factor() override;
  [[nodiscard]] bool factored() const { return factored_; }

  [[nodiscard]] Mat matrix() const { return matrix_; }

  /// x = A^-1 b, or A^-T b without conjugation. Collective. Two passes over the factors.
  void apply(Vec b, Vec x, bool transposed) const override;

 private:
  // Entries of a sparse coupling: one run stands for rows row ... row + length - 1 with one entry
  // each, in columns that rise alike.
  struct Run {
    int row, column, length;
    std::size_t first;  // in values
  };
  struct Coupling {
    std::vector<Run> runs;
    std::vector<PetscScalar> values;
    void add(int row, int column, PetscScalar value);
    void clear();
    // y -= C x or C^T x
    void subtract(const PetscScalar* x, PetscScalar* y, bool transposed = false) const;
  };
  // Diagonal block with its couplings; the inverse as panels, one for each row of blocks.
  struct Level {
    int size = 0;
    Triangle triangle;
    Coupling outwards, inwards;  // D, E
    std::unique_ptr<PetscScalar[]> panels;
    // y = S^-1 x or S^-T x
    void apply(const std::vector<PetscScalar>& x, std::vector<PetscScalar>& y,
               bool transposed) const;
  };

  struct Place {
    int block, position;  // block -1: of the rank before; blocks(): of the rank after
  };
  // Of a block by its number in a Place.
  [[nodiscard]] std::size_t size_of(int block) const;
  void exchange_borders();
  [[nodiscard]] Place place_of(PetscInt column) const;
  void find_triangles();
  void read_block(int s, std::vector<PetscScalar>& dense);
  static void subtract_return(const Level& level, const std::vector<PetscScalar>& back,
                              std::vector<PetscScalar>& dense);
  void reserve(std::vector<PetscScalar>& dense, std::vector<PetscScalar>& back);
  static void store(Level& level, const std::vector<PetscScalar>& inverse);
  static void multiply_inwards(const Level& level, const std::vector<PetscScalar>& inverse,
                               std::size_t columns, std::vector<PetscScalar>& product);
  [[nodiscard]] std::vector<std::vector<PetscScalar>> pass_inwards(Vec b, bool transposed) const;
  void pass_outwards(std::vector<std::vector<PetscScalar>>& z, Vec x, bool transposed) const;

  MatHandle matrix_;
  Chain chain_;
  MPI_Comm comm_;
  PetscInt first_row_ = 0;
  Neighbours ranks_;
  std::vector<Place> local_places_;                                    // of local rows
  std::vector<std::pair<PetscInt, int>> inner_border_, outer_border_;  // global row, position
  std::vector<Level> levels_;
  DenseInverse invert_;
  bool factored_ = false;
};

}  // namespace stickslip::petsc
