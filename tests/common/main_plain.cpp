#include "run_catch.hpp"

int main(int argc, char** argv) { return stickslip::test::run_catch(argc, argv); }
