# SPDX-License-Identifier: GPL-3.0-or-later
# MUMPS in double precision: the sequential one as the target MUMPS::dmumps or, with the component `parallel`, the one
# for MPI as MUMPS::dmumps_parallel.
include(FindPackageHandleStandardArgs)
if("parallel" IN_LIST MUMPS_FIND_COMPONENTS)
  find_path(MUMPS_PARALLEL_INCLUDE_DIR dmumps_c.h)
  find_library(MUMPS_PARALLEL_LIBRARY NAMES dmumps)
  set(MUMPS_parallel_FOUND ON)
  find_package_handle_standard_args(MUMPS REQUIRED_VARS MUMPS_PARALLEL_LIBRARY MUMPS_PARALLEL_INCLUDE_DIR)
  if(MUMPS_FOUND AND NOT TARGET MUMPS::dmumps_parallel)
    add_library(MUMPS::dmumps_parallel UNKNOWN IMPORTED)
    set_target_properties(MUMPS::dmumps_parallel PROPERTIES IMPORTED_LOCATION ${MUMPS_PARALLEL_LIBRARY}
                          INTERFACE_INCLUDE_DIRECTORIES ${MUMPS_PARALLEL_INCLUDE_DIR})
  endif()
else()
  find_path(MUMPS_INCLUDE_DIR dmumps_c.h PATH_SUFFIXES mumps_seq MUMPS)
  find_library(MUMPS_LIBRARY NAMES dmumps_seq dmumps)
  find_package_handle_standard_args(MUMPS REQUIRED_VARS MUMPS_LIBRARY MUMPS_INCLUDE_DIR)
  if(MUMPS_FOUND AND NOT TARGET MUMPS::dmumps)
    add_library(MUMPS::dmumps UNKNOWN IMPORTED)
    set_target_properties(MUMPS::dmumps PROPERTIES IMPORTED_LOCATION ${MUMPS_LIBRARY}
                          INTERFACE_INCLUDE_DIRECTORIES ${MUMPS_INCLUDE_DIR})
  endif()
endif()
mark_as_advanced(MUMPS_INCLUDE_DIR MUMPS_LIBRARY MUMPS_PARALLEL_INCLUDE_DIR MUMPS_PARALLEL_LIBRARY)
