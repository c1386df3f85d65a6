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
  set(HDF5_PREFER_PARALLEL ON)
endif()
choose(mpi "${SPLITGRAIN_MPI}")

if(SPLITGRAIN_HDF5)
  find_package(HDF5 REQUIRED COMPONENTS Fortran)
  add_library(splitgrain_hdf5 INTERFACE)
  target_include_directories(splitgrain_hdf5 SYSTEM INTERFACE ${HDF5_Fortran_INCLUDE_DIRS})
  target_link_libraries(splitgrain_hdf5 INTERFACE ${HDF5_Fortran_LIBRARIES})
  list(APPEND splitgrain_libraries splitgrain_hdf5)
endif()
choose(hdf5 "${SPLITGRAIN_HDF5}")

find_package(tomlplusplus REQUIRED)
list(APPEND splitgrain_libraries tomlplusplus::tomlplusplus stdc++)
