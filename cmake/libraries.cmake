# Optional libraries: each either brings its *_with_<library>.f90 files or leaves their *_without_ twins.
set(splitgrain_libraries "")

# choose(<library> <is on>): add the files of a library, or those that do without it.
function(choose library is_on)
  if(is_on)
    file(GLOB_RECURSE chosen CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*_with_${library}.f90)
  else()
    file(GLOB_RECURSE chosen CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*_without_${library}.f90)
  endif()
  # A library that speaks no Fortran may bring a file of C.
  if(is_on)
    file(GLOB_RECURSE shim CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*_with_${library}.c)
    set(sources ${sources} ${shim})
  endif()
  # gfortran 12 takes every submodule for a use without only; what does without a library has arguments to spare.
  set_source_files_properties(${chosen} PROPERTIES COMPILE_OPTIONS "-Wno-use-without-only;-Wno-unused-dummy-argument")
  set(sources ${sources} ${chosen} PARENT_SCOPE)
endfunction()

# on_demand(<name> <library>): write down where a library is that the program opens when it needs it (src/base/system/library.f90). The
# name of what runs is the library's own (its soname), not that of the link which compilers follow. A static library
# becomes a part of the program, as a whole, and its procedures are found there.
function(on_demand name library)
  set(${name}_FILE "" PARENT_SCOPE)
  if(library MATCHES "\\.a$")
    set(splitgrain_libraries ${splitgrain_libraries} "$<LINK_LIBRARY:WHOLE_ARCHIVE,${library}>" PARENT_SCOPE)
    set(splitgrain_exports ON PARENT_SCOPE)
    return()
  endif()
  file(REAL_PATH ${library} file)
  execute_process(COMMAND ${CMAKE_OBJDUMP} -p ${file} OUTPUT_VARIABLE header ERROR_QUIET)
  if(header MATCHES "SONAME +([^ \n]+)")
    cmake_path(GET library PARENT_PATH folder)
    set(file ${folder}/${CMAKE_MATCH_1})
  endif()
  # As in version.cmake: a path may be longer than a line of Fortran, and hold an apostrophe.
  string(REPLACE "'" "''" file "${file}")
  string(REPLACE "/" "/'// &\n    '" file "${file}")
  set(${name}_FILE "${file}" PARENT_SCOPE)
endfunction()

foreach(name METIS FFTW UMFPACK CHOLMOD QHULL LAPACK)
  set(${name}_FILE "not in this build")
endforeach()

if(SPLITGRAIN_MPI)
  find_package(MPI REQUIRED COMPONENTS Fortran)
  list(APPEND splitgrain_libraries MPI::MPI_Fortran)
endif()
choose(mpi "${SPLITGRAIN_MPI}")

