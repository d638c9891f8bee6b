# Headers that most sources include, compiled once for all targets that share flags, which helps where sources are compiled one by
# one (PIVNP_UNITY off). No source needs them: with -DPIVNP_PRECOMPILE=OFF everything compiles by its own includes.
option(PIVNP_PRECOMPILE "Compile common headers once" ON)

set(pivnp_common_headers
    <algorithm> <array> <cmath> <cstdint> <cstdio> <cstring> <filesystem> <fstream> <functional> <limits> <map> <memory>
    <numbers> <numeric> <optional> <set> <span> <sstream> <stdexcept> <string> <string_view> <unordered_map> <utility>
    <variant> <vector> <Eigen/Core> <Eigen/LU>)

# pivnp_precompile(TARGET [HEADERS <a.hpp> ...]): the common headers, compiled once for all targets with the same headers beside
# them and the same of those libraries that change how everything is compiled. Kernels are left out: nothing but Highway may be
# in sight where they are compiled for more than the baseline.
function(pivnp_precompile target)
  if(NOT PIVNP_PRECOMPILE OR PIVNP_UNITY)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "HEADERS" ${ARGN})
  get_target_property(linked ${target} LINK_LIBRARIES)
  set(shared Eigen3::Eigen)
  foreach(library OpenMP::OpenMP_CXX CGAL::CGAL Qt6::Gui Qt6::Widgets Qt6::PrintSupport QCustomPlotQt6::QCustomPlotQt6 CLI11::CLI11
                  GTest::gmock)
    if(library IN_LIST linked)
      list(APPEND shared ${library})
    endif()
  endforeach()
  get_target_property(independent ${target} POSITION_INDEPENDENT_CODE)
  string(MD5 key "${shared} ${ARG_HEADERS} ${independent}")
  string(SUBSTRING ${key} 0 6 key)
  set(owner pivnp_headers_${key})
  if(NOT TARGET ${owner})
    set(source ${CMAKE_BINARY_DIR}/headers.cpp)
    if(NOT EXISTS ${source})
      file(WRITE ${source} "")
    endif()
    add_library(${owner} OBJECT ${source})
    target_link_libraries(${owner} PRIVATE pivnp_flags ${shared})
    if(independent)
      pivnp_position_independent(${owner})
    endif()
    target_precompile_headers(${owner} PRIVATE ${pivnp_common_headers} ${ARG_HEADERS})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${owner})
  pivnp_dispatched_sources(${target} dispatched)
  if(dispatched)
    set_source_files_properties(${dispatched} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  endif()
endfunction()
