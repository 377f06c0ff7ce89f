// SPDX-License-Identifier: MIT
// Brings back the macros that begin_header.inl put aside.
#pragma pop_macro("min")
#pragma pop_macro("max")
#pragma pop_macro("near")
#pragma pop_macro("far")
#pragma pop_macro("small")
#pragma pop_macro("I")
#pragma pop_macro("EPS")
