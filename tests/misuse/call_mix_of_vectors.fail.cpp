// SPDX-License-Identifier: MIT
// A call whose mix() takes other rows, given to the processor that calls it.
// expected: attention_call: mix(F_hat, F_KF, rows, alpha) takes a span of sparse_rows<real_type> const
#include <genrender/attention/attention_call.hpp>

#include "right_models.hpp"

#include <genrender/injection/injector.hpp>

#include <vector>

struct mix_of_vectors : right_call {
    features mix(features, features, std::vector<genrender::sparse_rows<float>>&, float) const;
};

void run(genrender::injector<features, float> const& inject, mix_of_vectors& call) { inject(call); }
