#include "stickslip/operators/element_pc.hpp"

#include <fmt/format.h>
// The only private header of PETSc in this project. A PC type fills the structure of its
// operations, which PETSc declares here and installs for this purpose; its public interface has
// PCSHELL alone, which is no type of its own in options and views, and is not told of a reset.
#include <petsc/private/pcimpl.h>

#include <algorithm>
#include <memory>
#include <span>

#include "stickslip/operators/element_elimination.hpp"
#include "stickslip/operators/solver_policy.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/petsc/scalars.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/petsc/versions.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::operators {
namespace {

using petsc::check;
using petsc::guarded;

struct Events {
  PetscClassId id = 0;
  PetscLogEvent set_up = 0, solve = 0;
};

Events& events() {
  static Events all;
  return all;
}

/// What a PC of this type owns.
struct Elements {
  std::unique_ptr<ElementElimination<PetscScalar>> factors;
  std::unique_ptr<petsc::WholeVectors> vectors;
  PetscBool share = PETSC_TRUE;
  double entries = 0;  // of this rank, when factored
};

Elements& elements_of(PC pc) { return *static_cast<Elements*>(pc->data); }

/// Shows a scope as an event of -log_view.
class LoggedEvent {
 public:
  LoggedEvent(PetscLogEvent event, PC pc) : event_(event), pc_(pc) {
    (void)PetscLogEventBegin(event_, pc_, 0, 0, 0);
  }
  ~LoggedEvent() { (void)PetscLogEventEnd(event_, pc_, 0, 0, 0); }
  LoggedEvent(const LoggedEvent&) = delete;
  LoggedEvent& operator=(const LoggedEvent&) = delete;

