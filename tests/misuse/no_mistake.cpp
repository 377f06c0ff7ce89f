// SPDX-License-Identifier: MIT
// The right models where the mistakes are made: it must compile, or the refusals beside it prove nothing.
#include "right_models.hpp"

#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/maps/uv_maps_view.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/keyframes/recorder.hpp>

using namespace genrender;

int main() {
    require_denoiser<right_denoiser>();
    require_latent_lender<right_denoiser>();
    require_latent_lender<right_lender>();
    require_attention_call<right_call>();
    require_correspondence_map<correspondence_map_archetype>();
    require_canonical_maps<uv_maps_view>();
}

void run(right_call& call, injector<features, float> const& inject, recorder<features> const& record) {
    plain_attention{}(call);
    inject(call);
    record(call);
    stack<float, 2> owner({2, 2});
    strided_view<float, 2> const view = owner;
    strided_view<float, 1>(view.data(), {1});
}
