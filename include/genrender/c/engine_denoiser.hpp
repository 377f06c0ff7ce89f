// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] A table of functions of C as a denoiser.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_processor.hpp>
#include <genrender/c/engine.h>
#include <genrender/c/engine_call.hpp>
#include <genrender/core/error.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::c {

namespace detail {

/// A processor of C++ as the engine sees it, for one call of denoise. What is thrown while the engine is on the way is
/// kept until it has returned.
template <class Processor>
class engine_pass {
public:
    engine_pass(genrender_engine const& engine, Processor& processor)
        : table_{this, &run, &inputs, &record, &fail}, engine_(&engine), processor_(&processor) {}
    engine_pass(engine_pass const&) = delete;
    engine_pass& operator=(engine_pass const&) = delete;

    genrender_processor const* table() const { return &table_; }

    /// Throws what ended the call, if `code` says that something did.
    void finish(int code) const {
        if (failure_) {
            std::rethrow_exception(failure_);
        }
        if (code != 0) {
            throw engine_error("engine: " + (text_.empty() ? "denoise failed without a word" : text_));
        }
    }

private:
    static engine_pass& self(genrender_processor const* table) { return *static_cast<engine_pass*>(table->context); }

    template <class Work>
    bool succeeds(Work const& work) noexcept {
        try {
            work();
            return true;
        } catch (...) {
            std::lock_guard const lock(mutex_);
            if (!failure_) {
                failure_ = std::current_exception();
            }
            return false;
        }
    }

    static constexpr bool is_for_graphs = feature_io_processor<Processor, engine_features, float>;

    feature_inputs<engine_features, float> inputs_of([[maybe_unused]] attention_place place,
                                                     [[maybe_unused]] std::span<frame_index const> frames) const {
        if constexpr (is_for_graphs) {
            graph_abilities const able{.scales_logits = engine_->scales_logits != 0};
            return inputs_for<engine_features, float>(std::as_const(*processor_), place, frames, able);
        } else {
            throw value_error("engine_denoiser: the processor has no inputs_at(processor, place, frames), expected a "
                              "feature_io_processor for an engine that asks for inputs");
        }
    }

    engine_features output_of([[maybe_unused]] engine_call& call) const {
        if constexpr (attention_processor<Processor, engine_call>) {
            return (*processor_)(call);
        } else {
            throw value_error("engine_denoiser: the processor has no operator()(call), expected an attention_processor "
                              "for an engine that calls back");
        }
    }

    static genrender_features* run(genrender_processor const* table, genrender_call const* call) {
        auto& pass = self(table);
        genrender_features* F = nullptr;
        pass.succeeds([&] {
            engine_call own(*pass.engine_, *call);
            engine_features const out = pass.output_of(own);
            std::lock_guard const lock(pass.mutex_);
            pass.lent_[call->place.branch] = out;
            F = out.get();
        });
        return F;
    }
    static int inputs(genrender_processor const* table, genrender_place place, std::uint32_t const* frames,
                      std::size_t frame_count, genrender_inputs* to) {
        auto& pass = self(table);
        return pass.succeeds([&] {
            auto const stack = frames_of(frames, frame_count);
            auto in = pass.inputs_of({{place.site}, place.branch}, stack);
            std::vector<std::int32_t> left_out;
            for (auto const& one : in.left_out) {
                left_out.push_back(one ? static_cast<std::int32_t>(*one) : -1);
            }
            std::lock_guard const lock(pass.mutex_);
            auto& kept = pass.given_.emplace_back();
            kept.rows = rows_of(in.rows);
            kept.left_out = std::move(left_out);
            kept.scales = scales_of(in.scales);
            kept.in = std::move(in);
            *to = {kept.in.attends_to_stack ? 1 : 0,
                   kept.in.f_KF != nullptr ? kept.in.f_KF->get() : nullptr,
                   kept.in.f_KF != nullptr ? kept.left_out.data() : nullptr,
                   kept.in.F_KF != nullptr ? kept.in.F_KF->get() : nullptr,
                   kept.in.F_KF != nullptr ? kept.rows.data() : nullptr,
                   kept.in.alpha,
                   kept.in.is_recorded ? 1 : 0,
                   kept.scales.empty() ? nullptr : kept.scales.data()};
        })
                   ? 0
                   : 1;
    }
    static int record(genrender_processor const* table, genrender_place place, genrender_features* f,
                      genrender_features* F) {
        auto& pass = self(table);
        return pass.succeeds([&] {
            if (f == nullptr && F != nullptr) {
                pass.engine_->release(pass.engine_->context, F);
            }
            engine_features own_f(*pass.engine_, f, "the graph");
            engine_features own_F(*pass.engine_, F, "the graph");
            if constexpr (is_for_graphs) {
                record_features(std::as_const(*pass.processor_), attention_place{{place.site}, place.branch},
                                std::move(own_f), std::move(own_F));
            }
        })
                   ? 0
                   : 1;
    }
    static void fail(genrender_processor const* table, char const* text) {
        auto& pass = self(table);
        pass.succeeds([&] {
            std::lock_guard const lock(pass.mutex_);
            pass.text_ = text;
        });
    }

