// SPDX-License-Identifier: MIT
// One EXR file, scanline or tiled, of one part or many, as named planes of floats over its display window.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace genrender::examples {

/// A channel of an EXR file: where it lies, what it is called with its layer (`ViewLayer.UV.U`), what it stores.
struct exr_channel {
    std::string name;
    std::string name_in_part;
    int part = 0;
    Imf::PixelType type = Imf::FLOAT;
    std::size_t file = 0; ///< of several files of one frame, which
};

/// An open EXR file. Every failure of the EXR library leaves as a file_error that names the file and the library's
/// reason.
class exr_file {
public:
    /// Reads the headers. Throws file_error if the file is missing, foreign, broken, of deep data, or larger than
    /// 2^26 pixels.
    explicit exr_file(std::filesystem::path path) : path_(std::move(path)) {
        guarded([&] { file_ = std::make_unique<Imf::MultiPartInputFile>(path_.c_str(), 0); });
        window_ = file_->header(0).displayWindow();
        require_sensible(window_);
        for (int part = 0; part < file_->parts(); ++part) {
            list_channels(part);
        }
    }

    std::filesystem::path const& path() const { return path_; }
    /// Height and width of the display window, which is what every plane covers.
    grid_extents grid() const { return extents_of(window_); }
    /// The channels of all parts, in the file's order.
    std::vector<exr_channel> const& channels() const { return channels_; }

    /// The channel of that name, or nullptr.
    exr_channel const* find(std::string const& name) const {
        auto const at = std::find_if(channels_.begin(), channels_.end(), [&](auto const& c) { return c.name == name; });
        return at == channels_.end() ? nullptr : &*at;
    }

    /// The texts of all headers by name, such as what renderers say about their passes.
    std::map<std::string, std::string> texts() const {
        std::map<std::string, std::string> result;
        for (int part = 0; part < file_->parts(); ++part) {
            auto const& header = file_->header(part);
            for (auto entry = header.begin(); entry != header.end(); ++entry) {
                if (auto const* const text = dynamic_cast<Imf::StringAttribute const*>(&entry.attribute())) {
                    result.emplace(entry.name(), text->value());
                }
            }
        }
        return result;
    }

    /// The values of one channel, as `planes` gives it.
    std::vector<float> plane(exr_channel const& channel, float outside) const {
        return std::move(planes(std::span(&channel, 1), outside).front());
    }

    /// The values of several channels [height, width] over the display window; what lies outside a channel's data window
    /// is `outside`. 16-bit floats and integers are converted; channels of one part are decompressed together. Throws
    /// file_error if the pixels cannot be read.
    std::vector<std::vector<float>> planes(std::span<exr_channel const> channels, float outside) const {
        std::vector<std::vector<float>> result(channels.size(), std::vector<float>(grid().size(), outside));
        for (int part = 0; part < file_->parts(); ++part) {
            read_part(part, channels, result);
        }
        return result;
    }

private:
    template <class Action>
    void guarded(Action&& action) const {
        try {
            action();
        } catch (file_error const&) {
            throw;
        } catch (std::exception const& reason) {
            throw file_error(path_.string() + ": cannot be read as EXR (" + reason.what() +
                             "), expected a whole OpenEXR file");
        }
    }

    static grid_extents extents_of(Imath::Box2i const& window) {
        return {static_cast<std::size_t>(std::int64_t{window.max.y} - window.min.y + 1),
                static_cast<std::size_t>(std::int64_t{window.max.x} - window.min.x + 1)};
    }

    // Broken headers ask for absurd amounts of memory; nobody renders maps of 2^26 pixels.
    void require_sensible(Imath::Box2i const& window) const {
        auto const grid = extents_of(window);
        if (window.isEmpty() || grid.height > (1u << 26) / grid.width) {
            throw file_error(path_.string() + ": is an image of " + extents_text({grid.height, grid.width}) +
                             " pixels, expected 1 to 2^26 of them");
        }
    }

    void list_channels(int part) {
        auto const& header = file_->header(part);
        if (header.hasType() && Imf::isDeepData(header.type())) {
            throw file_error(path_.string() + ": holds deep data, expected one value a pixel");
        }
        require_sensible(header.dataWindow());
        for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
            std::string const own_name = channel.name();
            // Some writers leave the layer to the part's name: part "ViewLayer.UV", channel "U".
            auto const layer_is_in_part = header.hasName() && own_name.find('.') == std::string::npos &&
                                          header.name().find('.') != std::string::npos;
            channels_.push_back(
                {layer_is_in_part ? header.name() + "." + own_name : own_name, own_name, part, channel.channel().type});
            if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) {
                throw file_error(path_.string() + ": channel " + own_name +
                                 " is subsampled, expected one value a pixel");
            }
        }
    }

    void read_part(int part, std::span<exr_channel const> channels, std::vector<std::vector<float>>& result) const {
        auto const data = file_->header(part).dataWindow();
        auto const stored = extents_of(data);

        // Read the data window of the wanted channels
        Imf::FrameBuffer buffer;
        std::vector<std::pair<std::size_t, std::vector<float>>> read;
        for (std::size_t i = 0; i < channels.size(); ++i) {
            if (channels[i].part == part) {
                read.emplace_back(i, std::vector<float>(stored.size()));
                auto* const pixels = reinterpret_cast<char*>(read.back().second.data());
                buffer.insert(channels[i].name_in_part,
                              Imf::Slice::Make(Imf::FLOAT, pixels, data, sizeof(float), sizeof(float) * stored.width));
            }
        }
        if (read.empty()) {
            return;
        }
        guarded([&] {
            Imf::InputPart input(*file_, part);
            input.setFrameBuffer(buffer);
            input.readPixels(data.min.y, data.max.y);
        });

        // Copy what lies inside the display window
        auto const width = grid().width;
        auto const left = std::max(data.min.x, window_.min.x);
        auto const right = std::min(data.max.x, window_.max.x);
        for (auto y = std::max(data.min.y, window_.min.y); left <= right && y <= std::min(data.max.y, window_.max.y);
             ++y) {
            auto const from =
                static_cast<std::size_t>(y - data.min.y) * stored.width + static_cast<std::size_t>(left - data.min.x);
            auto const to =
                static_cast<std::size_t>(y - window_.min.y) * width + static_cast<std::size_t>(left - window_.min.x);
            for (auto const& [i, pixels] : read) {
                std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(from), right - left + 1,
                            result[i].begin() + static_cast<std::ptrdiff_t>(to));
            }
        }
    }

    std::filesystem::path path_;
    std::unique_ptr<Imf::MultiPartInputFile> file_;
    Imath::Box2i window_;
    std::vector<exr_channel> channels_;
};

} // namespace genrender::examples
