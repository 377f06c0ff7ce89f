// SPDX-License-Identifier: MIT
// Blocks out of chunks do not overlap, lie where they must, and share few chunks.
#include <genrender/core/chunked_memory.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("core/chunked_memory") {
    TEST_CASE("blocks keep what is written to them and are aligned") {
        chunked_memory memory;
        std::vector<std::pair<unsigned char*, std::size_t>> blocks;
        for (std::size_t n = 0; n < 400; ++n) {
            auto const bytes = 1 + n * 37 % 5000;
            auto const alignment = std::size_t{1} << n % 7;
            auto* const block = static_cast<unsigned char*>(memory.allocate(bytes, alignment));
            CHECK(reinterpret_cast<std::uintptr_t>(block) % alignment == 0);
            std::memset(block, static_cast<int>(n % 251), bytes);
            blocks.emplace_back(block, bytes);
        }
        for (std::size_t n = 0; n < blocks.size(); ++n) {
            for (std::size_t at = 0; at < blocks[n].second; ++at) {
                REQUIRE(blocks[n].first[at] == n % 251);
            }
        }
        CHECK(memory.byte_count() == 2 * chunked_memory::chunk_bytes);
    }

    TEST_CASE("a block of some size has a chunk of its own and the chunk before it goes on") {
        chunked_memory memory;
        auto* const first = static_cast<std::byte*>(memory.allocate(100, 4));
        CHECK(memory.allocate(chunked_memory::chunk_bytes / 4, 64) != nullptr);
        CHECK(memory.byte_count() == chunked_memory::chunk_bytes + chunked_memory::chunk_bytes / 4 + 64);
        CHECK(static_cast<std::byte*>(memory.allocate(100, 4)) == first + 100);
    }

    TEST_CASE("what is larger than a chunk has one of its own and what was freed stays") {
        chunked_memory memory;
        CHECK(memory.byte_count() == 0);
        auto* const large = memory.allocate(3 * chunked_memory::chunk_bytes, 64);
        CHECK(memory.byte_count() >= 3 * chunked_memory::chunk_bytes);
        std::memset(large, 1, 3 * chunked_memory::chunk_bytes);
        memory.deallocate(large, 3 * chunked_memory::chunk_bytes, 64);
        CHECK(static_cast<unsigned char*>(large)[7] == 1);
        std::pmr::vector<int> numbers({1, 2, 3}, &memory);
        numbers.push_back(4);
        CHECK(numbers.back() == 4);
        CHECK(memory.is_equal(memory));
        CHECK_FALSE(memory.is_equal(chunked_memory()));
    }
}
