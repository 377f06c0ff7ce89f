// SPDX-License-Identifier: MIT
// Puts macros aside that hosts and engines are known to define and that are words here or in the libraries that we include, every
// single capital letter among them; end_header.inl brings them back.
//
// Every header begins with this and ends with that, so whoever includes them keeps his macros and we ours.
#if __cplusplus <= 201703L && !(defined(_MSVC_LANG) && _MSVC_LANG > 201703L) && !defined(GENRENDER_BELOW_CXX20)
#define GENRENDER_BELOW_CXX20 // Said once.
#error "genrender is C++20: compile with -std=c++20 or later; hosts below have genrender/c/engine.h"
#endif
#pragma push_macro("min")
#pragma push_macro("max")
#pragma push_macro("near")
#pragma push_macro("far")
#pragma push_macro("small")
#pragma push_macro("EPS")
#pragma push_macro("PI")
#pragma push_macro("UV")
#pragma push_macro("KF")
#pragma push_macro("check")
#pragma push_macro("None")
#pragma push_macro("Status")
#pragma push_macro("Success")
#pragma push_macro("A")
#pragma push_macro("B")
#pragma push_macro("C")
#pragma push_macro("D")
#pragma push_macro("E")
#pragma push_macro("F")
#pragma push_macro("G")
#pragma push_macro("H")
#pragma push_macro("I")
#pragma push_macro("J")
#pragma push_macro("K")
#pragma push_macro("L")
#pragma push_macro("M")
#pragma push_macro("N")
#pragma push_macro("O")
#pragma push_macro("P")
#pragma push_macro("Q")
#pragma push_macro("R")
#pragma push_macro("S")
#pragma push_macro("T")
#pragma push_macro("U")
#pragma push_macro("V")
#pragma push_macro("W")
#pragma push_macro("X")
#pragma push_macro("Y")
#pragma push_macro("Z")
#undef min
#undef max
#undef near
#undef far
#undef small
#undef EPS
#undef PI
#undef UV
#undef KF
#undef check
#undef None
#undef Status
#undef Success
#undef A
#undef B
#undef C
#undef D
#undef E
#undef F
#undef G
#undef H
#undef I
#undef J
#undef K
#undef L
#undef M
#undef N
#undef O
#undef P
#undef Q
#undef R
#undef S
#undef T
#undef U
#undef V
#undef W
#undef X
#undef Y
#undef Z
