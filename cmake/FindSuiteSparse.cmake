# SPDX-License-Identifier: GPL-3.0-or-later
# CHOLMOD as the target SuiteSparse::cholmod and, for a benchmark, UMFPACK as SuiteSparse::umfpack if it is there.
find_path(SuiteSparse_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_CHOLMOD_LIBRARY cholmod)
find_library(SuiteSparse_UMFPACK_LIBRARY umfpack)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_INCLUDE_DIR)
foreach(part cholmod umfpack)
  string(TOUPPER ${part} name)
  if(SuiteSparse_FOUND AND SuiteSparse_${name}_LIBRARY AND NOT TARGET SuiteSparse::${part})
    add_library(SuiteSparse::${part} UNKNOWN IMPORTED)
    set_target_properties(SuiteSparse::${part} PROPERTIES IMPORTED_LOCATION ${SuiteSparse_${name}_LIBRARY}
                          INTERFACE_INCLUDE_DIRECTORIES ${SuiteSparse_INCLUDE_DIR})
  endif()
endforeach()
mark_as_advanced(SuiteSparse_INCLUDE_DIR SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_UMFPACK_LIBRARY)
