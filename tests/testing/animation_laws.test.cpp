// SPDX-License-Identifier: MIT
// [GR sec. 3] Every law of animations can be broken, and is told by its sentence.
#include <genrender/testing/animation_laws.hpp>

#include "broken_laws.hpp"

#include <glm/ext/matrix_transform.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

TEST_SUITE("testing/animation_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    using names = std::vector<std::string>;

    enum class slip {
        none,
        blind,
        twice_the_number,
        no_surface,
        bad_surface,
        few_positions,
        other_uvs,
        moves_when_asked
    };

    std::shared_ptr<mesh const> triangle(float u) {
        return std::make_shared<mesh const>(
            mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{u, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}});
    }

    /// A triangle that rises.
    struct rising {
        slip made = slip::none;
        std::shared_ptr<mesh const> surface = triangle(0);
        mutable std::atomic<int> asked{0};

        std::size_t frame_count() const { return 2; }
        posed_scene frame(frame_index i) const {
            posed_scene scene;
            auto const extra = made == slip::moves_when_asked ? ++asked : 0;
            auto const height = static_cast<float>(i.value) + static_cast<float>(extra);
            scene.objects.push_back(pose({4}, surface, glm::translate(glm::mat4(1), {0, height, 0})));
            switch (made) {
            case slip::blind:
                scene.camera.near_distance = -1;
                break;
            case slip::twice_the_number:
                scene.objects.push_back(scene.objects.front());
                break;
            case slip::no_surface:
                scene.objects.front().surface = nullptr;
                break;
            case slip::bad_surface: {
                auto bad = *surface;
                bad.triangles.front()[2] = 99;
                scene.objects.front().surface = std::make_shared<mesh const>(bad);
                break;
            }
            case slip::few_positions:
                scene.objects.front().positions.pop_back();
                break;
            case slip::other_uvs:
                scene.objects.front().surface = triangle(i.value == 0 ? 0.0F : 0.5F);
                break;
            default:
                break;
            }
            return scene;
        }
    };

    law_report report_on(slip made) { return check_animation_laws(rising{made}); }

    } // namespace

    TEST_CASE("an animation that keeps the laws has none to tell") { CHECK(report_on(slip::none).text() == ""); }
    TEST_CASE("each slip is told by the law that it breaks") {
        CHECK(broken_laws(report_on(slip::blind)) == names{"animation: cameras can see"});
        CHECK(broken_laws(report_on(slip::bad_surface)) == names{"animation: surfaces are meshes"});
        CHECK(broken_laws(report_on(slip::moves_when_asked)) ==
              names{"animation: frame(i) depends on i alone, from any thread"});
        CHECK(report_on(slip::twice_the_number).text() == "animation: no two objects of a frame share a number: found "
                                                          "object 4 of frame 0 twice, expected it once\n");
        CHECK(report_on(slip::no_surface).text() ==
              "animation: every object has a surface: found object 4 of frame 0 without one, expected a mesh\n");
        CHECK(report_on(slip::few_positions).text() == "animation: an object has a position for each of its surface's: "
                                                       "found 2 of object 4 of frame 0, expected 3\n");
        CHECK(
            report_on(slip::other_uvs).text() ==
            "animation: an object number names the same UVs and triangles in every frame: found others of object 4 of "
            "frame 1, expected those of the first frame that shows it\n");
    }
}
