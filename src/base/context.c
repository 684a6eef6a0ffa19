// SPDX-License-Identifier: MIT
// The context: one allocation that holds the settings and everything that changes under them.
#define _GNU_SOURCE // sched_getaffinity
#include "base/context.h"
#include <sched.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct block {
    sag_context context;
    sagi_memory memory;
    sagi_pool pool;
    pthread_mutex_t log_lock;
    size_t bytes; // of the whole block, the threads' handles behind it included
    pthread_t helpers[];
} block;

// As many as the process may run on: its affinity mask (containers and taskset narrow it), else the cores
// there are.
static uint32_t usable_threads(void) {
    long count = 0;
#ifdef CPU_COUNT
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) count = CPU_COUNT(&set);
#endif
    if (count < 1) count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : (uint32_t)count;
}

static uint32_t thread_count(const sag_context_options *options) {
    uint32_t count = options->executor.run != NULL ? options->executor.thread_count : options->thread_count;
    if (count == 0) count = options->executor.run != NULL ? 1 : usable_threads();
    return count > SAGI_MAX_THREADS ? SAGI_MAX_THREADS : count;
}

// A lock that its holder may take again, so that a log callback may itself call what logs.
static bool recursive_lock_init(pthread_mutex_t *lock) {
    pthread_mutexattr_t attributes;
    if (pthread_mutexattr_init(&attributes) != 0) return false;
    bool made = pthread_mutexattr_settype(&attributes, PTHREAD_MUTEX_RECURSIVE) == 0 &&
                pthread_mutex_init(lock, &attributes) == 0;
    pthread_mutexattr_destroy(&attributes);
    return made;
}

// "" in the environment counts as not set.
static bool choose_isa(const char *wanted, sagi_isa *isa) {
    if (wanted == NULL) wanted = getenv("SAG_ISA");
    return sagi_isa_choose(wanted != NULL && wanted[0] != 0 ? wanted : NULL, isa);
}

sag_context *sag_context_create(const sag_context_options *options) {
    static const sag_context_options defaults = {0};
    if (options == NULL) options = &defaults;
    sag_allocator allocator = options->allocator;
    if (allocator.allocate == NULL && allocator.release == NULL) allocator = sagi_libc_allocator();
    sagi_isa isa;
    if (allocator.allocate == NULL || allocator.release == NULL || !choose_isa(options->isa, &isa))
        return NULL;

    uint32_t threads = thread_count(options);
    uint32_t helpers = options->executor.run != NULL ? 0 : threads - 1;
    size_t bytes = sizeof(block) + helpers * sizeof(pthread_t);
    block *b = allocator.allocate(allocator.user, bytes, 64);
    if (b == NULL) return NULL;
    if (recursive_lock_init(&b->log_lock)) {
        if (sagi_pool_init(&b->pool, helpers, b->helpers)) {
            b->bytes = bytes;
            atomic_init(&b->memory.bytes, bytes);
            atomic_init(&b->memory.peak_bytes, bytes);
            b->context = (sag_context){
                .allocator = allocator,
                .executor = options->executor,
                .isa = isa,
                .thread_count = threads,
                .log = options->log,
                .log_user = options->log_user,
                .log_lock = &b->log_lock,
                .memory = &b->memory,
                .pool = &b->pool,
            };
            return &b->context;
        }
        pthread_mutex_destroy(&b->log_lock);
    }
    allocator.release(allocator.user, b, bytes, 64);
    return NULL;
}

void sag_context_destroy(sag_context *context) {
    if (context == NULL) return;
    block *b = (block *)context; // the context is its first member
    sag_allocator allocator = context->allocator;
    sagi_pool_clear(&b->pool);
    pthread_mutex_destroy(&b->log_lock);
    allocator.release(allocator.user, b, b->bytes, 64);
}

uint32_t sag_context_thread_count(const sag_context *context) { return context->thread_count; }

const char *sag_context_isa(const sag_context *context) { return sagi_isa_name(context->isa); }

void sag_context_log(const sag_context *context, sag_log_level level, const char *format, ...) {
    if (context->log == NULL) return;
    char message[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (length < 0) return;
    pthread_mutex_lock(context->log_lock);
    context->log(context->log_user, level, message);
    pthread_mutex_unlock(context->log_lock);
}

void sag_parallel_for(const sag_context *context, size_t count, void (*task)(void *argument, size_t index),
                      void *argument) {
    if (count == 0) return;
    if (context->executor.run != NULL)
        sagi_pool_run_on(context->pool, &context->executor, count, task, argument);
    else
        sagi_pool_run(context->pool, count, task, argument);
}
