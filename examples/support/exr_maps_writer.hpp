// SPDX-License-Identifier: MIT
// [GR sec. 3] UV and depth maps into a folder of EXR files, one a frame, in Blender's channel names or the plain ones.
#pragma once

#include "exr_layout.hpp"
#include "output_file.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace genrender::examples {

/// How maps are written.
struct exr_write_options {
    exr_layout layout = exr_layout::blender;
    std::string layer = "ViewLayer"; ///< Blender layout: the view layer's name
    bool multipart = false;          ///< Blender layout: one part a pass, as newer Blender versions write
    std::optional<bool>
        v_upwards{};           ///< write 1 - v; without a value true for Blender's layout, false for the plain one
    unsigned first_number = 1; ///< number of the first file: `0001.exr`
};

namespace detail {

/// A channel to be written, with the part it belongs to.
struct exr_output_plane {
    std::string part;
    std::string name;
    std::vector<float> values;
};

/// The channels of one frame. Background is what Cycles writes (UV 0, alpha 0, depth 1e10, index 0) or u v 0, id -1,
/// depth 1e10.
inline std::vector<exr_output_plane> exr_planes_of(uv_maps const& uv, depth_maps const& depth,
                                                   tensor<float, 4> const& position, std::size_t frame,
                                                   exr_write_options const& options) {
    auto const size = uv.grid().size();
    auto const is_plain = options.layout == exr_layout::plain;
    auto const layer = is_plain || options.layer.empty() ? std::string{} : options.layer + ".";
    auto const plane = [&](char const* pass, char const* component, char const* plain, float background) {
        auto const name = is_plain ? std::string(plain) : layer + pass + "." + component;
        return exr_output_plane{is_plain ? "" : layer + pass, name, std::vector<float>(size, background)};
    };
    std::vector<exr_output_plane> planes;
    planes.push_back(plane("UV", "U", "u", 0));
    planes.push_back(plane("UV", "V", "v", 0));
    planes.push_back(plane("IndexOB", "X", "id", is_plain ? -1.0f : 0.0f));
    planes.push_back(plane("Depth", "Z", "depth", 1e10f));
    if (!is_plain) {
        planes.push_back(plane("UV", "A", "", 0));
    }
    auto const first_position = planes.size();
    auto const has_position = frame < position.shape()[0];
    if (has_position) {
        planes.push_back(plane("Rest", "X", "x", 0));
        planes.push_back(plane("Rest", "Y", "y", 0));
        planes.push_back(plane("Rest", "Z", "z", 0));
    }
    auto const v_upwards = options.v_upwards.value_or(!is_plain);
    auto const begin = frame * size;
    for (std::size_t i = 0; i < size; ++i) {
        if (uv.coverage.data()[begin + i] == 0) {
            continue;
        }
        auto const v = uv.uv.data()[2 * (begin + i) + 1];
        planes[0].values[i] = uv.uv.data()[2 * (begin + i)];
        planes[1].values[i] = v_upwards ? 1 - v : v;
        planes[2].values[i] = static_cast<float>(uv.object.data()[begin + i]);
        planes[3].values[i] = depth.depth.data()[begin + i];
        if (!is_plain) {
            planes[4].values[i] = 1;
        }
        for (std::size_t axis = 0; has_position && axis < 3; ++axis) {
            planes[first_position + axis].values[i] = position.data()[3 * (begin + i) + axis];
        }
    }
    return planes;
}

/// Writes planes of 32-bit floats, in one part or in one part a name of `exr_output_plane::part`.
inline void write_exr_planes(std::filesystem::path const& path, std::vector<exr_output_plane> const& planes,
                             grid_extents grid, bool multipart) {
    std::vector<Imf::Header> headers;
    std::vector<Imf::FrameBuffer> buffers;
    for (auto const& plane : planes) {
        std::size_t part = 0;
        while (part < headers.size() && multipart && headers[part].name() != plane.part) {
            ++part;
        }
        if (part == headers.size()) {
            headers.emplace_back(static_cast<int>(grid.width), static_cast<int>(grid.height));
            headers.back().compression() = Imf::ZIP_COMPRESSION;
            headers.back().setType(Imf::SCANLINEIMAGE);
            if (multipart) {
                headers.back().setName(plane.part);
            }
            buffers.emplace_back();
        }
        headers[part].channels().insert(plane.name, Imf::Channel(Imf::FLOAT));
        auto* const pixels = reinterpret_cast<char*>(const_cast<float*>(plane.values.data())); // the library only reads
        buffers[part].insert(plane.name, Imf::Slice(Imf::FLOAT, pixels, sizeof(float), sizeof(float) * grid.width));
    }
    output_file file(path);
    try {
        Imf::MultiPartOutputFile output(file.temporary().c_str(), headers.data(), static_cast<int>(headers.size()),
                                        false, 0);
        for (std::size_t part = 0; part < headers.size(); ++part) {
            Imf::OutputPart target(output, static_cast<int>(part));
            target.setFrameBuffer(buffers[part]);
            target.writePixels(static_cast<int>(grid.height));
        }
    } catch (std::exception const& reason) {
        throw file_error(path.string() + ": cannot be written (" + reason.what() + "), expected room on the disk");
    }
    file.commit();
}

} // namespace detail

