# SPDX-License-Identifier: MIT
# What the library is made of: its components, the packages that each needs, and every header. From this one list come the
# targets, the package's config and .pc files, and what the rules of the house compare the headers with.

# genrender_package(NAME TARGET target INCLUDES expression [LEAST version] [PKG_CONFIG module] [LIBS flags] [MODULE])
#   NAME         what find_package calls it, by its config file unless MODULE says otherwise; TARGET is what is linked
#   INCLUDES     how an include of this package begins, after its `<`
#   LEAST        the oldest version that will do
#   PKG_CONFIG   its name there; LIBS are flags of a package that has none
macro(genrender_package name)
    cmake_parse_arguments(genrender_${name} "MODULE" "TARGET;INCLUDES;LEAST;PKG_CONFIG;LIBS" "" ${ARGN})
endmacro()

# genrender_component(NAME [PACKAGES packages] HEADERS headers)
#   The core is genrender::genrender and has its rooms in the order in which the data flows. Every other component is
#   genrender::NAME, lies in the room of its name, and links its packages and the core. Headers lie in include/genrender,
#   the umbrella first; a file *.inl is a part of the headers that include it. The room `testing` holds the laws of the
#   concepts of every component; each belongs to the component of its concept and to no umbrella.
macro(genrender_component name)
    list(APPEND genrender_components ${name})
    cmake_parse_arguments(genrender_${name} "" "" "PACKAGES;HEADERS" ${ARGN})
endmacro()

# genrender_adapter(NAME PACKAGES packages HEADERS headers)
#   A component that lets an engine's own tensors through: genrender::NAME, whose headers lie in the room `adapters`, the
#   first of them being its umbrella, which nothing else includes. Its packages are the engine's and found by whoever uses
#   it: they are neither looked for here nor by find_package(genrender), and linked where the user's project has their
#   targets.
macro(genrender_adapter name)
    list(APPEND genrender_adapters ${name})
    cmake_parse_arguments(genrender_${name} "" "" "PACKAGES;HEADERS" ${ARGN})
endmacro()

genrender_package(Eigen3 TARGET Eigen3::Eigen INCLUDES "Eigen/" LEAST 3.4 PKG_CONFIG eigen3)
genrender_package(xtensor TARGET xtensor INCLUDES "(xtensor|xtl|xsimd)/" PKG_CONFIG xtensor)
genrender_package(nanoflann TARGET nanoflann::nanoflann INCLUDES "nanoflann[.]hpp" PKG_CONFIG nanoflann)
genrender_package(Threads MODULE TARGET Threads::Threads INCLUDES "thread>" LIBS -pthread)
genrender_package(glm TARGET glm::glm INCLUDES "glm/" PKG_CONFIG glm)
genrender_package(nlohmann_json TARGET nlohmann_json::nlohmann_json INCLUDES "nlohmann/" PKG_CONFIG nlohmann_json)
genrender_package(utf8proc MODULE TARGET utf8proc::utf8proc INCLUDES "utf8proc[.]h" PKG_CONFIG libutf8proc)

genrender_package(Torch TARGET torch INCLUDES "(ATen|c10|torch)/")
genrender_package(ggml TARGET ggml::ggml INCLUDES "ggml(-[a-z]+)?[.]h")
genrender_package(OpenMP MODULE TARGET OpenMP::OpenMP_CXX INCLUDES "omp[.]h")
genrender_package(TBB TARGET TBB::tbb INCLUDES "tbb/")
genrender_package(OpenVINO TARGET openvino::runtime INCLUDES "openvino/")

