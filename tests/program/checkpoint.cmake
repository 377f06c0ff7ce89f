# SPDX-License-Identifier: MIT
# Runs that are killed at random moments, interrupted or refused, and gone on with: the frames are those of a run in one go.
# Run: cmake -D PROGRAM=<generative_rendering> -D FOLDER=<scratch folder>
#     -D WEIGHTS=<the miniature's> -P checkpoint.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${FOLDER})
set(but_the_scene --prompt dots --frames 2 --size 32 --steps 6 --sampler dpmpp_2m --latents)
set(run --scene camera_rotation ${but_the_scene})

# Whether a folder has the frames and latents of the run in one go, and nothing of a run that is under way.
function(require_whole folder what)
    foreach(file IN ITEMS frames/0000.png frames/0001.png latents.npy contact_sheet.png)
        execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${folder}/${file} ${FOLDER}/whole/${file}
            RESULT_VARIABLE differs)
        if(differs)
            message(FATAL_ERROR "${what}: ${folder}/${file} is not that of the run in one go")
        endif()
    endforeach()
    file(GLOB left ${folder}/checkpoint ${folder}/.*.part ${folder}/*/.*.part)
    if(left)
        message(FATAL_ERROR "${what}: ${left} is left, expected nothing when a run is done")
    endif()
endfunction()
function(go_on folder what)
    execute_process(COMMAND ${PROGRAM} ${run} --out ${folder} --resume --quiet OUTPUT_QUIET ERROR_VARIABLE error
        RESULT_VARIABLE code)
    if(NOT code EQUAL 0)
        message(FATAL_ERROR "${what}: --resume ends with ${code}, expected 0:\n${error}")
    endif()
    require_whole(${folder} "${what}")
endfunction()

string(TIMESTAMP begin "%s%f")
execute_process(COMMAND ${PROGRAM} ${run} --out ${FOLDER}/whole --quiet OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
string(TIMESTAMP end "%s%f")
math(EXPR microseconds "${end} - ${begin}")
require_whole(${FOLDER}/whole "the run in one go")

# -- killed ------------------------------------------------------------------------------------------------------------
set(killed 0)
set(in_the_middle 0)
set(attempts 0)
while(killed LESS 20)
    math(EXPR attempts "${attempts} + 1")
    if(attempts GREATER 200)
        message(FATAL_ERROR "${killed} of 200 runs were killed before their end, expected 20")
    endif()
    string(RANDOM LENGTH 4 ALPHABET 0123456789 share)
    math(EXPR moment "(4000 + 1${share} % 10000) * ${microseconds} / 14000 + 1000000000")
    string(SUBSTRING ${moment} 1 3 whole_seconds)
    string(SUBSTRING ${moment} 4 6 parts)
    set(moment ${whole_seconds}.${parts})
    set(folder ${FOLDER}/killed)
    file(REMOVE_RECURSE ${folder})
    execute_process(COMMAND timeout -s KILL ${moment} ${PROGRAM} ${run} --out ${folder} OUTPUT_QUIET ERROR_VARIABLE told
        RESULT_VARIABLE code)
    if(code EQUAL 0)
        continue()
    endif()
    math(EXPR killed "${killed} + 1")
    # The line of a step comes before its checkpoint, so that the last step may be lost and no other.
    string(REGEX MATCHALL "step [0-9]+ of 6, frames 2 of 2" steps "${told}")
    list(LENGTH steps steps)
    set(kept 0)
    if(EXISTS ${folder}/checkpoint)
        file(READ ${folder}/checkpoint kept OFFSET 24 LIMIT 1 HEX)
        math(EXPR kept "0x${kept}")
        math(EXPR in_the_middle "${in_the_middle} + 1")
    endif()
    if(kept EQUAL 0 AND EXISTS ${folder}/report.json) # All was written, and the checkpoint removed.
        message("killed after ${moment} s: it was done")
        require_whole(${folder} "a run that was killed at its end")
        continue()
    endif()
    math(EXPR lost "${steps} - ${kept}")
    if(lost GREATER 1)
        message(FATAL_ERROR "killed after ${moment} s: ${steps} steps were done and ${kept} are kept")
    endif()
    message("killed after ${moment} s: ${steps} steps were done, ${kept} are kept")
    if(kept EQUAL 0)
        execute_process(COMMAND ${PROGRAM} ${run} --out ${folder} --quiet OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
        require_whole(${folder} "a run that was killed before its first step")
    else()
        go_on(${folder} "a run that was killed after ${moment} s")
    endif()
endwhile()
if(in_the_middle LESS 5)
    message(FATAL_ERROR "${in_the_middle} of ${killed} killed runs left a checkpoint, expected more")
endif()

# -- interrupted -------------------------------------------------------------------------------------------------------
# What the program says is a command: a run of many steps is interrupted and ended by it.
set(folder ${FOLDER}/interrupted)
set(long --scene camera_rotation --prompt "a 'red' ball" --frames 2 --size 32 --steps 100 --latents)
execute_process(COMMAND ${PROGRAM} ${long} --out ${FOLDER}/long --quiet OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
set(is_interrupted FALSE)
foreach(moment IN ITEMS 0.5 0.3 1 0.2 2 4)
    file(REMOVE_RECURSE ${folder})
    execute_process(COMMAND timeout --preserve-status -s INT ${moment} ${PROGRAM} ${long} --out ${folder} --quiet
        OUTPUT_QUIET ERROR_VARIABLE told RESULT_VARIABLE code)
    if(code EQUAL 130 AND told MATCHES "checkpoint has all steps that are done; go on with\n *([^\n]*)\n")
        set(command "${CMAKE_MATCH_1}")
        set(is_interrupted TRUE)
        break()
    endif()
endforeach()
if(NOT is_interrupted)
    message(FATAL_ERROR "no run was interrupted with exit code 130 and the command that goes on; the last said:\n${told}")
endif()
execute_process(COMMAND sh -c "${command}" OUTPUT_QUIET ERROR_VARIABLE told RESULT_VARIABLE code)
if(NOT code EQUAL 0)
    message(FATAL_ERROR "${command}: ends with ${code}, expected 0:\n${told}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${folder}/latents.npy ${FOLDER}/long/latents.npy
    COMMAND_ERROR_IS_FATAL ANY)

# -- refused -----------------------------------------------------------------------------------------------------------
function(refuses what code text)
    execute_process(COMMAND ${PROGRAM} ${ARGN} --resume --quiet RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE error)
    string(FIND "${error}" "${text}" position)
    if(NOT result EQUAL code OR position EQUAL -1)
        message(FATAL_ERROR
            "${what}: exit code ${result}, expected ${code}; error stream, expected '${text}' in it:\n${error}")
    endif()
endfunction()
refuses("no checkpoint" 2 "--resume: ${FOLDER}/whole/checkpoint is missing" ${run} --out ${FOLDER}/whole)
refuses("no folder" 2 "checkpoint is missing" ${run} --out ${FOLDER}/nowhere)

# A report that cannot be written leaves the checkpoint of the last step.
set(folder ${FOLDER}/refused)
file(MAKE_DIRECTORY ${folder}/report.json)
execute_process(COMMAND ${PROGRAM} ${run} --out ${folder} --quiet OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE code)
if(NOT code EQUAL 1 OR NOT EXISTS ${folder}/checkpoint)
    message(FATAL_ERROR "a run whose report cannot be written ends with ${code}, expected 1 and a checkpoint")
endif()
set(same "expected one with the same settings, maps and model")
refuses("another seed" 2 "a run that differs in settings, ${same}" ${run} --seed 1 --out ${folder})
refuses("another method" 2 "differs in settings, ${same}" ${run} --method per_frame --out ${folder})
refuses("another scene" 2 "differs in maps and model, ${same}" ${but_the_scene} --scene bouncing_balls --out ${folder})
refuses("another prompt" 2 "differs in model, ${same}" ${run} --negative-prompt stripes --out ${folder})
file(COPY_FILE ${folder}/checkpoint ${FOLDER}/checkpoint)
file(WRITE ${folder}/checkpoint "This is a letter.\n")
refuses("a letter" 1 "${folder}/checkpoint: checkpoint: begins with other bytes" ${run} --out ${folder})
file(COPY_FILE ${FOLDER}/checkpoint ${folder}/checkpoint)
file(APPEND ${folder}/checkpoint "more")
refuses("more than a checkpoint" 1 "goes on after its end" ${run} --out ${folder})
execute_process(COMMAND head -c 1000 ${FOLDER}/checkpoint OUTPUT_FILE ${folder}/checkpoint)
refuses("half a checkpoint" 1 "ends after 1000 bytes" ${run} --out ${folder})

# The weights may lie elsewhere, and may not be others.
file(COPY ${WEIGHTS} DESTINATION ${FOLDER})
set(elsewhere --pipeline ${FOLDER}/weights --guidance 3)
execute_process(COMMAND sh -c
    "printf X | dd of=${FOLDER}/weights/unet/diffusion_pytorch_model.safetensors bs=1 seek=200000 conv=notrunc"
    OUTPUT_QUIET ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(COPY_FILE ${FOLDER}/checkpoint ${folder}/checkpoint)
refuses("weights of which one differs" 2 "differs in model, ${same}" ${run} ${elsewhere} --out ${folder})
file(COPY ${WEIGHTS} DESTINATION ${FOLDER})
refuses("the same weights elsewhere, and no room for the report" 1 "report.json" ${run} ${elsewhere} --out ${folder})

# All steps are done: what is left is to decode and write.
file(COPY_FILE ${FOLDER}/checkpoint ${folder}/checkpoint)
file(REMOVE_RECURSE ${folder}/report.json)
go_on(${folder} "a run whose report could not be written")

# A checkpoint that cannot be written is said once, and the run goes on without.
file(MAKE_DIRECTORY ${FOLDER}/without/checkpoint)
execute_process(COMMAND ${PROGRAM} ${run} --out ${FOLDER}/without --quiet OUTPUT_QUIET ERROR_VARIABLE error
    RESULT_VARIABLE code)
string(REGEX MATCHALL "note: [^\n]*checkpoint: cannot be replaced" notes "${error}")
list(LENGTH notes notes)
if(NOT code EQUAL 0 OR NOT notes EQUAL 1)
    message(FATAL_ERROR "a run without room for its checkpoint ends with ${code} and ${notes} notes, expected 0 and 1:\n${error}")
endif()
file(REMOVE_RECURSE ${FOLDER}/without/checkpoint)
require_whole(${FOLDER}/without "a run without room for its checkpoint")

# -- looked at ---------------------------------------------------------------------------------------------------------
# The estimates of the last step are the frames.
execute_process(COMMAND ${PROGRAM} ${run} --out ${FOLDER}/looked_at --preview 3 --quiet OUTPUT_QUIET
    COMMAND_ERROR_IS_FATAL ANY)
require_whole(${FOLDER}/looked_at "a run that was looked at")
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${FOLDER}/looked_at/preview.png
    ${FOLDER}/whole/contact_sheet.png COMMAND_ERROR_IS_FATAL ANY)
message("${killed} runs were killed, ${in_the_middle} with a checkpoint")
