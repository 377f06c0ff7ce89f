// SPDX-License-Identifier: MIT
// Small EXR files and maps for the tests of their readers and writers.
#pragma once

#include <examples/support/exr_maps.hpp>

#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <string>
#include <utility>
#include <vector>

namespace genrender::tests {

/// One channel of a file: its name, its stored type, its values [height, width] over the data window.
struct exr_test_channel {
    std::string name;
    std::vector<float> values;
    Imf::PixelType type = Imf::FLOAT;
};

/// Writes a one-part file; values are converted to the stored types.
inline void write_exr(std::filesystem::path const& path, Imath::Box2i display, Imath::Box2i data,
                      std::vector<exr_test_channel> const& channels, bool tiled = false) {
    Imf::Header header(display, data);
    Imf::FrameBuffer buffer;
    auto const width = static_cast<std::size_t>(data.max.x - data.min.x + 1);
    auto const height = static_cast<std::size_t>(data.max.y - data.min.y + 1);
    std::vector<std::vector<half>> halves;
    std::vector<std::vector<unsigned>> integers;
    halves.reserve(channels.size());
    integers.reserve(channels.size());
    for (auto const& channel : channels) {
        header.channels().insert(channel.name, Imf::Channel(channel.type));
        void const* pixels = channel.values.data();
        std::size_t size = sizeof(float);
        if (channel.type == Imf::HALF) {
            pixels = halves.emplace_back(channel.values.begin(), channel.values.end()).data();
            size = sizeof(half);
        } else if (channel.type == Imf::UINT) {
            auto& values = integers.emplace_back();
            for (auto const value : channel.values) {
                values.push_back(static_cast<unsigned>(value));
            }
            pixels = values.data();
        }
        buffer.insert(channel.name, Imf::Slice::Make(channel.type, pixels, data, size, size * width));
    }
    if (tiled) {
        header.setTileDescription(Imf::TileDescription(2, 2, Imf::ONE_LEVEL));
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(buffer);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(static_cast<int>(height));
    }
}

/// A window of `height` x `width` whose top left pixel is (top, left).
inline Imath::Box2i window(int height, int width, int top = 0, int left = 0) {
    return {Imath::V2i(left, top), Imath::V2i(left + width - 1, top + height - 1)};
}

/// A 1 x 2 Blender frame of one layer: left pixel covered (u 0.3, v 0.7, object 4, depth 2), right pixel background.
inline std::vector<exr_test_channel> blender_frame(std::string const& layer = "ViewLayer") {
    return {{layer + ".UV.U", {0.3f, 0}},   {layer + ".UV.V", {0.7f, 0}},     {layer + ".UV.A", {1, 0}},
            {layer + ".IndexOB.X", {4, 0}}, {layer + ".Depth.Z", {2, 1e10f}}, {layer + ".Combined.R", {0.5f, 0.5f}}};
}

/// Two frames of 3 x 5 with two objects, background and coordinates that need all 24 bits.
inline std::pair<uv_maps, depth_maps> two_frames() {
    std::pair<uv_maps, depth_maps> maps{uv_maps(2, {3, 5}), depth_maps(2, {3, 5})};
    for (std::size_t i = 0; i < maps.first.coverage.size(); ++i) {
        if (i % 4 == 3) {
            continue;
        }
        auto const x = static_cast<float>(i);
        maps.first.coverage.data()[i] = 1;
        maps.first.object.data()[i] = i % 3 == 0 ? 16777215u : 1u;
        maps.first.uv.data()[2 * i] = (x + 0.1234567f) / 31;
        maps.first.uv.data()[2 * i + 1] = 1 - (x + 0.7654321f) / 37;
        maps.second.coverage.data()[i] = 1;
        maps.second.depth.data()[i] = 0.1f + x * x;
    }
    return maps;
}

} // namespace genrender::tests