    struct given_inputs {
        feature_inputs<engine_features, float> in;
        std::vector<std::int32_t> left_out;
        std::vector<genrender_rows> rows;
        std::vector<float> scales;
    };

    genrender_processor table_;
    genrender_engine const* engine_;
    Processor* processor_;
    std::mutex mutex_;
    std::deque<given_inputs> given_;
    std::map<std::uint32_t, engine_features> lent_; // by branch
    std::exception_ptr failure_;
    std::string text_;
};

} // namespace detail

/// An engine of C: a model of denoiser, for both ways in.
class engine_denoiser {
public:
    using real_type = float;               ///< scalar of the latents
    using features_type = engine_features; ///< the engine's handle

    /// Refers to `engine`, which has to outlive every copy and all features. Throws value_error for a table of another
    /// version, and for one that says nothing of latents, sites, branches or noise levels, or lacks denoise or release.
    explicit engine_denoiser(genrender_engine const& engine) : engine_(&engine) {
        require_value(engine.version == GENRENDER_ENGINE_VERSION, "engine_denoiser", "engine.version", engine.version,
                      ("GENRENDER_ENGINE_VERSION, " + std::to_string(GENRENDER_ENGINE_VERSION)).c_str());
        require_value(engine.denoise != nullptr, "engine_denoiser", "engine.denoise", "null", "a function");
        require_value(engine.release != nullptr, "engine_denoiser", "engine.release", "null", "a function");
        require_value(engine.latent_channels > 0, "engine_denoiser", "engine.latent_channels", engine.latent_channels,
                      "at least one channel");
        require_value(engine.latent_grid.height > 0 && engine.latent_grid.width > 0, "engine_denoiser",
                      "engine.latent_grid",
                      std::to_string(engine.latent_grid.height) + " x " + std::to_string(engine.latent_grid.width),
                      "a row and a column at least");
        require_value(engine.branches > 0, "engine_denoiser", "engine.branches", engine.branches, "1 or more");
        require_value(engine.sites != nullptr || engine.site_count == 0, "engine_denoiser", "engine.sites", "null",
                      "site_count sites");
        require_value(engine.sigma_min > 0 && engine.sigma_min < engine.sigma_max, "engine_denoiser",
                      "engine.sigma_min", engine.sigma_min, "above 0 and below sigma_max");
        for (std::size_t s = 0; s < engine.site_count; ++s) {
            auto const& site = engine.sites[s];
            require_value(site.name != nullptr, "engine_denoiser", "engine.sites[].name", "null", "a text");
            require_value(site.network <= GENRENDER_NETWORK_CONTROL && site.part <= GENRENDER_PART_DECODER,
                          "engine_denoiser", site.name, "of an unknown network or part", "those of c/engine.h");
            sites_.push_back({site.name,
                              static_cast<network_kind>(site.network),
                              static_cast<network_part>(site.part),
                              {site.grid.height, site.grid.width},
                              site.channels});
        }
    }

    /// Channels of z.
    std::size_t latent_channels() const { return engine_->latent_channels; }
    /// Height and width of z.
    grid_extents latent_grid() const { return {engine_->latent_grid.height, engine_->latent_grid.width}; }
    /// Its self-attention modules.
    std::span<attention_site const> sites() const { return sites_; }
    /// Guidance branches.
    std::size_t branches() const { return engine_->branches; }

    /// The lowest noise level that the engine was trained for.
    float sigma_min() const { return engine_->sigma_min; }
    /// The highest.
    float sigma_max() const { return engine_->sigma_max; }

    /// Writes D(z, sigma) into x0. Throws engine_error with what the engine said, and what the processor threw while the
    /// engine ran it.
    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        std::vector<std::uint32_t> numbers;
        for (auto const frame : frames) {
            numbers.push_back(frame.value);
        }
        genrender_grid const grid{z.extent(2), z.extent(3)};
        detail::engine_pass<Processor> pass(*engine_, processor);
        pass.finish(engine_->denoise(engine_->context, {x0.data(), x0.extent(0), x0.extent(1), grid},
                                     {z.data(), z.extent(0), z.extent(1), grid}, sigma, numbers.data(), pass.table()));
    }

private:
    genrender_engine const* engine_;
    std::vector<attention_site> sites_;
};

} // namespace genrender::c

#include <genrender/core/end_header.inl>
