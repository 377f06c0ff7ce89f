// SPDX-License-Identifier: MIT
// Any header as a single-file checkpoint: refused with a sentence, or its networks are told and, if whole, built.
#include "memory_file.hpp"

#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/single_file.hpp>
#include <genrender/reference/unet.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    using namespace genrender;
    using namespace genrender::reference;
    fuzz::memory_file const file(fuzz::with_header_length(std::span(data, size)));
    auto const attempt = [](auto const& act) {
        try {
            act();
        } catch (file_error const&) {
            return;
        } catch (value_error const&) {
            return;
        }
    };
    attempt([&] {
        single_file const checkpoint(file.path(), prediction::velocity);
        for (auto const part : {model_part::unet, model_part::controlnet, model_part::vae, model_part::text_encoder}) {
            attempt([&] { checkpoint.options(part); });
            attempt([&] {
                for (auto const& named : checkpoint.places(part)) {
                    attempt([&] { named.second.read<float>(); });
                }
            });
        }
        attempt([&] {
            auto source = checkpoint.tensors<float>(model_part::unet);
            site_list sites({8, 8});
            unet<float> const network(infer_unet_config(checkpoint.places(model_part::unet), file.path()), source,
                                      sites);
        });
        attempt([&] {
            auto source = checkpoint.tensors<float>(model_part::controlnet);
            site_list sites({8, 8});
            controlnet<float> const network(infer_unet_config(checkpoint.places(model_part::controlnet), file.path()),
                                            source, sites);
        });
    });
    return 0;
}
