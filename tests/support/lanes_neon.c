// SPDX-License-Identifier: MIT
#if defined(__aarch64__) && defined(__ARM_NEON)
#define LANES lanes_neon
#include "support/lanes.inl"
#else
#include "support/lanes.h"
const lanes_of_isa lanes_neon = {0};
#endif
