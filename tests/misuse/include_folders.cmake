# SPDX-License-Identifier: MIT
# Appends to flags the FOLDERS that the compiler does not search by itself, which are IMPLICIT_FOLDERS.
foreach(folder IN LISTS FOLDERS)
    if(NOT folder IN_LIST IMPLICIT_FOLDERS)
        list(APPEND flags -isystem ${folder})
    endif()
endforeach()
