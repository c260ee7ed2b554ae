/// Catch2 itself, which takes longest to compile of all in the tests: once for all programs.

#define CATCH_CONFIG_RUNNER  // of Catch2 2
#include "run_catch.hpp"

#include "catch.hpp"

namespace stickslip::test {

int run_catch(int argc, char** argv) { return Catch::Session().run(argc, argv); }

}  // namespace stickslip::test
