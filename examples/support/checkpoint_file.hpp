// SPDX-License-Identifier: MIT
// OUT/checkpoint: where a run was left. It is whole at every moment, or not there.
#pragma once

#include "output_file.hpp"

#include <genrender/core/error.hpp>
#include <genrender/pipeline/checkpoint.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <istream>
#include <string>
#include <system_error>

namespace genrender::examples {

/// The checkpoint of the run in a folder, and what it costs to keep it.
class checkpoint_file {
public:
    explicit checkpoint_file(std::filesystem::path const& out) : path_(out / "checkpoint") {}

    std::filesystem::path const& path() const { return path_; }
    bool exists() const { return std::filesystem::is_regular_file(path_); }

    /// Puts a checkpoint in the place of the one before, on the disk when it returns. Throws file_error if there is no
    /// room; the one before stays then.
    void write(checkpoint<float> const& from) {
        auto const start = std::chrono::steady_clock::now();
        output_file file(path_);
        std::ofstream stream(file.temporary(), std::ios::binary | std::ios::trunc);
        write_checkpoint(stream, from);
        stream.close();
        if (!stream) {
            throw file_error(path_.string() + ": not all of it could be written, expected room on the disk");
        }
        bytes_ = std::filesystem::file_size(file.temporary());
        file.commit_to_disk();
        seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        ++written_;
    }

    /// Throws value_error if there is none, file_error if it cannot be read or was damaged.
    checkpoint<float> read() const {
        require_value(exists(), "--resume", path_.c_str(), "missing",
                      "the checkpoint of a run that was interrupted (one that is done leaves none)");
        try {
            std::ifstream stream(path_, std::ios::binary);
            auto read = read_checkpoint<float>(stream);
            if (stream.peek() != std::ifstream::traits_type::eof()) {
                throw file_error("checkpoint: goes on after its end, expected nothing there");
            }
            return read;
        } catch (file_error const& error) {
            throw file_error(path_.string() + ": " + error.what());
        }
    }

    /// Removes it, if it is there.
    void remove() const {
        std::error_code ignored;
        if (exists()) {
            std::filesystem::remove(path_, ignored);
        }
    }

    /// Bytes of the last one, and seconds that one took to write, on average.
    std::uintmax_t bytes() const { return bytes_; }
    double seconds() const { return written_ > 0 ? seconds_ / static_cast<double>(written_) : 0.0; }

private:
    std::filesystem::path path_;
    std::uintmax_t bytes_ = 0;
    double seconds_ = 0;
    std::size_t written_ = 0;
};

} // namespace genrender::examples
