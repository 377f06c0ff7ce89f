// SPDX-License-Identifier: MIT
// One frame of EXR files: the channels of one file, or of files of single passes under the names of one file of all.
#pragma once

#include "exr_file.hpp"
#include "exr_folder.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// The open files of one frame. Failures leave as file_errors that name the file.
class exr_frame {
public:
    /// Opens the files. Throws file_error where `exr_file` does, or if they differ in size.
    explicit exr_frame(exr_frame_files const& files) {
        for (auto const& file : files) {
            files_.emplace_back(file.path);
            if (files_.back().grid() != grid()) {
                throw file_error(file.path.string() + ": is " +
                                 extents_text({files_.back().grid().height, files_.back().grid().width}) +
                                 ", expected " + extents_text({grid().height, grid().width}) + " as in " +
                                 path().filename().string());
            }
            for (auto channel : named(file, files_.back().channels())) {
                channel.file = files_.size() - 1;
                channels_.push_back(std::move(channel));
            }
        }
    }

    /// The first file, which stands for the frame in sentences.
    std::filesystem::path const& path() const { return files_.front().path(); }
    /// Height and width of the display window.
    grid_extents grid() const { return files_.front().grid(); }
    /// The channels of all files.
    std::vector<exr_channel> const& channels() const { return channels_; }

    /// The channel of that name in upper or lower case, or nullptr.
    exr_channel const* find(std::string const& name) const {
        auto const wanted = detail::lower_case(name);
        auto const at = std::find_if(channels_.begin(), channels_.end(),
                                     [&](auto const& c) { return detail::lower_case(c.name) == wanted; });
        return at == channels_.end() ? nullptr : &*at;
    }

    /// The names of all channels as text: `A, B, C`.
    std::string channel_names() const {
        std::string text;
        for (auto const& channel : channels_) {
            text += (text.empty() ? "" : ", ") + channel.name;
        }
        return text.empty() ? "no channels" : text;
    }

    /// The texts of all headers by name.
    std::map<std::string, std::string> texts() const {
        std::map<std::string, std::string> result;
        for (auto const& file : files_) {
            result.merge(file.texts());
        }
        return result;
    }

    /// The values of several channels [height, width], each as `exr_file::planes` gives it.
    std::vector<std::vector<float>> planes(std::span<exr_channel const> channels, float outside) const {
        std::vector<std::vector<float>> result(channels.size());
        for (std::size_t file = 0; file < files_.size(); ++file) {
            std::vector<exr_channel> wanted;
            std::vector<std::size_t> places;
            for (std::size_t i = 0; i < channels.size(); ++i) {
                if (channels[i].file == file) {
                    wanted.push_back(channels[i]);
                    places.push_back(i);
                }
            }
            auto read = files_[file].planes(wanted, outside);
            for (std::size_t i = 0; i < places.size(); ++i) {
                result[places[i]] = std::move(read[i]);
            }
        }
        return result;
    }

private:
    using components = std::vector<std::string>;

    /// The channels of a file under the names that they have in a file of all passes; those of other components of a
    /// single pass are left out, unless none is known.
    static std::vector<exr_channel> named(exr_pass_file const& file, std::vector<exr_channel> const& channels) {
        auto const vectors = std::vector<std::pair<components, components>>{
            {{"u", "v", "a"}, {"U", "V", "A"}}, {{"x", "y", "z"}, {"X", "Y", "Z"}}, {{"r", "g", "b"}, {"X", "Y", "Z"}}};
        auto const scalars = std::vector<std::pair<components, components>>{
            {{"v"}, {"V"}}, {{"z"}, {"V"}}, {{"x"}, {"V"}}, {{"r"}, {"V"}}, {{"y"}, {"V"}}};
        if (file.pass.empty()) {
            return channels;
        }
        auto const prefix = (file.layer.empty() ? "" : file.layer + ".") + file.pass + ".";
        auto const is_vector = file.pass != "Depth" && file.pass != "IndexOB";
        std::vector<exr_channel> result;
        for (auto const& [from, to] : is_vector ? vectors : scalars) {
            for (std::size_t i = 0; i < from.size(); ++i) {
                for (auto const& channel : channels) {
                    auto const dot = channel.name.rfind('.');
                    auto const component = channel.name.substr(dot == std::string::npos ? 0 : dot + 1);
                    if (detail::lower_case(component) == from[i] && result.size() <= i) {
                        result.push_back(channel);
                        result.back().name = prefix + to[i];
                    }
                }
            }
            if (result.size() >= std::min<std::size_t>(from.size(), 2)) {
                return result;
            }
            result.clear();
        }
        if (!is_vector && channels.size() == 1) { // under any name
            result = channels;
            result.front().name = prefix + "V";
            return result;
        }
        return channels;
    }

    std::vector<exr_file> files_;
    std::vector<exr_channel> channels_;
};

} // namespace genrender::examples
