# SPDX-License-Identifier: GPL-3.0-or-later
# SLEPc with real numbers and the PETSc below it, as the target SLEPc::slepc. Where both lie their package files know;
# the compiler flags that these bring are left out, because they are those of the distribution's own builds.
find_package(PkgConfig REQUIRED)
pkg_check_modules(SLEPC_PC QUIET SLEPc PETSc)
set(SLEPC_VERSION "${SLEPC_PC_SLEPc_VERSION}")
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SLEPc REQUIRED_VARS SLEPC_PC_LINK_LIBRARIES SLEPC_PC_INCLUDE_DIRS
                                  VERSION_VAR SLEPC_VERSION)
if(SLEPc_FOUND AND NOT TARGET SLEPc::slepc)
  add_library(SLEPc::slepc INTERFACE IMPORTED)
  target_include_directories(SLEPc::slepc SYSTEM INTERFACE ${SLEPC_PC_INCLUDE_DIRS})
  target_link_libraries(SLEPc::slepc INTERFACE ${SLEPC_PC_LINK_LIBRARIES})
endif()
