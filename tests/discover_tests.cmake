# SPDX-License-Identifier: MIT
# Writes TESTS_FILE: one add_test for every doctest case of EXECUTABLE, named `<suite> <test case>` and
# labelled with the suite's room. Run with cmake -P.
# (doctest's own discovery knows no suites, and splits its list at brackets that do not match, as in [0, 1).)
execute_process(COMMAND ${EXECUTABLE} --list-test-cases --reporters=xml
    OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)

set(commands "")
while(listing MATCHES "<TestCase name=\"([^\"]*)\"( testsuite=\"([^\"]*)\")?")
    set(name "${CMAKE_MATCH_1}")
    set(suite "${CMAKE_MATCH_3}")
    string(FIND "${listing}" "${CMAKE_MATCH_0}" position)
    string(LENGTH "${CMAKE_MATCH_0}" length)
    math(EXPR position "${position} + ${length}")
    string(SUBSTRING "${listing}" ${position} -1 listing)

    foreach(text IN ITEMS name suite)
        string(REPLACE "&lt;" "<" ${text} "${${text}}")
        string(REPLACE "&gt;" ">" ${text} "${${text}}")
        string(REPLACE "&quot;" "\"" ${text} "${${text}}")
        string(REPLACE "&apos;" "'" ${text} "${${text}}")
        string(REPLACE "&amp;" "&" ${text} "${${text}}")
    endforeach()
    if(NOT suite MATCHES "^([a-z_]+)/")
        message(FATAL_ERROR "${EXECUTABLE}: '${name}' is in no TEST_SUITE(\"<room>/<header>\")")
    endif()
    set(room ${CMAKE_MATCH_1})

    # A comma would end the filter.
    string(REPLACE "," "\\," filter "${name}")
    string(APPEND commands
        "add_test([==[${suite} ${name}]==] [==[${EXECUTABLE}]==] [==[--test-suite=${suite}]==] [==[--test-case=${filter}]==])\n"
        # doctest is content when its filter matches nothing; we are not.
        "set_tests_properties([==[${suite} ${name}]==] PROPERTIES LABELS ${room} FAIL_REGULAR_EXPRESSION \"test cases: +0 \")\n")
endwhile()
if(commands STREQUAL "")
    message(FATAL_ERROR "${EXECUTABLE}: no test case")
endif()
file(WRITE ${TESTS_FILE} "${commands}")
