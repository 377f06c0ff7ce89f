// SPDX-License-Identifier: MIT
// Any bytes as a checkpoint: they are refused with a sentence, or written again as they were read.
#include <genrender/pipeline/checkpoint.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    using namespace genrender;
    std::string_view const bytes(reinterpret_cast<char const*>(data), size);
    std::istringstream from{std::string(bytes)};
    try {
        auto const read = read_checkpoint<float>(from);
        std::ostringstream to;
        write_checkpoint(to, read);
        if (!bytes.starts_with(to.str())) {
            std::abort();
        }
    } catch (file_error const&) {
        return 0;
    }
    return 0;
}
