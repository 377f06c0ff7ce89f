// SPDX-License-Identifier: MIT
// A library that exports something else.
int genrender_something_else(void);
int genrender_something_else(void) { return 1; }
