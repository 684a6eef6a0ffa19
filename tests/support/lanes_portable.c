// SPDX-License-Identifier: MIT
#define SAGI_SIMD_PLAIN
#define LANES lanes_portable
#include "support/lanes.inl"
