// SPDX-License-Identifier: MIT
// An engine in C11, which is C++11, too: a small denoiser of pictures in three colours with one self-attention module, in plain
// loops. It is called back; what it computes is testing::analytic_denoiser of the library, so its frames are known.
#include <genrender/c/engine.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef ENGINE_FUNCTION
#define ENGINE_FUNCTION genrender_engine_of
#endif

enum { height = 16, width = 16, tokens = height * width, channels = 3, branches = 2 };
static float const mean = 0.5f;    // of the pictures that it knows
static float const spread = 0.25f; // their standard deviation
static float const share = 0.5f;   // of attention in its estimates

// A stack [frames, tokens, channels].
typedef struct stack {
    size_t frames;
    float* values;
} stack;

static stack* new_stack(size_t frames) {
    stack* made = (stack*)malloc(sizeof(stack));
    if (made != NULL) {
        made->frames = frames;
        made->values = (float*)calloc(frames * tokens * channels, sizeof(float));
        if (made->values == NULL) {
            free(made);
            made = NULL;
        }
    }
    return made;
}

static void release(void* context, genrender_features* features) {
    (void)context;
    free(((stack*)features)->values);
    free(features);
}

// Queries, keys and values are the features themselves.
static genrender_features* copy_of(void* context, genrender_call const* call, genrender_features const* f) {
    stack const* from = (stack const*)f;
    stack* to = new_stack(from->frames);
    (void)context;
    (void)call;
    if (to != NULL) {
        memcpy(to->values, from->values, from->frames * tokens * channels * sizeof(float));
    }
    return to;
}

static float const* token_of(genrender_features const* f, size_t frame, size_t token) {
    return ((stack const*)f)->values + (frame * tokens + token) * channels;
}

static genrender_features* attend(void* context, genrender_call const* call, genrender_features const* Q,
                                  genrender_sources sources) {
    stack* F = new_stack(sources.frames);
    (void)context;
    (void)call;
    for (size_t i = 0; F != NULL && i < sources.frames; ++i) {
        float const scale = sources.scales != NULL ? sources.scales[i] : 1.0f;
        for (size_t t = 0; t < tokens; ++t) {
            float const* q = token_of(Q, i, t);
            float* out = F->values + (i * tokens + t) * channels;
            float sum = 0;
            for (size_t b = sources.offsets[i]; b < sources.offsets[i + 1]; ++b) {
                genrender_block const* block = &sources.blocks[b];
                for (size_t s = 0; s < tokens; ++s) {
                    float const* k = token_of(block->K, block->frame, s);
                    float const* v = token_of(block->V, block->frame, s);
                    float logit = 0;
                    for (size_t c = 0; c < channels; ++c) {
                        logit += q[c] * k[c];
                    }
                    // Features are a few units at most, so that nothing overflows.
                    float const weight = expf(scale * logit / sqrtf((float)channels));
                    sum += weight;
                    for (size_t c = 0; c < channels; ++c) {
                        out[c] += weight * v[c];
                    }
                }
            }
            for (size_t c = 0; c < channels; ++c) {
                out[c] /= sum;
            }
        }
    }
    return F;
}

static genrender_features* mix(void* context, genrender_call const* call, genrender_features const* F_hat,
                               genrender_features const* F_KF, genrender_rows const* rows, float alpha) {
    stack* F = (stack*)copy_of(context, call, F_hat);
    for (size_t i = 0; F != NULL && i < F->frames; ++i) {
        for (size_t t = 0; t < tokens; ++t) {
            float* out = F->values + (i * tokens + t) * channels;
            for (size_t c = 0; c < channels && rows[i].offsets[t] < rows[i].offsets[t + 1]; ++c) {
                float blended = 0;
                for (uint32_t e = rows[i].offsets[t]; e < rows[i].offsets[t + 1]; ++e) {
                    blended += rows[i].weights[e] * token_of(F_KF, 0, rows[i].sources[e])[c];
                }
                out[c] = alpha * blended + (1 - alpha) * out[c];
            }
        }
    }
    return F;
}

static int denoise(void* context, genrender_latents x0, genrender_const_latents z, float sigma, uint32_t const* frames,
                   genrender_processor const* processor) {
    float const gain = spread * spread / (spread * spread + sigma * sigma);
    size_t const size = tokens * channels;
    for (size_t e = 0; e < z.frames * size; ++e) {
        x0.values[e] = (1 - share) * (mean + gain * (z.values[e] - mean));
    }
    for (uint32_t branch = 0; branch < branches; ++branch) { // which differ by their sign
        float const sign = branch == 0 ? 1.0f : -1.0f;
        stack* f = new_stack(z.frames);
        if (f == NULL) {
            processor->fail(processor, "there is no memory for features");
            return 1;
        }
        for (size_t i = 0; i < z.frames; ++i) {
            for (size_t t = 0; t < tokens; ++t) {
                for (size_t c = 0; c < channels; ++c) {
                    float const value = z.values[(i * channels + c) * tokens + t];
                    f->values[(i * tokens + t) * channels + c] = sign * (mean + gain * (value - mean));
                }
            }
        }
        genrender_call const call = {{0, branch}, frames, z.frames, f, NULL};
        genrender_features const* F = processor->run(processor, &call);
        if (F != NULL) {
            for (size_t i = 0; i < z.frames; ++i) {
                for (size_t t = 0; t < tokens; ++t) {
                    for (size_t c = 0; c < channels; ++c) {
                        x0.values[(i * channels + c) * tokens + t] += share * sign * token_of(F, i, t)[c] / branches;
                    }
                }
            }
        }
        release(context, f);
        if (F == NULL) {
            return 1;
        }
    }
    return 0;
}

#ifdef __cplusplus
extern "C"
#endif
    genrender_engine const*
    ENGINE_FUNCTION(void);

genrender_engine const* ENGINE_FUNCTION(void) {
    static genrender_site const sites[] = {
        {"decoder.attn1", GENRENDER_NETWORK_DENOISING, GENRENDER_PART_DECODER, {height, width}, channels}};
    static genrender_engine const engine = {GENRENDER_ENGINE_VERSION,
                                            NULL,
                                            channels,
                                            {height, width},
                                            sites,
                                            1,
                                            branches,
                                            0.02f,
                                            10.0f,
                                            denoise,
                                            release,
                                            copy_of,
                                            copy_of,
                                            copy_of,
                                            attend,
                                            mix,
                                            1};
    return &engine;
}
