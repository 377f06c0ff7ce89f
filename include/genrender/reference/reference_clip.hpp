// SPDX-License-Identifier: MIT
// [GR sec. 4: CLIP] A small encoder of images and free texts for the metrics: CLIP with an image tower of convolutions.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/clip_text_config_file.hpp>
#include <genrender/reference/clip_text_encoder.hpp>
#include <genrender/reference/clip_tokenizer.hpp>
#include <genrender/reference/clip_tokenizer_folder.hpp>
#include <genrender/reference/config_file.hpp>
#include <genrender/reference/image_tower.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/safetensors_weights.hpp>
#include <genrender/reference/tensor_place.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::reference {

/// A model of image_text_embedder (Radford et al. 2021): an image_tower for images and CLIP's text encoder for texts,
/// whose row at the end of the text passes a matrix. Vectors have length 1. It takes any text; what it knows of words and
/// things is what examples/miniature/train_embedder.py taught it.
template <std::floating_point Real>
class reference_clip {
public:
    using real_type = Real; ///< type of an embedding's numbers

    /// Takes `text_projection.weight` [projection_dim, channels of the text encoder] and the tensors of an image_tower
    /// from `source`. Throws value_error if the config cannot be built or the text encoder has not a row for each token
    /// of the tokenizer and each place of its prompts, file_error if a tensor is missing, misshapen or of no use.
    reference_clip(image_tower_config const& config, clip_tokenizer tokenizer, clip_text_encoder<Real> text,
                   weights<Real>& source)
        : tokenizer_(std::move(tokenizer)), image_(config, source), text_(std::move(text)),
          text_projection_(source, "text_projection", text_.channels(), config.projection_dim, false) {
        require_value(tokenizer_.size() <= text_.config().vocab_size, "reference_clip", "tokens of the tokenizer",
                      tokenizer_.size(),
                      ("at most the " + std::to_string(text_.config().vocab_size) + " of vocab_size").c_str());
        require_value(tokenizer_.context_length() <= text_.most_tokens(), "reference_clip",
                      "context length of the tokenizer", tokenizer_.context_length(),
                      ("at most the " + std::to_string(text_.most_tokens()) + " of max_position_embeddings").c_str());
        source.require_all_taken();
    }

    /// A folder as examples/miniature/train_embedder.py writes it: config.json with "_class_name": "ReferenceClip", the
    /// fields of an image_tower_config and, as "text_config", those of a clip_text_config; model.safetensors; and the
    /// tokenizer's files. Throws file_error if they do not hold what they should, value_error if the tokenizer is not
    /// the text encoder's.
    static reference_clip from_folder(std::filesystem::path const& folder) {
        config_file file(folder / "config.json");
        file.require(file["_class_name"] == "ReferenceClip", "_class_name", "\"ReferenceClip\"");
        auto const config = read_tower(file);
        file.require(file["text_config"].is_object(), "text_config", "an object of options");
        auto const text_config = read_clip_text_config(config_file(file.path() + ", text_config", file["text_config"]));
        file.ignore({"_class_name", "text_config"});
        file.require_all_taken();
        auto tokenizer = load_clip_tokenizer(folder);
        auto const path = (folder / "model.safetensors").string();
        // The text encoder accounts for all tensors that it is given.
        tensor_places of_text, others;
        auto const all = read_weights<Real>(path);
        for (auto const& [name, place] : all.places()) {
            (name.starts_with("text_model.") ? of_text : others).emplace(name, place);
        }
        auto text_source = weights<Real>::from_places(std::move(of_text), path);
        auto source = weights<Real>::from_places(std::move(others), path);
        return {config, std::move(tokenizer), clip_text_encoder<Real>(text_config, text_source), source};
    }

    /// Length of an embedding.
    std::size_t dimension() const { return image_.config().projection_dim; }
    /// What becomes of a text before the encoder sees it; tells the words that training did not show.
    clip_tokenizer const& tokenizer() const { return tokenizer_; }

    /// The vector of an image [3, height, width] with values in [0, 1]; it was trained on 128 x 128 pixels. Throws
    /// shape_error unless there are three channels and pixels.
    std::vector<Real> embed_image(strided_view<Real const, 3> image) const { return unit_vector(image_(image)); }

    /// What the image tower's last convolution says of each place of an image: [channels, rows, columns], for
    /// perceptual_errors. Takes and throws what embed_image does.
    stack<Real, 3> image_features(strided_view<Real const, 3> image) const { return image_.feature_map(image); }

    /// The vector of a text in UTF-8, of which what exceeds the longest prompt is cut off. Throws value_error if it is
    /// not UTF-8.
    std::vector<Real> embed_text(std::string_view text) const {
        auto const prompt = tokenizer_(text);
        // A row does not depend on those behind it, so padding need not be encoded.
        auto const end = std::find(prompt.ids.begin() + 1, prompt.ids.end(), tokenizer_.end());
        std::vector<std::uint32_t> ids;
        std::transform(prompt.ids.begin(), end, std::back_inserter(ids),
                       [](std::size_t id) { return static_cast<std::uint32_t>(id); });
        ids.push_back(static_cast<std::uint32_t>(tokenizer_.end()));
        auto const rows = text_(ids);
        std::vector<Real> vector(dimension());
        text_projection_(strided_view<Real, 2>(vector.data(), {1, vector.size()}),
                         rows.view().slice(ids.size() - 1, 1));
        return unit_vector(std::move(vector));
    }

private:
    static image_tower_config read_tower(config_file& file) {
        image_tower_config const absent;
        image_tower_config config;
        config.block_out_channels = file.counts("block_out_channels", absent.block_out_channels);
        config.strides = file.counts("strides", absent.strides);
        config.norm_num_groups = file.count("norm_num_groups", absent.norm_num_groups);
        config.norm_eps = file.number("norm_eps", absent.norm_eps);
        config.hidden_size = file.count("hidden_size", absent.hidden_size);
        config.projection_dim = file.count("projection_dim", absent.projection_dim);
        file.require(config.strides.size() == config.block_out_channels.size(), "strides",
                     "as many numbers as block_out_channels has");
        file.require(std::all_of(config.block_out_channels.begin(), config.block_out_channels.end(),
                                 [&](std::size_t channels) { return channels % config.norm_num_groups == 0; }),
                     "block_out_channels",
                     "multiples of the " + std::to_string(config.norm_num_groups) + " of norm_num_groups");
        file.require(config.norm_eps > 0 && config.norm_eps < 1, "norm_eps", "a number in (0, 1)");
        return config;
    }

    /// Divided by its length, which is summed up in double.
    static std::vector<Real> unit_vector(std::vector<Real> vector) {
        double squares = 0;
        for (auto const x : vector) {
            squares += static_cast<double>(x) * static_cast<double>(x);
        }
        auto const length = std::max(std::sqrt(squares), 1e-12);
        for (auto& x : vector) {
            x = static_cast<Real>(static_cast<double>(x) / length);
        }
        return vector;
    }

    clip_tokenizer tokenizer_;
    image_tower<Real> image_;
    clip_text_encoder<Real> text_;
    linear<Real> text_projection_;
};

} // namespace genrender::reference

namespace genrender {

/// The front door of the component lies beside the library's own; its parts stay in namespace reference.
using reference::reference_clip;

} // namespace genrender

#include <genrender/core/end_header.inl>
