// SPDX-License-Identifier: MIT
// The traversal for any machine.
#define SAGI_KERNEL_NAME sagi_kernel_portable
#include "kernel/kernel.inl"
