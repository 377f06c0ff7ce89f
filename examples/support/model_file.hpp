// SPDX-License-Identifier: MIT
// [GR sec. 3] An animated scene from a model file: which of its animations play, at which times, and who looks at them.
#pragma once

#include "assimp_scene.hpp"
#include "gltf_scene.hpp"
#include "model_camera.hpp"
#include "model_report.hpp"
#include "model_scene.hpp"
#include "model_times.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/bounds.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/uv_overlap.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Where a model is looked at from.
enum class model_view {
    automatic, ///< orbiting around a rigid model; an animated one by the file's camera if that sees it, else still
    file,      ///< a camera of the file, whatever it sees
    still,     ///< one camera for all frames, from `azimuth` and `elevation`, that sees every frame
    orbiting,  ///< one turn around the model, which starts at `azimuth`
    fitted     ///< orbiting around a rigid model, still before an animated one
};

/// How a model file becomes an animation.
struct model_options {
    model_time_options time{};
    std::optional<float> aspect{}; ///< width / height of the image; without a value the file's camera's, else 1
    float vertical_fov = 0.6f;     ///< of cameras that are not the file's, radians
    float azimuth = 0.5f;          ///< 0 looks from +z, pi / 2 from +x; radians
    float elevation = 0.3f;        ///< above the ground, radians, in (-pi / 2, pi / 2)
    model_view view = model_view::automatic;
    std::string camera{}; ///< name of the file's camera for `file`; empty: the first that is not orthographic
    model_up up = model_up::from_file;
    model_uvs uvs = model_uvs::from_file;
    std::size_t uv_set = 0; ///< which of a mesh's sets of texture coordinates
};

/// A loaded model: an animation (see scene/animation.hpp). Copies share the file's data, which nobody changes.
class model_animation {
public:
    std::size_t frame_count() const { return times_.seconds.size(); }

    /// Width / height of the image.
    float aspect() const { return aspect_; }

    /// Frames a second of what is shown: those of the options, else what plays the chosen times in real time.
    double frames_per_second() const { return times_.frames_per_second; }

    /// Frame i: every mesh instance is an object, in the order of the file's nodes. Throws value_error beyond the end.
    posed_scene frame(frame_index i) const {
        require_value(i.value < frame_count(), "model_animation", "frame", i.value, "a frame of the animation");
        return {cameras_[i.value], scene_->objects_at(times_.seconds[i.value])};
    }

    model_report const& report() const { return report_; }

private:
    friend model_animation load_model(std::filesystem::path const&, model_options const&);

    model_animation(std::filesystem::path const& path, model_options const& options) : path_(path.string()) {
        scene_ = read_scene(path, {options.uvs, options.uv_set, options.up});
        auto const playing = choose_takes(scene_->takes(), options.time.animation);
        scene_->play(playing);
        times_ = choose_times(*scene_, playing, options.time);
        choose_cameras(!playing.empty(), options);
        report_.animation = times_.name;
        report_.seconds = times_.duration;
        report_.notes.insert(report_.notes.end(), times_.notes.begin(), times_.notes.end());
        report_.notes.insert(report_.notes.end(), scene_->notes().begin(), scene_->notes().end());
        report_.objects = scene_->objects();
        count_overlaps();
        report_.asked_for_uvs = options.uvs == model_uvs::atlas;
    }

