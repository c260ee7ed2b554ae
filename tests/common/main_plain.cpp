#define CATCH_CONFIG_RUNNER  // of Catch2 2
#include "catch.hpp"

int main(int argc, char** argv) { return Catch::Session().run(argc, argv); }
