// SPDX-License-Identifier: MIT
#include "support/failing_allocator.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

// In front of each block, in a piece as large as the alignment.
typedef struct label {
    size_t size_bytes, alignment_bytes;
} label;

static void *allocate(void *user, size_t size_bytes, size_t alignment_bytes) {
    failing_allocator *books = user;
    if (atomic_fetch_add(&books->calls, 1) >= books->fail_at) return NULL;
    size_t front = alignment_bytes < sizeof(label) ? sizeof(label) : alignment_bytes;
    size_t total = (front + size_bytes + front - 1) / front * front;
    char *memory = total < size_bytes ? NULL : aligned_alloc(front, total);
    if (memory == NULL) return NULL;
    *(label *)(void *)memory = (label){size_bytes, alignment_bytes};
    for (size_t i = front; i < total; i++)
        memory[i] = (char)0xA5; // whoever reads before writing shall notice
    atomic_fetch_add(&books->bytes, size_bytes);
    atomic_fetch_add(&books->blocks, 1);
    return memory + front;
}

static void release(void *user, void *memory, size_t size_bytes, size_t alignment_bytes) {
    failing_allocator *books = user;
    size_t front = alignment_bytes < sizeof(label) ? sizeof(label) : alignment_bytes;
    label *l = (label *)(void *)((char *)memory - front);
    if (l->size_bytes != size_bytes || l->alignment_bytes != alignment_bytes)
        atomic_fetch_add(&books->mismatches, 1);
    atomic_fetch_sub(&books->bytes, l->size_bytes);
    atomic_fetch_sub(&books->blocks, 1);
    free(l);
}

sag_allocator failing_allocator_make(failing_allocator *books) {
    return (sag_allocator){.user = books, .allocate = allocate, .release = release};
}

void failing_allocator_assert_empty(failing_allocator *books) {
    assert_int_equal(atomic_load(&books->mismatches), 0);
    assert_int_equal(atomic_load(&books->blocks), 0);
    assert_int_equal(atomic_load(&books->bytes), 0);
}
