// SPDX-License-Identifier: MIT
// A view of a single element.
// expected: strided_view: a view has at least one axis
#include <genrender/core/strided_view.hpp>

void run(float* element) { genrender::strided_view<float, 0>(element, {}); }
