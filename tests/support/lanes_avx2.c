// SPDX-License-Identifier: MIT
#if defined(__AVX2__) && defined(__FMA__)
#define LANES lanes_avx2
#include "support/lanes.inl"
#else
#include "support/lanes.h"
const lanes_of_isa lanes_avx2 = {0};
#endif
