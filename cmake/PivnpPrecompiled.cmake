# Headers that most sources include, compiled once for targets that share flags: a third of a cold build is spared. No source
# needs them: with -DPIVNP_PRECOMPILE=OFF everything compiles by its own includes.
option(PIVNP_PRECOMPILE "Compile common headers once" ON)

set(pivnp_common_headers
    <algorithm> <array> <cmath> <cstdint> <cstdio> <cstring> <filesystem> <fstream> <functional> <limits> <map> <memory>
    <numbers> <numeric> <optional> <set> <span> <sstream> <stdexcept> <string> <string_view> <unordered_map> <utility>
    <variant> <vector> <Eigen/Core> <Eigen/LU>)

# pivnp_precompile(TARGET [AS OTHER] [HEADERS <a.hpp> ...]): the common headers and those named; or those of a target whose flags
# are the same. Kernels that Highway compiles once an instruction set are left out: nothing but Highway may be
# in sight where they are compiled for more than the baseline.
function(pivnp_precompile target)
  if(NOT PIVNP_PRECOMPILE)
    return()
  endif()
  cmake_parse_arguments(ARG "" "AS" "HEADERS" ${ARGN})
  if(ARG_AS)
    target_precompile_headers(${target} REUSE_FROM ${ARG_AS})
  else()
    target_precompile_headers(${target} PRIVATE ${pivnp_common_headers} ${ARG_HEADERS})
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    file(REAL_PATH ${source} path BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    file(STRINGS ${path} dispatched REGEX "hwy/foreach_target.h" LIMIT_COUNT 1)
    if(dispatched)
      set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()
