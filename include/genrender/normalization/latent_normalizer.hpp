// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Latent normalisation of a run, where its latents are: in host memory, or lent by the denoiser's engine.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/normalization/adain.hpp>
#include <genrender/normalization/channel_statistics.hpp>
#include <genrender/sampling/latent_lender.hpp>
#include <genrender/sampling/lent_latents.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// Normalises latents of a run in place by normalize_latents. Refers to the background, which must outlive it.
template <denoiser Phi>
class latent_normalizer {
public:
    using real_type = typename Phi::real_type; ///< scalar of the latents

    /// `background` [frames, height, width] is 1 where no object is.
    latent_normalizer(Phi const&, strided_view<std::uint8_t const, 3> background) : background_(background) {}

    /// Normalises z [frames, channels, height, width], a view or what is viewed by to_view; returns the frames that were
    /// skipped. Throws shape_error if the background does not fit.
    std::vector<std::size_t> operator()(strided_view<real_type, 4> z, adain_settings<real_type> const& settings) const {
        return normalize_latents(z, background_, settings);
    }

private:
    strided_view<std::uint8_t const, 3> background_;
};

/// The same of latents that are lent: downloaded, normalised and uploaded again.
template <latent_lender Phi>
class latent_normalizer<Phi> {
public:
    using real_type = typename Phi::real_type; ///< scalar of the latents

    /// As above.
    latent_normalizer(Phi const&, strided_view<std::uint8_t const, 3> background) : background_(background) {}

    /// Normalises z; returns the frames that were skipped. Throws as above.
    std::vector<std::size_t> operator()(lent_latents<Phi>& z, adain_settings<real_type> const& settings) const {
        std::vector<std::size_t> skipped;
        z.on_host([&](strided_view<real_type, 4> view) { skipped = normalize_latents(view, background_, settings); });
        return skipped;
    }

private:
    strided_view<std::uint8_t const, 3> background_;
};

/// The same by what the engine lends for it: the background is uploaded once, and means and deviations alone leave the
/// engine's memory, but for low bands, for which latents are downloaded and uploaded again.
template <normalizing_lender Phi>
class latent_normalizer<Phi> {
public:
    using real_type = typename Phi::real_type;      ///< scalar of the latents
    using handle_type = typename Phi::latents_type; ///< the engine's handle

    /// As above; uploads nothing before it is asked to normalise.
    latent_normalizer(Phi const& phi, strided_view<std::uint8_t const, 3> background)
        : phi_(&phi), background_(background) {
        for (std::size_t i = 0; i < background.extent(0); ++i) {
            std::size_t pixels = 0;
            for (std::size_t row = 0; row < background.extent(1); ++row) {
                for (std::size_t column = 0; column < background.extent(2); ++column) {
                    pixels += background(i, row, column) != 0 ? std::size_t{1} : std::size_t{0};
                }
            }
            pixels_.push_back(pixels);
        }
    }

    /// Normalises z; returns the frames that were skipped. Throws as above.
    std::vector<std::size_t> operator()(lent_latents<Phi>& z, adain_settings<real_type> const& settings) const {
        auto const frames = z.extents()[0];
        auto const channels = z.extents()[1];
        auto const pixels = z.extents()[2] * z.extents()[3];
        require_shape("latent_normalizer", "background", background_, {frames, z.extents()[2], z.extents()[3]});
        require_adain_settings("latent_normalizer", settings);
        std::vector<std::size_t> skipped;
        if (frames == 0) {
            return skipped;
        }
        if (settings.statistics == adain_statistics::low_band) {
            z.on_host(
                [&](strided_view<real_type, 4> view) { skipped = normalize_latents(view, background_, settings); });
            return skipped;
        }
        auto const of_background = statistics(z, uploaded(on_background_, false), pixels_);
        std::optional<std::vector<channel_statistics<real_type>>> of_all;
        rescaling by(frames, channels);
        skipped = detail::normalize_frames(
            background_, settings,
            [&](std::size_t i, bool of_all_pixels) {
                if (of_all_pixels && !of_all) {
                    of_all = statistics(z, uploaded(everywhere_, true), std::vector<std::size_t>(frames, pixels));
                }
                return of_all_pixels ? (*of_all)[i] : of_background[i];
            },
            [&](std::size_t i, channel_statistics<real_type> const& from, channel_statistics<real_type> const& to) {
                for (std::size_t c = 0; c < channels; ++c) {
                    by.mean_from(i, c) = from.mean[c];
                    by.scale(i, c) = to.deviation[c] / from.deviation[c];
                    by.mean_to(i, c) = to.mean[c];
                }
                by.changes = true;
            });
        if (by.changes) {
            z.assign(phi_->rescaled(z.handle(), std::as_const(by.mean_from).view(), std::as_const(by.scale).view(),
                                    std::as_const(by.mean_to).view()));
        }
        return skipped;
    }

private:
    using table = stack<real_type, 2>; ///< [frames, channels]

    /// What leaves all latents as they are, until it is told otherwise.
    struct rescaling {
        table mean_from;
        table scale;
        table mean_to;
        bool changes = false;
        rescaling(std::size_t frames, std::size_t channels)
            : mean_from({frames, channels}), scale({frames, channels}), mean_to({frames, channels}) {
            std::fill_n(scale.data(), scale.size(), real_type{1});
        }
    };

    /// The pixels that count as a handle [frames, 1, height, width], uploaded by the first who asks.
    handle_type const& uploaded(std::optional<handle_type>& kept, bool all_pixels) const {
        if (!kept) {
            auto const& [frames, height, width] = background_.extents();
            stack<real_type, 4> w({frames, 1, height, width});
            for (std::size_t i = 0; i < frames; ++i) {
                for (std::size_t row = 0; row < height; ++row) {
                    for (std::size_t column = 0; column < width; ++column) {
                        w(i, 0, row, column) = all_pixels || background_(i, row, column) != 0 ? 1 : 0;
                    }
                }
            }
            kept.emplace(phi_->upload(std::as_const(w).view()));
        }
        return *kept;
    }

    /// Of each frame, over so many pixels.
    std::vector<channel_statistics<real_type>> statistics(lent_latents<Phi> const& z, handle_type const& w,
                                                          std::vector<std::size_t> const& pixels) const {
        auto const frames = z.extents()[0];
        auto const channels = z.extents()[1];
        table mean({frames, channels});
        table deviation({frames, channels});
        phi_->channel_statistics(mean.view(), deviation.view(), z.handle(), w);
        std::vector<channel_statistics<real_type>> of_frames;
        for (std::size_t i = 0; i < frames; ++i) {
            if (pixels[i] < 2) { // As masked_statistics has it.
                of_frames.push_back(
                    {std::vector<real_type>(channels, 0), std::vector<real_type>(channels, 1), pixels[i]});
                continue;
            }
            auto const begin = static_cast<std::ptrdiff_t>(i * channels);
            auto const end = begin + static_cast<std::ptrdiff_t>(channels);
            of_frames.push_back({{mean.data() + begin, mean.data() + end},
                                 {deviation.data() + begin, deviation.data() + end},
                                 pixels[i]});
        }
        return of_frames;
    }

    Phi const* phi_;
    strided_view<std::uint8_t const, 3> background_;
    std::vector<std::size_t> pixels_; // of the background, by frame
    mutable std::optional<handle_type> on_background_{};
    mutable std::optional<handle_type> everywhere_{};
};

} // namespace genrender

#include <genrender/core/end_header.inl>
