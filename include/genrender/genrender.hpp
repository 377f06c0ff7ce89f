// SPDX-License-Identifier: MIT
// The core, in the order the data flows. The components have umbrellas of their own: genrender/scene.hpp, inspection.hpp,
// evaluation.hpp and reference.hpp.
#pragma once

#include <genrender/version.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/fingerprint.hpp>
#include <genrender/core/half_precision.hpp>
#include <genrender/core/half_storage.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/instance.hpp>
#include <genrender/core/linalg.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/plan_key.hpp>
#include <genrender/core/random.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/core/vector_target.hpp>
#include <genrender/core/vector_unit.hpp>
#include <genrender/core/vectors.hpp>

#include <genrender/maps/background_mask.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/cell_extents.hpp>
#include <genrender/maps/cell_shares.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/maps/uv_convention.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <genrender/maps/uv_maps_view.hpp>
#include <genrender/maps/uv_report.hpp>

#include <genrender/correspondence/chosen_correspondence.hpp>
#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/correspondence/correspondence_set.hpp>
#include <genrender/correspondence/footprint_map.hpp>
#include <genrender/correspondence/frame_cache.hpp>
#include <genrender/correspondence/frame_samples.hpp>
#include <genrender/correspondence/nearest_samples.hpp>
#include <genrender/correspondence/object_samples.hpp>
#include <genrender/correspondence/representative_pixel.hpp>
#include <genrender/correspondence/reproject.hpp>
#include <genrender/correspondence/sample_source.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/correspondence/surface_sample.hpp>
#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/correspondence/texture_projection.hpp>
#include <genrender/correspondence/texture_resolution.hpp>
#include <genrender/correspondence/token_matches.hpp>
#include <genrender/correspondence/visible_texels.hpp>

#include <genrender/noise/background_noise.hpp>
#include <genrender/noise/brownian_bridge.hpp>
#include <genrender/noise/initial_noise.hpp>
#include <genrender/noise/noise_request.hpp>
#include <genrender/noise/noise_texture.hpp>
#include <genrender/noise/noise_tree.hpp>
#include <genrender/noise/normals.hpp>
#include <genrender/noise/surface_noise.hpp>

#include <genrender/attention/any_attention_call.hpp>
#include <genrender/attention/any_features.hpp>
#include <genrender/attention/any_processor.hpp>
#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/attention_processor.hpp>
#include <genrender/attention/attention_scratch.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/attention/attention_tile.hpp>
#include <genrender/attention/attention_sources.hpp>
#include <genrender/attention/extended_attention.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/attention/host_features.hpp>
#include <genrender/attention/kept_variance.hpp>
#include <genrender/attention/key_counts.hpp>
#include <genrender/attention/key_value_view.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/attention/projected_features.hpp>
#include <genrender/attention/scaled_dot_product.hpp>

#include <genrender/sampling/classifier_free_guidance.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/dpmpp_2m.hpp>
#include <genrender/sampling/euler.hpp>
#include <genrender/sampling/heun.hpp>
#include <genrender/sampling/karras_schedule.hpp>
#include <genrender/sampling/latent_combination.hpp>
#include <genrender/sampling/latent_lender.hpp>
#include <genrender/sampling/lent_latents.hpp>
#include <genrender/sampling/noise_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>
#include <genrender/sampling/run_demands.hpp>
#include <genrender/sampling/run_shapes.hpp>
#include <genrender/sampling/sampler.hpp>
#include <genrender/sampling/sampler_arguments.hpp>
#include <genrender/sampling/sampler_history.hpp>
#include <genrender/sampling/storing_denoiser.hpp>

#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/keyframes/feature_bank.hpp>
#include <genrender/keyframes/recorder.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/blend_plans.hpp>
#include <genrender/blending/call_rows.hpp>
#include <genrender/blending/consensus.hpp>
#include <genrender/blending/consensus_settings.hpp>
#include <genrender/blending/mix_rows.hpp>
#include <genrender/blending/mix_rows_keeping_variance.hpp>
#include <genrender/blending/padded_rows.hpp>
#include <genrender/blending/point_counts.hpp>
#include <genrender/blending/quality_weights.hpp>
#include <genrender/blending/row_bound.hpp>
#include <genrender/blending/texel_weights.hpp>

#include <genrender/injection/alpha_schedule.hpp>
#include <genrender/injection/any_denoiser.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/injection/graph_abilities.hpp>
#include <genrender/injection/graph_pass.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/injection/injection_settings.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/injection/post_attention.hpp>
#include <genrender/injection/pre_attention.hpp>

#include <genrender/normalization/adain.hpp>
#include <genrender/normalization/adain_settings.hpp>
#include <genrender/normalization/channel_statistics.hpp>
#include <genrender/normalization/latent_normalizer.hpp>
#include <genrender/normalization/low_band.hpp>
#include <genrender/normalization/low_band_latents.hpp>
#include <genrender/normalization/normalization_target.hpp>
#include <genrender/normalization/supported_gain.hpp>

#include <genrender/pipeline/checkpoint.hpp>
#include <genrender/pipeline/estimate_consensus.hpp>
#include <genrender/pipeline/finished_step.hpp>
#include <genrender/pipeline/generative_rendering.hpp>
#include <genrender/pipeline/memory_plan.hpp>
#include <genrender/pipeline/pass_latents.hpp>
#include <genrender/pipeline/progress.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/pipeline/render_arguments.hpp>
#include <genrender/pipeline/render_report.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/pipeline/run_description.hpp>
#include <genrender/pipeline/run_fingerprint.hpp>
#include <genrender/pipeline/run_sampler.hpp>
#include <genrender/pipeline/sequence_denoiser.hpp>
#include <genrender/pipeline/sequence_passes.hpp>
#include <genrender/pipeline/sequence_method.hpp>
#include <genrender/pipeline/shapes_of_run.hpp>

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/previous_frame_attention.hpp>
#include <genrender/baselines/propagation_plan.hpp>
#include <genrender/baselines/token_propagation.hpp>
#include <genrender/baselines/tokenflow.hpp>
