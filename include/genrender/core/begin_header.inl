// SPDX-License-Identifier: MIT
// Puts macros aside that hosts are known to define and that are words here; end_header.inl brings them back.
//
// Every header begins with this and ends with that, so whoever includes them keeps his macros and we ours.
#pragma push_macro("min")
#pragma push_macro("max")
#pragma push_macro("near")
#pragma push_macro("far")
#pragma push_macro("small")
#pragma push_macro("I")
#pragma push_macro("EPS")
#undef min
#undef max
#undef near
#undef far
#undef small
#undef I
#undef EPS
