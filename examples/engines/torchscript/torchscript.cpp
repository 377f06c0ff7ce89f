// SPDX-License-Identifier: MIT
// A network that export_network.py has exported, behind genrender: its operator for self-attention calls back.
#include "../libtorch/conditioning.hpp"

#include <genrender/pipeline/render.hpp>

#include <ATen/Parallel.h>
#include <torch/csrc/jit/api/module.h>
#include <torch/csrc/jit/serialization/import.h>
#include <torch/library.h>

#include <stdexcept>

using namespace genrender;
using namespace genrender::examples;

// docs:begin torchscript_registered
/// What the operator does in the run that is under way on this thread.
static thread_local torch_self_attention const* running = nullptr;
struct running_now {
    explicit running_now(torch_self_attention const& run) { running = &run; }
    ~running_now() { running = nullptr; }
};

TORCH_LIBRARY(genrender, library) {
    library.def("self_attention(Tensor f, Tensor query, Tensor key, Tensor value, int heads, str site) -> Tensor",
                [](at::Tensor const& f, at::Tensor const& Q, at::Tensor const& K, at::Tensor const& V,
                   std::int64_t heads, std::string const& site) {
                    if (running == nullptr) {
                        throw std::logic_error(
                            "genrender::self_attention: runs outside of a torch_network, expected inside");
                    }
                    return (*running)(site, f, Q, K, V, heads);
                });
}

/// The network of a file; it may run on several threads at once.
static torch_network loaded(std::string const& path, at::Device device) {
    auto const module = torch::jit::load(path, device);
    return [=](at::Tensor const& z, double t, at::Tensor const& prompt, at::Tensor const& hints,
               torch_self_attention const& run) {
        running_now const now(run);
        return module.get_method("forward")({z, at::full({}, t, z.options()), prompt, hints}).toTensor();
    };
}
// docs:end

int main() {
    at::set_num_threads(1);
    auto const device = chosen_device();
    auto const network = loaded(GENRENDER_EXPORTED_NETWORK, device);
    return compare_engine("TorchScript on " + device.str(), "callback", 1e-4, [&](engine_case const& given) {
        auto const hints = tensor_of(given.conditioning.hint.view()).to(device);
        return render(denoiser_of(given, network, hints), to_uv_view(given.UV), {.settings = given.settings});
    });
}
