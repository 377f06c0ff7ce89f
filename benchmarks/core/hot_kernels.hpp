// SPDX-License-Identifier: MIT
// Every kernel that has code for several vector targets, each on inputs of one shape, to be compiled with any flags.
#pragma once

#include <genrender/attention/plain_attention.hpp>
#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/blending/mix_rows.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/noise/surface_noise.hpp>
#include <genrender/normalization/adain.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/layer_norm.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/unet.hpp>
#include <genrender/reference/weights.hpp>
#include <genrender/sampling/classifier_free_guidance.hpp>
#include <genrender/sampling/karras_schedule.hpp>
#include <genrender/sampling/sampler.hpp>

#include <benchmarks/support/miniature_config.hpp>
#include <benchmarks/support/turning_world.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace genrender::benchmarks {

/// Runs a kernel once on inputs that it owns.
using kernel_run = std::function<void()>;

/// A kernel of the library on inputs of one shape.
struct hot_kernel {
    char const* name;
    double flops;         ///< of a run; 0 where they are not what bounds it
    kernel_run (*make)(); ///< makes the inputs, packed for the vector target of that moment
};

namespace detail {

/// Numbers in [-1, 1], stored as T.
template <class T, std::size_t Rank>
stack<T, Rank> numbers(std::array<std::size_t, Rank> const& extents) {
    stack<T, Rank> values(extents);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values.data()[i] = static_cast<T>(static_cast<float>(i * 7919 % 1009) / 504.0F - 1);
    }
    return values;
}

/// A std::function has to be copied, and inputs are not.
template <class Inputs, class Run>
kernel_run run_on(std::shared_ptr<Inputs> const& inputs, Run const& run) {
    return [inputs, run] { run(*inputs); };
}

inline kernel_run make_attention() {
    struct inputs {
        stack<float, 2> F{{256, 640}};
        stack<float, 2> Q = numbers<float, 2>({256, 640});
        stack<float, 3> K = numbers<float, 3>({2, 256, 640});
        stack<float, 3> V = numbers<float, 3>({2, 256, 640});
    };
    return run_on(std::make_shared<inputs>(), [](inputs& in) {
        std::array<key_value_view<float>, 2> const blocks{
            {{in.K.view()[0], in.V.view()[0], {}}, {in.K.view()[1], in.V.view()[1], {}}}};
        scaled_dot_product(in.F.view(), in.Q, blocks, 8);
    });
}

/// Four sources a token of five keyframes that are kept as Stored.
template <class Stored>
struct mixed_features {
    stack<float, 2> F = numbers<float, 2>({1024, 640});
    stack<Stored, 3> F_KF = numbers<Stored, 3>({5, 1024, 640});
    std::vector<std::uint32_t> offsets{0};
    std::vector<std::uint32_t> sources;
    std::vector<float> weights;

    mixed_features() {
        for (std::uint32_t t = 0; t < 1024; ++t) {
            for (std::uint32_t k = 0; k < 4; ++k) {
                sources.push_back((t / 97 + k) % 5 * 1024 + (t + 3 * k) % 1024);
            }
            offsets.push_back(static_cast<std::uint32_t>(sources.size()));
        }
        weights.assign(sources.size(), 0.25F);
    }
};

template <class Stored>
kernel_run make_mix() {
    return run_on(std::make_shared<mixed_features<Stored>>(), [](mixed_features<Stored>& in) {
        mix_rows(in.F.view(), in_view<Stored, 3>(in.F_KF.view()), {in.offsets, in.sources, in.weights}, 0.7F);
    });
}

inline kernel_run make_surface_noise() {
    struct inputs {
        turning_world world{1};
        stack<float, 3> z{{4, 32, 32}};
    };
    return run_on(std::make_shared<inputs>(),
                  [](inputs& in) { surface_noise(in.z.view(), in.world.uv(), frame_index{0}, 1); });
}

struct normalized_latents {
    stack<float, 4> z = numbers<float, 4>({24, 4, 64, 64});
    stack<std::uint8_t, 3> background{{24, 64, 64}};

    normalized_latents() {
        for (std::size_t e = 0; e < background.size(); ++e) {
            background.data()[e] = e % 64 < 21 ? 1 : 0;
        }
    }
};

inline kernel_run make_statistics() {
    return run_on(std::make_shared<normalized_latents>(), [](normalized_latents& in) {
        for (std::size_t i = 0; i < in.z.extent(0); ++i) {
            masked_statistics(std::as_const(in.z).view()[i], std::as_const(in.background).view()[i]);
        }
    });
}

inline kernel_run make_normalize() {
    return run_on(std::make_shared<normalized_latents>(),
                  [](normalized_latents& in) { normalize_latents(in.z.view(), std::as_const(in.background).view()); });
}

