// SPDX-License-Identifier: MIT
// A small thread pool. A parallel call makes a job on its own stack, hangs it in the pool's list, works on it
// itself, takes it off the list when no index is left to claim and waits for the helpers that are still
// inside. Indices are claimed one by one from an atomic counter, so uneven tasks balance themselves; whoever
// wants larger pieces makes them part of the task.
//
// Why it cannot hang: the caller needs nobody. If no helper starts (the system has no more threads), none is
// free, or another thread's job holds them all, the caller works through every index alone. Helpers take any
// job in the list that has indices left, so calls from several threads at once share them.
//
// Nested calls run on the calling thread: each thread that works on a job notes itself in the list of frames,
// and a call that finds its own thread there is nested. That needs no thread-local variable, so two contexts
// stay strangers.
//
// After fork() the child has the pool's memory, locks as they happened to stand, and none of its threads:
// waiting for one would never end. So the first call in another process than the owner makes the pool anew.
//
// A thread that has nothing to do, or waits for the others, first looks round for some ten microseconds
// before it sleeps: the many short calls of a small scene's commit follow each other faster than a thread
// wakes up.
#include "base/pool.h"
#include <signal.h>
#include <stdatomic.h>
#include <unistd.h>

// Tasks may keep exact arithmetic's buffers on the stack; this is address space, not memory.
#define STACK_BYTES ((size_t)4 << 20)

#define LOOKS 1000 // of some 10 to 40 ns

struct sagi_job {
    void (*task)(void *argument, size_t index);
    void *argument;
    size_t count;
    atomic_size_t next; // the first index nobody claimed; runs past count by one for each thread that looked
    atomic_uint helper_count; // helpers inside; changed under the pool's lock
    sagi_job *link;
};

struct sagi_frame {
    pthread_t thread;
    sagi_frame *link;
};

static void enter(sagi_pool *pool, sagi_frame *frame) {
    frame->thread = pthread_self();
    frame->link = pool->frames;
    pool->frames = frame;
}

static void leave(sagi_pool *pool, const sagi_frame *frame) {
    sagi_frame **place = &pool->frames;
    while (*place != frame) place = &(*place)->link;
    *place = frame->link;
}

static bool is_inside(const sagi_pool *pool) {
    pthread_t self = pthread_self();
    for (const sagi_frame *f = pool->frames; f != NULL; f = f->link)
        if (pthread_equal(f->thread, self)) return true;
    return false;
}

static void settle(sagi_pool *pool) {
    if (pool->owner == getpid()) return;
    sagi_frame *frames = pool->frames;
    pool->frames = NULL;
    for (sagi_frame *f = frames, *link; f != NULL; f = link) { // this thread's own stay
        link = f->link;
        if (pthread_equal(f->thread, pthread_self())) f->link = pool->frames, pool->frames = f;
    }
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->work, NULL);
    pthread_cond_init(&pool->done, NULL);
    pool->jobs = NULL;
    pool->started = false;
    pool->helper_count = 0;
    pool->owner = getpid();
}

// One look round.
#if defined(__x86_64__) || defined(__i386__)
static inline void look(void) { __builtin_ia32_pause(); }
#else
static inline void look(void) { atomic_signal_fence(memory_order_seq_cst); }
#endif

// Until somebody posts a job, or not much longer.
static void look_for_work(sagi_pool *pool, unsigned seen) {
    for (int i = 0; i < LOOKS; i++) {
        if (atomic_load_explicit(&pool->posted, memory_order_relaxed) != seen) return;
        look();
    }
}

// Until nobody is inside, or not much longer.
static void look_for_end(const sagi_job *job) {
    for (int i = 0; i < LOOKS; i++) {
        if (atomic_load_explicit(&job->helper_count, memory_order_relaxed) == 0) return;
        look();
    }
}

static void work_on(sagi_job *job) {
    for (;;) {
        size_t index = atomic_fetch_add_explicit(&job->next, 1, memory_order_relaxed);
        if (index >= job->count) return;
        job->task(job->argument, index);
    }
}

static sagi_job *open_job(const sagi_pool *pool) {
    for (sagi_job *job = pool->jobs; job != NULL; job = job->link)
        if (atomic_load_explicit(&job->next, memory_order_relaxed) < job->count) return job;
    return NULL;
}

