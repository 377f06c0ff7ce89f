// SPDX-License-Identifier: MIT
// Memory for much that is small and stays: in large chunks, apart from what comes and goes.
#pragma once

#include <genrender/core/begin_header.inl>

#include <cstddef>
#include <memory>
#include <memory_resource>
#include <vector>

namespace genrender {

/// Gives memory out of chunks and takes none back before it ends. Small blocks that stay, allocated one by one between
/// larger ones that are freed, would leave holes that nothing fits in; a run of many frames would grow by them. For one
/// thread at a time. Throws std::bad_alloc where there is no more memory.
class chunked_memory final : public std::pmr::memory_resource {
public:
    /// Bytes of a chunk. A block of more than an eighth of it has one of its own, so that not more is lost at its end.
    static constexpr std::size_t chunk_bytes = std::size_t{512} << 10;

    chunked_memory() = default;
    chunked_memory(chunked_memory const&) = delete;
    chunked_memory& operator=(chunked_memory const&) = delete;

    /// Bytes of all chunks.
    std::size_t byte_count() const { return bytes_; }

private:
    void* do_allocate(std::size_t bytes, std::size_t alignment) override {
        if (bytes > chunk_bytes / 8) {
            auto space = bytes + alignment;
            auto* own = add_chunk(space);
            return std::align(alignment, bytes, own, space);
        }
        if (std::align(alignment, bytes, next_, left_) == nullptr) {
            next_ = add_chunk(chunk_bytes);
            left_ = chunk_bytes;
            std::align(alignment, bytes, next_, left_);
        }
        auto* const block = next_;
        next_ = static_cast<std::byte*>(next_) + bytes;
        left_ -= bytes;
        return block;
    }
    void do_deallocate(void*, std::size_t, std::size_t) override {}
    bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

    void* add_chunk(std::size_t bytes) {
        chunks_.push_back(std::make_unique_for_overwrite<std::byte[]>(bytes));
        bytes_ += bytes;
        return chunks_.back().get();
    }

    std::vector<std::unique_ptr<std::byte[]>> chunks_;
    void* next_ = nullptr;
    std::size_t left_ = 0;
    std::size_t bytes_ = 0;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
