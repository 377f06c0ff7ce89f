// SPDX-License-Identifier: MIT
// [GR eq. 1-3] One run of one self-attention module as its engine hands it to an attention processor.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/attention/attention_sources.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/sparse_rows.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <span>

namespace genrender {

/// One run of one self-attention module, with the engine's own operations on the engine's own tensors: a processor
/// never touches an element, so the features may lie on a device. A denoiser makes one for every site and branch of its
/// call and hands it to its processor as an lvalue, which may call members in any order and as often as it likes.
/// `features_type` is a cheap handle of a stack [frames, tokens, channels], as tensors of most engines are: copies
/// share the elements.
///
/// expression                           | type            | meaning
/// -------------------------------------|-----------------|------------------------------------------------------------
/// `typename Call::features_type`       | copyable        | handle of features [frames, tokens, channels]
/// `typename Call::real_type`           | float or double | type of the weights of `mix`
/// `call.place()`                       | attention_place | which site, which guidance branch
/// `call.frames()`                      | frame indices   | which frame of the animation each entry of the frame axis
///                                      |                 | is; a span
/// `call.f()`                           | features_type   | f: the input of the module, after its LayerNorm
/// `call.query(f)` `key(f)` `value(f)`  | features_type   | W^Q f, W^K f, W^V f [GR eq. 2], for any stack f
/// `call.attend(Q, sources)`            | features_type   | F [GR eq. 1]: frame i of Q attends to the tokens of all
///                                      |                 | blocks of `sources[i]` in one softmax, head by head; a
///                                      |                 | block is row `frame` of stacks that may be of other calls;
///                                      |                 | `sources.pattern()` says the same for engines that batch
/// `call.mix(F_hat, F_KF, rows, alpha)` | features_type   | eq. 6: rows covered by `rows[i]` become alpha F_bar + (1 -
///                                      |                 | alpha) F_hat with F_bar = rows[i] * F_KF (F_KF read as
///                                      |                 | [keyframes * tokens, channels]); all others stay F_hat.
///                                      |                 | rows[i].key tells plans apart (plan_key)
///
/// Members may be const or not. F_KF and K, V of a block may be results of a call at the same place for other frames,
/// which has ended. `mix` may write into F_hat and return it; it reads F_KF alone.
///
/// These the compiler cannot check, and a model owes them (check_attention_call_laws of testing/attention_call_laws.hpp
/// checks them): results stay what they are after the call for as long as a handle lives; `attend` depends on the order
/// of blocks by rounding alone; `mix` with alpha = 0 returns F_hat, and rows that are not covered are those of F_hat.
/// It does not require that F is taken before or after the output projection: blending commutes with it (weights of a
/// row sum to 1). It must be taken before the residual is added.
///
/// Optional capabilities: storing_attention_call (attention/feature_storage.hpp), projecting_attention_call
/// (attention/projected_features.hpp), and shaped_features of its features. make_padded_rows (blending/padded_rows.hpp)
/// turns rows and alpha into arrays of fixed width, make_call_rows (blending/call_rows.hpp) into int32 lists.
/// See also: attention_processor, which consumes it; host_attention_call, the model for features in host memory.
template <class Call>
concept attention_call = std::copyable<typename Call::features_type> && std::floating_point<typename Call::real_type> &&
    requires(Call& call, typename Call::features_type const& x,
             attention_sources<typename Call::features_type> const& sources,
             std::span<sparse_rows<typename Call::real_type> const> rows, typename Call::real_type alpha) {
    { call.place() } -> std::same_as<attention_place>;
    { call.frames() } -> std::convertible_to<std::span<frame_index const>>;
    { call.f() } -> std::convertible_to<typename Call::features_type>;
    { call.query(x) } -> std::convertible_to<typename Call::features_type>;
    { call.key(x) } -> std::convertible_to<typename Call::features_type>;
    { call.value(x) } -> std::convertible_to<typename Call::features_type>;
    { call.attend(x, sources) } -> std::convertible_to<typename Call::features_type>;
    { call.mix(x, x, rows, alpha) } -> std::convertible_to<typename Call::features_type>;
};

// The sentence of a temporary, which static_assert takes as a literal only.
/// What the compiler says of a call that is a temporary.
#define GENRENDER_CALL_IS_LVALUE                                                                                       \
    "attention_call: a processor takes an lvalue, my_call call(...); processor(call), since it may keep handles of it"

/// Fails to compile with a sentence for each part that an attention_call lacks.
template <class Call>
consteval void require_attention_call() {
    static_assert(
        requires {
            requires std::copyable<typename Call::features_type>;
            requires std::floating_point<typename Call::real_type>;
        },
        "attention_call: features_type is copyable and real_type is float or double");
    static_assert(
        requires(Call & call) {
            { call.place() } -> std::same_as<attention_place>;
        },
        "attention_call: place() returns an attention_place by value");
    static_assert(
        requires(Call & call) {
            { call.frames() } -> std::convertible_to<std::span<frame_index const>>;
        },
        "attention_call: frames() returns a span of frame_index");
    static_assert(
        requires(Call & call, typename Call::features_type const& x) {
            { call.f() } -> std::convertible_to<typename Call::features_type>;
            { call.query(x) } -> std::convertible_to<typename Call::features_type>;
            { call.key(x) } -> std::convertible_to<typename Call::features_type>;
            { call.value(x) } -> std::convertible_to<typename Call::features_type>;
        },
        "attention_call: f(), query(f), key(f) and value(f) take features_type const& and return features_type");
    static_assert(
        requires(Call & call, typename Call::features_type const& Q,
                 attention_sources<typename Call::features_type> const& sources) {
            { call.attend(Q, sources) } -> std::convertible_to<typename Call::features_type>;
        },
        "attention_call: attend(Q, sources) takes attention_sources<features_type> const& and returns features_type");
    static_assert(
        requires(Call & call, typename Call::features_type const& F,
                 std::span<sparse_rows<typename Call::real_type> const> rows, typename Call::real_type alpha) {
            { call.mix(F, F, rows, alpha) } -> std::convertible_to<typename Call::features_type>;
        },
        "attention_call: mix(F_hat, F_KF, rows, alpha) takes a span of sparse_rows<real_type> const and returns "
        "features_type");
}

/// Features that tell their extents, an optional capability of a features_type: the library then refuses features of
/// keyframes whose number of frames is not that of the keyframes (pre_attention_sources); of others it knows nothing.
///
/// expression    | type             | meaning
/// --------------|------------------|----------------------------------------------------------------------------------
/// `x.extents()` | array<size_t, 3> | frames, tokens, channels
template <class Features>
concept shaped_features = requires(Features const& x) {
    { x.extents() } -> std::convertible_to<std::array<std::size_t, 3>>;
};

/// The least that an attention_call is, for checking processors; never run.
template <class Features, class Real>
struct attention_call_archetype {
    using features_type = Features; ///< the handle of features
    using real_type = Real;         ///< the type of the weights
    /// Which site, which guidance branch.
    attention_place place() const;
    /// Which frame of the animation each entry of the frame axis is.
    std::span<frame_index const> frames() const;
    /// The input of the module.
    Features f() const;
    /// W^Q f.
    Features query(Features const&) const;
    /// W^K f.
    Features key(Features const&) const;
    /// W^V f.
    Features value(Features const&) const;
    /// F, each frame of the queries attending to its sources.
    Features attend(Features const&, attention_sources<Features> const&) const;
    /// F of eq. 6, from F_hat, F_KF, the rows of a plan and alpha.
    Features mix(Features const&, Features const&, std::span<sparse_rows<Real> const>, Real) const;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
