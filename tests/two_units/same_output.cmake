# SPDX-License-Identifier: MIT
# Two programs print the same, and something. Run: cmake -D FIRST=... -D SECOND=... -P same_output.cmake
execute_process(COMMAND ${FIRST} OUTPUT_VARIABLE first COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${SECOND} OUTPUT_VARIABLE second COMMAND_ERROR_IS_FATAL ANY)
string(LENGTH "${first}" length)
if(NOT first STREQUAL second OR length LESS 100)
    message(FATAL_ERROR "${FIRST} and ${SECOND} print different latents, or none")
endif()