    static std::shared_ptr<model_scene> read_scene(std::filesystem::path const& path, model_assembly const& assembly) {
        auto extension = path.extension().string();
        std::transform(extension.begin(), extension.end(), extension.begin(),
                       [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
        if (extension == ".gltf" || extension == ".glb") {
            return std::make_shared<gltf_scene>(path, assembly);
        }
        return std::make_shared<assimp_scene>(path, assembly);
    }

    void count_overlaps() {
        std::map<mesh const*, uv_overlap> counted; // instances share surfaces
        for (auto const& object : scene_->objects_at(times_.seconds[0])) {
            auto const [known, is_new] = counted.try_emplace(object.surface.get());
            if (is_new) {
                known->second = count_uv_overlap(*object.surface, 512);
            }
            report_.objects[object.object.value].overlap = known->second;
        }
    }

    void choose_cameras(bool is_animated, model_options const& options) {
        aspect_ = options.aspect.value_or(1);
        require_value(aspect_ > 0 && std::isfinite(aspect_), "load_model", "options.aspect", aspect_,
                      "width / height above 0");
        require_value(options.vertical_fov > 0 && options.vertical_fov < 3.1f, "load_model", "options.vertical_fov",
                      options.vertical_fov, "an angle between 0 and pi");
        require_value(std::abs(options.elevation) < 1.57f, "load_model", "options.elevation", options.elevation,
                      "an angle between -pi / 2 and pi / 2");

        // Collect where the model is in all frames
        std::vector<glm::vec3> points;
        for (std::size_t i = 0; i < (is_animated ? frame_count() : 1); ++i) {
            for (auto const& object : scene_->objects_at(times_.seconds[i])) {
                for (auto const& p : object.positions) {
                    if (!genrender::detail::is_finite(p)) {
                        throw file_error(path_ +
                                         ": moves vertices to places that are not finite, expected coordinates");
                    }
                    points.push_back(p);
                }
            }
        }
        auto const box = bounds_of(points);
        if (!(box.radius() > 0)) {
            throw file_error(path_ + ": has all its vertices at one point, expected a surface");
        }

        auto const lens = choose_lens(options);
        if (options.view == model_view::file && !(lens && use_lens(*lens, points, box, options))) {
            throw file_error(path_ + ": holds no camera that can be used, expected a perspective camera at a node");
        }
        if (options.view == model_view::automatic && is_animated && lens) {
            use_lens(*lens, points, box, options);
        }
        if (!cameras_.empty()) {
            return;
        }
        try {
            fit_cameras(is_animated, points, options);
        } catch (value_error const& reason) { // of coordinates alone, as the options have been looked at
            throw file_error(path_ + ": no camera can see it (" + reason.what() +
                             "), expected coordinates that numbers of 32 bits tell apart");
        }
    }

    void fit_cameras(bool is_animated, std::span<glm::vec3 const> points, model_options const& options) {
        if (options.view == model_view::still ||
            ((options.view == model_view::automatic || options.view == model_view::fitted) && is_animated)) {
            cameras_.assign(frame_count(), fit_points(points, view_direction(options.azimuth, options.elevation),
                                                      options.vertical_fov, aspect_));
            return;
        }
        cameras_ =
            orbit_cameras(points, options.azimuth, options.elevation, options.vertical_fov, aspect_, frame_count());
    }

    /// The file's camera of that name, else the first that can be rendered from.
    std::optional<std::size_t> choose_lens(model_options const& options) const {
        std::string names;
        for (std::size_t i = 0; i < scene_->lenses().size(); ++i) {
            auto const& lens = scene_->lenses()[i];
            if (options.camera.empty() ? !lens.is_orthographic : lens.name == options.camera) {
                return i;
            }
            names += (names.empty() ? "" : ", ") + lens.name;
        }
        require_value(options.camera.empty(), "load_model", "options.camera", options.camera,
                      names.empty() ? "none, as the file holds no camera" : ("a camera of the file: " + names).c_str());
        return std::nullopt;
    }

    // Returns whether there are cameras now. One that hardly sees the model belongs to a scene that this file is a
    // part of, and one that sees it as a speck, or stands far away with parallel rays, does not show it.
    bool use_lens(std::size_t lens, std::span<glm::vec3 const> points, bounds const& box,
                  model_options const& options) {
        auto const name = scene_->lenses()[lens].name;
        auto const who = "The file's camera" + (name.empty() ? std::string() : " " + name);
        auto const leave = [&](std::string const& reason) {
            report_.notes.push_back(who + reason);
            cameras_.clear();
            return false;
        };
        if (scene_->lenses()[lens].is_orthographic) {
            return leave(" is orthographic, and cannot be rendered from.");
        }
        auto const of_file = scene_->lenses()[lens].aspect;
        auto const aspect = options.aspect.value_or(of_file > 0 ? of_file : 1);
        try {
            for (auto const time : times_.seconds) {
                cameras_.push_back(scene_->eye_at(lens, time, aspect, 1e-3f * box.radius()));
            }
        } catch (value_error const& reason) {
            return leave(std::string(" cannot be used: ") + reason.what() + ".");
        }
        auto const percent = 100 * count_seen(cameras_.front(), points, aspect) / points.size();
        if (options.view == model_view::automatic && percent < 50) {
            return leave(" is not used: it sees " + std::to_string(percent) + " % of the model.");
        }
        auto const filled = filled_share(cameras_.front(), points, aspect);
        if (options.view == model_view::automatic && filled < least_filled_share) {
            char share[16];
            std::snprintf(share, sizeof share, "%.2g", 100 * filled);
            return leave(std::string(" is not used: the model fills ") + share + " % of its picture.");
        }
        aspect_ = aspect;
        report_.notes.push_back("Looks through the file's camera" + (name.empty() ? "" : " " + name) + ", which sees " +
                                std::to_string(percent) + " % of the model.");
        return true;
    }

    std::string path_;
    std::shared_ptr<model_scene> scene_; ///< as it was read and told to play; nobody changes it later
    model_times times_;
    std::vector<camera> cameras_; ///< of each frame
    float aspect_ = 1;
    model_report report_;
};

static_assert(animation<model_animation>);

/// The model in `path`: nodes, skins of up to four joints a vertex and morph targets move as the file says; materials
/// are left out; v is 0 at the texture's top. A mesh without UVs gets an atlas of its triangles. Throws file_error
/// with the reader's reason if the file cannot be read or holds nothing to see, value_error at impossible options.
inline model_animation load_model(std::filesystem::path const& path, model_options const& options = {}) {
    return model_animation(path, options);
}

} // namespace genrender::examples
