// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] An engine as a table of functions, in C11 and C++11: for hosts below C++20, and for engines that are loaded.
#pragma once

// An engine's own code includes this header alone, fills in a genrender_engine and hands it to a unit of C++20, which wraps it
// (genrender/c/engine_denoiser.hpp) and renders. An engine in a library of its own exports a function
//
//     genrender_engine const* genrender_engine_of(void);
//
// There are two ways in, of which an engine takes one in each call of `denoise`. Called back, it calls `processor->run` at each
// of its self-attention modules and takes the module's output from it; the operations `query` to `mix` are then asked of it. As a
// static graph it asks `processor->inputs` for every module before it runs, and calls `processor->record` afterwards where the
// inputs say `is_recorded`; the operations may then be null.
//
// Features are handles of the engine, stacks [frames, tokens, channels] with the tokens row by row. A handle that the engine
// returns or gives away is the library's, which gives it back to `release` once; a handle that the engine is lent is valid until
// the function returns. No function may let an exception out. A failure is told by `processor->fail` and ends all calls at once:
// a function that was told of one (run returned null, inputs or record not 0) releases what it holds and returns its own failure.
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// What `genrender_engine::version` is. Tables of another number are refused.
#define GENRENDER_ENGINE_VERSION 1

/// A handle of features of the engine: what it points to is the engine's affair.
typedef void genrender_features;

/// Height and width of a grid.
typedef struct genrender_grid {
    size_t height; ///< rows
    size_t width;  ///< columns
} genrender_grid;

/// Latents [frames, channels, height, width], row-major without gaps.
typedef struct genrender_latents {
    float* values;       ///< the first element
    size_t frames;       ///< entries of the stack
    size_t channels;     ///< of the latents
    genrender_grid grid; ///< of the latents
} genrender_latents;

/// Latents that are only read.
typedef struct genrender_const_latents {
    float const* values; ///< the first element
    size_t frames;       ///< entries of the stack
    size_t channels;     ///< of the latents
    genrender_grid grid; ///< of the latents
} genrender_const_latents;

/// Which of the networks holds a module.
typedef enum genrender_network {
    GENRENDER_NETWORK_DENOISING = 0, ///< the one that predicts the latents
    GENRENDER_NETWORK_CONTROL = 1    ///< a ControlNet or the like
} genrender_network;

/// Which part of the network holds it.
typedef enum genrender_part {
    GENRENDER_PART_ENCODER = 0, ///< on the way to the coarsest grid
    GENRENDER_PART_MIDDLE = 1,  ///< at the coarsest grid
    GENRENDER_PART_DECODER = 2  ///< on the way back
} genrender_part;

/// A self-attention module.
typedef struct genrender_site {
    char const* name;          ///< as the engine calls it, ended by 0
    genrender_network network; ///< that it is a part of
    genrender_part part;       ///< of that network
    genrender_grid grid;       ///< of its features
    size_t channels;           ///< of its features
} genrender_site;

/// Which module, by its number in `sites`, and which guidance branch.
typedef struct genrender_place {
    uint32_t site;   ///< from 0
    uint32_t branch; ///< from 0
} genrender_place;

/// One run of a module, when the engine calls back: it lives until `run` returns.
typedef struct genrender_call {
    genrender_place place;  ///< which module and branch
    uint32_t const* frames; ///< which frame of the animation each entry of the stack is
    size_t frame_count;     ///< entries of the stack
    genrender_features* f;  ///< input of the module, after its LayerNorm; stays the engine's
    void* context;          ///< what the engine wants to find again in its operations
} genrender_call;

/// Keys and values of one frame: row `frame` of the stacks K and V.
typedef struct genrender_block {
    genrender_features const* K; ///< keys, lent
    genrender_features const* V; ///< values, lent
    size_t frame;                ///< entry of both
} genrender_block;

/// What each frame of the queries attends to: frame i the blocks of number offsets[i] to offsets[i + 1] - 1, as if their
/// tokens stood in a row.
typedef struct genrender_sources {
    genrender_block const* blocks; ///< of all frames
    size_t const* offsets;         ///< frames + 1 of them
    size_t frames;                 ///< of the queries
    float const*
        scales; ///< a frame each: what its logits are multiplied by beside 1 / sqrt(d); null if all by 1, and for
                ///< engines without `scales_logits`
} genrender_sources;

