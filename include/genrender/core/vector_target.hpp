// SPDX-License-Identifier: MIT
// Which vector instructions the kernels use: compiled for several targets in one translation unit, chosen as they run.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/vector_unit.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#if GENRENDER_HAS_X86_TARGETS
#include <cpuid.h>
#endif

namespace genrender {

/// The instructions that a kernel may use, the lesser first.
enum class vector_target : std::uint8_t {
    baseline, ///< those of the translation unit's own flags: 128-bit vectors of x86-64 or NEON where there are none
    v3,       ///< 256 bits of x86-64-v3: AVX2, FMA, F16C, BMI, BMI2
    v4        ///< 512 bits of x86-64-v4: AVX-512 F, BW, CD, DQ, VL
};

/// `baseline`, `v3` or `v4`.
inline char const* name_of(vector_target target) {
    switch (target) {
    case vector_target::v3:
        return "v3";
    case vector_target::v4:
        return "v4";
    default:
        return "baseline";
    }
}

namespace detail {

/// The greatest target that this processor and its operating system know.
inline vector_target processor_target() {
#if GENRENDER_HAS_X86_TARGETS
    static auto const known = [] {
        __builtin_cpu_init();
        unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
        // Not every compiler's __builtin_cpu_supports has a name for F16C.
        auto const has_f16c = __get_cpuid(1, &eax, &ebx, &ecx, &edx) != 0 && (ecx >> 29U & 1U) != 0;
        auto const is_v3 = has_f16c && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
        auto const is_v4 = is_v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                           __builtin_cpu_supports("avx512vl");
        return is_v4 ? vector_target::v4 : is_v3 ? vector_target::v3 : vector_target::baseline;
    }();
    return known;
#else
    return vector_target::baseline;
#endif
}

inline constexpr int not_forced = -1;

/// What force_vector_target asked for, in all of the program.
inline std::atomic<int> forced_target{not_forced};

/// What the environment variable GENRENDER_VECTOR_TARGET asks for. Throws value_error if that is no target or none of
/// this processor's.
inline std::optional<vector_target> environment_target() {
    static auto const wanted = []() -> std::optional<vector_target> {
        auto const* const word = std::getenv("GENRENDER_VECTOR_TARGET");
        if (word == nullptr || *word == '\0') {
            return std::nullopt;
        }
        std::string known;
        for (auto const target : {vector_target::baseline, vector_target::v3, vector_target::v4}) {
            if (target <= processor_target()) {
                if (std::string(word) == name_of(target)) {
                    return target;
                }
                known += (known.empty() ? "" : ", ") + std::string(name_of(target));
            }
        }
        throw value_error("GENRENDER_VECTOR_TARGET is " + std::string(word) +
                          ", expected one of this processor's: " + known);
    }();
    return wanted;
}

/// Of one kernel in all targets, the one compiled for `target` or what comes nearest below it.
template <class Kernel>
Kernel* of_target(vector_target target, Kernel* own, Kernel* v3 = nullptr, Kernel* v4 = nullptr) {
    if (v4 != nullptr && target >= vector_target::v4) {
        return v4;
    }
    return v3 != nullptr && target >= vector_target::v3 ? v3 : own;
}

} // namespace detail

inline namespace GENRENDER_UNIT {

/// The target of this translation unit's own flags: what runs where a processor knows no better.
inline constexpr auto own_vector_target = static_cast<vector_target>(GENRENDER_OWN_TARGET);

/// The targets that this translation unit's kernels are compiled for and this processor knows, the least first.
inline std::vector<vector_target> available_vector_targets() {
    std::vector<vector_target> targets{own_vector_target};
    for (auto const target : {vector_target::v3, vector_target::v4}) {
        auto const is_compiled = target == vector_target::v3 ? GENRENDER_COMPILES_V3 : GENRENDER_COMPILES_V4;
        if (is_compiled && target <= detail::processor_target()) {
            targets.push_back(target);
        }
    }
    return targets;
}

/// The target at which kernels called from this translation unit run: the one that was forced, else the one that the
/// environment variable GENRENDER_VECTOR_TARGET (baseline, v3 or v4) names, else the greatest of the processor's; of
/// these the greatest that is compiled here and not above it. Results have the same bits on any machine and number of
/// threads for one target and compiler; other targets round otherwise. Throws value_error if the variable names none
/// of the processor's targets.
inline vector_target chosen_vector_target() {
    auto const forced = detail::forced_target.load(std::memory_order_relaxed);
    auto const most = forced != detail::not_forced ? static_cast<vector_target>(forced)
                                                   : detail::environment_target().value_or(detail::processor_target());
    if (GENRENDER_COMPILES_V4 && most >= vector_target::v4) {
        return vector_target::v4;
    }
    return GENRENDER_COMPILES_V3 && most >= vector_target::v3 ? vector_target::v3 : own_vector_target;
}

/// Makes all kernels of the program that are called from now on run at one target, for tests and to have on this
/// machine the bits of another; nothing takes it back. Not while kernels run that must agree with each other. Throws
/// value_error unless the target is one of available_vector_targets().
inline void force_vector_target(std::optional<vector_target> target) {
    if (!target) {
        detail::forced_target.store(detail::not_forced);
        return;
    }
    auto const available = available_vector_targets();
    if (std::find(available.begin(), available.end(), *target) == available.end()) {
        std::string names;
        for (auto const one : available) {
            names += (names.empty() ? "" : ", ") + std::string(name_of(one));
        }
        throw value_error(std::string("force_vector_target: target is ") + name_of(*target) + ", expected one of " +
                          names);
    }
    detail::forced_target.store(static_cast<int>(*target));
}

} // namespace GENRENDER_UNIT

} // namespace genrender

/// A pointer to the kernel `name` (a function, or a template with its arguments) of a namespace, compiled for a target.
#if GENRENDER_COMPILES_V3
#define GENRENDER_KERNEL_OF(target, where, ...)                                                                        \
    ::genrender::detail::of_target(target, &where::baseline::__VA_ARGS__, &where::v3::__VA_ARGS__,                     \
                                   &where::v4::__VA_ARGS__)
#elif GENRENDER_COMPILES_V4
#define GENRENDER_KERNEL_OF(target, where, ...)                                                                        \
    ::genrender::detail::of_target(target, &where::baseline::__VA_ARGS__, &where::v4::__VA_ARGS__,                     \
                                   &where::v4::__VA_ARGS__)
#else
#define GENRENDER_KERNEL_OF(target, where, ...) ::genrender::detail::of_target(target, &where::baseline::__VA_ARGS__)
#endif

/// The same for the target at which kernels run now.
#define GENRENDER_KERNEL(where, ...) GENRENDER_KERNEL_OF(::genrender::chosen_vector_target(), where, __VA_ARGS__)

#include <genrender/core/end_header.inl>
