// SPDX-License-Identifier: MIT
// [GR sec. 4: CLIP] A small encoder of images and prompts for the metrics, trained on renders of known prompts.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/activation.hpp>
#include <genrender/reference/config_file.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/feature_maps.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/prompt_vocabulary.hpp>
#include <genrender/reference/safetensors_weights.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::reference {

/// A model of image_text_embedder. Images pass four convolutions with GroupNorm and SiLU, all but the first halving
/// height and width, the mean over pixels and a matrix; texts are the mean of their words' vectors, the start of every
/// prompt among them, and a matrix. Vectors have length 1. Its words are those of its training
/// (examples/reference_denoiser/train_embedder.py), its measure of likeness theirs.
template <std::floating_point Real>
class reference_embedder {
public:
    using real_type = Real; ///< type of an embedding's numbers

    /// Takes `image.blocks.N.conv`, `image.blocks.N.norm`, `image.projection`, `text.embedding.weight` [1 + words,
    /// dimension] and `text.projection`. Throws file_error if one is missing, misshapen or of no use.
    reference_embedder(weights<Real>& source, std::vector<std::string> words, std::size_t dimension = 64)
        : words_(std::move(words)), blocks_(take_blocks(source)),
          image_projection_(source, "image.projection", block_channels.back(), dimension),
          embedding_({words_.size() + 1, dimension}),
          text_projection_(source, "text.projection", dimension, dimension) {
        auto const values = source.take("text.embedding.weight", {words_.size() + 1, dimension});
        std::copy(values.begin(), values.end(), embedding_.data());
        source.require_all_taken();
    }

    /// A folder as train_embedder.py writes it: `config.json`, which is {"_class_name": "PromptEmbedder", "words":
    /// ["stripes", ...], "dimension": 64}, and `model.safetensors`. Throws file_error if they do not hold what they
    /// should.
    static reference_embedder from_folder(std::filesystem::path const& folder) {
        config_file file(folder / "config.json");
        file.require(file["_class_name"] == "PromptEmbedder", "_class_name", "\"PromptEmbedder\"");
        auto words = file.texts("words", {});
        for (auto const& word : words) {
            auto const is_fine = internal::is_prompt_word(word) && std::count(words.begin(), words.end(), word) == 1;
            file.require(is_fine, "words", "words of lower-case letters and digits, each once");
        }
        file.require(!words.empty(), "words", "at least one");
        auto const dimension = file.count("dimension", 64);
        file.ignore({"_class_name"});
        file.require_all_taken();
        auto source = read_weights<Real>((folder / "model.safetensors").string());
        return reference_embedder(source, std::move(words), dimension);
    }

    /// Length of an embedding.
    std::size_t dimension() const { return embedding_.extent(1); }
    /// The words it knows.
    std::vector<std::string> const& words() const { return words_; }

    /// The vector of an image [3, height, width] with values in [0, 1]; it was trained on 64 x 64 pixels. Throws
    /// shape_error unless there are three channels and pixels.
    std::vector<Real> embed_image(strided_view<Real const, 3> image) const {
        require_shape("embed_image", "image", image,
                      {3, std::max<std::size_t>(1, image.extent(1)), std::max<std::size_t>(1, image.extent(2))});
        feature_maps<Real> x(1, {image.extent(1), image.extent(2)}, 3);
        copy(x.channels_first()[0], image);
        std::for_each(x[0].data(), x[0].data() + x[0].size(), [](Real& value) { value = 2 * value - 1; });
        for (auto const& [conv, norm] : blocks_) {
            feature_maps<Real> y(1, conv.out_grid(x.grid()), conv.out_channels());
            conv(y[0], x[0], x.grid());
            norm(y[0], y[0]);
            silu(std::span<Real>(y[0].data(), y[0].size()));
            x = std::move(y);
        }
        return unit_vector(image_projection_, std::as_const(x)[0]);
    }

    /// The vector of a text. Throws value_error as prompt_rows does, naming a word that it does not know.
    std::vector<Real> embed_text(std::string_view text) const {
        auto const rows = prompt_rows(text, words_);
        stack<Real, 2> tokens({rows.size(), dimension()});
        for (std::size_t i = 0; i < rows.size(); ++i) {
            copy(tokens.view()[i], strided_view<Real const, 1>(embedding_.view()[rows[i]]));
        }
        return unit_vector(text_projection_, tokens.view());
    }

private:
    struct block {
        conv2d<Real> conv;
        group_norm<Real> norm;
    };

    static constexpr std::array<std::size_t, 4> block_channels{24, 48, 96, 96};
    static constexpr std::size_t norm_groups = 8;

    static std::vector<block> take_blocks(weights<Real>& source) {
        std::vector<block> blocks;
        std::size_t in = 3;
        for (auto const out : block_channels) {
            auto const name = "image.blocks." + std::to_string(blocks.size());
            auto const stride = blocks.empty() ? 1U : 2U;
            blocks.push_back({conv2d<Real>(source, name + ".conv", in, out, 3, stride),
                              group_norm<Real>(source, name + ".norm", out, norm_groups, Real(1e-5))});
            in = out;
        }
        return blocks;
    }

    /// The mean of the rows of `in` through a matrix, then divided by its length; sums in double.
    static std::vector<Real> unit_vector(linear<Real> const& projection, strided_view<Real const, 2> in) {
        auto const rows = static_cast<double>(in.extent(0));
        stack<Real, 2> mean({1, in.extent(1)});
        for (std::size_t c = 0; c < in.extent(1); ++c) {
            double sum = 0;
            for (std::size_t row = 0; row < in.extent(0); ++row) {
                sum += static_cast<double>(in(row, c));
            }
            mean(0, c) = static_cast<Real>(sum / rows);
        }
        std::vector<Real> vector(projection.out_channels());
        projection(strided_view<Real, 2>(vector.data(), {1, vector.size()}), mean);
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

    std::vector<std::string> words_;
    std::vector<block> blocks_;
    linear<Real> image_projection_;
    stack<Real, 2> embedding_;
    linear<Real> text_projection_;
};

} // namespace genrender::reference

namespace genrender {

/// The front door of the component lies beside the library's own; its parts stay in namespace reference.
using reference::reference_embedder;

} // namespace genrender

#include <genrender/core/end_header.inl>
