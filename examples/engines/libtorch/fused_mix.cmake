# SPDX-License-Identifier: MIT
# With GENRENDER_TORCH_CUDA eq. 6 is one kernel on CUDA devices: a unit of nvcc's that registers itself, linked to targets by
# link_fused_mix(targets...), which does nothing without the option.
if(GENRENDER_TORCH_CUDA)
    enable_language(CUDA)
    if(NOT CMAKE_CUDA_ARCHITECTURES)
        set(CMAKE_CUDA_ARCHITECTURES native)
    endif()
    add_library(torch_mix OBJECT ${CMAKE_CURRENT_LIST_DIR}/../gpu/torch_mix.cu)
    # CMake 3.25 does not know that newer compilers have C++20.
    target_compile_options(torch_mix PRIVATE -std=c++20)
    target_link_libraries(torch_mix PRIVATE genrender::torch genrender::cuda)
endif()

function(link_fused_mix)
    if(GENRENDER_TORCH_CUDA)
        foreach(target IN LISTS ARGN)
            target_link_libraries(${target} PRIVATE torch_mix)
        endforeach()
    endif()
endfunction()
