// SPDX-License-Identifier: MIT
// A map that answers with a token whether there is one or not.
// expected: correspondence_map: token_at(frame, point) is const and returns std::optional<token_index>
#include <genrender/correspondence/correspondence_map.hpp>

struct always_shown : genrender::correspondence_map_archetype {
    genrender::token_index token_at(genrender::frame_index, point_type) const;
};

int main() { genrender::require_correspondence_map<always_shown>(); }
