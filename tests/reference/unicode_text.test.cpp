// SPDX-License-Identifier: MIT
// Tests of texts as code points.
#include <genrender/reference/unicode_text.hpp>

#include <doctest/doctest.h>

#include <string>
#include <string_view>

using namespace genrender;

using namespace genrender::reference;

namespace {

std::u32string points_of(std::string_view text) { return code_points("f", "text", text); }

} // namespace

TEST_SUITE("reference/unicode_text") {
    TEST_CASE("a text is the same after it was code points") {
        std::string const text("a\0\x7f\xc2\x80\xdf\xbf\xe0\xa0\x80\xed\x9f\xbf\xee\x80\x80\xef\xbf\xbf\xf0\x90\x80\x80"
                               "\xf4\x8f\xbf\xbf",
                               27);
        auto const points = points_of(text);
        CHECK(points == std::u32string(U"a\0\x7f\x80\x7ff\x800\xd7ff\xe000\xffff\x10000\x10ffff", 11));
        CHECK(utf8_text(points) == text);
        CHECK(points_of("").empty());
        CHECK(utf8_text({}).empty());
    }

    TEST_CASE("the first byte that begins no character is named") {
        auto const check = [](std::string const& text, char const* sentence) {
            CHECK_THROWS_WITH_AS(points_of(text), sentence, value_error);
        };
        check("\xff", "f: text is byte 255 at offset 0, which begins no character, expected valid UTF-8");
        check("ab\x80"
              "c\xff",
              "f: text is byte 128 at offset 2, which begins no character, expected valid UTF-8");
        check("\xc3\xa4\xc3", "f: text is byte 195 at offset 2, which begins no character, expected valid UTF-8");
        check("a\xe2\x82 ", "f: text is byte 226 at offset 1, which begins no character, expected valid UTF-8");
    }

    TEST_CASE("overlong forms, surrogates and what is beyond Unicode are no characters") {
        for (auto const* text :
             {"\xc0\x80", "\xc1\xbf", "\xe0\x9f\xbf", "\xf0\x8f\xbf\xbf", "\xed\xa0\x80", "\xed\xbf\xbf",
              "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xf8\x88\x80\x80\x80", "\xf0\x9f\x99"}) {
            CAPTURE(text);
            CHECK_THROWS_AS(points_of(text), value_error);
        }
    }

    TEST_CASE("characters are letters, numbers, white space or none of these") {
        for (auto const point : U"aZäßΣДאعहไ東한ªʰǅ𐐀") {
            if (point != 0) {
                CAPTURE(static_cast<unsigned>(point));
                CHECK((is_letter(point) && !is_number(point) && !is_white_space(point)));
            }
        }
        for (auto const point : U"09²½Ⅷ٣३６〇㊿𝟘") {
            if (point != 0) {
                CAPTURE(static_cast<unsigned>(point));
                CHECK((is_number(point) && !is_letter(point) && !is_white_space(point)));
            }
        }
        for (auto const point : {0x9, 0xa, 0xb, 0xc, 0xd, 0x20, 0x85, 0xa0, 0x1680, 0x2000, 0x200a, 0x2028, 0x2029,
                                 0x202f, 0x205f, 0x3000}) {
            CAPTURE(point);
            auto const c = static_cast<char32_t>(point);
            CHECK((is_white_space(c) && !is_letter(c) && !is_number(c)));
        }
        for (auto const point : {0x0,    0x1c,   0x1f,   0x21,   0x5f,   0x7f,   0x84,   0x86,   0xad,    0x301,
                                 0x180e, 0x200b, 0x200d, 0x20e3, 0xe000, 0xfe0f, 0xfeff, 0xffff, 0x1f642, 0x10ffff}) {
            CAPTURE(point);
            auto const c = static_cast<char32_t>(point);
            CHECK((!is_white_space(c) && !is_letter(c) && !is_number(c)));
        }
    }

    TEST_CASE("marks are put in canonical order and composed") {
        CHECK(composed(U"e\u0301") == U"\u00e9");
        CHECK(composed(U"\u00e9\u0301") == U"\u00e9\u0301");
        CHECK(composed(U"e\u0302\u0323") == U"\u1ec7");
        CHECK(composed(U"\u00ea\u0323") == U"\u1ec7");
        CHECK(composed(U"q\u0307\u0323") == U"q\u0323\u0307");
        CHECK(composed(U"\u0301a\u0315\u0300\u05ae\u0300b") == U"\u0301\u00e0\u05ae\u0300\u0315b");
        // Singletons and what is excluded from composition stay decomposed.
        CHECK(composed(U"\u212b\u212a\u2126") == U"\u00c5K\u03a9");
        CHECK(composed(U"\u0958") == U"\u0915\u093c");
        CHECK(composed(U"\u0344") == U"\u0308\u0301");
        // Syllables of Hangul.
        CHECK(composed(U"\u1112\u1161\u11ab") == U"\ud55c");
        CHECK(composed(U"\ud558\u11ab") == U"\ud55c");
        CHECK(composed(U"\ufb01\u00bd") == U"\ufb01\u00bd");
        CHECK(composed(U"") == U"");
    }

    TEST_CASE("composition is composed itself, and a long run of marks is ordered") {
        std::u32string text = U"a";
        for (int i = 0; i < 50'000; ++i) {
            text += U"\u0301\u0323";
        }
        auto const once = composed(text);
        CHECK(once == U"\u1ea1" + std::u32string(49'999, U'\u0323') + std::u32string(50'000, U'\u0301'));
        CHECK(composed(once) == once);
    }

    TEST_CASE("lower case is that of each character alone") {
        CHECK(lower_case(U"AZ\u00c4\u0130I\u0131\u1e9e\u00df") == U"az\u00e4i\u0307i\u0131\u00df\u00df");
        CHECK(lower_case(U"\u03a3\u0391\u03a3") == U"\u03c3\u03b1\u03c3");
        CHECK(lower_case(U"\u01c4\u01c5\U00010400\u2167\u24b6") == U"\u01c6\u01c6\U00010428\u2177\u24d0");
        CHECK(lower_case(U"\ufb01\u6771 1!") == U"\ufb01\u6771 1!");
    }
}
