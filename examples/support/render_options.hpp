// SPDX-License-Identifier: MIT
// The command line of the program generative_rendering.
#pragma once

#include "../scenes/scenes.hpp"
#include "consistency_options.hpp"
#include "correspondence_options.hpp"
#include "frame_file.hpp"
#include "injection_options.hpp"
#include "model_input_options.hpp"
#include "names.hpp"
#include "program.hpp"

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/vector_target.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <CLI/CLI.hpp>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace genrender::examples {

/// What the pictures shall show, and how strictly.
struct prompt_options {
    std::string text;
    std::string negative;
    std::optional<double> guidance_scale; ///< none: the model's usual
    double guidance_rescale = 0;
    double conditioning_scale = 1;
    std::size_t clip_skip = 0;
};

/// Everything a run is told. One of `scene`, `model` and `maps` is not empty.
struct render_options {
    std::string scene;
    std::filesystem::path model;
    std::filesystem::path maps;
    std::string view_layer; ///< of the maps; empty: all, the nearest surface of each pixel
    model_input_options input;
    prompt_options prompt;
    std::filesystem::path out;
    std::filesystem::path beside;                                    ///< an earlier run to compare with
    std::filesystem::path pipeline = GENRENDER_MINIATURE "/weights"; ///< a folder or a file
    std::filesystem::path engine;                                    ///< a library; empty: the pipeline
    std::filesystem::path controlnet;                                ///< empty: in the pipeline
    std::filesystem::path tokenizer;                                 ///< empty: in the pipeline
    std::string variant;                                             ///< of the files of weights
    std::optional<prediction> prediction_type;                       ///< of a single file
    std::vector<std::pair<std::filesystem::path, double>> loras;     ///< files and scales
    std::optional<std::size_t> frames;
    std::optional<std::size_t> keyframes;
    std::size_t size = 0;             ///< height of a frame; 0: the model's usual
    std::optional<std::size_t> width; ///< none: follows the input
    std::size_t threads = 0;
    std::optional<vector_target> vectors; ///< none: the processor's
    std::uint64_t seed = 0;
    render_method method = render_method::generative_rendering;
    frame_format format = frame_format::png8;
    bool has_alpha = false; ///< of the frames: where objects are
    bool is_quiet = false;
    bool resumes = false;       ///< goes on from OUT/checkpoint
    std::size_t preview = 0;    ///< steps from one preview to the next; 0: none
    bool keeps_latents = false; ///< writes what the pictures are decoded from, too
    bool is_check = false;      ///< tells what the maps are good for and renders nothing
    bool is_plan = false;       ///< tells what the run will take and renders nothing
    correspondence_options correspondence;
    injection_options injection;
    consistency_options consistency;
    render_settings<float> settings;
};

/// Thrown when the command line does not describe a run; `exit_code` is 0 after --help and 2 else.
struct no_run {
    int exit_code;
};

namespace detail {

inline std::string listed(auto const& names, char const* separator) {
    std::string text;
    for (auto const& name : names) {
        text += (text.empty() ? "" : separator) + std::string(name);
    }
    return text;
}

} // namespace detail

namespace detail {

/// `FILE:SCALE` or `FILE`, whose scale is 1. Throws CLI::ValidationError for a scale that is no number.
inline std::pair<std::filesystem::path, double> lora_of(std::string const& text) {
    auto const colon = text.rfind(':');
    if (colon == std::string::npos || colon + 1 == text.size()) {
        return {text.substr(0, colon), 1.0};
    }
    double scale = 0;
    auto const* const end = text.data() + text.size();
    auto const [rest, error] = std::from_chars(text.data() + colon + 1, end, scale);
    if (error != std::errc() || rest != end || !is_finite(scale)) {
        throw CLI::ValidationError("--lora",
                                   "scale is '" + text.substr(colon + 1) + "', expected a number, as in FILE:0.8");
    }
    return {text.substr(0, colon), scale};
}

} // namespace detail

/// The options of a command line. Prints help or what is wrong, and throws no_run, if there is nothing to run.
inline render_options parse_render_options(int argc, char const* const* argv,
                                           program_kind kind = program_kind::of_models) {
    render_options options;
    auto& settings = options.settings;
    CLI::App app(
        "Renders an animated, untextured 3D scene as a stylised animation: UV and depth maps guide a 2D diffusion\n"
        "network, whose features are kept consistent along the surfaces (Generative Rendering, Alg. 1).");
    app.get_formatter()->column_width(34);
    // Descriptions say what is allowed; the checks' own would say it again in another tongue.
    auto const positive = CLI::Range(std::size_t{1}, std::size_t{1} << 20).description("");
    auto const one_of = [](auto names) { return CLI::IsMember(std::move(names)).description(""); };
    CLI::Validator const not_empty([](std::string& text) { return text.empty() ? "is empty, expected a path" : ""; },
                                   "");

    CLI::Validator const not_negative(
        [](std::string& text) { return text.starts_with('-') ? "is " + text + ", expected 0 or more" : ""; }, "");

    auto* const input = app.add_option_group("Input", "what is rendered (one of the three)");
    input->add_option("--scene", options.scene, "built-in scene: " + detail::listed(scenes::names, ", "))
        ->check(one_of(std::vector<std::string>(scenes::names.begin(), scenes::names.end())))
        ->type_name("NAME");
    input->add_option("--model", options.model, "animated model file: glTF, FBX, Collada, and what else assimp reads")
        ->check(not_empty)
        ->type_name("FILE");
    input
        ->add_option("--maps", options.maps,
                     "folder of EXR files with UV, depth and object passes, as Blender writes them")
        ->check(not_empty)
        ->type_name("DIR");
    input->require_option(1);
    auto* const view_layer_option =
        app.add_option("--view-layer", options.view_layer,
                       "of --maps with several, the one to show (all, the nearest surface of each pixel)")
            ->check(CLI::Validator(
                [](std::string& text) { return text.empty() ? "is empty, expected a view layer's name" : ""; }, ""))
            ->type_name("NAME");
    CLI::App unknown; // Options of models, where there are none: nobody parses with it.
    auto& of_models = kind == program_kind::of_models ? app : unknown;
    auto const* const prompt_option =
        of_models.add_option("--prompt", options.prompt.text,
                             "what it shall look like; the miniature knows pictures of its small world alone, say\n"
                             "\"a red and white dotted ball on green ground\" (not needed with --check or --plan)");
    of_models.add_option("--negative-prompt", options.prompt.negative, "what it shall not look like")
        ->type_name("TEXT");
    of_models
        .add_option("--guidance", options.prompt.guidance_scale,
                    "scale of classifier-free guidance, 1 for none (7.5; 3 with the miniature)")
        ->check(CLI::Range(0.0, 100.0).description(""))
        ->type_name("G");
    of_models
        .add_option("--guidance-rescale", options.prompt.guidance_rescale,
                    "share of what a large guidance adds to contrast that is taken back, 0 to 1")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1.0).description(""))
        ->type_name("SHARE");
    app.add_option("--out", options.out, "folder for frames, maps, animation, contact sheet and report")
        ->required()
        ->check(not_empty)
        ->type_name("DIR");
    app.add_option("--beside", options.beside,
                   "folder of an earlier run, shown beside this one in comparison.png and .webp")
        ->check(not_empty)
        ->type_name("DIR");

    std::size_t frames = 0;
    auto* const frames_option =
        app.add_option(
               "--frames", frames,
               "number of frames (24; of a model taken evenly from its time, unless --fps is given, else its real\n"
               "time and at most 48; with --maps: at most this many)")
            ->check(positive)
            ->type_name("N");
    of_models
        .add_option("--size,--height", options.size,
                    "height of the frames in pixels (what the network was trained for: 128, 512); the width follows "
                    "the camera\n"
                    "or the maps; what the network renders besides, in whole steps of 16 or 64, is cut")
        ->check(positive)
        ->type_name("PX");
    of_models.add_option("--width", options.width, "width of the frames in pixels")->check(positive)->type_name("PX");
    options.input.add_to(app);
    std::string format = "png8";
    app.add_option("--frame-format", format, "of the frames: png8, png16 (bits a channel) or exr (linear light)")
        ->capture_default_str()
        ->check(one_of(all_names(frame_format_names)))
        ->type_name("FORMAT");
    app.add_flag("--alpha-channel", options.has_alpha, "frames carry the mask of the objects as alpha");
    settings.steps = 20;
    app.add_option("--steps", settings.steps, "denoising steps")
        ->capture_default_str()
        ->check(positive)
        ->type_name("N");
    app.add_option("--seed", options.seed, "of noise and keyframes")
        ->check(not_negative)
        ->capture_default_str()
        ->type_name("S");
    std::string sampler_name = "euler";
    app.add_option("--sampler", sampler_name, "euler, heun or dpmpp_2m")
        ->capture_default_str()
        ->check(one_of(all_names(sampler_names)))
        ->type_name("NAME");

    std::string method = "generative_rendering";
    app.add_option("--method", method,
                   "generative_rendering, or a baseline: per_frame, pix2video (frames attend to the first and the\n"
                   "previous one), tokenflow (outputs of keyframes are carried along)")
        ->capture_default_str()
        ->check(one_of(all_names(method_names)))
        ->type_name("NAME");
    std::string noise;
    auto* const noise_option =
        app.add_option("--noise", noise,
                       "initial noise: uv (moves with the surfaces), fixed (sticks to "
                       "the screen) or independent; uv, for per_frame independent, for the other "
                       "baselines fixed")
            ->check(one_of(all_names(noise_names)))
            ->type_name("KIND");
    auto* const ours = app.add_option_group("Of the method", "not with a baseline, but for --keyframes of tokenflow");
    std::size_t keyframes = 0;
    auto* const keyframes_option =
        ours->add_option("--keyframes", keyframes, "m, drawn anew each step (4, or all frames if they are fewer)")
            ->check(positive)
            ->type_name("M");
    options.injection.add_to(app, *ours);
    bool no_pre = false;
    bool no_post = false;
    bool no_adain = false;
    bool adain_deviations = false;
    ours->add_flag("--no-pre", no_pre, "no pre-attention injection (eq. 3 and 5)");
    ours->add_flag("--no-post", no_post, "no post-attention injection (eq. 6)");
    auto* const without = ours->add_flag("--no-adain", no_adain, "the same as --normalization none");
    auto* const deviations =
        ours->add_flag("--adain-deviations", adain_deviations, "the same as --normalization paper")->excludes(without);

    std::string storage = "same";
    ours->add_option("--feature-storage", storage,
                     "of the keyframes' features: same (as computed), float16 or bfloat16, in half the memory")
        ->capture_default_str()
        ->check(one_of(all_names(storage_names)))
        ->type_name("FORMAT");

    options.correspondence.add_to(app);
    options.consistency.add_to(app)->excludes(without)->excludes(deviations);
    app.add_option("--preview", options.preview, "every N steps what the frames look like so far, as OUT/preview.png")
        ->check(positive)
        ->type_name("N");
    app.add_flag(
        "--resume", options.resumes,
        "go on with the run that was interrupted in OUT, to the frames it would have had; all other options as\n"
        "they were");
    app.add_flag("--check", options.is_check,
                 "look before you run: what the maps are good for, as preflight.txt, .json and .png in OUT")
        ->excludes("--resume");
    app.add_flag("--plan", options.is_plan,
                 "say before you run: memory and work of the run, as a table, plan.txt and plan.json in OUT")
        ->excludes("--check")
        ->excludes("--resume");
    auto* const of_pipeline =
        of_models.add_option_group("Model", "Stable Diffusion 1.x or 2.x with a ControlNet for depth");
    of_pipeline
        ->add_option(
            "--pipeline", options.pipeline,
            "a folder in diffusers' layout or a checkpoint in one file (the miniature that comes with the library)")
        ->check(not_empty)
        ->type_name("DIR|FILE");
    of_pipeline
        ->add_option("--controlnet", options.controlnet, "its ControlNet, a folder or a file (the one in the pipeline)")
        ->check(not_empty)
        ->type_name("DIR|FILE");
    of_pipeline->add_option("--conditioning", options.prompt.conditioning_scale, "factor of what the ControlNet adds")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 10.0).description(""))
        ->type_name("SCALE");
    std::vector<std::string> loras;
    of_pipeline->add_option("--lora", loras, "a LoRA to merge into the weights, as often as there are (scale 1)")
        ->check(not_empty)
        ->allow_extra_args(false)
        ->type_name("FILE[:SCALE]");
    of_pipeline
        ->add_option("--tokenizer", options.tokenizer,
                     "folder with vocab.json and merges.txt (the one in the pipeline; a file has none)")
        ->check(not_empty)
        ->type_name("DIR");
    of_pipeline
        ->add_option("--variant", options.variant,
                     "of the weights in a folder, such as fp16 (the whole ones, else fp16)")
        ->check(not_empty)
        ->type_name("NAME");
    auto* const engine_option =
        of_pipeline
            ->add_option(
                "--engine", options.engine,
                "an engine of your own instead, a library with the function of genrender/c/engine.h: it knows\n"
                "its prompt and size, and its latents are pictures in three colours")
            ->check(not_empty)
            ->type_name("LIBRARY");
    std::string prediction_type;
    of_pipeline
        ->add_option(
            "--prediction-type", prediction_type,
            "epsilon or v_prediction: what a file of Stable Diffusion 2.x was trained for, which it does not say")
        ->check(one_of(all_names(prediction_type_names)))
        ->type_name("NAME");
    of_pipeline->add_option("--clip-skip", options.prompt.clip_skip, "last layers of the text encoder to leave out")
        ->capture_default_str()
        ->check(CLI::Range(0, 64).description(""))
        ->type_name("N");
    app.add_option("--threads", options.threads, "0: as many as the machine has")
        ->check(CLI::Range(0, 1024).description(""))
        ->capture_default_str()
        ->type_name("N");
    std::map<std::string, vector_target> targets;
    for (auto const target : available_vector_targets()) {
        targets.emplace(name_of(target), target);
    }
    app.add_option_function<std::string>(
           "--vectors", [&](std::string const& name) { options.vectors = targets.at(name); },
           "vector instructions of the kernels, to have the bits of another machine; the processor's best unless told")
        ->check(one_of(targets))
        ->type_name("TARGET");
    app.add_flag("--latents", options.keeps_latents,
                 "write the frames' latents as OUT/latents.npy, too, to decode them elsewhere");
    app.add_flag("--quiet", options.is_quiet, "no progress");
    app.footer(
        "It writes OUT/frames/0000.png ..., OUT/maps/, OUT/animation.webp, OUT/contact_sheet.png and OUT/report.json.\n"
        "Exit code: 0 done, 1 failed, 2 bad arguments, 130 interrupted by Ctrl-C: --resume goes on from the last "
        "step.");
    try {
        app.parse(argc, argv);
        options.input.require_input(!options.model.empty(), !options.scene.empty());
        options.method = value_in(method_names, method);
        auto const foreign = ours->count_all() -
                             (options.method == render_method::tokenflow ? keyframes_option->count() : std::size_t{0});
        if (options.method != render_method::generative_rendering && foreign > 0) {
            throw CLI::ValidationError("--method", method + " has no keyframes, injection or normalisation to set");
        }
        if (options.method == render_method::per_frame && options.injection.temperature) {
            throw CLI::ValidationError("--temperature", "is of methods in which frames attend to others");
        }
        if (options.is_plan &&
            (options.method == render_method::pix2video || options.method == render_method::tokenflow)) {
            throw CLI::ValidationError("--plan", "is of generative_rendering and per_frame");
        }
        if (view_layer_option->count() > 0 && options.maps.empty()) {
            throw CLI::ValidationError("--view-layer", "is of --maps");
        }
        if (engine_option->count() > 0 &&
            (of_pipeline->count_all() > 1 || prompt_option->count() > 0 || !options.prompt.negative.empty() ||
             options.prompt.guidance_scale || options.size > 0 || options.width)) {
            throw CLI::ValidationError("--engine", "knows its own model, prompt, guidance and size");
        }
        if (kind == program_kind::of_models && engine_option->count() == 0 && prompt_option->count() == 0 &&
            !options.is_check && !options.is_plan) {
            throw CLI::RequiredError("--prompt");
        }
        for (auto const& lora : loras) {
            options.loras.push_back(detail::lora_of(lora));
        }
        options.injection.start_from_preset(settings);
        options.correspondence.default_to(settings, app);
        options.correspondence.apply_to(settings);
        options.injection.apply_to(settings);
        settings.injection.pre_attention = !no_pre;
        settings.injection.post_attention = !no_post;
        settings.normalization.enabled = settings.normalization.enabled && !no_adain;
        if (adain_deviations) {
            settings.normalization.enabled = true;
            settings.normalization.statistics = adain_statistics::mean_and_deviation;
        }
        if (options.method == render_method::per_frame) {
            settings = per_frame(settings);
        } else if (options.method != render_method::generative_rendering) {
            settings = baseline_settings(settings);
        }
        options.consistency.apply_to(settings);
    } catch (CLI::ParseError const& error) {
        throw no_run{app.exit(error) == 0 ? 0 : 2};
    }

    if (!prediction_type.empty()) {
        options.prediction_type = value_in(prediction_type_names, prediction_type);
    }
    if (frames_option->count() > 0) {
        options.frames = frames;
    }
    if (keyframes_option->count() > 0) {
        options.keyframes = keyframes;
    }
    options.format = value_in(frame_format_names, format);
    settings.sampler = value_in(sampler_names, sampler_name);
    settings.keyframe_storage = value_in(storage_names, storage);
    settings.noise.seed = options.seed;
    settings.keyframes.seed = options.seed;
    settings.consensus.sources.seed = options.seed;
    if (noise_option->count() > 0) {
        settings.noise.kind = value_in(noise_names, noise);
    }
    return options;
}

} // namespace genrender::examples
