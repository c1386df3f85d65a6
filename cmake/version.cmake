# Version, commit, compiler and flags, as a Fortran module made anew when the commit changes.
execute_process(COMMAND git describe --always --dirty --abbrev=10 WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                OUTPUT_VARIABLE splitgrain_commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT splitgrain_commit)
  set(splitgrain_commit "unknown")
endif()
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
set(splitgrain_flags_text "${CMAKE_Fortran_FLAGS_${build_type}}")
if(SPLITGRAIN_NATIVE)
  string(APPEND splitgrain_flags_text " -march=native")
endif()
if(SPLITGRAIN_SANITIZE)
  string(APPEND splitgrain_flags_text " -fsanitize=${SPLITGRAIN_SANITIZE}")
endif()
# One flag a line: together they are longer than a line of Fortran may be.
string(REPLACE " " " '// &\n    '" splitgrain_flags_text "${splitgrain_flags_text}")
# A path may be longer than a line of Fortran, and hold an apostrophe.
string(REPLACE "'" "''" splitgrain_source_text "${PROJECT_SOURCE_DIR}")
string(REPLACE "/" "/'// &\n    '" splitgrain_source_text "${splitgrain_source_text}")
if(EXISTS ${PROJECT_SOURCE_DIR}/.git/logs/HEAD)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/.git/logs/HEAD)
endif()
configure_file(${PROJECT_SOURCE_DIR}/cmake/version.f90.in ${PROJECT_BINARY_DIR}/generated/version.f90 @ONLY)
