# SPDX-License-Identifier: MIT
# Prints what Doxygen lets pass: concepts and enumerators without a comment. Exits with 1 if there are any.
FNR == 1 { in_enum = has_comment = is_internal = 0 }
/^namespace (.*::)?(detail|internal) \{/ { is_internal = 1 }
/^\} \/\/ namespace (.*::)?(detail|internal)$/ { is_internal = 0 }
is_internal { next }

/^concept / && !has_comment {
    print FILENAME ":" FNR ": concept " $2 " is not documented"
    failed = 1
}
/^enum class / && /\}/ {
    print FILENAME ":" FNR ": enumerators of " $3 " are not documented"
    failed = 1
}
/^enum class / && !/\}/ {
    in_enum = 1
    next
}
/^\};/ { in_enum = 0 }
in_enum && /^ *[a-z]/ && !/\/\/\/</ && !has_comment {
    print FILENAME ":" FNR ": enumerator " $1 " is not documented"
    failed = 1
}

# A comment stands above a template's head and its requirements, too.
/^ *\/\/\// { has_comment = 1; next }
!/^(template|    |requires)/ || in_enum { has_comment = 0 }

END { exit failed }
