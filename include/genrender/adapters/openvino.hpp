// SPDX-License-Identifier: MIT
// OpenVINO behind genrender: nodes of static graphs for self-attention by eqs. 3, 5 and 6, and memory that they read.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/openvino_memory.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/injection/graph_pass.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <openvino/core/model.hpp>
#include <openvino/op/add.hpp>
#include <openvino/op/broadcast.hpp>
#include <openvino/op/concat.hpp>
#include <openvino/op/constant.hpp>
#include <openvino/op/convert.hpp>
#include <openvino/op/gather.hpp>
#include <openvino/op/matmul.hpp>
#include <openvino/op/multiply.hpp>
#include <openvino/op/parameter.hpp>
#include <openvino/op/reshape.hpp>
#include <openvino/op/result.hpp>
#include <openvino/runtime/infer_request.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::adapters {

/// An output of a node, as OpenVINO's graphs are made of.
using openvino_value = ov::Output<ov::Node>;

/// The extra inputs and outputs of a model under construction, each with its tensor.
class openvino_ports {
public:
    /// An input that reads `tensor`.
    openvino_value add_input(std::string const& name, ov::Tensor const& tensor) {
        auto const parameter = std::make_shared<ov::op::v0::Parameter>(tensor.get_element_type(), tensor.get_shape());
        parameter->output(0).set_names({name});
        parameters_.push_back(parameter);
        tensors_.emplace_back(name, tensor);
        return parameter;
    }
    /// An output that is written to `tensor`, converted to its type.
    void add_output(std::string const& name, openvino_value const& value, ov::Tensor const& tensor) {
        auto const converted = std::make_shared<ov::op::v0::Convert>(value, tensor.get_element_type());
        converted->output(0).set_names({name});
        results_.push_back(std::make_shared<ov::op::v0::Result>(converted));
        tensors_.emplace_back(name, tensor);
    }

    /// The inputs, for the model's list behind its own.
    ov::ParameterVector const& parameters() const { return parameters_; }
    /// The outputs, for the model's list behind its own.
    ov::ResultVector const& results() const { return results_; }

    /// Lets a request of the compiled model read and write the tensors: once, before its first run.
    void bind(ov::InferRequest& request) const {
        for (auto const& [name, tensor] : tensors_) {
            request.set_tensor(name, tensor);
        }
    }

private:
    ov::ParameterVector parameters_;
    ov::ResultVector results_;
    std::vector<std::pair<std::string, ov::Tensor>> tensors_;
};

/// One self-attention module of a model under construction: what goes around the engine's own projections and attention.
/// Features are f32 [frames, tokens, channels] of known extents. At a place that takes no part, and in a plain pass, every
/// member gives back what it is given.
class openvino_site {
public:
    /// Of a pass; extra inputs and outputs go to `ports` under names that begin with `name`. `bank` and `plan` are null
    /// where the module is left plain.
    openvino_site(graph_pass pass, run_shapes const& shapes, openvino_bank const* bank, openvino_plan const* plan,
                  openvino_ports& ports, std::string name)
        : is_keyframe_(pass == graph_pass::keyframe && bank != nullptr),
          attends_to_stack_(is_keyframe_ && shapes.attends_to_stack), bank_(bank), ports_(&ports),
          name_(std::move(name)) {
        if (pass == graph_pass::injected && bank != nullptr && shapes.joins_keyframes) {
            f_KF_ = as_f32(ports.add_input(name_ + ".f_KF", bank->f_KF));
            if (shapes.leaves_out) {
                mask_ = ports.add_input(name_ + ".mask", plan->mask);
            }
        }
        mixes_ = pass == graph_pass::injected && bank != nullptr && shapes.mixes_rows ? plan : nullptr;
    }

    /// The tokens that the module's queries are of: of f, or of its frames in a row, [1, frames tokens, channels] (eq. 3:
    /// one long row of tokens that all attend to each other is the same). The module's residual and all behind it take f.
    openvino_value queries(openvino_value const& f) const {
        auto const& s = f.get_shape();
        return attends_to_stack_ ? reshaped(f, {1, s[0] * s[1], s[2]}) : f;
    }

