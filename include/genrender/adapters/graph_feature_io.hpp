// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi as a static graph] What adapters of static graphs share: a run's fixed tensors, written and recorded.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/injection/graph_abilities.hpp>
#include <genrender/injection/graph_pass.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace genrender::adapters {

/// Which of an engine's graphs: one is built for each pass, number of frames and guidance branch.
struct graph_key {
    graph_pass pass = graph_pass::plain; ///< what its modules do
    std::size_t frames = 1;              ///< the stack that it was built for
    std::uint32_t branch = 0;            ///< guidance branch
    /// Orders by pass, frames and branch.
    friend constexpr auto operator<=>(graph_key, graph_key) = default;
};

/// Everything between a feature_io_processor and the graphs of an engine: features of keyframes and plans in fixed
/// tensors, which graphs read and write without a copy where the engine can. A plan is written once for all branches, and
/// again when its key is another. It is used by one call at a time (`lock`). A Memory makes the tensors:
///
/// expression                            | type                    | meaning
/// --------------------------------------|-------------------------|---------------------------------------------------
/// `typename Memory::features_type`      | equality comparable     | handle of a stack of features, made of a tensor;
///                                       |                         | equal if it is the same memory
/// `memory.bank(site, shapes)`           | `Memory::bank_type`     | its tensors `f_KF` and `F_KF` of a site
/// `memory.plan(frames, tokens, shapes)` | `Memory::plan_type`     | has `write_rows(rows, alpha)` and
///                                       |                         | `write_mask(left_out)`, for such a stack
/// `memory.scales(frames)`               | `Memory::scales_type`   | has `write(scales)`, a number for each of so many
///                                       |                         | frames; asked for where logits are scaled
template <class Memory>
class graph_feature_io {
public:
    using features_type = typename Memory::features_type; ///< handle of features
    using bank_type = typename Memory::bank_type;         ///< f_KF and F_KF of a place
    using plan_type = typename Memory::plan_type;         ///< rows and mask of a stack of frames at a site
    using scales_type = typename Memory::scales_type;     ///< of the logits of a stack of frames at a site

    /// For the shapes of a run and the denoiser's sites, of which all modules scale their queries if `scales_logits`.
    /// Throws value_error if the run asks for sources beyond eqs. 1, 3 and 5, for scales without `scales_logits`, keeps
    /// several banks at a time or names a site that there is not; and what the memory throws.
    graph_feature_io(Memory memory, run_shapes shapes, std::span<attention_site const> sites,
                     bool scales_logits = false)
        : memory_(std::move(memory)), shapes_(std::move(shapes)), sites_(sites.begin(), sites.end()) {
        constexpr auto here = "graph_feature_io";
        require_value(!shapes_.lists_sources, here, "shapes.lists_sources", "true", "a method that lists no sources");
        require_abilities(here, {.scales_logits = scales_logits}, shapes_);
        require_value(shapes_.banks == 1, here, "shapes.banks", shapes_.banks, "one bank at a time");
        for (auto const place : shapes_.places) {
            require_value(place.site.value < sites_.size(), here, "shapes.places", place.site.value, "a site");
            banks_.try_emplace(place, memory_.bank(sites_[place.site.value], shapes_));
        }
    }

    /// Held during a call of the denoiser from before `pass_of` to after `record`.
    [[nodiscard]] std::unique_lock<std::mutex> lock() const { return std::unique_lock(mutex_); }

    /// What the run asks for.
    run_shapes const& shapes() const { return shapes_; }

    /// Which pass a processor runs: the one whose graph the call takes.
    template <class Processor>
    graph_pass pass_of(Processor const& processor, std::span<frame_index const> frames) const {
        return graph_pass_of<features_type, float>(processor, shapes_, frames, able());
    }

    /// f_KF and F_KF of a place; null where it takes no part.
    bank_type const* bank(attention_place place) const {
        auto const found = banks_.find(place);
        return found == banks_.end() ? nullptr : &found->second;
    }

    /// The plans of a site for stacks of so many frames: the same tensors for all branches, made when first asked for.
    plan_type& plan(site_index site, std::size_t frames) {
        auto const found = plans_.find({site, frames});
        if (found != plans_.end()) {
            return found->second;
        }
        auto const tokens = sites_[site.value].grid.size();
        return plans_.try_emplace({site, frames}, memory_.plan(frames, tokens, shapes_)).first->second;
    }

    /// What the logits of a place are multiplied by in a pass, for stacks of so many frames: the same tensor for all
    /// branches, made when first asked for. Null where nothing is scaled.
    scales_type* scales(attention_place place, graph_pass pass, std::size_t frames) {
        auto const joins = pass == graph_pass::keyframe ? shapes_.attends_to_stack
                                                        : pass == graph_pass::injected && shapes_.joins_keyframes;
        if (!shapes_.scales_logits || !joins || bank(place) == nullptr) {
            return nullptr;
        }
        auto const found = scales_.find({place.site, frames});
        if (found != scales_.end()) {
            return &found->second;
        }
        return &scales_.try_emplace({place.site, frames}, memory_.scales(frames)).first->second;
    }

    /// Before the graph of a pass and branch runs: writes what the processor gives its modules. Throws value_error if
    /// that is not what the shapes said, or a row has more entries than shapes.row_width.
    template <class Processor>
    void write(Processor const& processor, graph_pass pass, std::uint32_t branch, std::span<frame_index const> frames) {
        for (auto const& [place, bank] : banks_) {
            if (place.branch != branch) {
                continue;
            }
            auto const in = inputs_for<features_type, float>(processor, place, frames, able());
            require_inputs(in, pass, shapes_, frames);
            auto const is_ours = (in.f_KF == nullptr || *in.f_KF == features_type{bank.f_KF}) &&
                                 (in.F_KF == nullptr || *in.F_KF == features_type{bank.F_KF});
            require_value(is_ours, "graph_feature_io::write", "inputs", "features of another memory",
                          "those that `record` handed over");
            if (in.f_KF != nullptr) {
                plan(place.site, frames.size()).write_mask(in.left_out);
            }
            if (in.F_KF != nullptr) {
                plan(place.site, frames.size()).write_rows(in.rows, in.alpha);
            }
            if (auto* const scales_of_place = scales(place, pass, frames.size())) {
                scales_of_place->write(in.scales.empty() ? std::vector<double>(frames.size(), 1) : in.scales);
            }
        }
    }

    /// After the graph of a pass and branch has run: hands the recorded features over where the processor asks for them.
    template <class Processor>
    void record(Processor const& processor, std::uint32_t branch, std::span<frame_index const> frames) const {
        for (auto const& [place, bank] : banks_) {
            if (place.branch == branch &&
                inputs_for<features_type, float>(processor, place, frames, able()).is_recorded) {
                record_features(processor, place, features_type{bank.f_KF}, features_type{bank.F_KF});
            }
        }
    }

private:
    /// Of this run: what its graphs were not built for is refused.
    graph_abilities able() const { return {.scales_logits = shapes_.scales_logits}; }

    Memory memory_;
    run_shapes shapes_;
    std::vector<attention_site> sites_;
    std::map<attention_place, bank_type> banks_;
    std::map<std::pair<site_index, std::size_t>, plan_type> plans_;
    std::map<std::pair<site_index, std::size_t>, scales_type> scales_;
    mutable std::mutex mutex_;
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
