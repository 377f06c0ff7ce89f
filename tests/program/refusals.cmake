# SPDX-License-Identifier: MIT
# What the program generative_rendering refuses, with which exit code and which text on its error stream, in one run.
# Run: cmake -D PROGRAM=<generative_rendering> -D MAPS_PROGRAM=<blender_maps> -D FOLDER=<scratch folder> -P refusals.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${FOLDER})

set(refusals 0)
set(failures 0)
function(fails text)
    message("${text}")
    math(EXPR count "${failures} + 1")
    set(failures ${count} PARENT_SCOPE)
endfunction()

# Runs the program with the arguments after `text`.
function(refuses what code text)
    execute_process(COMMAND ${PROGRAM} ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE error)
    string(FIND "${error}" "${text}" position)
    if(NOT result EQUAL code OR position EQUAL -1)
        fails("${what}: exit code ${result}, expected ${code}; error stream, expected '${text}' in it:\n${error}")
    endif()
    math(EXPR count "${refusals} + 1")
    set(refusals ${count} PARENT_SCOPE)
    set(failures ${failures} PARENT_SCOPE)
endfunction()

# Files that no run can use.
set(broken ${FOLDER}/broken)
file(WRITE ${broken}/text.obj "This is a letter and not a model.\n")
set(tiny ${CMAKE_CURRENT_LIST_DIR}/../data/tiny_pipeline)
file(COPY ${tiny} DESTINATION ${broken})
file(WRITE ${broken}/tiny_pipeline/unet/diffusion_pytorch_model.safetensors "This is a letter and no weights at all.\n")
file(WRITE ${broken}/maps/frame_0001.exr "This is a letter and not an image.\n")
file(WRITE ${broken}/pictures/frame_0001.png "8 bits are not enough.\n")
# A pickle begins so, in a zip or by itself.
file(WRITE ${broken}/model.ckpt "PK\nno archive")
file(WRITE ${broken}/file "A file where a folder should be.\n")

