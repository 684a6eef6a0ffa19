// SPDX-License-Identifier: MIT
// The library's own way a second time, elsewhere in memory.
#include "dispatch.h"
#define SAGI_KERNEL_NAME dispatch_again
#include "kernel/kernel.inl"