set(genrender_components "")
set(genrender_adapters "")
genrender_component(core PACKAGES Eigen3 xtensor nanoflann Threads HEADERS
    genrender.hpp
    version.hpp
    core/begin_header.inl
    core/each_target.inl
    core/end_header.inl
    core/error.hpp
    core/finite.hpp
    core/fingerprint.hpp
    core/half_precision.hpp
    core/half_storage.hpp
    core/index.hpp
    core/instance.hpp
    core/linalg.hpp
    core/linear_combination.hpp
    core/linear_combination.inl
    core/parallel.hpp
    core/plan_key.hpp
    core/random.hpp
    core/sparse_rows.hpp
    core/stack.hpp
    core/strided_view.hpp
    core/tensor.hpp
    core/vector_target.hpp
    core/vector_unit.hpp
    core/vectors.hpp
    core/vectors.inl
    core/widening.inl
    maps/background_mask.hpp
    maps/canonical_maps.hpp
    maps/cell_extents.hpp
    maps/cell_shares.hpp
    maps/depth_maps.hpp
    maps/uv_convention.hpp
    maps/uv_maps.hpp
    maps/uv_maps_view.hpp
    maps/uv_report.hpp
    correspondence/chosen_correspondence.hpp
    correspondence/correspondence_map.hpp
    correspondence/correspondence_set.hpp
    correspondence/footprint_map.hpp
    correspondence/frame_cache.hpp
    correspondence/frame_samples.hpp
    correspondence/nearest_samples.hpp
    correspondence/object_samples.hpp
    correspondence/representative_pixel.hpp
    correspondence/reproject.hpp
    correspondence/sample_source.hpp
    correspondence/surface_footprint.hpp
    correspondence/surface_sample.hpp
    correspondence/texel_grid.hpp
    correspondence/texture_projection.hpp
    correspondence/texture_resolution.hpp
    correspondence/token_matches.hpp
    correspondence/visible_texels.hpp
    noise/background_noise.hpp
    noise/brownian_bridge.hpp
    noise/initial_noise.hpp
    noise/noise_request.hpp
    noise/noise_texture.hpp
    noise/noise_tree.hpp
    noise/normals.hpp
    noise/normals.inl
    noise/surface_noise.hpp
    attention/any_attention_call.hpp
    attention/any_features.hpp
    attention/any_processor.hpp
    attention/attention_call.hpp
    attention/attention_processor.hpp
    attention/attention_scratch.hpp
    attention/attention_scratch.inl
    attention/attention_site.hpp
    attention/attention_sources.hpp
    attention/attention_tile.hpp
    attention/attention_tile.inl
    attention/extended_attention.hpp
    attention/feature_storage.hpp
    attention/host_features.hpp
    attention/kept_variance.hpp
    attention/key_counts.hpp
    attention/key_value_view.hpp
    attention/length_correction.hpp
    attention/plain_attention.hpp
    attention/projected_features.hpp
    attention/scaled_dot_product.hpp
    attention/scaled_dot_product.inl
    sampling/classifier_free_guidance.hpp
    sampling/denoiser.hpp
    sampling/dpmpp_2m.hpp
    sampling/euler.hpp
    sampling/heun.hpp
    sampling/karras_schedule.hpp
    sampling/latent_combination.hpp
    sampling/latent_lender.hpp
    sampling/lent_latents.hpp
    sampling/noise_schedule.hpp
    sampling/preconditioning.hpp
    sampling/run_demands.hpp
    sampling/run_shapes.hpp
    sampling/sampler.hpp
    sampling/sampler_arguments.hpp
    sampling/sampler_history.hpp
    sampling/storing_denoiser.hpp
    keyframes/draw_keyframes.hpp
    keyframes/feature_bank.hpp
    keyframes/recorder.hpp
    keyframes/stoppable_denoiser.hpp
    blending/blend_plan.hpp
    blending/blend_plans.hpp
    blending/call_rows.hpp
    blending/consensus.hpp
    blending/consensus_settings.hpp
    blending/mix_rows.hpp
    blending/mix_rows.inl
    blending/mix_rows_keeping_variance.hpp
    blending/mix_rows_keeping_variance.inl
    blending/padded_rows.hpp
    blending/point_counts.hpp
    blending/quality_weights.hpp
    blending/row_bound.hpp
    blending/texel_weights.hpp
    injection/alpha_schedule.hpp
    injection/any_denoiser.hpp
    injection/feature_io.hpp
    injection/graph_abilities.hpp
    injection/graph_pass.hpp
    injection/host_attention_call.hpp
    injection/injection_settings.hpp
    injection/injector.hpp
    injection/post_attention.hpp
    injection/pre_attention.hpp
    normalization/adain.hpp
    normalization/adain.inl
    normalization/adain_settings.hpp
    normalization/channel_statistics.hpp
    normalization/channel_statistics.inl
    normalization/latent_normalizer.hpp
    normalization/low_band.hpp
    normalization/low_band_latents.hpp
    normalization/normalization_target.hpp
    normalization/supported_gain.hpp
    pipeline/checkpoint.hpp
    pipeline/estimate_consensus.hpp
    pipeline/finished_step.hpp
    pipeline/generative_rendering.hpp
    pipeline/memory_plan.hpp
    pipeline/pass_latents.hpp
    pipeline/progress.hpp
    pipeline/render.hpp
    pipeline/render_arguments.hpp
    pipeline/render_report.hpp
    pipeline/render_settings.hpp
    pipeline/run_description.hpp
    pipeline/run_fingerprint.hpp
    pipeline/run_sampler.hpp
    pipeline/sequence_denoiser.hpp
    pipeline/sequence_passes.hpp
    pipeline/sequence_method.hpp
    pipeline/shapes_of_run.hpp
    baselines/baseline_settings.hpp
    baselines/per_frame.hpp
    baselines/pix2video.hpp
    baselines/previous_frame_attention.hpp
    baselines/propagation_plan.hpp
    baselines/token_propagation.hpp
    baselines/tokenflow.hpp
    testing/analytic_denoiser.hpp
    testing/at_once.hpp
    testing/attention_call_laws.hpp
    testing/attention_processor_laws.hpp
    testing/correspondence_laws.hpp
    testing/denoiser_laws.hpp
    testing/latent_lender_laws.hpp
    testing/law_report.hpp
    testing/optional_call_laws.hpp
    testing/parallel_loop_laws.hpp
    testing/random_stack.hpp
    testing/sequence_method_laws.hpp)

