# SPDX-License-Identifier: MIT
# Runs FUZZER on a copy of CORPUS in FOLDER, where an input that breaks it is kept. Run with cmake -P.
cmake_minimum_required(VERSION 3.25)
set(seconds 10)
if(DEFINED ENV{GENRENDER_FUZZ_SECONDS})
    set(seconds $ENV{GENRENDER_FUZZ_SECONDS})
endif()
file(GLOB seeds ${CORPUS}/*)
if(NOT seeds)
    message(FATAL_ERROR "${CORPUS}: there is no file, expected inputs to begin with")
endif()
file(REMOVE_RECURSE ${FOLDER})
file(COPY ${seeds} DESTINATION ${FOLDER}/corpus)
execute_process(
    COMMAND ${FUZZER} -max_total_time=${seconds} -rss_limit_mb=2048 -timeout=10 -print_final_stats=1
            -artifact_prefix=${FOLDER}/ ${FOLDER}/corpus
    COMMAND_ERROR_IS_FATAL ANY)
