// SPDX-License-Identifier: MIT
// Bytes as a file that lies in memory, for readers that take a path.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include <sys/mman.h>
#include <unistd.h>

namespace genrender::fuzz {

/// A file of these bytes until the end of its life.
class memory_file {
public:
    explicit memory_file(std::string_view bytes) : descriptor_(memfd_create("genrender", 0)) {
        while (!bytes.empty()) {
            auto const written = write(descriptor_, bytes.data(), bytes.size());
            if (written <= 0) {
                std::abort();
            }
            bytes.remove_prefix(static_cast<std::size_t>(written));
        }
    }
    memory_file(memory_file const&) = delete;
    memory_file& operator=(memory_file const&) = delete;
    ~memory_file() { close(descriptor_); }

    std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

private:
    int descriptor_;
};

/// A safetensors file of an input that is its header, a line feed, and its data: the length in front, which chance would
/// hardly find, is made to fit.
inline std::string with_header_length(std::span<std::uint8_t const> input) {
    std::string_view const text(reinterpret_cast<char const*>(input.data()), input.size());
    auto const end = text.find('\n');
    auto const header = text.substr(0, end);
    std::uint64_t const length = header.size();
    std::string file(reinterpret_cast<char const*>(&length), sizeof length);
    file += header;
    file += end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    return file;
}

} // namespace genrender::fuzz
