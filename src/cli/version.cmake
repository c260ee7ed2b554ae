# Writes version.hpp with the project version and the commit, only when something changed.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12
                OUTPUT_VARIABLE STICKSLIP_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT STICKSLIP_COMMIT)
  set(STICKSLIP_COMMIT "not in a repository")
endif()
set(STICKSLIP_VERSION ${VERSION})
configure_file(${SOURCE}/src/cli/version.hpp.in ${TARGET} @ONLY)
