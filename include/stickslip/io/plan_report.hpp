#pragma once
/// What -plan tells.

#include <mpi.h>

#include <string>

#include "stickslip/accuracy/prediction.hpp"
#include "stickslip/options/request.hpp"

namespace stickslip::io {

/// The table for standard output: tasks, systems, solves; then sizes and times by step.
[[nodiscard]] std::string plan_table(const options::Request& request,
                                     const accuracy::Prediction& prediction);

/// The same as JSON: scene, plan, provenance.
[[nodiscard]] std::string plan_summary(MPI_Comm comm, const options::Request& request,
                                       const accuracy::Prediction& prediction);

}  // namespace stickslip::io
