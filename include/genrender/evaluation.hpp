// SPDX-License-Identifier: MIT
// Metrics of consistency, fidelity and flicker over finished frames: the component genrender::evaluation.
#pragma once

#include <genrender/evaluation/contrast.hpp>
#include <genrender/evaluation/correspondence_error.hpp>
#include <genrender/evaluation/embeddings.hpp>
#include <genrender/evaluation/flicker.hpp>
#include <genrender/evaluation/frame_consistency.hpp>
#include <genrender/evaluation/image_text_embedder.hpp>
#include <genrender/evaluation/mean_and_error.hpp>
#include <genrender/evaluation/perceptual_error.hpp>
#include <genrender/evaluation/pixel_correspondence.hpp>
#include <genrender/evaluation/pixel_objects.hpp>
#include <genrender/evaluation/prompt_fidelity.hpp>
#include <genrender/evaluation/recognition.hpp>
#include <genrender/evaluation/sharpness.hpp>
#include <genrender/evaluation/sticking.hpp>
#include <genrender/evaluation/subject_consistency.hpp>
#include <genrender/evaluation/temporal_flicker.hpp>
#include <genrender/evaluation/time_slice.hpp>
