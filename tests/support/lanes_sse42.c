// SPDX-License-Identifier: MIT
#if defined(__SSE4_2__)
#define LANES lanes_sse42
#include "support/lanes.inl"
#else
#include "support/lanes.h"
const lanes_of_isa lanes_sse42 = {0};
#endif
