// SPDX-License-Identifier: MIT
// A folder that lives as long as one test.
#pragma once

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

namespace genrender::tests {

/// An empty folder of its own, removed with everything in it.
class scratch_folder {
public:
    scratch_folder() {
        static std::atomic<int> count{0};
        path_ = std::filesystem::temp_directory_path() /
                ("genrender-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    scratch_folder(scratch_folder const&) = delete;
    scratch_folder& operator=(scratch_folder const&) = delete;
    ~scratch_folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    std::filesystem::path const& path() const { return path_; }
    std::filesystem::path operator/(std::string const& name) const { return path_ / name; }

    /// Writes a text file and returns its path.
    std::filesystem::path write(std::string const& name, std::string const& text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
        return path_ / name;
    }

    /// Number of entries in the folder, hidden ones too.
    std::size_t entries() const {
        std::size_t count = 0;
        for (auto const& entry : std::filesystem::directory_iterator(path_)) {
            count += !entry.path().empty();
        }
        return count;
    }

private:
    std::filesystem::path path_;
};

} // namespace genrender::tests
