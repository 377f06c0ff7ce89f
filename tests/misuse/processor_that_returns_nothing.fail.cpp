// SPDX-License-Identifier: MIT
// A processor that keeps what it computes.
// expected: attention_processor: operator()(call) takes the engine's attention_call as an lvalue and returns its
#include <genrender/attention/attention_processor.hpp>

#include "right_models.hpp"

struct returns_nothing {
    void operator()(right_call& call) const;
};

int main() { genrender::require_attention_processor<returns_nothing, right_call>(); }
