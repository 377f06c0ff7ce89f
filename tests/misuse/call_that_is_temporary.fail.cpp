// SPDX-License-Identifier: MIT
// A call that ends before the processor does.
// expected: attention_call: a processor takes an lvalue
#include <genrender/attention/attention_call.hpp>

#include "right_models.hpp"

#include <genrender/attention/plain_attention.hpp>

void run() { genrender::plain_attention{}(right_call{}); }
