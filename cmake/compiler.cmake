# Flags of every Fortran file; those of build types are in default_flags.cmake. Never -ffast-math: it removes the NaN tests that
# the program relies on.
# gfortran 12 takes array descriptors for uninitialized where arrays are allocated on assignment, so that warning is off;
# debug builds start all reals as signalling NaNs instead.
# An inquiry beside .and. may well be left out, so -Wno-function-elimination.
add_library(splitgrain_flags INTERFACE)
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  target_compile_options(splitgrain_flags INTERFACE
    $<$<COMPILE_LANGUAGE:Fortran>:-std=f2008 -pedantic -fimplicit-none -Wall -Wextra -Wimplicit-interface
      -Wuse-without-only -Wconversion-extra -Wno-maybe-uninitialized -Wno-function-elimination -Wno-uninitialized>)
else()
  message(WARNING "${CMAKE_Fortran_COMPILER_ID} is not tested: only its default flags are used")
endif()
if(SPLITGRAIN_WERROR)
  target_compile_options(splitgrain_flags INTERFACE $<$<COMPILE_LANGUAGE:Fortran>:-Werror>)
endif()
if(SPLITGRAIN_NATIVE)
  target_compile_options(splitgrain_flags INTERFACE -march=native)
endif()
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  # Procedures that threads run side by side, or coroutines in turns, look like recursive ones to this check.
  target_compile_options(splitgrain_flags INTERFACE $<$<AND:$<COMPILE_LANGUAGE:Fortran>,$<CONFIG:Debug>>:-fcheck=no-recursion>)
endif()
# Reports of sanitizers name lines: where variables lie would take a third of the time that files compile.
if(SPLITGRAIN_SANITIZE)
  target_compile_options(splitgrain_flags INTERFACE -fsanitize=${SPLITGRAIN_SANITIZE} -fno-sanitize-recover=all
    -fno-omit-frame-pointer -g1)
  target_link_options(splitgrain_flags INTERFACE -fsanitize=${SPLITGRAIN_SANITIZE})
endif()
