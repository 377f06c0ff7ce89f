# SPDX-License-Identifier: MIT
# A plan says what a run will hold and how long it will take. Run: cmake -D PROGRAM=... -D PIPELINE=... -D FOLDER=... -P plan.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${PROGRAM} --plan --pipeline ${PIPELINE} --scene camera_rotation --frames 3 --steps 2 --out ${FOLDER}
    OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
file(READ ${FOLDER}/plan.json plan)
foreach(figure IN ITEMS denoiser_seconds weights_bytes denoised_frames)
    string(JSON value GET "${plan}" ${figure})
    if(NOT value GREATER 0)
        message(FATAL_ERROR "plan.json: ${figure} is ${value}, expected a number above 0")
    endif()
endforeach()
string(FIND "${output}" "denoiser, minutes, about" position)
if(position EQUAL -1)
    message(FATAL_ERROR "the plan does not say how long the denoiser takes:\n${output}")
endif()
