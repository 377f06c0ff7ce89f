// SPDX-License-Identifier: MIT
// Any bytes as a safetensors file: it is refused with a sentence, or all of its tensors can be read.
#include "memory_file.hpp"

#include <genrender/reference/safetensors.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    using namespace genrender;
    fuzz::memory_file const file(std::string_view(reinterpret_cast<char const*>(data), size));
    try {
        reference::safetensors_file const tensors(file.path());
        std::size_t bytes = 0;
        for (auto const& [name, entry] : tensors.entries()) {
            bytes += entry.end - entry.begin;
            try {
                auto const values = tensors.read<float>(name);
                if (values.size() * 2 > entry.end - entry.begin) {
                    std::abort(); // more elements than bytes can hold
                }
            } catch (file_error const&) {
                continue; // of a type that is not read
            }
        }
        if (bytes > size) {
            std::abort(); // tensors overlap
        }
    } catch (file_error const&) {
        return 0;
    }
    return 0;
}
