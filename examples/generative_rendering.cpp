// SPDX-License-Identifier: MIT
// The program that does it all, with Stable Diffusion or an engine that is loaded: an animated scene in, a stylised animation
// out.
#include "support/diffusion_model.hpp"
#include "support/engine_library.hpp"
#include "support/program.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

namespace {

/// The networks that come with the library.
class reference_model final : public picture_model {
public:
    explicit reference_model(render_options const& options) : model_(options) {}
    std::vector<std::string> notes() const override { return model_.notes(); }
    std::size_t scale() const override { return model_.scale(); }
    grid_extents usual_size() const override { return {model_.usual_size(), model_.usual_size()}; }
    std::size_t grid_divisor() const override { return model_.config().grid_divisor(); }
    std::string key() const override { return model_.key(); }
    float sigma_min() const override { return static_cast<float>(model_.schedule().sigma_min()); }
    float sigma_max() const override { return static_cast<float>(model_.schedule().sigma_max()); }
    any_denoiser<float> network(rendered_guidance const& guidance, grid_extents image, any_loop const& loop) override {
        return model_.network(guidance, image, loop);
    }
    tensor<float, 4> pictures(latents<float> const& z, any_loop const& loop) const override {
        return model_.pictures(z, loop);
    }

private:
    diffusion_model model_;
};

std::unique_ptr<picture_model> model_of(render_options const& options) {
    if (options.engine.empty()) {
        return std::make_unique<reference_model>(options);
    }
    auto engine = load_engine(options.engine);
    auto const sigma_min = engine.sigma_min();
    auto const sigma_max = engine.sigma_max();
    fingerprint library;
    add_file(library, options.engine);
    return std::make_unique<own_model>(own_denoiser{.phi = std::move(engine),
                                                    .sigma_min = sigma_min,
                                                    .sigma_max = sigma_max,
                                                    .key = std::to_string(library.value())});
}

} // namespace

int main(int argc, char** argv) { return run_program(argc, argv, program_kind::of_models, model_of); }
