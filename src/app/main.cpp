/// stickslip: dry friction under random forcing. See README.md and `stickslip -help`.

#include "stickslip/app/run.hpp"

int main(int argc, char** argv) { return stickslip::app::run(argc, argv); }
