// SPDX-License-Identifier: MIT
// A file being written: it appears under its own name when it is whole, or not at all.
#pragma once

#include <genrender/core/error.hpp>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/types.h>
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
        if (!std::ofstream(temporary_, std::ios::binary)) {
            throw file_error(folder.string() + ": cannot be written, expected a folder where files may be made");
        }
    }

    output_file(output_file const&) = delete;
    output_file& operator=(output_file const&) = delete;

    ~output_file() {
        std::error_code ignored;
        std::filesystem::remove(temporary_, ignored);
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
        sync(temporary_, O_WRONLY);
        commit();
        auto const folder = path_.parent_path();
        sync(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
    }

private:
    static void sync(std::filesystem::path const& path, int how) {
        auto const file = ::open(path.c_str(), how | O_CLOEXEC);
        // Some file systems cannot do it for folders, which is no fault of what was written.
        auto const is_done = file >= 0 && (::fsync(file) == 0 || errno == EINVAL);
        if (file >= 0) {
            ::close(file);
        }
        if (!is_done) {
            throw file_error(path.string() + ": cannot be brought to the disk, expected room and a disk that works");
        }
    }

    std::filesystem::path path_;
    std::filesystem::path temporary_;
};

/// Removes from a folder what output_files of programs that were killed have left there; those of programs that run stay.
inline void remove_left_parts(std::filesystem::path const& folder) {
    std::error_code ignored;
    for (auto const& entry : std::filesystem::directory_iterator(folder, ignored)) {
        // .NAME-PROCESS-COUNT.part
        auto const name = entry.path().filename().string();
        auto const count = name.rfind('-');
        auto const process = count == std::string::npos ? count : name.rfind('-', count - 1);
        if (!name.starts_with('.') || !name.ends_with(".part") || process == std::string::npos) {
            continue;
        }
        auto const digits = name.substr(process + 1, count - process - 1);
        pid_t id = 0;
        auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), id);
        if (error == std::errc() && end == digits.data() + digits.size() && id > 0 &&
            (::kill(id, 0) != 0 && errno == ESRCH)) {
            std::filesystem::remove(entry.path(), ignored);
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
