/// stickslip: dry friction under random forcing. See README.md and `stickslip -help`.

#include "program.hpp"

int main(int argc, char** argv) { return stickslip::cli::run(argc, argv); }
