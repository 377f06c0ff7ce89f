# What Doxygen reads in place of a header: the head of a file is its description, and the namespace that is named after
# compiler flags is left out, its members being those of the namespace around it. Lines stay where they are.
1,/^(#pragma once)?$/ {
    s|^// SPDX-License-Identifier: .*|/// @file|
    s|^//( .*)?$|///\1|
}
s|^inline namespace GENRENDER_UNIT \{|extern "C++" {|
