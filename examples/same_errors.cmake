# SPDX-License-Identifier: MIT
# Two runs have the same correspondence errors, to four digits. Run: cmake -D ONE=<report.json> -D OTHER=<report.json> -P same_errors.cmake
cmake_minimum_required(VERSION 3.25)
foreach(run IN ITEMS ONE OTHER)
    file(READ ${${run}} report)
    string(JSON error GET "${report}" correspondence_error 1)
    string(SUBSTRING "${error}" 0 6 ${run}_error)
endforeach()
if(NOT ONE_error STREQUAL OTHER_error OR NOT ONE_error GREATER 0)
    message(FATAL_ERROR "${ONE} has an error of ${ONE_error}, ${OTHER} of ${OTHER_error}, expected the same, above 0")
endif()
