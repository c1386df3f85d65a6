# Flags of every Fortran file. Never -ffast-math: it removes the NaN tests that the program relies on.
# gfortran 12 takes array descriptors for uninitialized where arrays are allocated on assignment, so that warning is off;
# debug builds start all reals as signalling NaNs instead.
# An inquiry beside .and. may well be left out, so -Wno-function-elimination.
add_library(splitgrain_flags INTERFACE)
target_compile_options(splitgrain_flags INTERFACE
  $<$<COMPILE_LANGUAGE:Fortran>:-std=f2008 -pedantic -fimplicit-none -Wall -Wextra -Wimplicit-interface
    -Wuse-without-only -Wconversion-extra -Wno-maybe-uninitialized -Wno-function-elimination -Wno-uninitialized>)
if(SPLITGRAIN_WERROR)
  target_compile_options(splitgrain_flags INTERFACE $<$<COMPILE_LANGUAGE:Fortran>:-Werror>)
endif()
if(SPLITGRAIN_NATIVE)
  target_compile_options(splitgrain_flags INTERFACE -march=native)
endif()
set(CMAKE_Fortran_FLAGS_RELEASE "-O3")
set(CMAKE_Fortran_FLAGS_DEBUG "-Og -g -fbacktrace -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow -finit-real=snan -finit-derived")
if(SPLITGRAIN_OPENMP)
  # Procedures that threads run side by side look like recursive ones to this check.
  string(APPEND CMAKE_Fortran_FLAGS_DEBUG " -fcheck=no-recursion")
endif()
if(SPLITGRAIN_SANITIZE)
  target_compile_options(splitgrain_flags INTERFACE -fsanitize=${SPLITGRAIN_SANITIZE} -fno-sanitize-recover=all
    -fno-omit-frame-pointer -g)
  target_link_options(splitgrain_flags INTERFACE -fsanitize=${SPLITGRAIN_SANITIZE})
endif()
