// SPDX-License-Identifier: MIT
// Keyframes in 16 bits for a denoiser whose calls cannot store them.
// expected: keyframe_storage_for: storage is of 16 bits, expected feature_storage::same for a denoiser whose call_type has no `stored`
#include <genrender/sampling/storing_denoiser.hpp>

#include "right_models.hpp"

struct stores_nothing : right_denoiser {
    using call_type = right_call;
};

genrender::feature_storage choose() {
    using namespace genrender;
    return keyframe_storage_for<stores_nothing, feature_storage::f16>();
}
