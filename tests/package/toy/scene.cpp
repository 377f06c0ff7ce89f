// SPDX-License-Identifier: MIT
// A program of somebody who draws maps of scenes of his own: one turning box.
#include <genrender/scene.hpp>

#include <glm/ext/matrix_transform.hpp>

#include <cstdint>
#include <iostream>
#include <memory>

struct turning_box {
    std::shared_ptr<genrender::mesh const> box =
        std::make_shared<genrender::mesh const>(genrender::make_box({1, 1, 1}));
    std::size_t frame_count() const { return 2; }
    genrender::posed_scene frame(genrender::frame_index i) const {
        auto const turn = glm::rotate(glm::mat4(1), static_cast<float>(i.value), {0, 1, 0});
        return {genrender::look_at({0, 0, 3}, {0, 0, 0}, 0.8F), {genrender::pose({0}, box, turn)}};
    }
};

int main() {
    auto const maps = genrender::rasterize(turning_box{}, {16, 16});
    int covered = 0;
    for (auto const pixel : maps.uv.coverage) {
        covered += pixel;
    }
    std::cout << covered << " of 512 pixels show the box\n";
    return covered > 100 && covered < 400 ? 0 : 1;
}