    /// The tokens that keys and values are of: those of `queries`, or each frame's own and then the keyframes' (eq. 5),
    /// [frames, tokens (1 + m), channels].
    openvino_value sources(openvino_value const& f) const { return f_KF_ ? join(f, keyframes()) : queries(f); }

    /// f_KF in a row, [1, m tokens, channels], for engines that project it once for all frames and `join` the products;
    /// none where nothing is joined.
    std::optional<openvino_value> keyframes() const {
        if (!f_KF_) {
            return std::nullopt;
        }
        auto const& s = f_KF_->get_shape();
        return reshaped(*f_KF_, {1, s[0] * s[1], s[2]});
    }

    /// Each frame's own tokens and those of keyframes after them; `own` itself where there are none.
    openvino_value join(openvino_value const& own, std::optional<openvino_value> const& of_keyframes) const {
        if (!of_keyframes) {
            return own;
        }
        auto const& s = of_keyframes->get_shape();
        auto const of_each =
            std::make_shared<ov::op::v3::Broadcast>(*of_keyframes, sizes({own.get_shape()[0], s[1], s[2]}));
        return std::make_shared<ov::op::v0::Concat>(ov::OutputVector{own, of_each}, 1);
    }

    /// What is added to the scaled products of queries and keys, f32 [frames, 1, 1, tokens (1 + m)]; none where no frame
    /// leaves a keyframe out.
    std::optional<openvino_value> const& mask() const { return mask_; }

    /// The module's output [frames, tokens, channels] of what attention over `queries` and `sources` gave (behind the
    /// projection of the output, if there is one, and before the residual): recorded in a keyframe pass, mixed by eq. 6
    /// in an injected one. `f` is the module's input.
    openvino_value output(openvino_value const& f, openvino_value const& F_hat) const {
        auto const& s = f.get_shape();
        auto const F = attends_to_stack_ ? reshaped(F_hat, s) : F_hat;
        if (is_keyframe_) {
            ports_->add_output(name_ + ".f", f, bank_->f_KF);
            ports_->add_output(name_ + ".F", F, bank_->F_KF);
        }
        if (mixes_ == nullptr) {
            return F;
        }
        auto const F_KF = as_f32(ports_->add_input(name_ + ".F_KF", bank_->F_KF));
        auto const rows = reshaped(F_KF, {F_KF.get_shape()[0] * F_KF.get_shape()[1], s[2]});
        auto const index = ports_->add_input(name_ + ".index", mixes_->index);
        auto const axis = ov::op::v0::Constant::create(ov::element::i32, {}, {0});
        auto const gathered = std::make_shared<ov::op::v8::Gather>(rows, index, axis); // [frames tokens, W, channels]
        auto const weights = ports_->add_input(name_ + ".weights", mixes_->weights);
        auto const F_bar = reshaped(std::make_shared<ov::op::v0::MatMul>(weights, gathered), s);
        auto const own = ports_->add_input(name_ + ".own", mixes_->own);
        return std::make_shared<ov::op::v1::Add>(std::make_shared<ov::op::v1::Multiply>(F, own), F_bar);
    }

private:
    static openvino_value sizes(ov::Shape const& shape) {
        return ov::op::v0::Constant::create(ov::element::i64, {shape.size()}, shape);
    }
    static openvino_value reshaped(openvino_value const& x, ov::Shape const& shape) {
        return std::make_shared<ov::op::v1::Reshape>(x, sizes(shape), false);
    }
    static openvino_value as_f32(openvino_value const& x) {
        return x.get_element_type() == ov::element::f32
                   ? x
                   : openvino_value(std::make_shared<ov::op::v0::Convert>(x, ov::element::f32));
    }

    bool is_keyframe_;
    bool attends_to_stack_;
    openvino_bank const* bank_;
    openvino_ports* ports_;
    std::string name_;
    std::optional<openvino_value> f_KF_;
    std::optional<openvino_value> mask_;
    openvino_plan const* mixes_ = nullptr;
};

