// SPDX-License-Identifier: MIT
// What each object of a program of several flags tells of its kernels.
#pragma once

#include <cstddef>
#include <cstdint>

struct object_report {
    char const* target;         ///< what runs, by its name
    std::size_t register_bytes; ///< of the kernels that run
    double error;               ///< greatest difference from the plainly written result
    std::uint64_t checksum;     ///< of the bits of the result
};

object_report object_of_no_flags();
object_report object_of_avx2();
object_report object_of_avx512();