 private:
  PetscLogEvent event_;
  PC pc_;
};

std::shared_ptr<const MatrixData> data_for(PC pc) {
  auto data = data_of(pc->pmat);
  if (data &&
      dynamic_cast<const velocity::HpDiscretisation*>(data->discretisation.velocities.get()))
    return data;
  const char* prefix = nullptr;
  check(PCGetOptionsPrefix(pc, &prefix));
  throw BadInput(fmt::format("-{}pc_type: elements needs the matrix of a sliding operator on an hp "
                             "discretisation; leave it out",
                             prefix == nullptr ? "" : prefix));
}

// Of all ranks; those that do not share elements have them all.
FactorCost cost_of(PC pc, const MatrixData& data) {
  const int ranks = petsc::ranks(data.states.comm());
  const bool share = elements_of(pc).share == PETSC_TRUE, reduced = data.states.symmetry_reduced();
  if (share) return elimination_cost(data.discretisation, reduced, ranks);
  const FactorCost one = elimination_cost(data.discretisation, reduced, 1);
  return {ranks * one.entries, ranks * one.bytes, ranks * one.operations};
}

// Called by PETSc.

PetscErrorCode set_up(PC pc) {
  return guarded([pc] {
    const LoggedEvent logged(events().set_up, pc);
    const auto data = data_for(pc);
    Elements& own = elements_of(pc);
    own.factors.reset();  // before there are others
    own.factors =
        std::make_unique<ElementElimination<PetscScalar>>(pc->pmat, data, own.share == PETSC_TRUE);
    own.vectors = std::make_unique<petsc::WholeVectors>(pc->pmat);
    own.entries = own.factors->entries();
    check(PetscLogFlops(cost_of(pc, *data).operations / petsc::ranks(data->states.comm())));
  });
}

PetscErrorCode apply_to_columns(PC pc, std::span<const Vec> b, std::span<const Vec> x,
                                bool transposed) {
  return guarded([=] {
    const LoggedEvent logged(events().solve, pc);
    const Elements& own = elements_of(pc);
    PetscInt size = 0;
    check(VecGetSize(b[0], &size));
    petsc::DenseMatrix all(size, static_cast<int>(b.size()));
    for (int c = 0; c < all.columns(); ++c) {
      const auto column = own.vectors->gathered(b[c]);
      std::copy(column.begin(), column.end(), all.column(c));
    }
    own.factors->solve(all, transposed);
    for (int c = 0; c < all.columns(); ++c) {
      own.vectors->scatter(all.column(c), x[c], [](PetscScalar entry) { return entry; });
    }
    check(PetscLogFlops(2 * own.entries * all.columns()));
  });
}

template <bool transposed>
PetscErrorCode apply(PC pc, Vec b, Vec x) {
  return apply_to_columns(pc, {&b, 1}, {&x, 1}, transposed);
}

// NOLINTNEXTLINE(readability-identifier-naming): the name that PETSc's macros expect
PetscErrorCode set_from_options(PC pc, petsc::OptionItems PetscOptionsObject) {
  PetscBool& share = elements_of(pc).share;
  PetscOptionsHeadBegin(PetscOptionsObject, "Elimination of velocity elements");
  return PetscOptionsBool("-pc_elements_share", "Ranks share the elements, or each factors all",
                          nullptr, share, &share, nullptr);
}

PetscErrorCode compose(PC pc, petsc::Analyse* analyse, petsc::ApplyToColumns* apply) {
  return guarded([=] {
    const auto object = reinterpret_cast<PetscObject>(pc);
    check(PetscObjectComposeFunction(object, petsc::kAnalyse, analyse));
    check(PetscObjectComposeFunction(object, petsc::kApplyToColumns, apply));
  });
}

PetscErrorCode reset(PC pc) {
  elements_of(pc).factors.reset();
  elements_of(pc).vectors.reset();
  return 0;
}

PetscErrorCode destroy(PC pc) {
  delete &elements_of(pc);
  pc->data = nullptr;
  return compose(pc, nullptr, nullptr);
}

PetscErrorCode view(PC pc, PetscViewer viewer) {
  return guarded([=] {
    PetscBool ascii = PETSC_FALSE;
    check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(viewer), PETSCVIEWERASCII, &ascii));
    if (ascii == PETSC_FALSE) return;
    const auto data = data_of(pc->pmat);
    if (!data) return;
    const Discretisation& on = data->discretisation;
    const FactorCost cost = cost_of(pc, *data);
    const auto line = [viewer](const std::string& text) {
      check(PetscViewerASCIIPrintf(viewer, "  %s\n", text.c_str()));
    };
    line("block LU along the velocity, over elements condensed to the values at their ends");
    line(fmt::format("elements {} on {} velocity branch(es), noise nodes {} in {} groups",
                     on.velocities->cells().size() - 1, data->states.branches().size(),
                     on.noise->count(), on.noise->groups().size()));
    line(fmt::format("elements shared by {} rank(s)",
                     elements_of(pc).share == PETSC_TRUE ? petsc::ranks(data->states.comm()) : 1));
    line(fmt::format("entries of the factors {:.4g}, operations of factoring {:.4g}", cost.entries,
                     cost.operations));
  });
}

PetscErrorCode analyse(PC pc, petsc::Analysis* analysis) {
  return guarded([=] {
    const auto data = data_for(pc);
    const FactorCost cost = cost_of(pc, *data);
    *analysis = {petsc::kElementsPc, cost.entries, cost.bytes / 1e6, cost.operations};
  });
}

PetscErrorCode create(PC pc) {
  pc->data = new Elements;
  pc->ops->setup = set_up;
  pc->ops->apply = apply<false>;
  pc->ops->applytranspose = apply<true>;
  pc->ops->setfromoptions = set_from_options;
  pc->ops->reset = reset;
  pc->ops->destroy = destroy;
  pc->ops->view = view;
  return compose(pc, analyse, apply_to_columns);
}

}  // namespace

void register_preconditioners() {
  check(PCRegister(petsc::kElementsPc, create));
  check(PetscClassIdRegister("stickslip", &events().id));
  check(PetscLogEventRegister("PCElementsSetUp", events().id, &events().set_up));
  check(PetscLogEventRegister("PCElementsSolve", events().id, &events().solve));
}

}  // namespace stickslip::operators
