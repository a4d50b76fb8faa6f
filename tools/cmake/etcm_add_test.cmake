# etcm_add_test(NAME SOURCES file... [LIBRARIES target...] [TIMEOUT seconds] [LABELS label...]
#               [COMPUTES])
#
# One GoogleTest program; each of its cases becomes a test named "<folder>/<suite>.<case>". Under an
# emulator or sanitizers, where a program takes longer to start than most cases do, its cases are
# dealt out to a few tests named "<folder>/<program>.<part>" instead.
# A source of its own with main() is welcome: it takes precedence over GoogleTest's.
# TIMEOUT is per case; without it a case has 60 seconds. An emulator gets ten times that, a build under
# sanitizers three times.
# COMPUTES: the test itself works hard, as an oracle does, and is optimised as the build is. Others
# are not: what they call is, and their own code is mostly GoogleTest's, which takes long to optimise.
include(GoogleTest)

function(etcm_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "COMPUTES" "TIMEOUT" "SOURCES;LIBRARIES;LABELS")
  if(NOT arg_SOURCES OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "etcm_add_test(${name}): give SOURCES; not understood: "
                        "'${arg_UNPARSED_ARGUMENTS}'")
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 60)
  endif()
  if(CMAKE_CROSSCOMPILING_EMULATOR)
    math(EXPR arg_TIMEOUT "10 * ${arg_TIMEOUT}")
  elseif(ETCM_SANITIZED)
    math(EXPR arg_TIMEOUT "3 * ${arg_TIMEOUT}")
  endif()
  get_filename_component(folder "${CMAKE_CURRENT_SOURCE_DIR}" NAME)
  if(NOT arg_LABELS)
    set(arg_LABELS ${folder})
  endif()

  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} GTest::gmock_main etcm_warnings)
  if(NOT arg_COMPUTES)
    # Nor looked at for undefined behaviour, which takes as long again.
    target_compile_options(${name} PRIVATE -O0 -fno-sanitize=undefined)
  endif()
  if(CMAKE_CROSSCOMPILING_EMULATOR)
    target_compile_definitions(${name} PRIVATE ETCM_EMULATED)
  endif()
  # bin/ is for programs a user would run.
  set_target_properties(${name} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests/bin"
    # GoogleTest's headers take longer to compile than most tests.
    UNITY_BUILD ON
  )
  if(CMAKE_CROSSCOMPILING_EMULATOR OR ETCM_SANITIZED)
    # Of the longest program each part runs for a minute or two.
    set(parts 4)
    math(EXPR last_part "${parts} - 1")
    math(EXPR arg_TIMEOUT "4 * ${arg_TIMEOUT}")
    foreach(part RANGE ${last_part})
      add_test(NAME "${folder}/${name}.${part}" COMMAND ${name})
      set_tests_properties("${folder}/${name}.${part}" PROPERTIES
        ENVIRONMENT "GTEST_TOTAL_SHARDS=${parts};GTEST_SHARD_INDEX=${part}"
        TIMEOUT ${arg_TIMEOUT}
        LABELS "${arg_LABELS}"
      )
    endforeach()
    return()
  endif()
  # PRE_TEST: the program is not run while it is built.
  gtest_discover_tests(${name}
    TEST_PREFIX "${folder}/"
    NO_PRETTY_VALUES
    DISCOVERY_MODE PRE_TEST
    DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}"
  )
endfunction()
