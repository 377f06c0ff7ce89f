// SPDX-License-Identifier: MIT
// What a kernel of this object knows of its target.

namespace genrender::detail::GENRENDER_TARGET {

inline std::size_t register_bytes_of_object() { return GENRENDER_TARGET_BYTES; }

} // namespace genrender::detail::GENRENDER_TARGET
