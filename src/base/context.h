// SPDX-License-Identifier: MIT
// What a context is made of. Public calls take a `const sag_context *`, because they do not change what the
// caller set up; what does change underneath (counters, threads, the log's lock) is reached through pointers.
#ifndef SAGI_BASE_CONTEXT_H
#define SAGI_BASE_CONTEXT_H

#include "base/cpu.h"
#include "base/pool.h"
#include <pthread.h>
#include <sagitta/base.h>
#include <stdatomic.h>

// Bytes held from the allocator, now and at most.
typedef struct sagi_memory {
    atomic_size_t bytes, peak_bytes;
} sagi_memory;

struct sag_context {
    sag_allocator allocator; // complete: libc's when the caller gave none
    sag_executor executor;   // .run is NULL when the pool does the work
    sagi_isa isa;
    uint32_t thread_count;
    sag_log_callback log;
    void *log_user;
    pthread_mutex_t *log_lock;
    sagi_memory *memory;
    sagi_pool *pool;
};

// libc's allocator.
sag_allocator sagi_libc_allocator(void);

#endif
