# SPDX-License-Identifier: MIT
# Which rows --filter asks for, by the rules of Google Benchmark.

# Sets `result` to whether a row's name matches the regular expression, or does not where a minus stands in front of it.
function(matches_filter result name filter)
    set(is_wanted TRUE)
    if(filter MATCHES "^-(.+)$")
        set(unwanted "${CMAKE_MATCH_1}")
        if(name MATCHES "${unwanted}")
            set(is_wanted FALSE)
        endif()
    elseif(NOT filter STREQUAL "" AND NOT name MATCHES "${filter}")
        set(is_wanted FALSE)
    endif()
    set(${result} ${is_wanted} PARENT_SCOPE)
endfunction()
