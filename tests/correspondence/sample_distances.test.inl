// SPDX-License-Identifier: MIT
// What is checked of the distances of one target.

namespace genrender::testing::GENRENDER_TARGET {

using namespace genrender::detail;
using namespace genrender::detail::GENRENDER_TARGET_NAME;

/// 40 x 30 pixels of a bent surface; every 50th has no footprint, every 7th faces the other way.
template <std::size_t D>
std::vector<grid_sample<D>> surface() {
    std::vector<grid_sample<D>> samples;
    auto const place = [](double x, double y) {
        std::array<float, D> p{};
        p[0] = static_cast<float>(x / 40 + 0.1 * y * y / 1600);
        p[1] = static_cast<float>(y / 40);
        if constexpr (D == 3) {
            p[2] = static_cast<float>(0.2 * x * x / 1600);
        }
        return p;
    };
    for (std::size_t number = 0; number < 1200; ++number) {
        auto const x = static_cast<double>(number % 40);
        auto const y = static_cast<double>(number / 40);
        grid_sample<D> s{place(x, y), surface_footprint<D>{}};
        auto const right = place(x + 1, y);
        auto const below = place(x, y + 1);
        for (std::size_t d = 0; d < D; ++d) {
            s.footprint->across[d] = right[d] - s.place[d];
            s.footprint->down[d] = below[d] - s.place[d];
        }
        if (number % 7 == 6) {
            std::swap(s.footprint->across, s.footprint->down);
        }
        if (number % 50 == 49) {
            s.footprint.reset();
        }
        samples.push_back(s);
    }
    return samples;
}

template <class Dim>
void check_search() {
    constexpr auto D = Dim::value;
    auto samples = surface<D>();
    sample_bins<D> const bins(samples, 1, 4, 4, 1);
    std::size_t alone = 0;
    std::size_t unknown = 0;
    for (std::size_t asked = 3; asked < samples.size(); asked += 5) {
        if (!samples[asked].footprint || !faces_alike(*samples[asked].footprint, *samples[0].footprint)) {
            continue;
        }
        auto place = samples[asked].place;
        place[0] += 0.003F;
        auto const bin = bins.bin_at(place);
        REQUIRE(bin.has_value());
        typename sample_bins<D>::block const near(bins, *bin, 1);
        sample_distances<D> const found(bins, near, place, *samples[asked].footprint);
        auto const border = bins.border_of(near, place);

        // All pixels in double precision, as far as the block tells of them.
        std::int32_t inside = 0;
        auto closest = std::numeric_limits<double>::infinity();
        bool is_any_unknown = false;
        std::size_t closest_number = 0;
        for (std::size_t n = 0; n < samples.size(); ++n) {
            double square = 0;
            for (std::size_t d = 0; d < D; ++d) {
                square += std::pow(double{samples[n].place[d]} - double{place[d]}, 2);
            }
            if (square > 0.99 * double{border} * double{border}) {
                continue;
            }
            ++inside;
            if (!samples[n].footprint) {
                is_any_unknown = true;
                continue;
            }
            if (!faces_alike(*samples[n].footprint, *samples[asked].footprint)) {
                continue;
            }
            auto const offset = offset_on(*samples[n].footprint, samples[n].place, place);
            auto const distance = std::max(std::abs(offset.right), std::abs(offset.down)) / 2;
            if (distance < closest) {
                closest = distance;
                closest_number = n;
            }
        }
        auto const radius = 0.99F * border * border;
        CHECK(found.count_within(radius) == inside);
        CHECK(found.count_inside() >= inside);
        CHECK(found.next_beyond(-1) < radius);
        CHECK(found.count_within(found.next_beyond(-1)) >= 1);
        if (is_any_unknown) {
            CHECK(found.closest_within(radius) < 0);
            ++unknown;
            continue;
        }
        CHECK(found.closest_within(radius) == doctest::Approx(closest).epsilon(1e-3));
        auto const only = found.only_one_within(radius, static_cast<float>(closest) + 1e-4F);
        if (only) {
            CHECK(only->first == closest_number);
            ++alone;
        }
        CHECK_FALSE(found.only_one_within(radius, 100).has_value());
        CHECK_FALSE(found.only_one_within(-1, 100).has_value());
    }
    CHECK(alone > 60);
    CHECK(unknown > 20);
}

} // namespace genrender::testing::GENRENDER_TARGET