/// One frame's rows of eq. 6: F_bar[t] is the sum of weights[e] F_KF[sources[e]] for e from offsets[t] to offsets[t + 1]
/// - 1, where the rows of F_KF are counted through all keyframes; a token without such an e keeps its own.
typedef struct genrender_rows {
    uint32_t const* offsets; ///< tokens + 1 of them
    uint32_t const* sources; ///< rows of F_KF
    float const* weights;    ///< one a source
    size_t tokens;           ///< of the frame
} genrender_rows;

/// What a static graph is given at one place beside its weights; it points to memory that lives until `denoise` returns.
typedef struct genrender_inputs {
    int attends_to_stack;           ///< not 0: eq. 3, keys and values of all frames of the stack
    genrender_features const* f_KF; ///< eq. 5: joined to each frame's own f; null for none
    int32_t const* left_out; ///< a frame each: the keyframe of f_KF that it does not join, or -1; null without f_KF
    genrender_features const* F_KF; ///< eq. 6; null for none
    genrender_rows const* rows;     ///< a frame each; null without F_KF
    float alpha;                    ///< eq. 6: F becomes alpha F_bar + (1 - alpha) F where a row has entries
    int is_recorded;                ///< not 0: f and F are to be handed to `record`
    float const* scales;            ///< as in genrender_sources
} genrender_inputs;

/// What the library does at self-attention modules during one call of `denoise`.
typedef struct genrender_processor genrender_processor;
struct genrender_processor {
    void* context; ///< the library's
    /// The output of a module, which takes the place of the engine's own; lent until `run` is called again for this
    /// branch, or `denoise` returns. Null for a failure.
    genrender_features* (*run)(genrender_processor const* processor, genrender_call const* call);
    /// Fills in the inputs of a place. Not 0 for a failure.
    int (*inputs)(genrender_processor const* processor, genrender_place place, uint32_t const* frames,
                  size_t frame_count, genrender_inputs* inputs);
    /// Takes f and F of a place, which are the library's from here on, also when it fails. Not 0 for a failure.
    int (*record)(genrender_processor const* processor, genrender_place place, genrender_features* f,
                  genrender_features* F);
    /// Says why the engine is going to fail; the text is copied.
    void (*fail)(genrender_processor const* processor, char const* text);
};

/// An engine. All functions are called for different frames at the same time if the run has several threads.
typedef struct genrender_engine {
    uint32_t version;            ///< GENRENDER_ENGINE_VERSION
    void* context;               ///< the engine's, first argument of its functions
    size_t latent_channels;      ///< of z
    genrender_grid latent_grid;  ///< of z
    genrender_site const* sites; ///< the modules that take part or may
    size_t site_count;           ///< how many
    size_t branches;             ///< guidance branches: 1, or 2 with classifier-free guidance
    float sigma_min;             ///< lowest noise level that it was trained for, above 0
    float sigma_max;             ///< the highest
    /// Writes D(z, sigma) into x0, running the processor at each site of each branch. Not 0 for a failure.
    int (*denoise)(void* context, genrender_latents x0, genrender_const_latents z, float sigma, uint32_t const* frames,
                   genrender_processor const* processor);
    /// Gives a handle back.
    void (*release)(void* context, genrender_features* features);
    /// W^Q f, W^K f and W^V f [GR eq. 2] for any stack f, in new handles; null for a failure.
    genrender_features* (*query)(void* context, genrender_call const* call, genrender_features const* f);
    genrender_features* (*key)(void* context, genrender_call const* call,
                               genrender_features const* f); ///< see query
    genrender_features* (*value)(void* context, genrender_call const* call,
                                 genrender_features const* f); ///< see query
    /// F [GR eq. 1] of the queries over their sources in one softmax, in a new handle; null for a failure.
    genrender_features* (*attend)(void* context, genrender_call const* call, genrender_features const* Q,
                                  genrender_sources sources);
    /// F of eq. 6 from F_hat and one genrender_rows a frame, in a new handle; null for a failure.
    genrender_features* (*mix)(void* context, genrender_call const* call, genrender_features const* F_hat,
                               genrender_features const* F_KF, genrender_rows const* rows, float alpha);
    int scales_logits; ///< not 0: `attend` and graphs honour `scales`; else runs that scale logits are refused
} genrender_engine;

/// The name of the function that a library of an engine exports, as dlsym takes it, and its type.
#define GENRENDER_ENGINE_FUNCTION "genrender_engine_of"
typedef genrender_engine const* (*genrender_engine_function)(void); ///< see GENRENDER_ENGINE_FUNCTION

#ifdef __cplusplus
}
#endif
