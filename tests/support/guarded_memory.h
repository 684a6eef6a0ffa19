// SPDX-License-Identifier: MIT
// Memory with nothing around it: every block begins or ends where a page does and its neighbours may not be
// touched, so that who reads or writes beyond it dies at once, with or without a sanitizer. A block ends at
// a page's end as far as its alignment allows; the few bytes that may be left over are looked after as well
// as can be: written to, they are noticed when the block is released; under the address sanitizer they may
// not even be read.
#ifndef TESTS_SUPPORT_GUARDED_MEMORY_H
#define TESTS_SUPPORT_GUARDED_MEMORY_H

#include <sagitta/base.h>

typedef enum guarded_side {
    GUARDED_END,   // the block ends where it must not be passed
    GUARDED_BEGIN, // it begins there
} guarded_side;

// For a context. A release with another size than the allocation's, or of a block whose surroundings were
// written to, aborts the program.
sag_allocator guarded_allocator(guarded_side side);

// The same at the end, where SAGITTA_GUARDED is in the environment (the tests guarded/*); else the default.
sag_allocator guarded_if_asked(void);

// A copy of a caller's array that ends at a page's end to the byte; `bytes` is a multiple of the elements'
// alignment. NULL of NULL or of nothing.
void *guarded_copy(const void *from, size_t bytes);
void guarded_free(void *copy, size_t bytes);

#endif
