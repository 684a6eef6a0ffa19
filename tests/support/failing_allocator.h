// SPDX-License-Identifier: MIT
// An allocator that fails on demand and keeps books: the tool to show that running out of memory anywhere is
// an error code and that nothing leaks. The usual loop fails the k-th allocation for every k:
//
//     for (size_t k = 0;; k++) {
//         failing_allocator f = {.fail_at = k};
//         sag_context *c = sag_context_create(&(sag_context_options){.allocator =
//         failing_allocator_make(&f)}); bool done = c != NULL && work(c);    // what is tested; true when it
//         came to its end sag_context_destroy(c); failing_allocator_assert_empty(&f); if (done) break; // k
//         was beyond the last allocation
//     }
#ifndef TESTS_SUPPORT_FAILING_ALLOCATOR_H
#define TESTS_SUPPORT_FAILING_ALLOCATOR_H

#include <sagitta/base.h>
#include <stdatomic.h>

#define NEVER SIZE_MAX

typedef struct failing_allocator {
    size_t fail_at;           // this allocation, counted from 0, and all later ones fail; NEVER: none
    atomic_size_t calls;      // how many were asked for
    atomic_size_t bytes;      // held now
    atomic_size_t blocks;     // held now
    atomic_size_t mismatches; // releases with another size or alignment than the allocation's
} failing_allocator;

sag_allocator failing_allocator_make(failing_allocator *books);
// Fails the test when anything is still held or was released wrongly.
void failing_allocator_assert_empty(failing_allocator *books);

#endif
