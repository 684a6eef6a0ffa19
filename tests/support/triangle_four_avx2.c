// SPDX-License-Identifier: MIT
#if defined(__AVX2__) && defined(__FMA__)
#define SOLVERS triangle_solvers_avx2
#include "support/triangle_four.inl"
#else
#include "support/triangle_four.h"
const triangle_solvers triangle_solvers_avx2 = {0};
#endif
