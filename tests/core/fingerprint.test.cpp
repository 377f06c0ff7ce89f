// SPDX-License-Identifier: MIT
// Equal data have equal fingerprints, other data have others.
#include <genrender/core/fingerprint.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

using namespace genrender;

TEST_SUITE("core/fingerprint") {
    namespace {

    template <class... Pieces>
    constexpr std::uint64_t fingerprint_of_pieces(Pieces const&... pieces) {
        fingerprint all;
        (all.add(pieces), ...);
        return all.value();
    }

    constexpr std::string_view forty_one_bytes = "a text that is longer than thirty-two too";
    static_assert(forty_one_bytes.size() == 41);

    } // namespace

    TEST_CASE("every bit of every byte of a text of any length tells") {
        for (auto const length : {1U, 7U, 8U, 9U, 31U, 32U, 33U, 64U, 71U}) {
            std::vector<std::uint8_t> bytes(length, 0x5a);
            std::set<std::uint64_t> seen{fingerprint_of_pieces(std::span<std::uint8_t const>(bytes))};
            for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
                bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << bit % 8));
                seen.insert(fingerprint_of_pieces(std::span<std::uint8_t const>(bytes)));
                bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << bit % 8));
            }
            CHECK(seen.size() == 8 * bytes.size() + 1);
        }
    }
    TEST_CASE("the order of words and the place where one text ends and the next begins tell") {
        std::vector<std::uint64_t> const all{fingerprint_of_pieces(),
                                             fingerprint_of_pieces(std::uint64_t{0}),
                                             fingerprint_of_pieces(std::uint64_t{1}, std::uint64_t{2}),
                                             fingerprint_of_pieces(std::uint64_t{2}, std::uint64_t{1}),
                                             fingerprint_of_pieces(std::string_view("ab"), std::string_view("c")),
                                             fingerprint_of_pieces(std::string_view("a"), std::string_view("bc")),
                                             fingerprint_of_pieces(std::string_view("abc")),
                                             fingerprint_of_pieces(std::string_view("abc\0", 4)),
                                             fingerprint_of_pieces(std::optional<std::size_t>()),
                                             fingerprint_of_pieces(std::optional<std::size_t>(0)),
                                             fingerprint_of_pieces(1.0F),
                                             fingerprint_of_pieces(1.0),
                                             fingerprint_of_pieces(0.0),
                                             fingerprint_of_pieces(-0.0)};
        // A word of 0, 0.0 and that there is no value are the same bits, and the same piece.
        CHECK(std::set<std::uint64_t>(all.begin(), all.end()).size() == all.size() - 2);
        CHECK(all[12] == all[1]);
        CHECK(all[8] == all[1]);
    }
    TEST_CASE("a fingerprint is the same when it is compiled, when it runs and on every machine") {
        constexpr auto compiled = fingerprint_of_pieces(forty_one_bytes, 3, true, 0.5F);
        std::string const text(forty_one_bytes);
        CHECK(fingerprint_of_pieces(std::string_view(text), 3, true, 0.5F) == compiled);
        // From a few lines of another language.
        CHECK(compiled == 17471011697756960824U);
    }
}
