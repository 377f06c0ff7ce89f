// SPDX-License-Identifier: MIT
// The Python module: everything of the library that is not the loop around the network, on NumPy arrays.
#include "animation_consensus.hpp"
#include "animation_maps.hpp"
#include "arrays.hpp"

#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/padded_rows.hpp>
#include <genrender/blending/point_counts.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/maps/background_mask.hpp>
#include <genrender/noise/initial_noise.hpp>
#include <genrender/normalization/adain.hpp>
#include <genrender/sampling/karras_schedule.hpp>
#include <genrender/sampling/noise_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>
#include <genrender/sampling/sampler.hpp>
#include <genrender/version.hpp>

#ifdef GENRENDER_PYTHON_EXR
#include "examples/support/exr_maps.hpp"
#endif

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace nb = nanobind;
using namespace nb::literals;

namespace genrender::python {
namespace {

/// The value that a name stands for.
template <class Value>
Value named(char const* function, char const* argument, std::string const& name,
            std::initializer_list<std::pair<char const*, Value>> values) {
    std::string names;
    for (auto const& [known, value] : values) {
        if (name == known) {
            return value;
        }
        names += (names.empty() ? "" : ", ") + std::string(known);
    }
    throw value_error(std::string(function) + ": " + argument + " is " + name + ", expected one of " + names);
}

/// Threads that are there for all calls of the module.
any_loop const& threads() {
    static any_loop const loop = threaded_loop();
    return loop;
}

std::vector<frame_index> frames_of(std::vector<std::uint32_t> const& numbers) {
    std::vector<frame_index> frames;
    for (auto const number : numbers) {
        frames.push_back({number});
    }
    return frames;
}

std::shared_ptr<animation_maps> make_maps(input<float, 4> const& uv, input<std::uint32_t, 3> const& object,
                                          input<std::uint8_t, 3> const& coverage,
                                          std::optional<input<float, 3>> const& depth,
                                          std::optional<input<float, 4>> const& position) {
    auto const shape = view_of<std::uint8_t const, 3>(coverage).extents();
    auto const [frames, height, width] = shape;
    require_value(coverage.size() > 0, "Maps", "coverage", extents_text(shape), "at least one frame and pixel");
    auto maps = std::make_shared<animation_maps>();
    maps->uv.uv = tensor_of<float, 4>("uv", uv, {frames, height, width, 2});
    maps->uv.object = tensor_of<std::uint32_t, 3>("object", object, shape);
    maps->uv.coverage = tensor_of<std::uint8_t, 3>("coverage", coverage, shape);
    if (depth) {
        maps->depth.depth = tensor_of<float, 3>("depth", *depth, shape);
        maps->depth.coverage = maps->uv.coverage;
    }
    if (position) {
        maps->position = tensor_of<float, 4>("position", *position, {frames, height, width, 3});
    }
    return maps;
}

std::shared_ptr<animation_maps> load_exr(std::string const& folder, std::string const& layer,
                                         std::optional<bool> v_upwards) {
#ifdef GENRENDER_PYTHON_EXR
    auto read = examples::load_exr_sequence(folder, {.layer = layer, .v_upwards = v_upwards});
    auto maps = std::make_shared<animation_maps>();
    maps->uv = std::move(read.uv);
    maps->depth = std::move(read.depth);
    maps->position = std::move(read.position);
    maps->notes = std::move(read.notes);
    return maps;
#else
    static_cast<void>(layer);
    static_cast<void>(v_upwards);
    throw file_error(folder +
                     ": cannot be read, since this module was built without OpenEXR; expected arrays for Maps");
#endif
}

auto inverse_depth(animation_maps const& maps, std::size_t height, std::size_t width) {
    return array_of(cell_means(sequence_inverse_depth(maps.known_depth()), {height, width}));
}

auto background(animation_maps const& maps, std::size_t height, std::size_t width) {
    return array_of(background_mask(to_uv_view(maps.uv), {height, width}));
}

auto noise(animation_maps const& maps, std::size_t channels, std::size_t height, std::size_t width, std::uint64_t seed,
           std::optional<std::vector<std::uint32_t>> const& frames, std::string const& kind,
           std::string const& background, std::string const& canonical) {
    noise_settings settings;
    settings.seed = seed;
    settings.kind = named(
        "initial_noise", "kind", kind,
        {std::pair("uv", noise_kind::uv), {"fixed", noise_kind::fixed}, {"independent", noise_kind::independent}});
    settings.background =
        named("initial_noise", "background", background,
              {std::pair("fixed", background_noise::fixed), {"independent", background_noise::independent}});
    std::vector<frame_index> shown;
    for (std::uint32_t i = 0; i < maps.uv.frame_count(); ++i) {
        shown.push_back({i});
    }
    shown = frames ? frames_of(*frames) : shown;
    auto z = tensor<float, 4>::from_shape({shown.size(), channels, height, width});
    {
        nb::gil_scoped_release const others_run;
        maps.with_canonical(canonical,
                            [&](auto const& view) { initial_noise(to_view(z), view, shown, settings, threads()); });
    }
    return array_of(std::move(z));
}

std::shared_ptr<token_correspondence> correspondence(std::shared_ptr<animation_maps> maps, std::size_t height,
                                                     std::size_t width, std::string const& kind,
                                                     std::string const& canonical) {
    correspondence_settings settings;
    settings.kind =
        named("correspondence", "kind", kind,
              {std::pair("footprint", correspondence_kind::footprint), {"texels", correspondence_kind::texel_grid}});
    nb::gil_scoped_release const others_run;
    return maps->with_canonical(canonical, [&](auto const& view) {
        using map_type = chosen_correspondence<std::remove_cvref_t<decltype(view)>::dimensions>;
        return std::make_shared<token_correspondence>(
            token_correspondence{maps, map_type(view, grid_extents{height, width}, settings, threads())});
    });
}

grid_extents grid_of(token_correspondence const& of) {
    return of.with_map([](auto const& map) { return map.grid(); });
}

auto matches(token_correspondence const& of, std::uint32_t from, std::uint32_t to) {
    auto const tokens = grid_of(of).size();
    std::vector<std::int32_t> found(tokens, 0);
    std::vector<std::uint8_t> is_shown(tokens, 0);
    of.with_map([&](auto const& map) {
        require_frame("matches", "from", map, {from});
        require_frame("matches", "to", map, {to});
        for (std::uint32_t t = 0; t < tokens; ++t) {
            auto const point = map.point_at({from}, {t});
            auto const token = point ? map.token_at({to}, *point) : std::nullopt;
            found[t] = static_cast<std::int32_t>(token.value_or(token_index{}).value);
            is_shown[t] = token ? 1 : 0;
        }
    });
    return std::tuple(array_of<1>(std::move(found), {tokens}), array_of<1>(std::move(is_shown), {tokens}));
}

auto rows(token_correspondence const& of, std::vector<std::uint32_t> const& keyframes,
          std::vector<std::uint32_t> const& frames, float alpha, float first_fill_share, std::string const& average,
          std::optional<std::size_t> width) {
    auto const kind = named("padded_rows", "average", average,
                            {std::pair("quality", texel_average::by_quality), {"plain", texel_average::plain}});
    auto const KF = frames_of(keyframes);
    std::vector<blend_plan<float>> plans(frames.size());
    padded_rows<float> padded;
    {
        nb::gil_scoped_release const others_run;
        of.with_map([&](auto const& map) {
            threads()(frames.size(), [&](std::size_t i) {
                plans[i] = make_blend_plan<float>(map, KF, {frames[i]}, first_fill_share, kind);
            });
        });
        std::vector<sparse_rows<float>> all;
        for (auto const& plan : plans) {
            all.push_back(plan.rows());
        }
        padded = make_padded_rows<float>(all, alpha, width);
    }
    auto const tokens = grid_of(of).size();
    return std::tuple(array_of<3>(std::move(padded.index), {frames.size(), tokens, padded.width}),
                      array_of<3>(std::move(padded.weights), {frames.size(), tokens, padded.width}),
                      array_of<2>(std::move(padded.own), {frames.size(), tokens}));
}

auto counts(token_correspondence const& of, std::vector<std::uint32_t> const& keyframes,
            std::optional<std::vector<std::uint32_t>> const& frames) {
    auto const KF = frames_of(keyframes);
    auto const joined = frames_of(frames.value_or(keyframes));
    auto const keys = (KF.size() + (frames ? 1 : 0)) * grid_of(of).size();
    std::vector<float> all(joined.size() * keys);
    {
        nb::gil_scoped_release const others_run;
        of.with_map([&](auto const& map) {
            threads()(joined.size(), [&](std::size_t i) {
                auto const plan = make_blend_plan<float>(map, KF, joined[i], 0.5F);
                auto const of_frame =
                    frames ? point_counts(plan.rows(), KF.size()) : point_counts_of_stack(plan.rows(), KF.size());
                std::copy(of_frame.begin(), of_frame.end(), all.begin() + static_cast<std::ptrdiff_t>(i * keys));
            });
        });
    }
    return array_of<2>(std::move(all), {joined.size(), keys});
}

std::vector<std::uint32_t> keyframes(std::size_t count, std::size_t frames, std::size_t step, std::uint64_t seed,
                                     std::string const& drawing) {
    keyframe_settings settings;
    settings.count = count;
    settings.seed = seed;
    settings.drawing =
        named("draw_keyframes", "drawing", drawing,
              {std::pair("uniform", keyframe_drawing::uniform), {"stratified", keyframe_drawing::stratified}});
    std::vector<std::uint32_t> numbers;
    for (auto const frame : draw_keyframes(settings, frames, step)) {
        numbers.push_back(frame.value);
    }
    return numbers;
}

/// Latents in host memory that are changed in place.
using latents_in_place = nb::ndarray<float, nb::ndim<4>, nb::c_contig, nb::device::cpu>;

std::vector<std::size_t> normalize(latents_in_place const& z, input<std::uint8_t, 3> const& background,
                                   std::string const& statistics) {
    adain_settings<float> settings;
    settings.statistics = named("normalize_latents", "statistics", statistics,
                                {std::pair("mean", adain_statistics::mean),
                                 {"mean_and_supported_deviation", adain_statistics::mean_and_supported_deviation},
                                 {"low_band", adain_statistics::low_band},
                                 {"mean_and_deviation", adain_statistics::mean_and_deviation}});
    return normalize_latents(view_of<float, 4>(z), view_of<std::uint8_t const, 3>(background), settings);
}

std::shared_ptr<animation_consensus> make_consensus(std::shared_ptr<token_correspondence> correspondence,
                                                    std::size_t steps, std::uint64_t seed, std::size_t sources,
                                                    float window_begin, float window_end, float strength,
                                                    float most_gain, bool fades_at_silhouettes,
                                                    bool agrees_on_background) {
    render_settings<float> settings;
    settings.steps = steps;
    auto& consensus = settings.consensus;
    consensus.sources.count = sources;
    consensus.sources.seed = seed;
    consensus.window_begin = window_begin;
    consensus.window_end = window_end;
    consensus.strength = [strength](std::size_t) { return strength; };
    consensus.most_gain = most_gain;
    consensus.fades_at_silhouettes = fades_at_silhouettes;
    consensus.agrees_on_background = agrees_on_background;
    return std::make_shared<animation_consensus>(std::move(correspondence), std::move(settings));
}

std::vector<std::size_t> reach(animation_consensus const& consensus, latents_in_place const& x0, std::size_t step) {
    auto const view = view_of<float, 4>(x0);
    nb::gil_scoped_release const others_run;
    return consensus.reach(view, step, threads());
}

/// Latents of any array library of Python's: samplers move them by their own operators, wherever they are.
struct python_latents {
    nb::object array;
    friend python_latents operator+(python_latents const& a, python_latents const& b) { return {a.array + b.array}; }
    friend python_latents operator-(python_latents const& a, python_latents const& b) { return {a.array - b.array}; }
    friend python_latents operator*(double factor, python_latents const& a) { return {nb::float_(factor) * a.array}; }
};

nb::object sample_latents(std::string const& sampler, nb::callable const& D, nb::object z,
                          std::vector<double> const& sigmas, nb::object const& after_step) {
    auto const kind = named(
        "sample", "sampler", sampler,
        {std::pair("euler", sampler_kind::euler), {"heun", sampler_kind::heun}, {"dpmpp_2m", sampler_kind::dpmpp_2m}});
    auto const estimate = [&](python_latents const& noisy, double sigma, std::size_t step) {
        return python_latents{D(noisy.array, sigma, step)};
    };
    return sample(kind, estimate, python_latents{std::move(z)}, sigmas,
                  [&](std::size_t step, python_latents& now) {
                      if (!after_step.is_none()) {
                          after_step(step, now.array);
                      }
                  })
        .array;
}

std::tuple<double, double, double> scaling_factors(std::string const& predicted, double sigma) {
    auto const kind = named("scalings", "prediction", predicted,
                            {std::pair("epsilon", prediction::epsilon),
                             {"v_prediction", prediction::velocity},
                             {"sample", prediction::clean},
                             {"flow", prediction::flow}});
    auto const [c_skip, c_out, c_in] = scalings_of(kind, sigma);
    return {c_skip, c_out, c_in};
}

discrete_noise_schedule noise_schedule(std::vector<double> const& alphas_cumprod) {
    return discrete_noise_schedule(std::span<double const>(alphas_cumprod));
}

} // namespace
} // namespace genrender::python

