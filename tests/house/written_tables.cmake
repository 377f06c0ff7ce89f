# SPDX-License-Identifier: MIT
# Proves cmake/write_tables.cmake on a page and two files of tables. Run: cmake -D FOLDER=<scratch folder> -P written_tables.cmake
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${FOLDER})
file(WRITE ${FOLDER}/build/a.md "# Head\n\n| x | y |\n|---|---|\n| 0 | 0 |\n\nBetween.\n\n| x | z |\n|---|---|\n| 1; [2 | a \\* |\n| 3 | ± |")
file(WRITE ${FOLDER}/build/b.md "| s | x | z |\n|---|---|---|\n| one | 5 | 6 |\n| two | 7 | 8 |\n| two | 9 | 10 |\n")
set(page "# Page [1; 2\n\n<!-- table build/a.md -->\n| x | z |\n|---|---|\n@a@\n\nText.\n\n\
<!-- table build/b.md of two -->\n| x | z |\n|---|---|\n@b@\n\n<!-- table build/missing.md -->\n| x |\n|---|\n| kept |\n\n| x | z |\n|---|---|\n| kept |\n")
set(a "| old |")
set(b "| old |\n| older |")
string(CONFIGURE "${page}" before @ONLY)
set(a "| 1; [2 | a \\* |\n| 3 | ± |")
set(b "| 7 | 8 |\n| 9 | 10 |")
string(CONFIGURE "${page}" expected @ONLY)

function(write_tables expected_code)
    execute_process(COMMAND ${CMAKE_COMMAND} -D ROOT=${FOLDER} -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../cmake/write_tables.cmake
        RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
    if(NOT code EQUAL expected_code OR (ARGC GREATER 1 AND NOT said MATCHES "${ARGV1}"))
        message(FATAL_ERROR "ended with ${code}: ${said}")
    endif()
endfunction()

# Twice, since what is written stays when nothing is new.
foreach(time IN ITEMS 1 2)
    if(time EQUAL 1)
        file(WRITE ${FOLDER}/docs/page.md "${before}")
    endif()
    write_tables(0)
    file(READ ${FOLDER}/docs/page.md found)
    if(NOT found STREQUAL expected)
        message(FATAL_ERROR "expected\n${expected}\nfound\n${found}")
    endif()
endforeach()

# A table that is not there any more is said, and nothing is lost.
file(WRITE ${FOLDER}/build/a.md "| other |\n|---|\n")
write_tables(1 "docs/page.md: build/a.md has no table that begins | x | z |")
file(WRITE ${FOLDER}/build/a.md "| x | z |\n|---|---|\n| 1 | 2 |\n\n- Only rows that match 'x' were measured.\n")
write_tables(1 "docs/page.md: build/a.md is of some benchmarks, expected all")
file(READ ${FOLDER}/docs/page.md found)
if(NOT found STREQUAL expected)
    message(FATAL_ERROR "expected\n${expected}\nfound\n${found}")
endif()
