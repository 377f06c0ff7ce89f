// SPDX-License-Identifier: MIT
// A model file as assimp reads it, with what is known to be wrong about that put right or refused.
#pragma once

#include "child_trial.hpp"
#include "fbx_file.hpp"

#include <genrender/core/error.hpp>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

namespace genrender::examples {

/// What assimp makes of a file.
struct assimp_file {
    std::shared_ptr<aiScene const> scene; ///< holds at least one mesh
    std::vector<std::string> notes;       ///< sentences
};

/// Frames a second of an FBX file's author; 24 for a file of another format or one that says nothing.
inline double fbx_frame_rate(aiScene const& scene) {
    // FBX numbers its rates; 0 is what its own programs begin with, 14 a rate that is given apart
    constexpr std::array<double, 19> rates{30, 120, 100,  60,         50, 48, 30, 30,         30 / 1.001, 30 / 1.001,
                                           25, 24,  1000, 24 / 1.001, 0,  96, 72, 60 / 1.001, 120 / 1.001};
    std::int32_t number = 0;
    if (scene.mMetaData == nullptr || !scene.mMetaData->Get("FrameRate", number)) {
        return 24;
    }
    float custom = 0;
    if (number == 14 && scene.mMetaData->Get("CustomFrameRate", custom) && custom > 0) {
        return static_cast<double>(custom);
    }
    auto const known = number >= 0 && static_cast<std::size_t>(number) < rates.size() && number != 14;
    return known ? rates[static_cast<std::size_t>(number)] : 24;
}

namespace detail {

/// Whether FBX's reader made the scene.
inline bool is_fbx(aiScene const& scene) {
    std::int32_t number = 0;
    return scene.mMetaData != nullptr && scene.mMetaData->Get("FrameRate", number);
}

/// The bytes of a file that is called one of FBX; nothing of any other.
inline std::string fbx_bytes(std::filesystem::path const& path) {
    auto extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::error_code unknown;
    if (extension != ".fbx" || !std::filesystem::is_regular_file(path, unknown)) {
        return {};
    }
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Reads and prepares the file, or the bytes in its place, without the meshes that assimp would build around the
/// joints of a lone skeleton; the reason why there is nothing, or an empty text.
inline std::string read_with(Assimp::Importer& importer, std::string const& path,
                             std::optional<std::string> const& instead) {
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    try {
        // Checked later, as a check would refuse a file without meshes in words that say nothing to an artist
        auto const* scene = instead ? importer.ReadFileFromMemory(instead->data(), instead->size(), 0, "fbx")
                                    : importer.ReadFile(path, 0);
        if (scene != nullptr && scene->mNumMeshes > 0) {
            importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_LimitBoneWeights | aiProcess_FlipUVs |
                                         aiProcess_ValidateDataStructure);
        }
    } catch (std::exception const& failure) {
        return failure.what();
    }
    return importer.GetScene() == nullptr ? importer.GetErrorString() : "";
}

/// The name of the reader that assimp takes for files that are called so.
inline std::string reader_of(std::filesystem::path const& path) {
    Assimp::Importer const importer;
    auto const* const reader = importer.GetImporterInfo(importer.GetImporterIndex(path.extension().string().c_str()));
    return reader != nullptr ? reader->mName : "reader";
}

/// What the reading of a file of this size may take: slow readers do a megabyte in seconds, and need a hundred times
/// its size.
inline trial_limits limits_for(std::filesystem::path const& path) {
    std::error_code unknown;
    auto const size = std::filesystem::file_size(path, unknown);
    auto const bytes = unknown ? 0 : static_cast<std::uint64_t>(size);
    return {60 + static_cast<unsigned>(bytes >> 20) * 10, (std::uint64_t(1) << 30) + 200 * bytes};
}

/// How many blend shapes of the meshes at a node and its children no key moves. Keys name the node or the mesh.
inline std::size_t count_still(aiScene const& scene, std::set<std::string> const& moved, aiNode const& node) {
    std::size_t still = 0;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        auto const& mesh = *scene.mMeshes[node.mMeshes[i]];
        auto const is_moved = moved.contains(node.mName.C_Str()) || moved.contains(mesh.mName.C_Str());
        still += is_moved ? 0 : mesh.mNumAnimMeshes;
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
        still += count_still(scene, moved, *node.mChildren[i]);
    }
    return still;
}

/// FBX's reader of assimp 5 gives each blend shape of one target the weight 1, whatever the file says. At rest
/// there are none; keys move them. Returns how many no keys move.
inline std::size_t rest_blend_shapes(aiScene& scene) {
    std::set<std::string> moved;
    for (unsigned i = 0; i < scene.mNumAnimations; ++i) {
        for (unsigned k = 0; k < scene.mAnimations[i]->mNumMorphMeshChannels; ++k) {
            std::string const name = scene.mAnimations[i]->mMorphMeshChannels[k]->mName.C_Str();
            moved.insert(name.substr(0, name.find('*')));
        }
    }
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
        for (unsigned k = 0; k < scene.mMeshes[i]->mNumAnimMeshes; ++k) {
            scene.mMeshes[i]->mAnimMeshes[k]->mWeight = 0;
        }
    }
    return count_still(scene, moved, *scene.mRootNode);
}

} // namespace detail

/// The scene in a file. Throws file_error with assimp's reason if it cannot be read, if its reader crashes, or if it
/// holds no mesh, as a skeleton alone does. assimp's readers crash on some malformed files: each file is read in a
/// child process first, so that this program goes on.
inline assimp_file read_assimp_file(std::filesystem::path const& path) {
    auto const name = path.string();
    auto const refuse = [&](std::string const& reason) {
        throw file_error(name + ": cannot be read as a model (" + reason +
                         "), expected a whole file that assimp knows");
    };
    auto bytes = detail::fbx_bytes(path);
    auto const has_cache = bytes.find("VertexCacheDeformer") != bytes.npos;
    auto const instead = with_straight_curves(bytes); // assimp knows no others
    bytes = {};
    auto const failure = failure_in_child(
        [&] {
            Assimp::Importer importer;
            detail::read_with(importer, name, instead);
        },
        detail::limits_for(path));
    if (failure) {
        refuse("assimp's " + detail::reader_of(path) + " " + *failure);
    }

    Assimp::Importer importer;
    auto const reason = detail::read_with(importer, name, instead);
    std::shared_ptr<aiScene> const scene(importer.GetOrphanedScene());
    if (scene == nullptr || scene->mRootNode == nullptr) {
        refuse(reason);
    }
    if (scene->mNumMeshes == 0) {
        throw file_error(name + (scene->mNumAnimations > 0
                                     ? ": holds no mesh, only a skeleton, expected the surface as well"
                                     : ": holds no triangles, expected a mesh at a node"));
    }

    assimp_file file{scene, {}};
    if (has_cache) {
        file.notes.push_back("The file names a vertex cache, which is not read: what that moves stands still.");
    }
    if (detail::is_fbx(*scene)) {
        if (auto const still = detail::rest_blend_shapes(*scene); still > 0) {
            file.notes.push_back(std::to_string(still) + " blend shapes without keys stay at 0: assimp does not tell "
                                                         "the weights that an FBX file gives them.");
        }
    }
    return file;
}

} // namespace genrender::examples
