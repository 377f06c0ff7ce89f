// SPDX-License-Identifier: MIT
// What a kernel knows of its target.

namespace genrender::testing::GENRENDER_TARGET {

inline std::size_t register_bytes() { return GENRENDER_TARGET_BYTES; }

} // namespace genrender::testing::GENRENDER_TARGET