/// Steps of a sampler whose denoiser finds what it is given; so few latents that no memory comes from the system anew.
template <sampler_kind Kind>
kernel_run make_sampler() {
    struct inputs {
        latents<float> z = latents<float>::from_shape({6, 4, 32, 32});
        std::vector<float> sigmas = karras_schedule<float>(4);
    };
    auto const in = std::make_shared<inputs>();
    in->z.fill(0.25F);
    return run_on(in, [](inputs& of) {
        sample(
            Kind, [](latents<float> const& z, float) -> latents<float> const& { return z; }, of.z, of.sigmas);
    });
}

inline kernel_run make_guidance() {
    struct inputs {
        stack<float, 4> uncond = numbers<float, 4>({24, 4, 64, 64});
        stack<float, 4> cond = uncond;
        stack<float, 4> out = uncond;
    };
    return run_on(std::make_shared<inputs>(), [](inputs& in) {
        guide(in.out.view(), std::as_const(in.uncond).view(), std::as_const(in.cond).view(), 7.5F);
    });
}

/// A layer of the reference network for features [tokens, channels]; Layer(weights, name) and run(layer, out, in).
template <std::size_t Tokens, std::size_t In, std::size_t Out, class Make, class Run>
kernel_run make_layer(Make const& make, Run const& run) {
    auto source = reference::weights<float>::seeded(1, "benchmark");
    using layer_type = decltype(make(source));
    struct inputs {
        layer_type layer;
        stack<float, 2> in = numbers<float, 2>({Tokens, In});
        stack<float, 2> out{{Tokens, Out}};
    };
    return run_on(std::make_shared<inputs>(inputs{make(source)}),
                  [run](inputs& of) { run(of.layer, of.out.view(), std::as_const(of.in).view()); });
}

inline kernel_run make_product() {
    return make_layer<1024, 320, 320>([](auto& source) { return reference::linear<float>(source, "linear", 320, 320); },
                                      [](auto const& layer, auto out, auto in) { layer(out, in); });
}

inline kernel_run make_convolution() {
    return make_layer<1024, 128, 128>([](auto& source) { return reference::conv2d<float>(source, "conv", 128, 128); },
                                      [](auto const& layer, auto out, auto in) {
                                          layer(out, in, {32, 32});
                                      });
}

inline kernel_run make_group_norm() {
    return make_layer<1024, 320, 320>(
        [](auto& source) { return reference::group_norm<float>(source, "norm", 320, 8, 1e-5F); },
        [](auto const& layer, auto out, auto in) { layer(out, in); });
}

inline kernel_run make_layer_norm() {
    return make_layer<1024, 320, 320>([](auto& source) { return reference::layer_norm<float>(source, "norm", 320); },
                                      [](auto const& layer, auto out, auto in) { layer(out, in); });
}

/// The UNet of the miniature with random weights, one frame with latents of 32 x 32.
inline kernel_run make_reference_network() {
    struct inputs {
        reference::unet_config config = miniature_config();
        reference::weights<float> source = reference::weights<float>::seeded(1, "unet");
        reference::site_list sites{{32, 32}};
        reference::unet<float> network{config, source, sites};
        reference::feature_maps<float> z{1, {32, 32}, config.in_channels};
        stack<float, 2> prompt = numbers<float, 2>({miniature_prompt_tokens, config.cross_attention_dim});
        std::vector<frame_index> frames{1};
        plain_attention plain;
        sequential_loop loop;
    };
    auto const in = std::make_shared<inputs>();
    std::fill_n(in->z.view().data(), in->z.view().size(), 0.25F);
    return run_on(in, [](inputs& of) {
        reference::forward_pass<float> pass{of.frames, 0, of.prompt.view(), of.plain, of.loop};
        of.network(pass, of.z, 417.0F);
    });
}

} // namespace detail

/// All of them. What the compiler makes of them follows the flags of the file that includes this one.
inline constexpr std::array hot_kernels{
    hot_kernel{"attention", 4.0 * 256 * 512 * 640, detail::make_attention},
    hot_kernel{"mix", 0, detail::make_mix<float>},
    hot_kernel{"mix_float16", 0, detail::make_mix<float16>},
    hot_kernel{"mix_bfloat16", 0, detail::make_mix<bfloat16>},
    hot_kernel{"surface_noise", 0, detail::make_surface_noise},
    hot_kernel{"statistics", 0, detail::make_statistics},
    hot_kernel{"normalize", 0, detail::make_normalize},
    hot_kernel{"heun", 0, detail::make_sampler<sampler_kind::heun>},
    hot_kernel{"dpmpp_2m", 0, detail::make_sampler<sampler_kind::dpmpp_2m>},
    hot_kernel{"guidance", 0, detail::make_guidance},
    hot_kernel{"product", 2.0 * 1024 * 320 * 320, detail::make_product},
    hot_kernel{"convolution", 2.0 * 1024 * 9 * 128 * 128, detail::make_convolution},
    hot_kernel{"group_norm", 0, detail::make_group_norm},
    hot_kernel{"layer_norm", 0, detail::make_layer_norm},
    hot_kernel{"reference_network", 0, detail::make_reference_network},
};

} // namespace genrender::benchmarks
