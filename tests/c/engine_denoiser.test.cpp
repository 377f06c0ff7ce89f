// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] An engine of C renders what the same denoiser renders in C++.
#include <genrender/c/engine_denoiser.hpp>

#include <genrender/pipeline/render.hpp>
#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/attention_call_laws.hpp>
#include <genrender/testing/denoiser_laws.hpp>
#include "../support/slanted_maps.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>

extern "C" genrender_engine const* engine_of_c11();
extern "C" genrender_engine const* engine_of_cxx11();

TEST_SUITE("c/engine_denoiser") {
    using namespace genrender;
    using genrender::c::engine_denoiser;
    using genrender::c::engine_error;

    namespace {

    render_settings<float> few_c_steps() {
        render_settings<float> settings = render_settings<float>::plain();
        settings.steps = 3;
        settings.sigma_max = 10;
        settings.keyframes.count = 2;
        settings.frames_per_call = 2;
        return settings;
    }
    template <class Phi>
    latents<float> c_frames(Phi const& phi, render_settings<float> const& settings = few_c_steps()) {
        auto const maps = testing::slanted_maps(5);
        return render(phi, to_uv_view(maps), {.settings = settings, .loop = threaded_loop(2)}).z;
    }
    float c_difference(latents<float> const& a, latents<float> const& b) {
        float most = 0;
        for (std::size_t e = 0; e < a.size(); ++e) {
            most = std::max(most, std::abs(a.data()[e] - b.data()[e]));
        }
        return most;
    }

    // What a static graph of C puts out: f = z / 20 of the first channel, F = f, plus what its inputs say.
    struct graph_stack {
        std::size_t frames;
        float values[3][256];
        static int alive;
    };
    int graph_stack::alive = 0;

    void graph_release(void*, genrender_features* features) {
        --graph_stack::alive;
        delete static_cast<graph_stack*>(features);
    }
    graph_stack* graph_new(std::size_t frames) {
        ++graph_stack::alive;
        return new graph_stack{frames, {}};
    }
    int graph_denoise(void* context, genrender_latents x0, genrender_const_latents z, float, uint32_t const* frames,
                      genrender_processor const* processor) {
        auto const& told = *static_cast<bool const*>(context);
        genrender_inputs in;
        if (processor->inputs(processor, {0, 0}, frames, z.frames, &in) != 0) {
            return 1;
        }
        if (told && in.F_KF != nullptr) {
            processor->fail(processor, "the graph has run out of memory");
            return 1;
        }
        auto* const f = graph_new(z.frames);
        auto* const F = graph_new(z.frames);
        for (std::size_t i = 0; i < z.frames; ++i) {
            for (std::size_t t = 0; t < 256; ++t) {
                f->values[i][t] = z.values[i * 256 + t] / 20;
                F->values[i][t] = f->values[i][t] + (in.attends_to_stack != 0 ? 0.25f : 0.0f);
                auto const* const f_KF = static_cast<graph_stack const*>(in.f_KF);
                for (std::size_t k = 0; f_KF != nullptr && k < f_KF->frames; ++k) {
                    F->values[i][t] += static_cast<int>(k) == in.left_out[i] ? 0 : f_KF->values[k][t] / 10;
                }
                if (in.F_KF != nullptr && in.rows[i].offsets[t] < in.rows[i].offsets[t + 1]) {
                    auto const& F_KF = *static_cast<graph_stack const*>(in.F_KF);
                    float blended = 0;
                    for (auto e = in.rows[i].offsets[t]; e < in.rows[i].offsets[t + 1]; ++e) {
                        auto const row = in.rows[i].sources[e];
                        blended += in.rows[i].weights[e] * F_KF.values[row / 256][row % 256];
                    }
                    F->values[i][t] = in.alpha * blended + (1 - in.alpha) * F->values[i][t];
                }
                x0.values[i * 256 + t] = F->values[i][t];
            }
        }
        if (in.is_recorded != 0) {
            return processor->record(processor, {0, 0}, f, F);
        }
        graph_release(nullptr, f);
        graph_release(nullptr, F);
        return 0;
    }
    genrender_engine graph_engine(bool& fails) {
        static genrender_site const site{"up.attn1", GENRENDER_NETWORK_DENOISING, GENRENDER_PART_DECODER, {16, 16}, 1};
        genrender_engine engine{};
        engine.version = GENRENDER_ENGINE_VERSION;
        engine.context = &fails;
        engine.latent_channels = 1;
        engine.latent_grid = {16, 16};
        engine.sites = &site;
        engine.site_count = 1;
        engine.branches = 1;
        engine.sigma_min = 0.02f;
        engine.sigma_max = 10;
        engine.denoise = graph_denoise;
        engine.release = graph_release;
        return engine;
    }

    // The same graph in C++.
    struct graph_of_cxx {
        using real_type = float;
        using features_type = host_features<float>;
        std::array<attention_site, 1> modules{
            {{"up.attn1", network_kind::denoising, network_part::decoder, {16, 16}, 1}}};
        std::size_t latent_channels() const { return 1; }
        grid_extents latent_grid() const { return {16, 16}; }
        std::span<attention_site const> sites() const { return modules; }
        std::size_t branches() const { return 1; }
        template <feature_io_processor<features_type, float> Processor>
        void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float,
                        std::span<frame_index const> frames, Processor& processor) const {
            auto const in = inputs_at<features_type, float>(processor, {}, frames);
            auto const f = features_type::allocate({frames.size(), 256, 1});
            auto const F = features_type::allocate({frames.size(), 256, 1});
            for (std::size_t i = 0; i < frames.size(); ++i) {
                for (std::size_t t = 0; t < 256; ++t) {
                    f.view()(i, t, 0) = z.data()[i * 256 + t] / 20;
                    auto value = f.view()(i, t, 0) + (in.attends_to_stack ? 0.25f : 0.0f);
                    for (std::size_t k = 0; in.f_KF != nullptr && k < in.f_KF->extents()[0]; ++k) {
                        value += in.left_out[i] == k ? 0 : in.f_KF->view()(k, t, 0) / 10;
                    }
                    F.view()(i, t, 0) = value;
                }
                if (in.F_KF != nullptr) {
                    post_attention(F.view()[i], *in.F_KF, in.rows[i], in.alpha);
                }
                for (std::size_t t = 0; t < 256; ++t) {
                    x0.data()[i * 256 + t] = F.view()(i, t, 0);
                }
            }
            if (in.is_recorded) {
                record_features(processor, {}, f, F);
            }
        }
    };

    } // namespace

    TEST_CASE("an engine that was compiled as C11 or C++11 renders the frames of the same denoiser in C++") {
        testing::analytic_denoiser<float> const phi{
            .grid = {16, 16},
            .attention = 0.5f,
            .guidance_branches = 2,
            .site_list = {{"decoder.attn1", network_kind::denoising, network_part::decoder, {16, 16}, 3}}};
        auto const expected = c_frames(phi);
        auto plain = few_c_steps();
        plain.layers = [](attention_site const&, std::uint32_t) { return false; };
        CHECK(c_difference(c_frames(phi, plain), expected) > 0.001f); // injection does something
        for (auto const* const engine : {engine_of_c11(), engine_of_cxx11()}) {
            CHECK(c_difference(c_frames(engine_denoiser(*engine)), expected) < 1e-5f);
        }
        // And so does one that scales logits; a copy of its table that does not say so is refused.
        auto scaled = few_c_steps();
        scaled.injection.length_correction = 4;
        auto const of_scaled = c_frames(phi, scaled);
        CHECK(c_difference(of_scaled, expected) > 1e-4f);
        for (auto const* const engine : {engine_of_c11(), engine_of_cxx11()}) {
            CHECK(c_difference(c_frames(engine_denoiser(*engine), scaled), of_scaled) < 1e-5f);
            auto without = *engine;
            without.scales_logits = 0;
            CHECK_THROWS_WITH_AS(c_frames(engine_denoiser(without), scaled),
                                 "engine_call: logits are scaled, expected a length_correction of 0 for an engine "
                                 "without scales_logits",
                                 value_error);
        }
    }
    TEST_CASE("an engine of C keeps the laws of denoiser and of attention_call") {
        engine_denoiser const phi(*engine_of_c11());
        CHECK(testing::check_denoiser_laws(phi, 1.5f).text() == "");
    }
    TEST_CASE("a static graph of C renders the frames of the same graph in C++, and gets all its features back") {
        bool fails = false;
        auto const engine = graph_engine(fails);
        graph_stack::alive = 0;
        auto settings = few_c_steps();
        auto const expected = c_frames(graph_of_cxx{}, settings);
        {
            auto const maps = testing::slanted_maps(5);
            auto const found = render(engine_denoiser(engine), to_uv_view(maps), {.settings = settings}).z;
            CHECK(c_difference(found, expected) < 1e-5f);
        }
        CHECK(graph_stack::alive == 0);
        settings.injection.length_correction = 1;
        CHECK_THROWS_WITH_AS(c_frames(engine_denoiser(engine), settings),
                             "inputs_at: logits are scaled, expected a length_correction of 0 for an engine whose "
                             "graph_abilities do not say scales_logits",
                             value_error);
        CHECK(graph_stack::alive == 0);
    }
    TEST_CASE("what an engine says of its failure is what the run says") {
        bool fails = true;
        auto const engine = graph_engine(fails);
        graph_stack::alive = 0;
        auto const maps = testing::slanted_maps(5);
        CHECK_THROWS_WITH_AS(render(engine_denoiser(engine), to_uv_view(maps), {.settings = few_c_steps()}),
                             "engine: the graph has run out of memory", engine_error);
        CHECK(graph_stack::alive == 0);
    }
    TEST_CASE("what a processor throws while the engine runs it comes out behind the engine") {
        struct throwing {
            genrender::c::engine_features operator()(genrender::c::engine_call&) const {
                throw std::out_of_range("thrown below C");
            }
        };
        engine_denoiser const phi(*engine_of_c11());
        stack<float, 4> z({1, 3, 16, 16});
        stack<float, 4> x0({1, 3, 16, 16});
        std::array<frame_index, 1> const frames{{{0}}};
        throwing const processor;
        CHECK_THROWS_WITH_AS(phi(x0.view(), z.view(), 1.0f, frames, processor), "thrown below C", std::out_of_range);
    }
    TEST_CASE("an engine of another version is refused, as are tables that miss something") {
        auto engine = *engine_of_c11();
        engine.version = 7;
        CHECK_THROWS_WITH_AS(engine_denoiser{engine},
                             "engine_denoiser: engine.version is 7, expected GENRENDER_ENGINE_VERSION, 1", value_error);
        engine = *engine_of_c11();
        engine.denoise = nullptr;
        CHECK_THROWS_WITH_AS(engine_denoiser{engine}, "engine_denoiser: engine.denoise is null, expected a function",
                             value_error);
        engine = *engine_of_c11();
        engine.sigma_min = 20;
        CHECK_THROWS_AS(engine_denoiser{engine}, value_error);
        engine = *engine_of_c11();
        engine.mix = nullptr;
        auto const maps = testing::slanted_maps(5);
        CHECK_THROWS_WITH_AS(render(engine_denoiser(engine), to_uv_view(maps), {.settings = few_c_steps()}),
                             "engine: mix is null, expected a function of an engine that calls back", engine_error);
    }
}
