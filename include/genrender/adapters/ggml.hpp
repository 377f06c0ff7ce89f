// SPDX-License-Identifier: MIT
// ggml behind genrender: graphs that are built once and run often, and a denoiser of them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/ggml_memory.hpp>
#include <genrender/adapters/ggml_site.hpp>
#include <genrender/adapters/graph_denoiser.hpp>
#include <genrender/adapters/graph_feature_io.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <ggml-alloc.h>
#include <ggml-backend.h>
#include <ggml-cpp.h>
#include <ggml.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

namespace genrender::adapters {

/// Where ggml graphs run, and how large they are.
struct ggml_device {
    ggml_backend_t backend;     ///< the caller's, which outlives all graphs
    std::size_t nodes = 16'384; ///< at most so many operations and inputs in a graph
};

/// A ggml graph that is built once and run often. Memory of its values lasts from one run to the next, values do not:
/// inputs are written before every run.
class ggml_graph {
public:
    using device_type = ggml_device;         ///< where it runs
    using tensor_type = ggml_tensor*;        ///< a value
    using feature_io_type = ggml_feature_io; ///< what its modules read and write

    /// The fixed tensors of a run. Throws as ggml_feature_io does.
    static std::unique_ptr<ggml_feature_io> make_feature_io(ggml_device device, run_shapes const& shapes,
                                                            std::span<attention_site const> sites,
                                                            bool scales_logits = false) {
        return std::make_unique<ggml_feature_io>(device.backend, shapes, sites, scales_logits);
    }

    /// One without nodes. `io` outlives it. Throws std::bad_alloc if there is no memory for its description.
    ggml_graph(ggml_device device, ggml_feature_io& io, graph_key key) : device_(device), io_(&io), key_(key) {
        auto const bytes = device.nodes * ggml_tensor_overhead() + ggml_graph_overhead_custom(device.nodes, false);
        context_.reset(ggml_init({bytes, nullptr, true}));
        if (!context_) {
            throw std::bad_alloc();
        }
        graph_ = ggml_new_graph_custom(context_.get(), device.nodes, false);
    }

    /// Which graph it is.
    graph_key key() const { return key_; }
    /// What new tensors are made in.
    ggml_context* context() const { return context_.get(); }
    /// The graph itself.
    ggml_cgraph* graph() const { return graph_; }

    /// The self-attention module of a site, whose pieces go around the engine's own.
    ggml_site site(site_index index) { return io_->site({index, key_.branch}, key_.pass, key_.frames); }

    /// An F32 input of a row-major shape of at most 4 axes: ne has them the other way round. Throws value_error if there
    /// are more.
    ggml_tensor* add_input(std::string const& name, std::vector<std::size_t> const& shape) {
        require_value(!shape.empty() && shape.size() <= GGML_MAX_DIMS, "ggml_graph::add_input", "shape.size()",
                      shape.size(), "1 to 4 axes");
        std::array<std::int64_t, GGML_MAX_DIMS> ne{1, 1, 1, 1};
        std::transform(shape.rbegin(), shape.rend(), ne.begin(), [](auto n) { return static_cast<std::int64_t>(n); });
        auto* const input = ggml_new_tensor(context_.get(), GGML_TYPE_F32, static_cast<int>(shape.size()), ne.data());
        ggml_set_name(input, name.c_str());
        ggml_set_input(input);
        ggml_build_forward_expand(graph_, input); // has memory even if nothing reads it
        return input;
    }

    /// Ends the graph and has memory allocated for it. Throws std::bad_alloc if the backend has none.
    void finish(ggml_tensor* output) {
        output = output->type == GGML_TYPE_F32 ? output : ggml_cast(context_.get(), output, GGML_TYPE_F32);
        output_ = ggml_is_contiguous(output) ? output : ggml_cont(context_.get(), output);
        keep_output(output_);
        ggml_build_forward_expand(graph_, output_);
        memory_.reset(ggml_gallocr_new(ggml_backend_get_default_buffer_type(device_.backend)));
        if (!memory_ || !ggml_gallocr_alloc_graph(memory_.get(), graph_)) {
            throw std::bad_alloc();
        }
    }

    /// Writes an input, row-major; of the finished graph, before every run. Throws value_error if there is none of that
    /// name or of so many numbers.
    void write(std::string const& name, std::span<float const> values) {
        auto* const input = ggml_get_tensor(context_.get(), name.c_str());
        require_value(input != nullptr, "ggml_graph::write", "name", name, "an input of the graph");
        require_value(values.size_bytes() == ggml_nbytes(input), "ggml_graph::write", (name + ".size()").c_str(),
                      values.size(), std::to_string(ggml_nelements(input)).c_str());
        ggml_backend_tensor_set(input, values.data(), 0, values.size_bytes());
    }

    /// Runs it. Throws value_error with ggml's status if it fails.
    void run() {
        auto const status = ggml_backend_graph_compute(device_.backend, graph_);
        require_value(status == GGML_STATUS_SUCCESS, "ggml_graph::run", "status", ggml_status_to_string(status),
                      "success");
    }

    /// Copies the output, row-major. Throws value_error if it has not so many numbers.
    void read(std::span<float> values) const {
        require_value(values.size_bytes() == ggml_nbytes(output_), "ggml_graph::read", "output.size()",
                      ggml_nelements(output_), std::to_string(values.size()).c_str());
        ggml_backend_tensor_get(output_, values.data(), 0, values.size_bytes());
    }

private:
    ggml_device device_;
    ggml_feature_io* io_;
    graph_key key_;
    ggml_context_ptr context_;
    ggml_gallocr_ptr memory_;
    ggml_cgraph* graph_ = nullptr;
    ggml_tensor* output_ = nullptr;
};

/// A denoiser of ggml graphs.
using ggml_denoiser = graph_denoiser<ggml_graph>;

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
