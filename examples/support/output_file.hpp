// SPDX-License-Identifier: MIT
// A file being written: it appears under its own name when it is whole, or not at all.
#pragma once

#include <genrender/core/error.hpp>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace genrender::examples {

/// Makes `folder` and its parents. Throws file_error that names the folder if it cannot be made.
inline void make_folder(std::filesystem::path const& folder) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (!std::filesystem::is_directory(folder)) {
        throw file_error(folder.string() + ": is no folder and cannot be made one (" + failure.message() +
                         "), expected a place that can be written");
    }
}

/// Reserves a temporary name beside `path`; `commit()` moves what was written there to `path`, replacing what was there
/// before. Without a commit the temporary file is removed and `path` stays as it was.
class output_file {
public:
    /// Makes the folder of `path` where it is missing. Throws file_error if that folder cannot be written.
    explicit output_file(std::filesystem::path path) : path_(std::move(path)) {
        static std::atomic<unsigned> count{0};
        auto folder = path_.parent_path();
        folder = folder.empty() ? "." : folder;
        make_folder(folder);
        auto name = path_.filename().string();
        for (auto const part : {static_cast<unsigned>(::getpid()), count++}) {
            name += '-' + std::to_string(part);
        }
        name.insert(name.begin(), '.'); // hidden, and no EXR or PNG by its ending
        name += ".part";
        temporary_ = folder / name;
        held_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
        if (held_ < 0) {
            throw file_error(folder.string() + ": cannot be written, expected a folder where files may be made");
        }
        ::flock(held_, LOCK_SH | LOCK_NB); // tells remove_left_parts, for as long as the program lives
    }

    output_file(output_file const&) = delete;
    output_file& operator=(output_file const&) = delete;

    ~output_file() {
        std::error_code ignored;
        std::filesystem::remove(temporary_, ignored);
        ::close(held_);
    }

    /// Where to write.
    std::filesystem::path const& temporary() const { return temporary_; }

    /// Gives the file its name. Throws file_error if it cannot have it.
    void commit() {
        std::error_code failure;
        std::filesystem::rename(temporary_, path_, failure);
        if (failure) {
            throw file_error(path_.string() + ": cannot be replaced (" + failure.message() + "), expected a file name");
        }
    }

    /// The same, and what was written outlives a power failure: when it returns the disk has bytes and name. Throws as
    /// above, and if the disk does not take them.
    void commit_to_disk() {
        sync(held_, temporary_);
        commit();
        auto folder = path_.parent_path();
        folder = folder.empty() ? "." : folder;
        auto const names = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (names >= 0) {
            sync(names, folder);
            ::close(names);
        }
    }

private:
    static void sync(int file, std::filesystem::path const& path) {
        // Some file systems cannot do it, which is no fault of what was written.
        if (::fsync(file) != 0 && errno != EINVAL) {
            throw file_error(path.string() + ": cannot be brought to the disk, expected room and a disk that works");
        }
    }

    std::filesystem::path path_;
    std::filesystem::path temporary_;
    int held_ = -1;
};

/// Removes from a folder what output_files of programs that were killed have left there; those of programs that run stay.
inline void remove_left_parts(std::filesystem::path const& folder) {
    std::error_code ignored;
    for (auto const& entry : std::filesystem::directory_iterator(folder, ignored)) {
        auto const name = entry.path().filename().string();
        if (!name.starts_with('.') || !name.ends_with(".part") || !entry.is_regular_file(ignored)) {
            continue;
        }
        auto const file = ::open(entry.path().c_str(), O_RDONLY | O_CLOEXEC);
        if (file >= 0) {
            if (::flock(file, LOCK_EX | LOCK_NB) == 0) { // Nobody holds it.
                std::filesystem::remove(entry.path(), ignored);
            }
            ::close(file);
        }
    }
}

/// Writes `bytes` as the whole of `path`, or leaves it as it was. Throws file_error if it cannot be written.
inline void write_bytes(std::filesystem::path const& path, std::span<std::uint8_t const> bytes) {
    output_file file(path);
    std::ofstream stream(file.temporary(), std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<char const*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) {
        throw file_error(path.string() + ": not all of its " + std::to_string(bytes.size()) +
                         " bytes could be written, expected room on the disk");
    }
    file.commit();
}

/// Writes `text` as the whole of `path`, as write_bytes does.
inline void write_text(std::filesystem::path const& path, std::string const& text) {
    write_bytes(path, {reinterpret_cast<std::uint8_t const*>(text.data()), text.size()});
}

} // namespace genrender::examples
