// SPDX-License-Identifier: MIT
// A call whose place() returns a reference, given to a processor of the library.
// expected: attention_call: place() returns an attention_place by value
#include <genrender/attention/attention_call.hpp>

#include "right_models.hpp"

#include <genrender/keyframes/recorder.hpp>

struct place_by_reference : right_call {
    genrender::attention_place const& place() const;
};

void run(genrender::recorder<features> const& record, place_by_reference& call) { record(call); }
