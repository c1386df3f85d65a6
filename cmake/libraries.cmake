# Optional libraries: each either brings its *_with_<library>.f90 files or leaves their *_without_ twins.
set(splitgrain_libraries "")

# choose(<library> <is on>): add the files of a library, or those that do without it.
function(choose library is_on)
  if(is_on)
    file(GLOB_RECURSE chosen CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*_with_${library}.f90)
  else()
    file(GLOB_RECURSE chosen CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*_without_${library}.f90)
  endif()
  # gfortran 12 takes every submodule for a use without only; what does without a library has arguments to spare.
  set_source_files_properties(${chosen} PROPERTIES COMPILE_OPTIONS "-Wno-use-without-only;-Wno-unused-dummy-argument")
  set(sources ${sources} ${chosen} PARENT_SCOPE)
endfunction()

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
endif()
choose(hdf5 "${SPLITGRAIN_HDF5}")

find_package(tomlplusplus REQUIRED)
list(APPEND splitgrain_libraries tomlplusplus::tomlplusplus stdc++)
