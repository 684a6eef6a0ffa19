// SPDX-License-Identifier: MIT
// The library's own way.
#include "dispatch.h"
#define SAGI_KERNEL_NAME dispatch_leaf
#include "kernel/kernel.inl"
