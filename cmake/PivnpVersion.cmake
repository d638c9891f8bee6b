# The library that knows what was built (pivnp/core/version.hpp): version, commit and the libraries it was built with.

# Notes a library that results depend on, where it is found.
function(pivnp_built_with name version)
  set_property(GLOBAL APPEND PROPERTY pivnp_built_with "${name} ${version}")
endfunction()

# The commit is asked for at every build; its source changes, and is compiled, only with the commit.
function(pivnp_version_library)
  set(folder ${CMAKE_BINARY_DIR}/version)
  execute_process(COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_SOURCE_DIR} -DOUT=${folder}/commit.cpp
                          -P ${CMAKE_SOURCE_DIR}/cmake/commit.cmake)
  add_custom_target(pivnp_commit
    COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_SOURCE_DIR} -DOUT=${folder}/commit.cpp
            -P ${CMAKE_SOURCE_DIR}/cmake/commit.cmake
    BYPRODUCTS ${folder}/commit.cpp
    VERBATIM)
  pivnp_library(pivnp_version SOURCES ${folder}/version.cpp ${folder}/commit.cpp)
  add_dependencies(pivnp_version pivnp_commit)
  # Written when all folders have noted their libraries.
  cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL pivnp_write_version)
endfunction()

function(pivnp_write_version)
  get_property(libraries GLOBAL PROPERTY pivnp_built_with)
  list(REMOVE_DUPLICATES libraries)
  list(SORT libraries CASE INSENSITIVE)
  list(JOIN libraries ", " libraries)
  configure_file(${CMAKE_SOURCE_DIR}/pivnp/core/version.cpp.in ${CMAKE_BINARY_DIR}/version/version.cpp @ONLY)
endfunction()
