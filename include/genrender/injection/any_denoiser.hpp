// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] Any denoiser, of either way in, behind one type: an engine's unit makes it, another renders with it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/any_attention_call.hpp>
#include <genrender/attention/any_features.hpp>
#include <genrender/attention/attention_processor.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/run_demands.hpp>
#include <genrender/sampling/run_shapes.hpp>
#include <genrender/sampling/storing_denoiser.hpp>

#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <ranges>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

namespace detail {

/// Any processor of any_features, for both ways in: a reference to one that outlives it.
template <class Real>
class held_processor {
public:
    template <class Processor>
    explicit held_processor(Processor& processor)
        : processor_(&processor), run_(&run_as<Processor>), inputs_at_(&inputs_as<Processor>),
          record_(&record_as<Processor>), is_plain_at_(&plain_as<Processor>) {}

    any_features run(any_attention_call<Real>& call) const { return run_(processor_, call); }
    feature_inputs<any_features, Real> inputs(attention_place place, std::span<frame_index const> frames,
                                              graph_abilities able) const {
        return inputs_at_(processor_, place, frames, able);
    }
    void record(attention_place place, any_features f, any_features F) const {
        record_(processor_, place, std::move(f), std::move(F));
    }
    bool is_plain_at(attention_place place) const { return is_plain_at_(processor_, place); }

private:
    template <class Processor>
    static any_features run_as(void const* object, any_attention_call<Real>& call) {
        if constexpr (attention_processor<Processor, any_attention_call<Real>>) {
            return (*const_cast<Processor*>(static_cast<Processor const*>(object)))(call);
        } else {
            throw value_error("any_denoiser: the processor has no operator()(call), expected an attention_processor "
                              "for a denoiser that calls back");
        }
    }
    template <class Processor>
    static feature_inputs<any_features, Real>
    inputs_as([[maybe_unused]] void const* object, [[maybe_unused]] attention_place place,
              [[maybe_unused]] std::span<frame_index const> frames, [[maybe_unused]] graph_abilities able) {
        if constexpr (feature_io_processor<Processor, any_features, Real>) {
            return inputs_for<any_features, Real>(*static_cast<Processor const*>(object), place, frames, able);
        } else {
            throw value_error("any_denoiser: the processor has no inputs_at(processor, place, frames), expected a "
                              "feature_io_processor for a denoiser that is a static graph");
        }
    }
    template <class Processor>
    static void record_as([[maybe_unused]] void const* object, [[maybe_unused]] attention_place place,
                          [[maybe_unused]] any_features f, [[maybe_unused]] any_features F) {
        if constexpr (feature_io_processor<Processor, any_features, Real>) {
            record_features(*static_cast<Processor const*>(object), place, std::move(f), std::move(F));
        }
    }
    template <class Processor>
    static bool plain_as(void const* object, attention_place place) {
        return genrender::is_plain_at(*static_cast<Processor const*>(object), place);
    }

    void const* processor_;
    any_features (*run_)(void const*, any_attention_call<Real>&);
    feature_inputs<any_features, Real> (*inputs_at_)(void const*, attention_place, std::span<frame_index const>,
                                                     graph_abilities);
    void (*record_)(void const*, attention_place, any_features, any_features);
    bool (*is_plain_at_)(void const*, attention_place);
};

/// The same for an engine of these features: a model of attention_processor and of feature_io_processor.
template <class Features, class Real>
class engine_processor {
public:
    explicit engine_processor(held_processor<Real> const& processor) : processor_(&processor) {}

    template <attention_call Call>
    typename Call::features_type operator()(Call& call) const {
        held_attention_call<Call> held(call);
        return processor_->run(held).template as<Features>();
    }
    template <class Call>
        requires(!attention_call<Call>)
    auto operator()(Call&) const { require_attention_call<Call>(); }
    bool is_plain_at(attention_place place) const { return processor_->is_plain_at(place); }

    feature_inputs<Features, Real> inputs(attention_place place, std::span<frame_index const> frames,
                                          graph_abilities able) const {
        auto held = processor_->inputs(place, frames, able);
        feature_inputs<Features, Real> own;
        own.attends_to_stack = held.attends_to_stack;
        own.f_KF = held.f_KF != nullptr ? &held.f_KF->template as<Features>() : nullptr;
        own.left_out = std::move(held.left_out);
        own.F_KF = held.F_KF != nullptr ? &held.F_KF->template as<Features>() : nullptr;
        own.rows = std::move(held.rows);
        own.alpha = held.alpha;
        own.scales = std::move(held.scales);
        own.variance = held.variance;
        own.is_recorded = held.is_recorded;
        return own;
    }
    void record(attention_place place, Features f, Features F) const {
        processor_->record(place, any_features::of(std::move(f)), any_features::of(std::move(F)));
    }

private:
    held_processor<Real> const* processor_;
};

template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(engine_processor<Features, Real> const& pass, attention_place place,
                                         std::span<frame_index const> frames, graph_abilities able = {}) {
    return pass.inputs(place, frames, able);
}
template <class Features, class Real>
void record_features(engine_processor<Features, Real> const& pass, attention_place place,
                     std::type_identity_t<Features> f, std::type_identity_t<Features> F) {
    pass.record(place, std::move(f), std::move(F));
}

/// What any_denoiser asks of the denoiser that it holds.
template <class Real>
struct denoiser_model {
    virtual ~denoiser_model() = default;
    virtual void estimate(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                          std::span<frame_index const> frames, held_processor<Real> const& processor,
                          void const* lent) const = 0;
    virtual void run_until(strided_view<Real const, 4> z, Real sigma, std::span<frame_index const> frames,
                           held_processor<Real> const& processor, std::span<std::optional<site_index> const> last,
                           std::shared_ptr<void const>* lent) const = 0;
    virtual std::size_t residual_bytes() const = 0;
    virtual void prepare(run_shapes const& shapes) const = 0;
};

template <denoiser Phi>
struct held_denoiser final : denoiser_model<typename Phi::real_type> {
    using Real = typename Phi::real_type;
    using processor_type = engine_processor<typename Phi::features_type, Real>;
    Phi phi;

