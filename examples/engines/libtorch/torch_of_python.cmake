# SPDX-License-Identifier: MIT
# Defines the target `torch`: ATen on the processor, from the package that pip installs. find_package(Torch) of that package asks
# for a whole CUDA toolkit if it was built for one; these two libraries need only its runtime and cupti, which pip installs
# beside them and they find by themselves (get.sh). The Python is GENRENDER_ENGINE_PYTHON, or that of get.sh. With
# GENRENDER_TORCH_CUDA its library for CUDA devices, too, which needs all that pip installs. Where there is no package
# `genrender_torch_missing` is a sentence, else `genrender_torch_python` is the Python that has it.
set(genrender_torch_missing "${GENRENDER_ENGINE_PYTHON} has no package torch with headers, nor has build/engines/libtorch")
foreach(python IN ITEMS ${GENRENDER_ENGINE_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/../../../build/engines/libtorch/bin/python3)
    execute_process(COMMAND ${python} -c
        "import importlib.util as u; s = u.find_spec('torch'); print(s.submodule_search_locations[0] if s else '')"
        OUTPUT_VARIABLE torch_folder OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(EXISTS "${torch_folder}/include/ATen/ATen.h")
        set(genrender_torch_missing "")
        set(genrender_torch_python ${python})
        break()
    endif()
endforeach()
if(genrender_torch_missing)
    return()
endif()
add_library(torch INTERFACE IMPORTED GLOBAL)
set_target_properties(torch PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${torch_folder}/include"
    INTERFACE_LINK_LIBRARIES "${torch_folder}/lib/libtorch_cpu.so;${torch_folder}/lib/libc10.so")
if(GENRENDER_TORCH_CUDA)
    # No symbol of it is used by name: it registers itself.
    set_property(TARGET torch APPEND PROPERTY INTERFACE_LINK_LIBRARIES
        -Wl,--no-as-needed "${torch_folder}/lib/libtorch_cuda.so" "${torch_folder}/lib/libc10_cuda.so" -Wl,--as-needed)
endif()
