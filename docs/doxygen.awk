# SPDX-License-Identifier: MIT
# What Doxygen reads in place of a header. The head of the file is its description; the namespace that is named after
# compiler flags is left out, so that its members are those of the namespace around it; a row of a table that goes on in the
# next line is one line. Every other line stays where it is.

# Prints the rows of a table, and as many empty lines as were joined to them.
function end_table() {
    for (i = 1; i <= rows; ++i) {
        print row[i]
    }
    for (; rows > 0 && joined > 0; --joined) {
        print indent "///"
    }
    rows = joined = 0
    in_table = 0
}

FNR == 1 && /^\/\/ SPDX-License-Identifier: / {
    print "/// @file"
    in_head = 1
    next
}
in_head && /^\/\// {
    print "/" $0
    next
}
{ in_head = 0 }

in_table && /^ *\/\/\/.*\|/ {
    count = split($0, cells, "|")
    if (cells[1] ~ /^ *\/\/\/ *$/ && rows > 0) {
        known = split(row[rows], before, "|")
        line = ""
        for (c = 1; c <= known; ++c) {
            more = c > 1 && c <= count ? cells[c] : ""
            sub(/^ +/, "", more)
            sub(/ +$/, "", before[c])
            line = line (c > 1 ? "|" : "") before[c] (more != "" ? " " more : "")
        }
        row[rows] = line
        ++joined
    } else {
        row[++rows] = $0
    }
    next
}
in_table { end_table() }

/^ *\/\/\/ *-+\|[-|]+ *$/ {
    print
    in_table = 1
    match($0, /^ */)
    indent = substr($0, 1, RLENGTH)
    next
}

/^inline namespace GENRENDER_UNIT \{/ {
    print "extern \"C++\" {"
    next
}
{ print }

END { end_table() }
