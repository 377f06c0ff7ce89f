// SPDX-License-Identifier: MIT
// A call whose place() returns a reference, given to a processor of the library.
// expected: attention_call: place() returns an attention_place by value
#include "right_models.hpp"

#include <genrender/attention/plain_attention.hpp>

struct place_by_reference : right_call {
    genrender::attention_place const& place() const;
};

void run(place_by_reference& call) { genrender::plain_attention{}(call); }
