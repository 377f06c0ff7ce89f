// SPDX-License-Identifier: MIT
// OpenVINO behind genrender: the small network as compiled models, one for each pass, stack and prompt, built once.
#include "network.hpp"

#include "../static_graph/comparison.hpp"

#include <genrender/pipeline/render.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <openvino/openvino.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace genrender::examples {

namespace {

class openvino_denoiser {
public:
    using real_type = float;
    using features_type = adapters::openvino_features;
    std::size_t latent_channels() const { return small_unet::latent_channels; }
    grid_extents latent_grid() const { return small_unet::grid; }
    auto const& sites() const { return engine_->net.sites; }
    std::size_t branches() const { return small_unet::prompts; }

    void prepare(run_shapes const& shapes) const {
        engine_->requests.clear();
        engine_->io.emplace(shapes, engine_->net.sites);
    }

    template <feature_io_processor<features_type, float> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto& e = *engine_;
        auto const lock = e.io->lock();
        auto const pass = e.io->pass_of(processor, frames);
        auto const c_in = scalings_of(prediction::velocity, sigma).c_in;
        std::vector<float> v(z.size());
        for (std::uint32_t prompt = 0; prompt < branches(); ++prompt) {
            auto& request = e.request(pass, frames.size(), prompt);
            ov::Tensor tokens = request.get_tensor("z");
            ov::Tensor shift = request.get_tensor("shift");
            linear_combination<float, 4, 1>(channels_first(tokens.data<float>(), frames.size()), {c_in}, {z});
            std::ranges::copy(small_unet::shift(sigma, prompt), shift.data<float>());
            e.io->write(processor, pass, prompt, frames);
            request.infer();
            e.io->record(processor, prompt, frames);
            ov::Tensor const out = request.get_tensor("v");
            std::transform(v.begin(), v.end(), out.data<float>(), v.begin(),
                           [](float a, float b) { return a + b / 2; });
        }
        to_clean(x0, prediction::velocity, z, channels_first(v.data(), frames.size()), sigma);
    }

private:
    struct engine {
        small_unet net;
        ov::Core core;
        std::optional<adapters::openvino_feature_io> io;
        std::map<std::tuple<graph_pass, std::size_t, std::uint32_t>, ov::InferRequest> requests;

        ov::InferRequest& request(graph_pass pass, std::size_t frames, std::uint32_t prompt) {
            auto& kept = requests[{pass, frames, prompt}];
            if (kept) {
                return kept;
            }
            adapters::openvino_ports ports;
            openvino_operations ops{[&](site_index s) { return io->site({s, prompt}, pass, frames, ports); }};
            auto const z = std::make_shared<ov::opset13::Parameter>(
                ov::element::f32, ov::Shape{frames, small_unet::grid.size(), small_unet::latent_channels});
            auto const shift =
                std::make_shared<ov::opset13::Parameter>(ov::element::f32, ov::Shape{1, 1, small_unet::channels});
            z->output(0).set_names({"z"});
            shift->output(0).set_names({"shift"});
            auto const v = net(ops, adapters::openvino_value(z), adapters::openvino_value(shift));
            v.get_tensor().set_names({"v"});
            ov::ParameterVector parameters{z, shift};
            parameters.insert(parameters.end(), ports.parameters().begin(), ports.parameters().end());
            ov::ResultVector results{std::make_shared<ov::opset13::Result>(v)};
            results.insert(results.end(), ports.results().begin(), ports.results().end());
            auto compiled =
                core.compile_model(std::make_shared<ov::Model>(results, parameters), "CPU",
                                   ov::hint::inference_precision(ov::element::f32), ov::inference_num_threads(1));
            kept = compiled.create_infer_request();
            ports.bind(kept);
            return kept;
        }
    };
    std::shared_ptr<engine> engine_ = std::make_shared<engine>();
};

static_assert(preparable_denoiser<openvino_denoiser>);

} // namespace

} // namespace genrender::examples

int main() {
    using namespace genrender;
    std::string const version = ov::get_openvino_version().buildNumber;
    return examples::compare_graphs(
        std::string("OpenVINO ") + version.substr(0, version.find('-')), [](examples::graph_case const& given) {
            auto run = render(examples::openvino_denoiser{}, to_uv_view(given.UV), {.settings = given.settings});
            return examples::graph_frames{std::move(run.z), std::move(run.report)};
        });
}
