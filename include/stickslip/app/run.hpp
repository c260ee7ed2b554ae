#pragma once
/// The program between main and its modules.

namespace stickslip::app {

/// Runs the command line and returns its exit status. Starts and ends PETSc.
int run(int argc, char** argv);

}  // namespace stickslip::app
