// SPDX-License-Identifier: MIT
// What a run leaves after each of its steps: the checkpoint, and now and then a preview.
#pragma once

#include "checkpoint_file.hpp"
#include "frame_extents.hpp"
#include "guidance_source.hpp"
#include "output_file.hpp"
#include "picture_model.hpp"
#include "pictures.hpp"
#include "render_options.hpp"
#include "render_output.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/fingerprint.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/pipeline/finished_step.hpp>
#include <genrender/version.hpp>

#include <cstddef>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Frames [frames, 3, height, width] in [0, 1] as pictures.
inline std::vector<rgb8_image> pictures_of(tensor<float, 4> const& images) {
    std::vector<rgb8_image> frames;
    for (std::size_t i = 0; i < images.shape()[0]; ++i) {
        frames.push_back(rgb_picture(to_view(images)[i]));
    }
    return frames;
}

/// What tells the denoiser of a run from others: the model with its prompt, the depth, and the version of the library.
inline std::string key_of(guidance_source const& source, picture_model const& model) {
    fingerprint depth;
    auto const& maps = source.guidance.depth;
    for (std::size_t p = 0; p < maps.depth.size(); ++p) {
        auto const is_covered = maps.coverage.data()[p] != 0;
        depth.add(is_covered ? maps.depth.data()[p] : -1.0F);
    }
    auto const& image = source.extents.rendered;
    return model.key() + " " + extents_text({image.height, image.width}) + " " + std::to_string(depth.value()) +
           " " GENRENDER_VERSION_STRING;
}

/// Writes after steps of a run. A disk that has no room is said once; the run goes on, and the checkpoint that there is
/// stays.
class kept_steps {
public:
    /// Frames are previewed in the extents `shown`. Refers to options and model.
    kept_steps(render_options const& options, picture_model const& model, grid_extents shown, any_loop loop)
        : options_(&options), model_(&model), shown_(shown), loop_(std::move(loop)), file_(options.out) {
        for (auto const& folder : {options.out, options.out / "frames", options.out / "maps"}) {
            remove_left_parts(folder);
        }
    }

    /// Told of every step that is done.
    void operator()(finished_step<float> const& step) {
        try {
            file_.write(step.make_checkpoint());
            if (options_->preview > 0 && (step.number() + 1) % options_->preview == 0) {
                auto const images = with_extents(model_->pictures(step.estimates(), loop_), shown_);
                write_preview(options_->out, pictures_of(images));
            }
        } catch (file_error const& error) {
            if (!has_warned_) {
                std::cerr << "\nnote: " << error.what() << "\n";
            }
            has_warned_ = true;
        }
    }

    /// The checkpoint, and what it costs.
    checkpoint_file const& file() const { return file_; }
    /// What a person is told after Ctrl-C; `resumes` is whether the run went on from a checkpoint, `again` the command that
    /// does.
    std::string last_words(bool resumes, std::string const& again) const {
        return resumes || file_.bytes() > 0 ? "interrupted: " + file_.path().string() +
                                                  " has all steps that are done; go on with\n    " + again + "\n"
                                            : "interrupted: no step was done, so that there is nothing to go on from\n";
    }

private:
    render_options const* options_;
    picture_model const* model_;
    grid_extents shown_;
    any_loop loop_;
    checkpoint_file file_;
    bool has_warned_ = false;
};

} // namespace genrender::examples
