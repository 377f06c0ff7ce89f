// SPDX-License-Identifier: MIT
// A call that does not say what its features are, given to the recorder.
// expected: attention_call: features_type is copyable and real_type is float or double
#include <genrender/attention/attention_call.hpp>

#include "right_models.hpp"

#include <genrender/keyframes/recorder.hpp>

struct nameless_call {};

void run(genrender::recorder<features> const& record, nameless_call& call) { record(call); }
