# SPDX-License-Identifier: MIT
# Frames of any size, from maps of any size, in any format. Run: cmake -D PROGRAM=... -D MAPS_PROGRAM=... -D FOLDER=... -P sizes.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${FOLDER})

# Runs the program and reads what its report says of the frames' size and the notes.
function(expect_size width height note)
    file(REMOVE_RECURSE ${FOLDER}/out)
    execute_process(COMMAND ${PROGRAM} ${ARGN} --prompt "a red ball" --steps 1 --keyframes 1 --quiet --out ${FOLDER}/out
        OUTPUT_QUIET ERROR_VARIABLE notes COMMAND_ERROR_IS_FATAL ANY)
    file(READ ${FOLDER}/out/report.json report)
    string(JSON size GET "${report}" settings size)
    string(REGEX REPLACE "[^0-9,]" "" size "${size}")
    if(NOT size STREQUAL "${height},${width}")
        message(FATAL_ERROR "${ARGN}: frames are [${size}], expected [${height},${width}]")
    endif()
    string(FIND "${notes}" "${note}" position)
    if(position EQUAL -1)
        message(FATAL_ERROR "${ARGN}: expected '${note}' in the notes:\n${notes}")
    endif()
    # Bytes 16 to 25 of a PNG file: width, height, bits, colour type.
    if(EXISTS ${FOLDER}/out/frames/0000.png)
        file(READ ${FOLDER}/out/frames/0000.png header OFFSET 16 LIMIT 10 HEX)
        set(header "${header}" PARENT_SCOPE)
    endif()
endfunction()

set(scene --scene bouncing_balls --frames 2)
expect_size(50 40 "The network renders 64 x 48, of which the frames' 50 x 40 are kept." ${scene} --size 40 --width 50)
if(NOT header STREQUAL "00000032000000280802")
    message(FATAL_ERROR "0000.png begins with ${header}, expected 50 x 40 of 8 bits and three colours")
endif()
expect_size(64 64 "" ${scene} --size 64 --alpha-channel --frame-format png16)
if(NOT header STREQUAL "00000040000000401006")
    message(FATAL_ERROR "0000.png begins with ${header}, expected 64 x 64 of 16 bits with alpha")
endif()
expect_size(64 64 "" ${scene} --size 64 --frame-format exr)
if(NOT EXISTS ${FOLDER}/out/frames/0001.exr OR EXISTS ${FOLDER}/out/frames/0000.png)
    message(FATAL_ERROR "--frame-format exr does not write frames/0001.exr alone")
endif()

# 180 lines of 320 pixels are what 720 of 1280 are to frames of four times the size.
execute_process(COMMAND ${MAPS_PROGRAM} bouncing_balls ${FOLDER}/maps 2 180 320
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
expect_size(64 36 "The network renders 64 x 48" --maps ${FOLDER}/maps --size 36)
expect_size(35 20 "The network renders 48 x 32" --maps ${FOLDER}/maps --size 20)
expect_size(29 16 "The network renders 32 x 16" --maps ${FOLDER}/maps --size 16)
