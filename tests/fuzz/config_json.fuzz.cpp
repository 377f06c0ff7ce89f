// SPDX-License-Identifier: MIT
// Any bytes as the config.json of all networks: refused with a sentence, or a config that can be built.
#include "memory_file.hpp"

#include <genrender/reference/diffusers_config.hpp>

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    using namespace genrender;
    using namespace genrender::reference;
    fuzz::memory_file const file(std::string_view(reinterpret_cast<char const*>(data), size));
    auto const attempt = [](auto const& act) {
        try {
            act();
        } catch (file_error const&) {
            return;
        } catch (value_error const&) {
            return;
        }
    };
    attempt([&] { read_diffusers_config(file.path(), file.path(), file.path()); });
    // Each of the three by itself gets further.
    attempt([&] {
        unet_config config;
        config_file options(file.path());
        internal::read_unet_options(config, options);
        require_config(config);
        unet_json(config);
    });
    attempt([&] {
        unet_config config;
        config_file options(file.path());
        internal::read_scheduler_options(config, options);
    });
    attempt([&] {
        config_file options(file.path());
        options.same_count("a", 3, 1);
        options.texts("b", {});
        options.number("c", 1);
        options.flag("d", true);
        options.require_all_taken();
    });
    return 0;
}
