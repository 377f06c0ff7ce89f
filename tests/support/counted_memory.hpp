// SPDX-License-Identifier: MIT
// Counts the heap: how much lives, and the most that lived at once. Include it in one file of an executable: it
// replaces malloc and what belongs to it, as the GNU C library allows, so that Eigen's and everybody's memory is
// counted.
#pragma once

#include <atomic>
#include <cstddef>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define GENRENDER_SANITIZED_HEAP
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GENRENDER_SANITIZED_HEAP
#endif

namespace genrender::testing {

/// Bytes of the heap since the program began.
struct counted_memory {
#if defined(__GLIBC__) && !defined(GENRENDER_SANITIZED_HEAP)
    static constexpr bool is_counted = true;
#else
    static constexpr bool is_counted = false; ///< sanitizers have a heap of their own
#endif
    static inline std::atomic<std::size_t> live{0};
    static inline std::atomic<std::size_t> most{0};

    static void add(std::size_t bytes) {
        auto const now = live.fetch_add(bytes, std::memory_order_relaxed) + bytes;
        auto before = most.load(std::memory_order_relaxed);
        while (now > before && !most.compare_exchange_weak(before, now, std::memory_order_relaxed)) {
        }
    }
    static void remove(std::size_t bytes) { live.fetch_sub(bytes, std::memory_order_relaxed); }

    /// The most that `body()` holds at once beyond what lived before it; 0 where nothing is counted.
    template <class Body>
    static std::size_t peak_of(Body&& body) {
        std::size_t const before = live;
        most = before;
        body();
        return most - before;
    }
};

} // namespace genrender::testing

#if defined(__GLIBC__) && !defined(GENRENDER_SANITIZED_HEAP)

#include <cstdlib>
#include <malloc.h>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

inline void* genrender_counted(void* memory) {
    if (memory != nullptr) {
        genrender::testing::counted_memory::add(malloc_usable_size(memory));
    }
    return memory;
}
inline void genrender_uncounted(void* memory) {
    if (memory != nullptr) {
        genrender::testing::counted_memory::remove(malloc_usable_size(memory));
    }
}

void* malloc(std::size_t bytes) noexcept { return genrender_counted(__libc_malloc(bytes)); }
void* calloc(std::size_t count, std::size_t bytes) noexcept { return genrender_counted(__libc_calloc(count, bytes)); }
void* realloc(void* memory, std::size_t bytes) noexcept {
    genrender_uncounted(memory);
    auto* const moved = __libc_realloc(memory, bytes);
    if (moved == nullptr && bytes > 0) {
        genrender_counted(memory); // It stays where it was.
        return nullptr;
    }
    return genrender_counted(moved);
}
void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
    return genrender_counted(__libc_memalign(alignment, bytes));
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
    return genrender_counted(__libc_memalign(alignment, bytes));
}
void free(void* memory) noexcept {
    genrender_uncounted(memory);
    __libc_free(memory);
}
}

#endif
