// SPDX-License-Identifier: MIT
// Nodes of OpenVINO's models that go around the self-attention of an engine, by eqs. 3, 5 and 6.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/graph_feature_io.hpp>
#include <genrender/adapters/openvino_memory.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/injection/graph_pass.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <openvino/core/node_output.hpp>
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
#include <memory>
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
    /// where the module is left plain, `scales` where its logits are not scaled.
    openvino_site(graph_pass pass, run_shapes const& shapes, openvino_bank const* bank, openvino_plan const* plan,
                  openvino_scales const* scales, openvino_ports& ports, std::string name)
        : is_keyframe_(pass == graph_pass::keyframe && bank != nullptr),
          attends_to_stack_(is_keyframe_ && shapes.attends_to_stack), bank_(bank), ports_(&ports),
          name_(std::move(name)) {
        if (pass == graph_pass::injected && bank != nullptr && shapes.joins_keyframes) {
            f_KF_ = as_f32(ports.add_input(name_ + ".f_KF", bank->f_KF));
            if (shapes.leaves_out) {
                mask_ = ports.add_input(name_ + ".mask", plan->mask);
            }
        }
        if (scales != nullptr) {
            scales_ = ports.add_input(name_ + ".scales", scales->tensor);
        }
        mixes_ = pass == graph_pass::injected && bank != nullptr && shapes.mixes_rows ? plan : nullptr;
    }

    /// The tokens that the module's queries are of: of f, or of its frames in a row, [1, frames tokens, channels] (eq. 3:
    /// one long row of tokens that all attend to each other is the same). The module's residual and all behind it take f.
    openvino_value queries(openvino_value const& f) const {
        auto const& s = f.get_shape();
        return attends_to_stack_ ? reshaped(f, {1, s[0] * s[1], s[2]}) : f;
    }

    /// What the module projected of `queries`, f32 [.., .., channels], times what the logits of each frame are multiplied by
    /// (the length-corrected temperature); Q itself where nothing is scaled. A network of which all modules take it says so
    /// (graph_network::scales_logits).
    openvino_value scaled(openvino_value const& Q) const {
        if (!scales_) {
            return Q;
        }
        auto const& s = Q.get_shape();
        auto const frames = scales_->get_shape()[0];
        auto const by_frame = reshaped(Q, {frames, s[0] * s[1] / frames, s[2]});
        return reshaped(std::make_shared<ov::op::v1::Multiply>(by_frame, *scales_), s);
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
    std::optional<openvino_value> scales_;
    openvino_plan const* mixes_ = nullptr;
};

/// Feature I/O of OpenVINO's models: tensors in host memory, which requests read and write in place where the device uses it.
/// Make one in `prepare`; models must not outlive it.
class openvino_feature_io : public graph_feature_io<openvino_memory> {
public:
    /// For the shapes of a run and the denoiser's sites. Throws as graph_feature_io does.
    openvino_feature_io(run_shapes shapes, std::span<attention_site const> sites, bool scales_logits = false)
        : graph_feature_io({}, std::move(shapes), sites, scales_logits) {}

    /// The module at a place, for building a model of a pass with so many frames. Extra inputs and outputs are named
    /// `genrender.<site>.<what>`.
    openvino_site site(attention_place place, graph_pass pass, std::size_t frames, openvino_ports& ports) {
        auto const* const of_place = bank(place);
        auto const reads_plan = of_place != nullptr && pass == graph_pass::injected;
        return {pass,
                shapes(),
                of_place,
                reads_plan ? &plan(place.site, frames) : nullptr,
                scales(place, pass, frames),
                ports,
                "genrender." + std::to_string(place.site.value)};
    }
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
