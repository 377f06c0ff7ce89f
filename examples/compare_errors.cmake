# SPDX-License-Identifier: MIT
# Expects the correspondence error between neighbouring frames in the report LOWER below that in the report HIGHER.
# Run: cmake -D LOWER=report.json -D HIGHER=report.json -P compare_errors.cmake
foreach(which IN ITEMS LOWER HIGHER)
    file(READ ${${which}} report)
    string(JSON ${which}_error GET ${report} correspondence_error 1)
endforeach()
message("correspondence error ${LOWER_error} against ${HIGHER_error}")
if(NOT LOWER_error LESS HIGHER_error)
    message(FATAL_ERROR "the first is not lower")
endif()
