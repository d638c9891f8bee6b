# How every target of the project is made: one library a folder, one test program a tested folder.

option(PIVNP_WERROR "Warnings are errors" OFF)
option(PIVNP_SANITIZE "Build with the address and undefined-behaviour sanitizers" OFF)
option(PIVNP_SPLIT_TESTS "Leave out those tests that the other preset runs (scripts/test builds both)" OFF)
option(PIVNP_UNITY "Compile a target's sources several at a time: half the time from scratch, more after an edit" OFF)

add_library(pivnp_flags INTERFACE)
target_include_directories(pivnp_flags INTERFACE ${CMAKE_SOURCE_DIR})
# No contraction: results must not depend on whether the compiler found a fused multiply-add.
target_compile_options(pivnp_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -ffp-contract=off
                       # GCC 12 sees false overlaps, overflows and uninitialised parts in std::string (its bugs 105329, 105651, 105562).
                       -Wno-restrict -Wno-stringop-overflow -Wno-maybe-uninitialized)
# Vector kernels are compiled for AVX-512, AVX2 and the baseline; SSSE3 and SSE4 are no faster than what the kernels make of that
# (docs/theory/mpm_speed.md). Sanitizers take minutes over each set: eight lanes and four in pairs of vectors are enough to look at.
set(pivnp_unused_targets "HWY_SSSE3|HWY_SSE4")
if(PIVNP_SANITIZE)
  string(APPEND pivnp_unused_targets "|HWY_AVX2")
endif()
target_compile_definitions(pivnp_flags INTERFACE "HWY_DISABLED_TARGETS=(${pivnp_unused_targets})")
if(PIVNP_UNITY)  # a source sees what the ones before it keep to themselves
  target_compile_options(pivnp_flags INTERFACE -Wno-subobject-linkage)
endif()
add_library(pivnp_test_flags INTERFACE)
if(PIVNP_UNITY)
  target_compile_options(pivnp_test_flags INTERFACE -Wno-shadow)
endif()
# What tests judge is in the libraries. Their own sources take half of a build's time, and a third less of it like this.
if(PIVNP_SANITIZE)
  target_compile_options(pivnp_test_flags INTERFACE -fno-sanitize=undefined)
else()
  target_compile_options(pivnp_test_flags INTERFACE $<$<CONFIG:Release>:-O1>)
endif()
if(PIVNP_WERROR)
  target_compile_options(pivnp_flags INTERFACE -Werror)
endif()
if(PIVNP_SANITIZE)
  # What is left out takes a third of the time. Null pointers, overruns and pointers out of range are met by the address sanitizer
  # as well, and any x86-64 reads what is not aligned, but for vectors, which trap by themselves.
  target_compile_options(pivnp_flags INTERFACE -fsanitize=address,undefined
                                               -fno-sanitize=null,object-size,vptr,alignment,pointer-overflow
                                               -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(pivnp_flags INTERFACE -fsanitize=address,undefined)
endif()

# Those sources of a target that Highway compiles once an instruction set.
function(pivnp_dispatched_sources target out)
  get_target_property(sources ${target} SOURCES)
  set(found)
  foreach(source IN LISTS sources)
    file(REAL_PATH ${source} path BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    if(EXISTS ${path})
      file(STRINGS ${path} line REGEX "hwy/foreach_target.h" LIMIT_COUNT 1)
      if(line)
        list(APPEND found ${source})
      endif()
    endif()
  endforeach()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# pivnp_compile_together(TARGET BATCH [a.cpp ...])
# With PIVNP_UNITY: so many sources of a target at a time, but for those that Highway compiles and those named.
function(pivnp_compile_together target batch)
  if(NOT PIVNP_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
  pivnp_dispatched_sources(${target} dispatched)
  set(alone ${dispatched} ${ARGN})
  if(alone)
    set_source_files_properties(${alone} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endfunction()

# For libraries, so that shared ones can be made of them (python/). Their own functions are called, and inlined, as those of the
# program are: nobody may put others in their place.
function(pivnp_position_independent target)
  if(NOT PIVNP_SANITIZE)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${target} PRIVATE -fno-semantic-interposition)
  endif()
endfunction()

# pivnp_library(NAME SOURCES a.cpp ... [PUBLIC lib ...] [PRIVATE lib ...] [HEADERS <a.hpp> ...])
# HEADERS: what its sources include and is worth compiling once for them.
function(pivnp_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE;HEADERS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  pivnp_position_independent(${name})
  target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:pivnp_flags> ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  pivnp_compile_together(${name} 24)
  pivnp_precompile(${name} HEADERS ${ARG_HEADERS})
  pivnp_dispatched_sources(${name} dispatched)
  if(PIVNP_SANITIZE AND dispatched)
    # Three quarters of the time that their compilation takes; bounds and overflow are still looked at.
    set_source_files_properties(${dispatched} PROPERTIES COMPILE_OPTIONS
      "-fno-sanitize-address-use-after-scope")
  endif()
endfunction()

# pivnp_runs_here(WHERE release|sanitized OUT): whether tests belong into this build. By itself a build has all of them. Where
# scripts/test makes both presets, what takes minutes to compile and to run twice runs where it finds more.
function(pivnp_runs_here where out)
  set(here YES)
  if(PIVNP_SPLIT_TESTS)
    if((PIVNP_SANITIZE AND where STREQUAL release) OR (NOT PIVNP_SANITIZE AND where STREQUAL sanitized))
      set(here NO)
    endif()
  endif()
  set(${out} ${here} PARENT_SCOPE)
endfunction()

# pivnp_test(NAME LABEL quick|full SOURCES a.cpp ... LINK lib ... [TIMEOUT seconds] [ALONE a.cpp ...] [SLOW Suite.Test ...])
# ALONE: sources that have names in common with others.
# SLOW: tests of figures that take 10 s and more under sanitizers. Where scripts/test makes both presets the release alone runs them.
# Of a full program, tests of suites that are called ...Small are quick: a coarse form of what the others verify, so that
# the gate sees it.
function(pivnp_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;LINK;ALONE;SLOW" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE pivnp_flags ${ARG_LINK} GTest::gtest_main GTest::gmock pivnp_test_flags)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  pivnp_compile_together(${name} 12 ${ARG_ALONE})
  pivnp_precompile(${name} HEADERS <gmock/gmock.h> <gtest/gtest.h>)
  if(ARG_LABEL STREQUAL full)
    gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60 TEST_FILTER "*Small.*"
                         TEST_LIST ${name}_small PROPERTIES LABELS quick TIMEOUT 300)
    set(but TEST_FILTER "-*Small.*")
  endif()
  pivnp_runs_here(release slow_here)
  if(ARG_SLOW AND NOT slow_here)
    list(JOIN ARG_SLOW ":" slow)
    set(but TEST_FILTER "-${slow}")
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60 ${but}
                       PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
