// SPDX-License-Identifier: MIT
// Views and spans show the same elements, and what no span can be is refused.
#include <genrender/adapters/mdspan.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

using namespace genrender;

TEST_SUITE("adapters/mdspan") {
    using adapters::to_mdspan;
    using adapters::to_view;

    namespace {

    /// A span of two axes with the members of std::mdspan that the adapter reads, for compilers that have none; the second
    /// axis has `Columns` elements, or any number.
    constexpr auto any = std::numeric_limits<std::size_t>::max();
    template <class T, std::size_t Columns, class Index, bool HasStrides>
    struct small_span {
        struct extents_type {
            explicit extents_type(std::array<Index, 2> e) : sizes(e) {}
            std::array<Index, 2> sizes;
            static constexpr std::size_t static_extent(std::size_t axis) { return axis == 1 ? Columns : any; }
        };
        struct mapping_type {
            explicit mapping_type(extents_type e) requires(!HasStrides) : extents(e), strides{e.sizes[1], Index{1}} {}
            mapping_type(extents_type e, std::array<Index, 2> s) requires HasStrides : extents(e), strides(s) {}
            extents_type extents;
            std::array<Index, 2> strides;
        };
        using element_type = T;
        using reference = T&;
        using data_handle_type = T*;
        using index_type = Index;
        small_span(T* data, mapping_type m) : first(data), mapping(m) {}
        static constexpr std::size_t rank() { return 2; }
        Index extent(std::size_t axis) const { return mapping.extents.sizes[axis]; }
        Index stride(std::size_t axis) const { return mapping.strides[axis]; }
        T* data_handle() const { return first; }
        T& at(std::size_t i, std::size_t j) const {
            return first[i * static_cast<std::size_t>(stride(0)) + j * static_cast<std::size_t>(stride(1))];
        }
        T* first;
        mapping_type mapping;
    };
    using strided_span = small_span<float, any, int, true>;

    struct numbers {
        std::vector<float> memory = std::vector<float>(24);
        numbers() { std::iota(memory.begin(), memory.end(), 0.0f); }
    };

    } // namespace

    TEST_CASE("a span of a view shows its elements, and its view is the view again") {
        numbers of;
        strided_view<float, 2> const view(of.memory.data() + 1, {3, 4}, {1, 5});
        auto const span = to_mdspan<strided_span>(view);
        auto const again = to_view(span);
        CHECK(again.extents() == view.extents());
        CHECK(again.strides() == view.strides());
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                CHECK(&span.at(i, j) == &view(i, j));
                CHECK(&again(i, j) == &view(i, j));
            }
        }
    }

    TEST_CASE("a span without strides takes contiguous views only") {
        using span = small_span<float, any, std::size_t, false>;
        numbers of;
        strided_view<float, 2> const view(of.memory.data(), {3, 4});
        CHECK(&to_mdspan<span>(view).at(2, 1) == &view(2, 1));
        strided_view<float, 2> const gaps(of.memory.data(), {3, 4}, {5, 1});
        CHECK_THROWS_WITH_AS(to_mdspan<span>(gaps), doctest::Contains("contiguous rows"), value_error);
    }

    TEST_CASE("static extents, index types and signs of strides are held to") {
        numbers of;
        strided_view<float, 2> const view(of.memory.data(), {3, 4});
        CHECK(to_mdspan<small_span<float, 4, int, true>>(view).extent(1) == 4);
        CHECK_THROWS_AS((to_mdspan<small_span<float, 5, int, true>>(view)), shape_error);
        strided_view<float, 2> const long_axis(of.memory.data(), {300, 1}, {0, 1});
        CHECK_THROWS_WITH_AS(to_mdspan<strided_span>(long_axis), doctest::Contains("more than 0"), value_error);
        strided_view<float, 2> const many(of.memory.data(), {1, 300}, {0, 1});
        CHECK_THROWS_WITH_AS((to_mdspan<small_span<float, any, signed char, true>>(many)),
                             doctest::Contains("index type"), value_error);
        strided_view<float, 2> const backward(of.memory.data() + 23, {3, 4}, {-4, -1});
        CHECK_THROWS_WITH_AS(to_mdspan<strided_span>(backward), doctest::Contains("view.stride"), value_error);
        strided_view<float, 2> const one(of.memory.data(), {1, 4}, {-7, 1});
        CHECK(to_mdspan<strided_span>(one).extent(0) == 1);
    }

#if defined(__cpp_lib_mdspan)
    TEST_CASE("std::mdspan of a view shows its elements, and a view those of a span of any layout") {
        numbers of;
        strided_view<float const, 3> const view(of.memory.data(), {2, 3, 4}, {1, 8, 2});
        auto const span = to_mdspan(view);
        CHECK(&span[std::array<std::size_t, 3>{1, 2, 3}] == &view(1, 2, 3));
        std::mdspan<float, std::extents<int, 4, 6>, std::layout_left> const left(of.memory.data());
        auto const of_left = to_view(left);
        CHECK(&of_left(3, 5) == &of.memory[23]);
        CHECK(&of_left(1, 2) == &of.memory[9]);
    }
#endif
}