genrender_component(scene PACKAGES glm HEADERS
    scene.hpp
    scene/animation.hpp
    scene/bounds.hpp
    scene/camera.hpp
    scene/frame_rasterizer.hpp
    scene/mesh.hpp
    scene/primitives.hpp
    scene/rasterizer.hpp
    scene/skinning.hpp
    scene/triangle_coverage.hpp
    scene/uv_overlap.hpp
    testing/animation_laws.hpp)

genrender_component(inspection HEADERS
    inspection.hpp
    inspection/coordinate_levels.hpp
    inspection/finite_maps.hpp
    inspection/frame_inspection.hpp
    inspection/grid_check.hpp
    inspection/map_check.hpp
    inspection/map_recommendations.hpp
    inspection/object_check.hpp
    inspection/pixel_check.hpp
    inspection/pixel_lattice.hpp
    inspection/preflight.hpp
    inspection/recommendation.hpp
    inspection/screen_search.hpp
    inspection/texture_tiles.hpp)

genrender_component(evaluation HEADERS
    evaluation.hpp
    evaluation/contrast.hpp
    evaluation/correspondence_error.hpp
    evaluation/embeddings.hpp
    evaluation/flicker.hpp
    evaluation/frame_consistency.hpp
    evaluation/image_text_embedder.hpp
    evaluation/mean_and_error.hpp
    evaluation/perceptual_error.hpp
    evaluation/pixel_correspondence.hpp
    evaluation/pixel_objects.hpp
    evaluation/prompt_fidelity.hpp
    evaluation/recognition.hpp
    evaluation/sharpness.hpp
    evaluation/sticking.hpp
    evaluation/subject_consistency.hpp
    evaluation/temporal_flicker.hpp
    evaluation/time_slice.hpp
    testing/embedder_laws.hpp)