NB_MODULE(_genrender, m) {
    using namespace genrender;
    using namespace genrender::python;
    m.attr("__version__") = GENRENDER_VERSION_STRING;
#ifdef GENRENDER_PYTHON_EXR
    m.attr("reads_exr") = true;
#else
    m.attr("reads_exr") = false;
#endif
    nb::exception<file_error>(m, "FileError", PyExc_OSError);

    nb::class_<animation_maps>(
        m, "Maps", "UV, object, coverage, and if given depth and rest positions of every pixel of an animation.")
        .def(nb::new_(&make_maps), "uv"_a, "object"_a, "coverage"_a, "depth"_a = nb::none(), "position"_a = nb::none(),
             "Copies uv [frames, height, width, 2], object and coverage [frames, height, width], depth (> 0 where "
             "covered) of "
             "the same shape, position [frames, height, width, 3]. Raises ValueError if shapes do not fit.")
        .def_prop_ro(
            "frames", [](animation_maps const& maps) { return maps.uv.frame_count(); }, "Number of frames.")
        .def_prop_ro(
            "height", [](animation_maps const& maps) { return maps.uv.grid().height; }, "Rows of pixels.")
        .def_prop_ro(
            "width", [](animation_maps const& maps) { return maps.uv.grid().width; }, "Columns of pixels.")
        .def_ro("notes", &animation_maps::notes, "Sentences of the reader of files.")
        .def_prop_ro(
            "uv", [](animation_maps const& maps) { return array_of(maps.uv.uv); }, nb::rv_policy::move, "A copy.")
        .def_prop_ro(
            "object", [](animation_maps const& maps) { return array_of(maps.uv.object); }, nb::rv_policy::move,
            "A copy.")
        .def_prop_ro(
            "coverage", [](animation_maps const& maps) { return array_of(maps.uv.coverage); }, nb::rv_policy::move,
            "A copy.")
        .def_prop_ro(
            "depth", [](animation_maps const& maps) { return array_of(maps.known_depth().depth); }, nb::rv_policy::move,
            "A copy.")
        .def("inverse_depth", &inverse_depth, "height"_a, "width"_a,
             "What a depth ControlNet sees [frames, height, width]: 1 nearest, 0 farthest of all frames.")
        .def("background", &background, "height"_a, "width"_a,
             "1 where a cell shows no object [frames, height, width].")
        .def("initial_noise", &noise, "channels"_a, "height"_a, "width"_a, "seed"_a = 0, "frames"_a = nb::none(),
             "kind"_a = "uv", "background"_a = "fixed", "canonical"_a = "uv",
             "Noise of N(0, 1) that moves with the surfaces [frames, channels, height, width] (kind: uv, fixed, "
             "independent).")
        .def("correspondence", &correspondence, "height"_a, "width"_a, "kind"_a = "footprint", "canonical"_a = "uv",
             "Which token shows which surface point, for feature maps of height x width (kind: footprint, texels).");

    nb::class_<token_correspondence>(m, "Correspondence", "Which token of which frame shows which surface point.")
        .def_prop_ro(
            "height", [](token_correspondence const& of) { return grid_of(of).height; }, "Rows of tokens.")
        .def_prop_ro(
            "width", [](token_correspondence const& of) { return grid_of(of).width; }, "Columns of tokens.")
        .def("matches", &matches, "source"_a, "target"_a,
             "For each token of frame `source`, the token of `target` that shows the same point, and whether one does.")
        .def("padded_rows", &rows, "keyframes"_a, "frames"_a, "alpha"_a = 0.7F, "first_fill_share"_a = 0.5F,
             "average"_a = "quality", "width"_a = nb::none(),
             "(index [frames, tokens, W], weights, own [frames, tokens]) of F_out = own F_hat + sum_w weights "
             "F_KF[index], "
             "where F_KF is [keyframes * tokens, channels]: eq. 6 with alpha folded in.")
        .def("point_counts", &counts, "keyframes"_a, "frames"_a = nb::none(),
             "What each key counts for, 1 / the number of keys that show its point [frames, (1 + keyframes) * tokens], "
             "where frames attend to their own tokens and the keyframes' (eq. 5); without `frames` [keyframes, "
             "keyframes * tokens], where keyframes attend to each other (eq. 3). Its logarithm is added to logits.");

    consensus_settings<float> const usual;
    nb::class_<animation_consensus>(
        m, "Consensus",
        "Clean estimates of all frames agree along the surfaces, and where no object is at their place on the screen.")
        .def(nb::new_(&make_consensus), "correspondence"_a, "steps"_a, nb::kw_only(), "seed"_a = 0,
             "sources"_a = usual.sources.count, "window_begin"_a = usual.window_begin,
             "window_end"_a = usual.window_end, "strength"_a = 1.0F, "most_gain"_a = usual.most_gain,
             "fades_at_silhouettes"_a = usual.fades_at_silhouettes,
             "agrees_on_background"_a = usual.agrees_on_background,
             "Of a run of `steps` steps whose latents have the grid of `correspondence`. It is a mean over `sources` "
             "frames, drawn anew each step, or all frames if these are fewer; along the surfaces in the steps whose "
             "share of all lies in [window_begin, window_end). A channel's deviation is multiplied by `most_gain` at "
             "most, to give back what averaging took. Raises ValueError for what no run could honour.")
        .def("reach", &reach, "x0"_a.noconvert(), "step"_a,
             "Moves x0 [frames, channels, height, width], float32, in place. Returns the cells of each frame that the "
             "sources cover, none in a step without a consensus along the surfaces. Raises ValueError for other "
             "frames, another grid or a step beyond the run, TypeError for what would have to be copied.");

    nb::class_<discrete_noise_schedule>(m, "NoiseSchedule", "The noise levels that a network was trained at.")
        .def(nb::new_(&noise_schedule), "alphas_cumprod"_a)
        .def_static(
            "scaled_linear",
            [](double first, double last, std::size_t steps) {
                return noise_schedule(scaled_linear_alphas_cumprod(first, last, steps));
            },
            "beta_start"_a = 0.00085, "beta_end"_a = 0.012, "steps"_a = 1000, "Of Stable Diffusion's kind of betas.")
        .def_prop_ro("sigma_min", &discrete_noise_schedule::sigma_min, "The lowest level.")
        .def_prop_ro("sigma_max", &discrete_noise_schedule::sigma_max, "The highest level.")
        .def("t_of", &discrete_noise_schedule::t_of<double>, "sigma"_a, "The time of a level, with a fraction.")
        .def("sigma_of", &discrete_noise_schedule::sigma_of<double>, "t"_a, "The level of a time.");

    m.def("load_exr", &load_exr, "folder"_a, "layer"_a = "", "v_upwards"_a = nb::none(),
          "Maps of a folder of EXR files, as Blender writes them: of all view layers, the nearest surface of each "
          "pixel, or of "
          "the one named. Raises FileError.");
    m.def("draw_keyframes", &keyframes, "count"_a, "frames"_a, "step"_a, "seed"_a = 0, "drawing"_a = "uniform",
          "The keyframes of a step, shuffled: a pure function of its arguments.");
    m.def("karras_schedule", &karras_schedule<double>, "steps"_a, "sigma_min"_a = 0.0292, "sigma_max"_a = 14.6146,
          "rho"_a = 7.0, "The steps + 1 noise levels of a run, the last of them 0.");
    m.def("scalings", &scaling_factors, "prediction"_a, "sigma"_a,
          "(c_skip, c_out, c_in): D = c_skip z + c_out F(c_in z).");
    m.def("normalize_latents", &normalize, "z"_a.noconvert(), "background"_a, "statistics"_a = "mean",
          "Gives every frame's background the statistics of frame 0's, in place. Returns frames without background.");
    m.def("sample", &sample_latents, "sampler"_a, "D"_a, "z"_a, "sigmas"_a, "after_step"_a = nb::none(),
          "z at the last level, from z at the first, following D(z, sigma, step), by euler, heun or dpmpp_2m. z is an "
          "array "
          "of any library, on any device. after_step(step, z) looks on.");
}
