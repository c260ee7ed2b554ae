#pragma once
/// The program between main and its rooms.

namespace stickslip::cli {

/// Runs the command line and returns its exit status. Starts and ends PETSc.
int run(int argc, char** argv);

}  // namespace stickslip::cli
