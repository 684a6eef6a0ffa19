// SPDX-License-Identifier: MIT
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__)
#define LANES lanes_avx512
#include "support/lanes.inl"
#else
#include "support/lanes.h"
const lanes_of_isa lanes_avx512 = {0};
#endif
