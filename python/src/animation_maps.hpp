// SPDX-License-Identifier: MIT
// [GR sec. 3] What Python calls Maps: UV, object, coverage, depth and rest positions of an animation, in memory of its own.
#pragma once

#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/chosen_correspondence.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace genrender::python {

/// Maps of an animation. Views of them stay good while they live.
struct animation_maps {
    uv_maps uv;                                                             ///< texture coordinates, objects, coverage
    depth_maps depth;                                                       ///< of no frame if there are none
    tensor<float, 4> position = tensor<float, 4>::from_shape({0, 0, 0, 3}); ///< of no frame if there are none
    std::vector<std::string> notes;                                         ///< what a reader of files noticed

    /// What `use` makes of the maps that `canonical`, uv or position, names. Throws value_error if there are none.
    template <class Use>
    auto with_canonical(std::string const& canonical, Use const& use) const {
        require_value(canonical == "uv" || canonical == "position", "Maps", "canonical", canonical, "uv or position");
        if (canonical == "uv") {
            return use(to_uv_view(uv));
        }
        require_value(position.shape()[0] > 0, "Maps", "position", "not given", "rest positions");
        return use(position_maps_view(to_view(position), to_view(uv.object), to_view(uv.coverage)));
    }

    /// The depth maps. Throws value_error if there are none.
    depth_maps const& known_depth() const {
        require_value(depth.frame_count() > 0, "Maps", "depth", "not given", "distances from the camera");
        return depth;
    }
};

/// A correspondence map of either kind of canonical coordinates, and the maps that it views.
struct token_correspondence {
    std::shared_ptr<animation_maps const> maps;                              ///< what the correspondence views
    std::variant<chosen_correspondence<2>, chosen_correspondence<3>> chosen; ///< the correspondence

    /// What `use` makes of the correspondence map.
    template <class Use>
    auto with_map(Use const& use) const {
        return std::visit(use, chosen);
    }
};

} // namespace genrender::python
