// SPDX-License-Identifier: MIT
#define SOLVERS triangle_solvers_portable
#include "support/triangle_four.inl"