if(SPLITGRAIN_HDF5)
  # HDF5's own compiler knows where it is. FindHDF5 asks it too, but fails where the path of the project has blanks.
  if(SPLITGRAIN_MPI)
    find_program(HDF5_COMPILER NAMES h5pfc h5fc REQUIRED)
  else()
    find_program(HDF5_COMPILER NAMES h5fc h5pfc REQUIRED)
  endif()
  execute_process(COMMAND ${HDF5_COMPILER} -shlib -show OUTPUT_VARIABLE hdf5_line COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(hdf5_words UNIX_COMMAND "${hdf5_line}")
  set(hdf5_includes ${hdf5_words})
  list(FILTER hdf5_includes INCLUDE REGEX "^-I")
  list(TRANSFORM hdf5_includes REPLACE "^-I" "")
  list(FILTER hdf5_words INCLUDE REGEX "^-L|^-l|^-Wl,|\\.(a|so)$")
  add_library(splitgrain_hdf5 INTERFACE)
  target_include_directories(splitgrain_hdf5 SYSTEM INTERFACE ${hdf5_includes})
  target_link_libraries(splitgrain_hdf5 INTERFACE ${hdf5_words})
  list(APPEND splitgrain_libraries splitgrain_hdf5)
  # Ranks share files where HDF5 was made for MPI, which its settings tell.
  set(hdf5_shares OFF)
  find_file(HDF5_SETTINGS H5pubconf.h HINTS ${hdf5_includes} NO_CACHE)
  if(SPLITGRAIN_MPI AND HDF5_SETTINGS)
    file(STRINGS ${HDF5_SETTINGS} hdf5_shares_line REGEX "^#define H5_HAVE_PARALLEL 1")
    if(hdf5_shares_line)
      set(hdf5_shares ON)
    else()
      message(STATUS "This HDF5 was not made for MPI: runs on several ranks will write no pictures and restart files")
    endif()
  endif()
  choose(mpio "${hdf5_shares}")
endif()
choose(hdf5 "${SPLITGRAIN_HDF5}")

if(SPLITGRAIN_METIS)
  find_library(METIS_LIBRARY metis REQUIRED)
  find_file(METIS_HEADER metis.h REQUIRED)
  file(STRINGS ${METIS_HEADER} metis_wide REGEX "^#define IDXTYPEWIDTH +64")
  if(metis_wide)
    message(FATAL_ERROR "${METIS_HEADER}: this METIS counts with 64 bits; SplitGrain needs one of 32, as Debian's")
  endif()
  on_demand(METIS ${METIS_LIBRARY})
endif()
choose(metis "${SPLITGRAIN_METIS}")

if(SPLITGRAIN_FFTW)
  find_library(FFTW_LIBRARY fftw3 REQUIRED)
  on_demand(FFTW ${FFTW_LIBRARY})
endif()
choose(fftw "${SPLITGRAIN_FFTW}")

if(SPLITGRAIN_SUITESPARSE)
  find_library(UMFPACK_LIBRARY umfpack REQUIRED)
  find_file(UMFPACK_HEADER umfpack.h PATH_SUFFIXES suitesparse REQUIRED)
  on_demand(UMFPACK ${UMFPACK_LIBRARY})
  find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
  find_path(CHOLMOD_HEADERS cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
  on_demand(CHOLMOD ${CHOLMOD_LIBRARY})
  set_source_files_properties(${PROJECT_SOURCE_DIR}/src/numerics/cholmod_with_suitesparse.c
                              PROPERTIES INCLUDE_DIRECTORIES ${CHOLMOD_HEADERS})
endif()
choose(suitesparse "${SPLITGRAIN_SUITESPARSE}")

if(SPLITGRAIN_QHULL)
  find_library(QHULL_LIBRARY qhull_r REQUIRED)
  find_file(QHULL_HEADER libqhull_r/qhull_ra.h REQUIRED)
  on_demand(QHULL ${QHULL_LIBRARY})
endif()
choose(qhull "${SPLITGRAIN_QHULL}")

if(SPLITGRAIN_LAPACK)
  find_library(LAPACK_LIBRARY lapack REQUIRED)
  on_demand(LAPACK ${LAPACK_LIBRARY})
endif()
choose(lapack "${SPLITGRAIN_LAPACK}")

if(SPLITGRAIN_OPENMP)
  # Files with directives of OpenMP: all others are compiled as without it.
  find_package(OpenMP REQUIRED COMPONENTS Fortran)
  separate_arguments(openmp_flags UNIX_COMMAND "${OpenMP_Fortran_FLAGS}")
  set(threaded base/system/threads detection/plane/placed_corners detection/touch_pieces
               problem/assemble_by_gaps problem/problem_bodies problem/status_by_gaps run/motion run/simulate
               solvers/sweeps/order_errors
               solvers/sweeps/sweep_order solvers/sweeps/sweeps)
  list(TRANSFORM threaded REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/src/\\1.f90")
  list(APPEND splitgrain_libraries ${OpenMP_Fortran_LIBRARIES})
endif()

configure_file(${PROJECT_SOURCE_DIR}/cmake/library_files.f90.in ${PROJECT_BINARY_DIR}/generated/library_files.f90 @ONLY)
list(APPEND splitgrain_libraries ${CMAKE_DL_LIBS})

find_package(tomlplusplus REQUIRED)
list(APPEND splitgrain_libraries tomlplusplus::tomlplusplus stdc++)
