// SPDX-License-Identifier: MIT
// Runs the objects that are linked into this program and prints a line for each.
#include "object.hpp"

#include <cstdio>

int main() {
    auto const print = [](char const* name, object_report const& report) {
        std::printf("%s: %s, %zu bytes, %s, %016llx\n", name, report.target, report.register_bytes,
                    report.error < 1e-5 ? "right" : "wrong", static_cast<unsigned long long>(report.checksum));
    };
#ifdef WITH_NO_FLAGS
    print("no flags", object_of_no_flags());
#endif
#ifdef WITH_AVX2
    print("avx2", object_of_avx2());
#endif
#ifdef WITH_AVX512
    print("avx512", object_of_avx512());
#endif
    return 0;
}
