#pragma once

namespace stickslip::test {

/// Runs the cases that the command line names; how many failed.
int run_catch(int argc, char** argv);

}  // namespace stickslip::test
