// SPDX-License-Identifier: MIT
// The context's threads.
#ifndef SAGI_BASE_POOL_H
#define SAGI_BASE_POOL_H

#include <pthread.h>
#include <sagitta/base.h>
#include <stdatomic.h>
#include <sys/types.h>

#define SAGI_MAX_THREADS 1024

typedef struct sagi_job sagi_job;
typedef struct sagi_frame sagi_frame;

typedef struct sagi_pool {
    pthread_mutex_t lock;
    pthread_cond_t work; // a job came, or the end
    pthread_cond_t done; // a thread left a job
    sagi_job *jobs;      // those that may have indices left; they live on their callers' stacks
    atomic_uint posted;  // how many jobs there have been
    sagi_frame *frames;  // one for each thread that is inside a task
    pid_t owner;         // the process the threads run in
    bool stopping;
    bool started;
    uint32_t helper_limit; // threads to start: all but the caller's own
    uint32_t helper_count; // threads running
    pthread_t *helpers;    // room for helper_limit
} sagi_pool;

// `helpers` has room for helper_limit threads and must outlive the pool. False when the system has no lock to
// give.
bool sagi_pool_init(sagi_pool *pool, uint32_t helper_limit, pthread_t *helpers);
// Stops and joins the threads. No call may be running. (After fork the child has none: there it only
// forgets.)
void sagi_pool_clear(sagi_pool *pool);
// sag_parallel_for on the pool's threads and the caller's.
void sagi_pool_run(sagi_pool *pool, size_t count, void (*task)(void *argument, size_t index), void *argument);
// The same on the caller's own scheduler.
void sagi_pool_run_on(sagi_pool *pool, const sag_executor *executor, size_t count,
                      void (*task)(void *argument, size_t index), void *argument);

#endif
