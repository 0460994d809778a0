# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the library into a folder of its own, builds the consumer against it by CMake and by pkg-config, and runs
# both programs there. With MPIEXEC also the consumer of the component mpi, whose processes may outnumber cores here,
# and which root may start.
function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
endfunction()
set(prefix ${FOLDER}/prefix)
set(with_mpi OFF)
if(MPIEXEC)
  set(with_mpi ON)
endif()
file(REMOVE_RECURSE ${FOLDER})
must(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
must(${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/tests/consumer -B ${FOLDER}/build -DCMAKE_PREFIX_PATH=${prefix}
     -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=${FLAGS}"
     -DCONSUMER_MPI=${with_mpi})
must(${CMAKE_COMMAND} --build ${FOLDER}/build)
must(${FOLDER}/build/consumer)
if(MPIEXEC)
  foreach(setting OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM OMPI_MCA_rmaps_base_oversubscribe
                  OMPI_MCA_mpi_yield_when_idle)
    set(ENV{${setting}} 1)
  endforeach()
  must(${MPIEXEC} -q -n 5 ${FOLDER}/build/consumer_mpi)
endif()
# The same without CMake. The packages of pkg-config say where they lie, wherever the installation was moved to.
file(RENAME ${prefix} ${FOLDER}/moved)
set(prefix ${FOLDER}/moved)
find_program(PKG_CONFIG pkg-config REQUIRED)
set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBRARIES}/pkgconfig)
# compile(COMPILER SOURCE PROGRAM PACKAGE...)
function(compile compiler source program)
  execute_process(COMMAND ${PKG_CONFIG} --cflags --libs ${ARGN} OUTPUT_VARIABLE options COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(options UNIX_COMMAND "${options} ${FLAGS}")
  must(${compiler} -std=c++20 -O0 ${SOURCE}/tests/consumer/${source} -o ${FOLDER}/${program} ${options}
       -Wl,-rpath,${prefix}/${LIBRARIES})
endfunction()
compile(${COMPILER} main.cpp by_pkgconfig nscdd gsl)
must(${FOLDER}/by_pkgconfig)
if(MPIEXEC)
  compile(${MPICXX} shared.cpp by_pkgconfig_mpi nscdd-mpi)
  must(${MPIEXEC} -q -n 2 ${FOLDER}/by_pkgconfig_mpi)
endif()
# The installed program finds its cases and studies beside itself, wherever it is called from.
must(${CMAKE_COMMAND} -E chdir ${FOLDER} ${prefix}/bin/nscdd sweep disks4 --epsilon 0 --csv -)
must(${CMAKE_COMMAND} -E chdir ${FOLDER} ${prefix}/bin/nscdd run figure-7 --check)
