# Flags with which the cache of a new build folder begins, by build type; what a user gives stays as it is.
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-O3")
  set(CMAKE_Fortran_FLAGS_DEBUG_INIT
      "-Og -g -fbacktrace -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow -finit-real=snan -finit-derived")
endif()
