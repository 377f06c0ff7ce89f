// SPDX-License-Identifier: MIT
// Any header as a LoRA, merged into a small model: refused with a sentence, or added within the weights' bounds.
#include "memory_file.hpp"

#include <genrender/reference/lora_file.hpp>
#include <genrender/reference/lora_merge.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    using namespace genrender;
    using namespace genrender::reference;
    fuzz::memory_file const file(fuzz::with_header_length(std::span(data, size)));
    tensor_places places;
    places["a.to_q.weight"] = {nullptr, "", {2, 3}, 0};
    places["a.conv.weight"] = {nullptr, "", {2, 1, 3, 3}, 0};
    places["text_model.q.weight"] = {nullptr, "", {4, 2}, 0};
    try {
        lora_file const lora(file.path());
        for (auto const part : {model_part::unet, model_part::text_encoder}) {
            try {
                for (auto const& [name, difference] : differences_of(lora, part, places)) {
                    std::vector<float> weight(places.at(name).count());
                    add_difference<float>(weight, difference);
                }
            } catch (file_error const&) {
                continue;
            }
        }
    } catch (file_error const&) {
        return 0;
    }
    return 0;
}