# A sequence as Blender writes it.
set(sequence ${FOLDER}/sequence)
execute_process(COMMAND ${MAPS_PROGRAM} walking_figure ${sequence} 3 256 OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

# 1: the arguments are fine and the work cannot be done; 2: the arguments are wrong.
set(scene --scene camera_rotation)
set(out --out ${FOLDER}/refused)
refuses("a run without a prompt" 2 "--prompt" ${scene} ${out})
refuses("a run without an input" 2 "--scene" --prompt dots ${out})
refuses("two inputs" 2 "--scene" ${scene} --model a.obj --prompt dots ${out})
refuses("an unknown scene" 2 "--scene: attic" --scene attic --prompt dots ${out})
refuses("an unknown option" 2 "--colour" ${scene} --prompt dots ${out} --colour)
refuses("zero frames" 2 "--frames" ${scene} --prompt dots ${out} --frames 0)
refuses("more keyframes than frames" 2 "count is 9, expected 1 to the animation's 3 frames" ${scene} --prompt dots ${out}
    --frames 3 --keyframes 9)
refuses("options of a model without one" 2 "are of --model" ${scene} --prompt dots ${out} --camera fit)
refuses("a range of a scene" 2 "--start and --end" ${scene} --prompt dots ${out} --start 3)
refuses("a rate of nothing" 2 "--fps" ${scene} --prompt dots ${out} --fps 0)
refuses("an unknown format of frames" 2 "--frame-format" ${scene} --prompt dots ${out} --frame-format jpeg)
refuses("a set of coordinates and an atlas" 2 "--atlas" --model ${broken}/text.obj --prompt dots ${out} --atlas --uv-set 1)
refuses("an alpha above 1" 2 "--alpha" ${scene} --prompt dots ${out} --alpha 1.5)
refuses("an alpha that is no number" 2 "--alpha" ${scene} --prompt dots ${out} --alpha nan)
refuses("an unknown preset" 2 "--preset" ${scene} --prompt dots ${out} --preset loud)
refuses("a temperature that is no number" 2 "--temperature" ${scene} --prompt dots ${out} --temperature warm)
refuses("a temperature below 0" 2 "--temperature: is not a number of 0 to 100" ${scene} --prompt dots ${out} --temperature -1)
refuses("a temperature of nan" 2 "--temperature: is not a number of 0 to 100" ${scene} --prompt dots ${out} --temperature nan)
refuses("a temperature of frames that attend to nobody else" 2 "--temperature: is of methods" ${scene} --prompt dots ${out}
    --method per_frame --temperature 1)
refuses("a variance that is none" 2 "--variance" ${scene} --prompt dots ${out} --variance most)
refuses("a schedule that is none" 2 "--alpha-schedule" ${scene} --prompt dots ${out} --alpha-schedule sometimes)
refuses("an exponent that is no number" 2 "--quality-exponent: is '0:high', expected a number or two" ${scene} --prompt dots
    ${out} --quality-exponent 0:high)
refuses("an exponent below 0" 2 "--quality-exponent: is not a number of 0 to 100" ${scene} --prompt dots ${out}
    --quality-exponent=-1)
refuses("an exponent of a plain average" 2 "--quality-exponent: is of --average quality" ${scene} --prompt dots ${out}
    --average plain --quality-exponent 2)
refuses("a threshold below 0" 2 "--quality-threshold: is not a number of 0 to 100" ${scene} --prompt dots ${out}
    --quality-threshold=-0.5)
refuses("a threshold of texels" 2 "--quality-threshold: is of --correspondence footprint" ${scene} --prompt dots ${out}
    --preset paper --quality-threshold 0.5)
refuses("texels of the paper's preset and rest positions" 2 "--canonical: position has no texels" ${scene} --prompt dots ${out}
    --preset paper --canonical position)
refuses("a preset of a baseline" 2 "tokenflow has no keyframes, injection" ${scene} --prompt dots ${out} --method tokenflow
    --preset vivid)
refuses("keyframes that are drawn like nothing" 2 "--keyframe-drawing" ${scene} --prompt dots ${out} --keyframe-drawing dice)
refuses("vectors that no processor has" 2 "--vectors" ${scene} --prompt dots ${out} --vectors v9)
refuses("a negative seed" 2 "--seed" ${scene} --prompt dots ${out} --seed -1)
refuses("maps that no machine can hold" 2 "half of the machine's memory" ${scene} --prompt dots ${out} --size 1048576)
refuses("a pipeline without a name" 2 "--pipeline" ${scene} --prompt dots ${out} --pipeline "")
refuses("a pipeline that is not there" 1 "there is nothing" ${scene} --prompt dots ${out} --pipeline ${FOLDER}/nowhere)
refuses("a ControlNet that is not there" 1 "there is nothing" ${scene} --prompt dots ${out} --pipeline ${tiny}
    --controlnet ${FOLDER}/nowhere)
refuses("a tokenizer that is not there" 1 "vocab.json" ${scene} --prompt dots ${out} --pipeline ${tiny}
    --tokenizer ${FOLDER}/nowhere)
refuses("a variant that is not there" 1 "int4" ${scene} --prompt dots ${out} --pipeline ${tiny} --variant int4)
refuses("a LoRA that is not there" 1 "nowhere" ${scene} --prompt dots ${out} --pipeline ${tiny} --lora ${FOLDER}/nowhere:0.5)
refuses("a LoRA of no scale" 2 "--lora: scale is 'much'" ${scene} --prompt dots ${out} --pipeline ${tiny} --lora a:much)
refuses("a pickle" 1 "pickle" ${scene} --prompt dots ${out} --pipeline ${broken}/model.ckpt)
refuses("a network of a folder as a pipeline" 1 "one network of a diffusers folder" ${scene} --prompt dots ${out}
    --pipeline ${tiny}/unet/diffusion_pytorch_model.safetensors)
refuses("all layers of the text encoder left out" 1 "skipped is 2, expected below the 2 layers" ${scene} --prompt dots
    ${out} --pipeline ${tiny} --clip-skip 2)
refuses("a width that the maps do not have" 2 "--width: width is 64" --maps ${sequence} --prompt dots ${out} --size 128
    --width 64)
refuses("a guidance that is none" 2 "--guidance" ${scene} --prompt dots ${out} --guidance strong)
refuses("a sampler that is none" 2 "--sampler" ${scene} --prompt dots ${out} --sampler dice)
refuses("settings of the method without the method" 2 "per_frame has no keyframes" ${scene} --prompt dots ${out}
    --method per_frame --no-post)
refuses("a texture resolution without texels" 2 "--texture-resolution: is of --correspondence texels" ${scene} --prompt dots
    ${out} --texture-resolution 64)
refuses("a noise resolution without texels" 2 "--noise-resolution: is of --noise-reading nearest" ${scene} --prompt dots ${out}
    --noise-resolution 64)
refuses("texels of rest positions" 2 "--canonical: position has no texels" ${scene} --prompt dots ${out}
    --canonical position --correspondence texels)
refuses("quality of texels" 2 "--average: quality is not known" ${scene} --prompt dots ${out} --average quality
    --correspondence texels)
refuses("a window without a consensus" 2 "--consensus-window: is of --consensus" ${scene} --prompt dots ${out}
    --preset plain --consensus-window 0 0.5)
refuses("a share of alpha above 1" 2 "--latents-grid-alpha" ${scene} --prompt dots ${out} --latents-grid-alpha 2)
refuses("sources of no consensus" 2 "--consensus-sources: is of --consensus" ${scene} --prompt dots ${out}
    --no-consensus --consensus-sources 4)
refuses("a consensus and none" 2 "--no-consensus" ${scene} --prompt dots ${out} --consensus --no-consensus)
refuses("a window that ends before it begins" 2 "--consensus-window: expected 0 <= BEGIN <= END <= 1" ${scene}
    --prompt dots ${out} --consensus --consensus-window 0.5 0.25)
refuses("a window that is no number" 2 "--consensus-window" ${scene} --prompt dots ${out} --consensus
    --consensus-window 0 nan)
refuses("a window of one end" 2 "--consensus-window" ${scene} --prompt dots ${out} --consensus --consensus-window 0.5)
refuses("no sources" 2 "--consensus-sources: is 0, expected a number of frames or all" ${scene} --prompt dots ${out}
    --consensus --consensus-sources 0)
refuses("sources by another word" 2 "--consensus-sources: is some, expected" ${scene} --prompt dots ${out} --consensus
    --consensus-sources some)
refuses("a normalisation that is none" 2 "--normalization" ${scene} --prompt dots ${out} --normalization median)
refuses("two normalisations" 2 "--normalization" ${scene} --prompt dots ${out} --normalization means --no-adain)
refuses("a target that is none" 2 "--normalization-target" ${scene} --prompt dots ${out} --normalization-target last)
refuses("a target of no normalisation" 2 "--normalization-target: there is no normalisation" ${scene} --prompt dots
    ${out} --normalization none --normalization-target mean)
refuses("an environment read by the nearest texel" 2 "--background: environment takes" ${scene} --prompt dots ${out}
    --background environment --noise-reading nearest)
refuses("a plan of a baseline" 2 "--plan: is of generative_rendering" ${scene} ${out} --plan --method tokenflow)
refuses("a missing model" 1 "missing.obj" --model missing.obj --prompt dots ${out})
refuses("a foreign model" 1 "text.obj" --model ${broken}/text.obj --prompt dots ${out})
refuses("foreign maps" 1 "frame_0001.exr" --maps ${broken}/maps --prompt dots ${out})
refuses("8-bit maps" 1 "256" --maps ${broken}/pictures --prompt dots ${out})
refuses("a missing folder of maps" 1 "nowhere" --maps ${broken}/nowhere --prompt dots ${out})
refuses("a size above the maps'" 2 "--size: height is 300, expected at most the maps', which are 256 x 256"
    --maps ${sequence} --prompt dots ${out} --size 300)
refuses("an environment of maps" 2 "--background: environment is of EXR maps" --maps ${sequence} --prompt dots ${out}
    --background environment)
refuses("a comparison with nothing" 1 "report.json: is no report of a run" ${scene} --prompt dots ${out}
    --beside ${broken})
refuses("foreign weights" 1 "diffusion_pytorch_model.safetensors" ${scene} --prompt dots ${out} --frames 2
    --pipeline ${broken}/tiny_pipeline)
refuses("a folder without weights" 1 "unet" ${scene} --prompt dots ${out} --frames 2 --pipeline ${broken}/maps)
refuses("an output folder that cannot be written" 1 "${broken}/file" ${scene} --prompt dots --out ${broken}/file)

refuses("an engine that is not there" 1 "there is nothing, expected the library of an engine" ${scene} ${out}
    --engine ${FOLDER}/nowhere.so)
refuses("an engine that is no library" 1 "is no library that can be loaded" ${scene} ${out} --engine ${broken}/file)
refuses("a library without an engine" 1 "has no function genrender_engine_of" ${scene} ${out} --engine ${NO_ENGINE})
refuses("an engine of another version" 2 "engine.version is 2, expected GENRENDER_ENGINE_VERSION, 1" ${scene} ${out}
    --engine ${ENGINE_OF_TOMORROW})
refuses("an engine and a prompt" 2 "--engine: knows its own model, prompt" ${scene} --prompt dots ${out} --engine ${ENGINE})
refuses("an engine and a pipeline" 2 "--engine: knows its own model, prompt" ${scene} ${out} --engine ${ENGINE}
    --pipeline ${tiny})
refuses("an engine and a size" 2 "--engine: knows its own model, prompt" ${scene} ${out} --engine ${ENGINE} --size 64)

# A program with a denoiser of its own has no options for what that knows, in its help neither.
set(of_models ${PROGRAM})
set(PROGRAM ${OWN_PROGRAM})
foreach(option IN ITEMS --prompt --negative-prompt --guidance --size --width --pipeline --lora --engine)
    refuses("${option} of a denoiser of one's own" 2 "${option}" ${scene} ${out} ${option} 64)
endforeach()
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
if(help MATCHES "--prompt|--pipeline|--size" OR NOT help MATCHES "--keyframes")
    fails("the help of a denoiser of one's own:\n${help}")
endif()
set(PROGRAM ${of_models})

# What was written before a failure stays.
file(MAKE_DIRECTORY ${broken}/run/report.json)
refuses("to put a report where a folder is" 1 "report.json" ${scene} --out ${broken}/run
    --prompt dots --frames 3 --size 64 --steps 2 --quiet)
if(NOT EXISTS ${broken}/run/frames/0002.png)
    fails("${broken}/run/frames/0002.png: was written before the failure and is not there")
endif()

if(failures GREATER 0 OR refusals EQUAL 0)
    message(FATAL_ERROR "${failures} of ${refusals} refusals are not as they should be")
endif()
message("${refusals} refusals")
