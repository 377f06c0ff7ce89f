// SPDX-License-Identifier: MIT
// OpenVINO behind genrender: models that are built and compiled once and run often, and a denoiser of them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/graph_denoiser.hpp>
#include <genrender/adapters/graph_feature_io.hpp>
#include <genrender/adapters/openvino_memory.hpp>
#include <genrender/adapters/openvino_site.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <openvino/core/model.hpp>
#include <openvino/op/convert.hpp>
#include <openvino/op/parameter.hpp>
#include <openvino/op/result.hpp>
#include <openvino/runtime/core.hpp>
#include <openvino/runtime/infer_request.hpp>
#include <openvino/runtime/properties.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::adapters {

/// Where OpenVINO's models run, and how they are compiled.
struct openvino_device {
    ov::Core core{};          ///< copies share plugins
    std::string name = "CPU"; ///< as OpenVINO calls it
    /// Told when a model is compiled. On processors with bf16 units frames differ in the third digit without f32.
    ov::AnyMap properties = {ov::hint::inference_precision(ov::element::f32)};
};

/// A model that is built node by node, compiled once and run often.
class openvino_graph {
public:
    using device_type = openvino_device;         ///< where it runs
    using tensor_type = openvino_value;          ///< an output of a node
    using feature_io_type = openvino_feature_io; ///< what its modules read and write

    /// The fixed tensors of a run. Throws as openvino_feature_io does.
    static std::unique_ptr<openvino_feature_io> make_feature_io(openvino_device const&, run_shapes const& shapes,
                                                                std::span<attention_site const> sites,
                                                                bool scales_logits = false) {
        return std::make_unique<openvino_feature_io>(shapes, sites, scales_logits);
    }

    /// One without nodes. `io` outlives it.
    openvino_graph(openvino_device device, openvino_feature_io& io, graph_key key)
        : device_(std::move(device)), io_(&io), key_(key) {}

    /// Which graph it is.
    graph_key key() const { return key_; }

    /// The self-attention module of a site, whose pieces go around the engine's own. The graph outlives it.
    openvino_site site(site_index index) { return io_->site({index, key_.branch}, key_.pass, key_.frames, ports_); }

    /// An f32 input. Throws value_error if there is one of that name.
    openvino_value add_input(std::string const& name, std::vector<std::size_t> const& shape) {
        auto const input = std::make_shared<ov::op::v0::Parameter>(ov::element::f32, ov::Shape(shape));
        input->output(0).set_names({name});
        auto const is_new = inputs_.try_emplace(name, input).second;
        require_value(is_new, "openvino_graph::add_input", "name", name, "one that no other input has");
        parameters_.push_back(input);
        return input;
    }

    /// Ends the model and compiles it.
    void finish(openvino_value const& output) {
        output_ = std::make_shared<ov::op::v0::Result>(std::make_shared<ov::op::v0::Convert>(output, ov::element::f32));
        ov::ResultVector results{output_};
        results.insert(results.end(), ports_.results().begin(), ports_.results().end());
        parameters_.insert(parameters_.end(), ports_.parameters().begin(), ports_.parameters().end());
        auto const model = std::make_shared<ov::Model>(results, parameters_);
        request_ = device_.core.compile_model(model, device_.name, device_.properties).create_infer_request();
        ports_.bind(request_);
    }

    /// Writes an input, row-major; of the finished graph, before every run. Throws value_error if there is none of that
    /// name or of so many numbers.
    void write(std::string const& name, std::span<float const> values) {
        auto const found = inputs_.find(name);
        require_value(found != inputs_.end(), "openvino_graph::write", "name", name, "an input of the graph");
        ov::Tensor input = request_.get_tensor(found->second->output(0));
        require_value(values.size() == input.get_size(), "openvino_graph::write", (name + ".size()").c_str(),
                      values.size(), std::to_string(input.get_size()).c_str());
        std::copy(values.begin(), values.end(), input.data<float>());
    }

    /// Runs it.
    void run() { request_.infer(); }

    /// Copies the output, row-major. Throws value_error if it has not so many numbers.
    void read(std::span<float> values) {
        ov::Tensor const output = request_.get_tensor(output_->output(0));
        require_value(values.size() == output.get_size(), "openvino_graph::read", "output.size()", output.get_size(),
                      std::to_string(values.size()).c_str());
        std::copy_n(output.data<float>(), values.size(), values.data());
    }

private:
    openvino_device device_;
    openvino_feature_io* io_;
    graph_key key_;
    openvino_ports ports_;
    std::map<std::string, std::shared_ptr<ov::op::v0::Parameter>> inputs_;
    ov::ParameterVector parameters_;
    std::shared_ptr<ov::op::v0::Result> output_;
    ov::InferRequest request_;
};

/// A denoiser of OpenVINO's models.
using openvino_denoiser = graph_denoiser<openvino_graph>;

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
