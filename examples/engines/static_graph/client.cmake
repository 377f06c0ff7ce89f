# SPDX-License-Identifier: MIT
# What the project of an engine with static graphs includes: the library's side of their comparison, compiled once, and the
# client with the tests of its adapter.
set(GENRENDER_COMPONENTS scene reference CACHE STRING "")
add_subdirectory(${CMAKE_CURRENT_LIST_DIR}/../../.. genrender)
set(engine_comparison_source ${CMAKE_CURRENT_LIST_DIR}/comparison.cpp)
include(${CMAKE_CURRENT_LIST_DIR}/../client.cmake)

# The program client_<engine> of <engine>.cpp, which prints a row of the table, and its tests. The last two are the adapter
# and the engine's own target.
function(genrender_graph_client engine adapter target)
    add_executable(client_${engine} ${engine}.cpp)
    target_link_libraries(client_${engine} PRIVATE engine_comparison ${adapter} ${target})
    add_test(NAME "${engine} client" COMMAND client_${engine})

    find_package(doctest CONFIG)
    if(doctest_FOUND)
        set(tests ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../../tests)
        add_executable(adapter_tests ${tests}/main.cpp ${tests}/adapters/${engine}.test.cpp
            ${tests}/adapters/${engine}_memory.test.cpp ${tests}/adapters/${engine}_site.test.cpp)
        target_include_directories(adapter_tests PRIVATE ${tests})
        target_link_libraries(adapter_tests PRIVATE ${adapter} ${target} doctest::doctest engine_flags)
        set_target_properties(adapter_tests PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
        add_test(NAME "${engine} adapter" COMMAND adapter_tests)
        set_tests_properties("${engine} adapter" PROPERTIES FAIL_REGULAR_EXPRESSION "test cases: +0 ")
    endif()
endfunction()
