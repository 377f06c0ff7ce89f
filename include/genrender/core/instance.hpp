// SPDX-License-Identifier: MIT
// Instances of templates that a program compiles once, apart from what calls them.
#pragma once

#include <genrender/core/begin_header.inl>

// Where all units of a program define GENRENDER_COMPILED, instances that are named below are compiled elsewhere: in the one unit
// that includes whole components and defines GENRENDER_INSTANCES_HERE instead. Where neither is defined, templates are compiled
// where they are called, as templates are. Functions whose body stands in a class are inline: only others leave the unit that
// calls them.

#if defined(GENRENDER_INSTANCES_HERE)
/// Names the instance of a function template, such as `scaled_dot_product<float>`, at namespace scope.
#define GENRENDER_INSTANCE(...) template decltype(__VA_ARGS__) __VA_ARGS__
/// The same for the members of an instance of a class template.
#define GENRENDER_CLASS_INSTANCE(...) template class __VA_ARGS__
#elif defined(GENRENDER_COMPILED)
#define GENRENDER_INSTANCE(...) extern template decltype(__VA_ARGS__) __VA_ARGS__
#define GENRENDER_CLASS_INSTANCE(...) extern template class __VA_ARGS__
#else
#define GENRENDER_INSTANCE(...) static_assert(true)
#define GENRENDER_CLASS_INSTANCE(...) static_assert(true)
#endif

#include <genrender/core/end_header.inl>