genrender_component(reference PACKAGES nlohmann_json utf8proc HEADERS
    reference.hpp
    reference/activation.hpp
    reference/activation.inl
    reference/attention_matrices.hpp
    reference/autoencoder_config.hpp
    reference/autoencoder_config_file.hpp
    reference/autoencoder_kl.hpp
    reference/byte_pair_encoding.hpp
    reference/byte_pair_files.hpp
    reference/checked_json.hpp
    reference/clip_added_tokens.hpp
    reference/clip_declarations.hpp
    reference/clip_text_config.hpp
    reference/clip_text_config_file.hpp
    reference/clip_text_encoder.hpp
    reference/clip_text_layer.hpp
    reference/clip_tokenizer.hpp
    reference/clip_tokenizer_folder.hpp
    reference/clip_words.hpp
    reference/compvis_architecture.hpp
    reference/compvis_modules.hpp
    reference/compvis_names.hpp
    reference/config_file.hpp
    reference/controlnet.hpp
    reference/conv2d.hpp
    reference/diffusers_config.hpp
    reference/diffusers_folder.hpp
    reference/embedded_hints.hpp
    reference/encoded_frames.hpp
    reference/feature_maps.hpp
    reference/feed_forward.hpp
    reference/forward_pass.hpp
    reference/group_norm.hpp
    reference/group_norm.inl
    reference/image_tower.hpp
    reference/layer_norm.hpp
    reference/layer_norm.inl
    reference/linear.hpp
    reference/lora_difference.hpp
    reference/lora_file.hpp
    reference/lora_merge.hpp
    reference/map_stripes.hpp
    reference/model_part.hpp
    reference/network_conditioning.hpp
    reference/padded_map.hpp
    reference/panel_source.hpp
    reference/pickles.hpp
    reference/pipeline_files.hpp
    reference/reference_clip.hpp
    reference/reference_network.hpp
    reference/resampler.hpp
    reference/resnet_block.hpp
    reference/safetensors.hpp
    reference/safetensors_weights.hpp
    reference/seeded_tensor.hpp
    reference/single_file.hpp
    reference/site_list.hpp
    reference/spare_map.hpp
    reference/spatial_transformer.hpp
    reference/stable_diffusion.hpp
    reference/tensor_file.hpp
    reference/tensor_place.hpp
    reference/time_embedding.hpp
    reference/transformer_block.hpp
    reference/unet.hpp
    reference/unet_config.hpp
    reference/unet_encoder.hpp
    reference/unicode_text.hpp
    reference/vae_attention.hpp
    reference/vae_decoder.hpp
    reference/vae_encoder.hpp
    reference/vae_mid_block.hpp
    reference/vae_resampler.hpp
    reference/vae_resnet.hpp
    reference/weight_files.hpp
    reference/weight_panels.hpp
    reference/weight_panels.inl
    reference/weight_storage.hpp
    reference/weights.hpp)

genrender_component(c HEADERS
    c.hpp
    c/engine.h
    c/engine_call.hpp
    c/engine_denoiser.hpp)

genrender_adapter(torch PACKAGES Torch HEADERS
    adapters/torch.hpp
    adapters/torch_denoiser.hpp
    adapters/torch_latents.hpp
    adapters/torch_mix.hpp
    adapters/torch_plans.hpp)

genrender_adapter(cuda HEADERS
    adapters/cuda/mix_rows.cuh
    adapters/cuda/torch_mix.cuh)
# What adapters of static graphs share is in each of them.
set(genrender_graph_headers
    adapters/graph_denoiser.hpp
    adapters/graph_feature_io.hpp)
genrender_adapter(ggml PACKAGES ggml HEADERS
    adapters/ggml.hpp
    adapters/ggml_memory.hpp
    adapters/ggml_site.hpp
    ${genrender_graph_headers})
genrender_adapter(openvino PACKAGES OpenVINO HEADERS
    adapters/openvino.hpp
    adapters/openvino_memory.hpp
    adapters/openvino_site.hpp
    ${genrender_graph_headers})
genrender_adapter(eigen HEADERS
    adapters/eigen.hpp)
genrender_adapter(mdspan HEADERS
    adapters/mdspan.hpp)
genrender_adapter(xtensor PACKAGES xtensor HEADERS
    adapters/xtensor.hpp)
genrender_adapter(openmp PACKAGES OpenMP HEADERS
    adapters/openmp.hpp)
genrender_adapter(tbb PACKAGES TBB HEADERS
    adapters/tbb.hpp)