static void *helper_main(void *argument) {
    sagi_pool *pool = argument;
    sagi_frame frame;
    bool looked = true;
    pthread_mutex_lock(&pool->lock);
    enter(pool, &frame);
    while (!pool->stopping) {
        sagi_job *job = open_job(pool);
        if (job == NULL && looked) {
            pthread_cond_wait(&pool->work, &pool->lock);
            continue;
        }
        if (job == NULL) {
            const unsigned seen = atomic_load_explicit(&pool->posted, memory_order_relaxed);
            pthread_mutex_unlock(&pool->lock);
            look_for_work(pool, seen);
            looked = true;
            pthread_mutex_lock(&pool->lock);
            continue;
        }
        atomic_fetch_add_explicit(&job->helper_count, 1, memory_order_relaxed);
        pthread_mutex_unlock(&pool->lock);
        work_on(job);
        looked = false;
        pthread_mutex_lock(&pool->lock);
        // (What the task wrote, the lock makes known.)
        if (atomic_fetch_sub_explicit(&job->helper_count, 1, memory_order_relaxed) == 1)
            pthread_cond_broadcast(&pool->done);
    }
    leave(pool, &frame);
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

// Starts what threads can be had, with all signals blocked so that the host's handlers run on the host's own
// threads.
static void start(sagi_pool *pool) {
    pool->started = true;
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes) != 0) return;
    pthread_attr_setstacksize(&attributes, STACK_BYTES);
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (pool->helper_count < pool->helper_limit &&
           pthread_create(&pool->helpers[pool->helper_count], &attributes, helper_main, pool) == 0)
        pool->helper_count++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
}

bool sagi_pool_init(sagi_pool *pool, uint32_t helper_limit, pthread_t *helpers) {
    *pool = (sagi_pool){.owner = getpid(), .helper_limit = helper_limit, .helpers = helpers};
    if (pthread_mutex_init(&pool->lock, NULL) != 0) return false;
    if (pthread_cond_init(&pool->work, NULL) == 0) {
        if (pthread_cond_init(&pool->done, NULL) == 0) return true;
        pthread_cond_destroy(&pool->work);
    }
    pthread_mutex_destroy(&pool->lock);
    return false;
}

void sagi_pool_clear(sagi_pool *pool) {
    settle(pool);
    pthread_mutex_lock(&pool->lock);
    pool->stopping = true;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->lock);
    for (uint32_t i = 0; i < pool->helper_count; i++) pthread_join(pool->helpers[i], NULL);
    pthread_cond_destroy(&pool->done);
    pthread_cond_destroy(&pool->work);
    pthread_mutex_destroy(&pool->lock);
}

void sagi_pool_run(sagi_pool *pool, size_t count, void (*task)(void *argument, size_t index),
                   void *argument) {
    sagi_job job = {.task = task, .argument = argument, .count = count};
    sagi_frame frame;
    settle(pool);
    pthread_mutex_lock(&pool->lock);
    if (is_inside(pool)) {
        pthread_mutex_unlock(&pool->lock);
        work_on(&job);
        return;
    }
    enter(pool, &frame);
    if (count > 1) {
        if (!pool->started) start(pool);
        job.link = pool->jobs;
        pool->jobs = &job; // cppcheck-suppress autoVariables ; taken off before this function returns
        pthread_cond_broadcast(&pool->work);
    }
    pthread_mutex_unlock(&pool->lock);
    // (After the lock is free: who sees it takes the lock.)
    if (count > 1) atomic_fetch_add_explicit(&pool->posted, 1, memory_order_relaxed);

    work_on(&job);
    look_for_end(&job);

    pthread_mutex_lock(&pool->lock);
    for (sagi_job **place = &pool->jobs; *place != NULL; place = &(*place)->link) {
        if (*place != &job) continue;
        *place = job.link;
        break;
    }
    while (atomic_load_explicit(&job.helper_count, memory_order_relaxed) > 0)
        pthread_cond_wait(&pool->done, &pool->lock);
    leave(pool, &frame);
    pthread_mutex_unlock(&pool->lock);
}

typedef struct guest {
    sagi_pool *pool;
    void (*task)(void *argument, size_t index);
    void *argument;
} guest;

// A task on a thread of the caller's scheduler: noted in the frames for as long as it runs.
static void guest_task(void *argument, size_t index) {
    const guest *g = argument;
    sagi_frame frame;
    pthread_mutex_lock(&g->pool->lock);
    enter(g->pool, &frame);
    pthread_mutex_unlock(&g->pool->lock);
    g->task(g->argument, index);
    pthread_mutex_lock(&g->pool->lock);
    leave(g->pool, &frame);
    pthread_mutex_unlock(&g->pool->lock);
}

void sagi_pool_run_on(sagi_pool *pool, const sag_executor *executor, size_t count,
                      void (*task)(void *argument, size_t index), void *argument) {
    settle(pool);
    pthread_mutex_lock(&pool->lock);
    bool nested = is_inside(pool);
    pthread_mutex_unlock(&pool->lock);
    if (nested) {
        for (size_t i = 0; i < count; i++) task(argument, i);
        return;
    }
    guest g = {.pool = pool, .task = task, .argument = argument};
    executor->run(executor->user, guest_task, &g, count);
}