    explicit held_denoiser(Phi held) : phi(std::move(held)) {}

    void estimate(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                  std::span<frame_index const> frames, held_processor<Real> const& processor,
                  [[maybe_unused]] void const* lent) const override {
        processor_type const own(processor);
        if constexpr (residual_lender<Phi>) {
            if (lent != nullptr) {
                phi(x0, z, sigma, frames, own, *static_cast<typename Phi::residuals_type const*>(lent));
                return;
            }
        }
        phi(x0, z, sigma, frames, own);
    }
    void run_until(strided_view<Real const, 4> z, Real sigma, std::span<frame_index const> frames,
                   held_processor<Real> const& processor,
                   [[maybe_unused]] std::span<std::optional<site_index> const> last,
                   [[maybe_unused]] std::shared_ptr<void const>* lent) const override {
        processor_type const own(processor);
        if constexpr (residual_lender<Phi>) {
            auto const residuals = lent != nullptr ? std::make_shared<typename Phi::residuals_type>() : nullptr;
            phi.run_until(z, sigma, frames, own, last, residuals.get());
            if (lent != nullptr) {
                *lent = residuals;
            }
        } else if constexpr (stoppable_denoiser<Phi>) {
            phi.run_until(z, sigma, frames, own, last);
        } else {
            auto nobodys = stack<Real, 4>::uninitialized(z.extents());
            phi(nobodys.view(), z, sigma, frames, own);
        }
    }
    void prepare(run_shapes const& shapes) const override {
        require_storage<Phi>(shapes.storage);
        require_demands<Phi>(shapes);
        prepare_denoiser(phi, shapes);
    }
    std::size_t residual_bytes() const override {
        if constexpr (residual_lender<Phi>) {
            return phi.residual_bytes();
        } else {
            return 0;
        }
    }
};

} // namespace detail

/// Any denoiser, itself a model: made where the engine is known, rendered with where it is not, so that the unit of the
/// engine is compiled without the pipeline and that of the pipeline without the engine. Copies share the denoiser. It
/// gives the estimates of the denoiser to the bit, by the same way in, and offers what that offers besides: an early end
/// of the keyframe pass, residuals, 16 bits; where the denoiser does not, it runs whole, lends nothing and throws
/// value_error.
template <std::floating_point Real>
class any_denoiser {
public:
    using real_type = Real;             ///< scalar of the latents
    using features_type = any_features; ///< the engine's, held

    /// What a denoiser lends (residual_lender); nothing of one that does not.
    class residuals_type {
        friend any_denoiser;
        std::shared_ptr<void const> lent_;
    };

    /// Holds `phi`, of the same scalar.
    template <class Phi>
        requires(!std::is_same_v<Phi, any_denoiser>)
    any_denoiser(Phi phi)
        : latent_channels_(phi.latent_channels()), latent_grid_(phi.latent_grid()), branches_(phi.branches()) {
        require_denoiser<Phi>();
        static_assert(std::is_same_v<typename Phi::real_type, Real>, "any_denoiser: Real is real_type of the denoiser");
        auto&& sites = phi.sites();
        sites_.assign(std::ranges::begin(sites), std::ranges::end(sites));
        model_ = std::make_shared<detail::held_denoiser<Phi> const>(std::move(phi));
    }

    /// Channels of z.
    std::size_t latent_channels() const { return latent_channels_; }
    /// Height and width of z.
    grid_extents latent_grid() const { return latent_grid_; }
    /// The self-attention modules, as they were when it was made.
    std::span<attention_site const> sites() const { return sites_; }
    /// Guidance branches.
    std::size_t branches() const { return branches_; }

    /// Writes D(z, sigma) into x0. Throws what the denoiser throws, and value_error for a processor that does not serve
    /// the denoiser's way in.
    template <class Processor>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        model_->estimate(x0, z, sigma, frames, detail::held_processor<Real>(processor), nullptr);
    }

    /// The same with what was lent, as residual_lender has it.
    template <class Processor>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor, residuals_type const& lent) const {
        model_->estimate(x0, z, sigma, frames, detail::held_processor<Real>(processor), lent.lent_.get());
    }

    /// Runs the sites up to the last ones, as stoppable_denoiser and residual_lender have it; all of them where the
    /// denoiser cannot stop.
    template <class Processor>
    void run_until(strided_view<Real const, 4> z, Real sigma, std::span<frame_index const> frames, Processor& processor,
                   std::span<std::optional<site_index> const> last, residuals_type* lent = nullptr) const {
        model_->run_until(z, sigma, frames, detail::held_processor<Real>(processor), last,
                          lent != nullptr ? &lent->lent_ : nullptr);
    }

    /// Tells the denoiser the shapes of a run, as preparable_denoiser has it. Throws what it throws, and value_error for
    /// features in 16 bits if it is known that it cannot store them.
    void prepare(run_shapes const& shapes) const { model_->prepare(shapes); }

    /// What is lent takes a frame, in bytes.
    std::size_t residual_bytes() const { return model_->residual_bytes(); }

private:
    std::size_t latent_channels_;
    grid_extents latent_grid_;
    std::size_t branches_;
    std::vector<attention_site> sites_;
    std::shared_ptr<detail::denoiser_model<Real> const> model_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
