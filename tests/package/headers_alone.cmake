# SPDX-License-Identifier: MIT
# Builds the project of headers/, two compilers at once: more wait for memory. Run with cmake -P.
execute_process(COMMAND ${CMAKE_COMMAND} --fresh -S ${CMAKE_CURRENT_LIST_DIR}/headers -B ${BUILD} -G ${GENERATOR}
    -D CMAKE_CXX_COMPILER=${COMPILER} -D SOURCE=${SOURCE} -D INSTALLED=${INSTALLED} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --parallel 2 COMMAND_ERROR_IS_FATAL ANY)