/// Writes one 32-bit float EXR file a frame into `folder` (made if missing), named by number, each whole or not at
/// all, and returns their paths; rest positions [frames, height, width, 3] too, unless `position` has no frames;
/// `load_exr_sequence` gives the same maps back (v to the rounding of 1 - v). Throws
/// shape_error if the maps differ in extents, value_error if they differ in coverage, a covered depth is not in (0,
/// 1e10) or an object index is 2^24 or more (a float cannot hold it), file_error if the folder cannot be written.
inline std::vector<std::filesystem::path>
write_exr_maps(std::filesystem::path const& folder, uv_maps const& uv, depth_maps const& depth,
               exr_write_options const& options = {},
               tensor<float, 4> const& position = tensor<float, 4>::from_shape({0, 0, 0, 3})) {
    if (position.shape()[0] > 0) {
        auto const& e = uv.coverage.shape();
        require_extents("write_exr_maps", "position", position.shape(),
                        std::array<std::size_t, 4>{e[0], e[1], e[2], 3});
    }
    require_extents("write_exr_maps", "depth.depth", depth.depth.shape(), uv.coverage.shape());
    require_extents("write_exr_maps", "depth.coverage", depth.coverage.shape(), uv.coverage.shape());
    for (std::size_t i = 0; i < uv.coverage.size(); ++i) {
        auto const is_covered = uv.coverage.data()[i] != 0;
        require_value(is_covered == (depth.coverage.data()[i] != 0), "write_exr_maps", "depth.coverage", !is_covered,
                      "the coverage of uv");
        auto const z = depth.depth.data()[i];
        require_value(!is_covered || (z > 0 && z < 1e10f), "write_exr_maps", "depth.depth", z,
                      "above 0 and below 1e10");
        auto const object = uv.object.data()[i];
        require_value(!is_covered || object < 16777216, "write_exr_maps", "uv.object", object, "below 2^24");
    }
    make_folder(folder);
    std::vector<std::filesystem::path> files;
    for (std::size_t frame = 0; frame < uv.frame_count(); ++frame) {
        auto number = std::to_string(options.first_number + frame);
        number.insert(0, number.size() < 4 ? 4 - number.size() : 0, '0');
        files.push_back(folder / (number + ".exr"));
        detail::write_exr_planes(files.back(), detail::exr_planes_of(uv, depth, position, frame, options), uv.grid(),
                                 options.multipart && options.layout == exr_layout::blender);
    }
    return files;
}

} // namespace genrender::examples
