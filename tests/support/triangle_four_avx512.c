// SPDX-License-Identifier: MIT
#if defined(__AVX512F__) && defined(__AVX512VL__)
#define SOLVERS triangle_solvers_avx512
#include "support/triangle_four.inl"
#else
#include "support/triangle_four.h"
const triangle_solvers triangle_solvers_avx512 = {0};
#endif
