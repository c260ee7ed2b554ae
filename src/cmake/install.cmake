# What `cmake --install` puts under the prefix, and the Debian package that `cpack -G DEB` makes of it.

include(GNUInstallDirs)

# Manual page and completion, printed by the program. No leak of a library at its exit matters here.
set(manual ${CMAKE_BINARY_DIR}/manual)
file(MAKE_DIRECTORY ${manual})
add_custom_command(OUTPUT ${manual}/stickslip.1 ${manual}/stickslip
  COMMAND ${CMAKE_COMMAND} -E env ASAN_OPTIONS=detect_leaks=0 $<TARGET_FILE:stickslip> -man_page
          > ${manual}/stickslip.1
  COMMAND ${CMAKE_COMMAND} -E env ASAN_OPTIONS=detect_leaks=0 $<TARGET_FILE:stickslip> -completion
          > ${manual}/stickslip
  DEPENDS stickslip VERBATIM)
# All that is installed.
add_custom_target(programs ALL DEPENDS ${manual}/stickslip.1 ${manual}/stickslip ${PROGRAMS})

install(TARGETS ${PROGRAMS} RUNTIME)
set(completions ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
foreach(program ${PROGRAMS})
  install(FILES ${manual}/stickslip.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 RENAME ${program}.1)
  install(FILES ${manual}/stickslip DESTINATION ${completions} RENAME ${program})
endforeach()
install(DIRECTORY options DESTINATION ${CMAKE_INSTALL_DATADIR}/stickslip)
# Where Debian's python3 looks if the prefix is /usr.
install(DIRECTORY python/stickslip DESTINATION lib/python3/dist-packages
        FILES_MATCHING PATTERN *.py PATTERN __pycache__ EXCLUDE)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}
        PATTERN *.py EXCLUDE PATTERN __pycache__ EXCLUDE)
install(FILES CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES python/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME python.md)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
# Installed pages name the installed program, but for those about building it.
install(CODE "
  file(GLOB pages \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}/*.md\")
  foreach(page IN LISTS pages)
    if(NOT page MATCHES \"/(install|development)[.]md$\")
      file(READ \"\${page}\" text)
      string(REGEX REPLACE \"build/stickslip|[.]/bootstrap run\" stickslip text \"\${text}\")
      string(REPLACE \"./bootstrap plot\" \"python3 -m stickslip plot\" text \"\${text}\")
      file(WRITE \"\${page}\" \"\${text}\")
    endif()
  endforeach()")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The stickslip authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "openmpi-bin, libopenblas0-pthread, bash-completion, "
                                    "python3-numpy, python3-h5py, python3-matplotlib")
list(JOIN CPACK_DEBIAN_PACKAGE_RECOMMENDS "" CPACK_DEBIAN_PACKAGE_RECOMMENDS)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/src/cmake/prerm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
