# PETSc and SLEPc with real scalars and, where there are any, with complex ones: the imported targets
# PkgConfig::PETSC_<kind> and PkgConfig::SLEPC_<kind> of each kind in STICKSLIP_VARIANTS.
#
# Searched are PETSC_DIR if it is given; else PKG_CONFIG_PATH if it leads to a PETSc; else the folders
# of Debian, which installs PETSc once for each type of scalars; else pkg-config's own folders. One
# place serves alone: what is compiled once for both programs must see one PETSc and one MPI.

option(STICKSLIP_COMPLEX "Build stickslip-complex as well, if a complex PETSc is found" ON)
set(PETSC_DIR "$ENV{PETSC_DIR}" CACHE STRING "PETSc to use; for real and complex scalars a list")
set(PETSC_ARCH "$ENV{PETSC_ARCH}" CACHE STRING "Its builds to use, a list; none if it is installed")
set(SLEPC_DIR "$ENV{SLEPC_DIR}" CACHE STRING "SLEPc to use; a list as long as PETSC_DIR")
set(USERS_PATH "$ENV{PKG_CONFIG_PATH}")

# real, complex, or empty if PETSc is missing or computes with other than double precision.
function(scalars_of_petsc variable)
  set(${variable} "" PARENT_SCOPE)
  set(ENV{PKG_CONFIG_ALLOW_SYSTEM_CFLAGS} 1)
  execute_process(COMMAND ${PKG_CONFIG_EXECUTABLE} --cflags-only-I PETSc
                  OUTPUT_VARIABLE flags ERROR_QUIET)
  string(REGEX MATCHALL "[^ \n]+" flags "${flags}")
  list(TRANSFORM flags REPLACE "^-I" "")
  foreach(folder ${flags})
    if(EXISTS ${folder}/petscconf.h)
      file(STRINGS ${folder}/petscconf.h uses REGEX "define PETSC_USE_(COMPLEX|REAL_DOUBLE)[ \t]")
      if(uses MATCHES COMPLEX AND uses MATCHES DOUBLE)
        set(${variable} complex PARENT_SCOPE)
      elseif(uses MATCHES DOUBLE)
        set(${variable} real PARENT_SCOPE)
      endif()
      return()
    endif()
  endforeach()
endfunction()

# Takes the first PETSc of this search path, with the SLEPc of the same path, unless one with the same
# scalars was found before.
function(take_petsc path)
  set(ENV{PKG_CONFIG_PATH} "${path}")
  scalars_of_petsc(kind)
  if(NOT kind OR kind IN_LIST STICKSLIP_VARIANTS OR (kind STREQUAL complex AND NOT STICKSLIP_COMPLEX))
    return()
  endif()
  # pkg_check_modules keeps in the cache what it found under another path.
  get_cmake_property(kept CACHE_VARIABLES)
  list(FILTER kept INCLUDE REGEX "^(__pkg_config_checked|pkgcfg_lib)_(PETSC|SLEPC)_${kind}")
  foreach(entry ${kept})
    unset(${entry} CACHE)
  endforeach()
  pkg_check_modules(PETSC_${kind} IMPORTED_TARGET GLOBAL PETSc>=3.18)
  pkg_check_modules(SLEPC_${kind} IMPORTED_TARGET GLOBAL SLEPc>=3.18)
  if(PETSC_${kind}_FOUND AND SLEPC_${kind}_FOUND)
    set(STICKSLIP_VARIANTS ${STICKSLIP_VARIANTS} ${kind} PARENT_SCOPE)
    message(STATUS "PETSc ${PETSC_${kind}_VERSION}, ${kind}: ${PETSC_${kind}_PREFIX}")
  endif()
endfunction()

# The folders of a search path that hold a file.
function(folders_with file variable)
  set(found)
  foreach(folder ${ARGN})
    if(EXISTS ${folder}/${file})
      list(APPEND found ${folder})
    endif()
  endforeach()
  set(${variable} ${found} PARENT_SCOPE)
endfunction()

# Takes what is in lists like PETSC_DIR, PETSC_ARCH and SLEPC_DIR. A SLEPc that pkg-config finds
# elsewhere belongs to another PETSc.
function(take_folders petsc_dirs archs slepc_dirs)
  string(REPLACE ":" ";" users "${USERS_PATH}")
  foreach(dir IN ZIP_LISTS petsc_dirs slepc_dirs)
    foreach(arch ${archs} .)
      folders_with(PETSc.pc petsc ${dir_0}/${arch}/lib/pkgconfig)
      folders_with(SLEPc.pc slepc ${dir_1}/${arch}/lib/pkgconfig ${dir_1}/lib/pkgconfig ${petsc} ${users})
      if(petsc AND slepc)
        list(JOIN slepc ":" slepc)
        take_petsc("${petsc}:${slepc}:${USERS_PATH}")
      elseif(petsc)
        message(STATUS "No SLEPc for the PETSc of ${petsc}: give SLEPC_DIR")
      endif()
    endforeach()
  endforeach()
  set(STICKSLIP_VARIANTS ${STICKSLIP_VARIANTS} PARENT_SCOPE)
endfunction()

set(STICKSLIP_VARIANTS)
string(REPLACE ":" ";" users "${USERS_PATH}")
folders_with(PETSc.pc users_petsc ${users})
if(PETSC_DIR)
  take_folders("${PETSC_DIR}" "${PETSC_ARCH}" "${SLEPC_DIR}")
elseif(users_petsc)
  take_petsc("${USERS_PATH}")
else()
  file(GLOB petsc /usr/lib/petscdir/petsc[0-9]*)
  file(GLOB slepc /usr/lib/slepcdir/slepc[0-9]*)
  set(archs ${CMAKE_LIBRARY_ARCHITECTURE}-real ${CMAKE_LIBRARY_ARCHITECTURE}-complex)
  take_folders("${petsc}" "${archs}" "${slepc}")
  take_petsc("${USERS_PATH}")
endif()
set(ENV{PKG_CONFIG_PATH} "${USERS_PATH}")

if(NOT real IN_LIST STICKSLIP_VARIANTS)
  message(FATAL_ERROR "No PETSc >= 3.18 with real scalars in double precision, and SLEPc of it "
    "(PETSC_DIR \"${PETSC_DIR}\", found with scalars: \"${STICKSLIP_VARIANTS}\").\n"
    "On Debian: apt-get install libpetsc-real-dev libslepc-real-dev\n"
    "Another one: -DPETSC_DIR=... -DSLEPC_DIR=..., and -DPETSC_ARCH=... if it is not installed; lists "
    "name one with real and one with complex scalars. Or PKG_CONFIG_PATH.")
endif()
if(NOT complex IN_LIST STICKSLIP_VARIANTS)
  message(STATUS "Without stickslip-complex: not asked for, or no PETSc and SLEPc with complex scalars")
elseif(NOT PETSC_real_VERSION STREQUAL PETSC_complex_VERSION)
  message(FATAL_ERROR "PETSc ${PETSC_real_VERSION} with real and ${PETSC_complex_VERSION} with complex "
    "scalars: give two of one version, or -DSTICKSLIP_COMPLEX=OFF.")
endif()

# Only Debian's libraries are found at run time without being told where.
if(PETSC_DIR OR users_petsc)
  set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)
endif()