/// Everything between a feature_io_processor and the models of an engine: features of keyframes and plans in tensors of its
/// own, which requests read and write in place where the device uses host memory. Make one in `prepare`; models are built
/// once for each pass, number of frames and branch, and must not outlive it. It is used by one call at a time (`lock`).
class openvino_feature_io {
public:
    /// For the shapes of a run and the denoiser's sites. Throws value_error if the run asks for sources beyond eqs. 1, 3
    /// and 5, or keeps several banks at a time.
    openvino_feature_io(run_shapes shapes, std::span<attention_site const> sites)
        : shapes_(std::move(shapes)), sites_(sites.begin(), sites.end()) {
        constexpr auto here = "openvino_feature_io";
        require_value(!shapes_.lists_sources, here, "shapes.lists_sources", "true", "a method that lists no sources");
        require_abilities(here, {}, shapes_);
        require_value(shapes_.banks == 1, here, "shapes.banks", shapes_.banks, "one bank at a time");
        for (auto const place : shapes_.places) {
            require_value(place.site.value < sites_.size(), here, "shapes.places", place.site.value, "a site");
            auto const& site = sites_[place.site.value];
            ov::Shape const shape{shapes_.keyframes, site.grid.size(), site.channels};
            auto const type = openvino_type_of(shapes_.storage);
            banks_[place] = {ov::Tensor(type, shape), ov::Tensor(type, shape)};
        }
    }

    /// Held during a call of the denoiser from before `pass_of` to after `record`.
    [[nodiscard]] std::unique_lock<std::mutex> lock() const { return std::unique_lock(mutex_); }

    /// Which pass a processor runs: the one whose model the call takes.
    template <class Processor>
    graph_pass pass_of(Processor const& processor, std::span<frame_index const> frames) const {
        return graph_pass_of<openvino_features, float>(processor, shapes_, frames);
    }

    /// The module at a place, for building a model of a pass with so many frames.
    openvino_site site(attention_place place, graph_pass pass, std::size_t frames, openvino_ports& ports) {
        auto const bank = banks_.find(place);
        auto name = "genrender." + std::to_string(place.site.value);
        if (bank == banks_.end()) {
            return {pass, shapes_, nullptr, nullptr, ports, std::move(name)};
        }
        auto* const plan = pass == graph_pass::injected ? &plan_of(place.site, frames) : nullptr;
        return {pass, shapes_, &bank->second, plan, ports, std::move(name)};
    }

    /// Before the model of a pass and branch runs: writes what the processor gives its modules. Throws value_error if
    /// that is not what the shapes said, or a row has more entries than shapes.row_width.
    template <class Processor>
    void write(Processor const& processor, graph_pass pass, std::uint32_t branch, std::span<frame_index const> frames) {
        for (auto const& [place, bank] : banks_) {
            if (place.branch != branch) {
                continue;
            }
            auto const in = inputs_at<openvino_features, float>(processor, place, frames);
            require_inputs(in, pass, shapes_, frames);
            auto const is_ours = (in.f_KF == nullptr || in.f_KF->tensor.data() == bank.f_KF.data()) &&
                                 (in.F_KF == nullptr || in.F_KF->tensor.data() == bank.F_KF.data());
            require_value(is_ours, "openvino_feature_io::write", "inputs", "features of another memory",
                          "those that `record` handed over");
            if (in.f_KF != nullptr) {
                plan_of(place.site, frames.size()).write_mask(in.left_out);
            }
            if (in.F_KF != nullptr) {
                plan_of(place.site, frames.size()).write_rows(in.rows, in.alpha);
            }
        }
    }

    /// After the model of a pass and branch has run: hands the recorded features over where the processor asks for them.
    template <class Processor>
    void record(Processor const& processor, std::uint32_t branch, std::span<frame_index const> frames) const {
        for (auto const& [place, bank] : banks_) {
            if (place.branch == branch && inputs_at<openvino_features, float>(processor, place, frames).is_recorded) {
                record_features(processor, place, openvino_features{bank.f_KF}, openvino_features{bank.F_KF});
            }
        }
    }

private:
    openvino_plan& plan_of(site_index site, std::size_t frames) {
        return plans_.try_emplace({site, frames}, frames, sites_[site.value].grid.size(), shapes_).first->second;
    }

    run_shapes shapes_;
    std::vector<attention_site> sites_;
    std::map<attention_place, openvino_bank> banks_;
    std::map<std::pair<site_index, std::size_t>, openvino_plan> plans_;
    mutable std::mutex mutex_;
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
