// SPDX-License-Identifier: MIT
// Contexts: options, memory counts, threads, nesting, executors, the log.
#include "base/context.h"
#include "support/failing_allocator.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { COUNT = 10000 };

typedef struct tally {
    const sag_context *context;
    atomic_uint at[COUNT];
    atomic_uint nested, strangers;
} tally;

static void add_one(void *argument, size_t index) {
    tally *t = argument;
    atomic_fetch_add(&t->at[index], 1);
}

static void assert_each(const tally *t, unsigned times) {
    for (size_t i = 0; i < COUNT; i++) assert_int_equal(atomic_load(&t->at[i]), times);
}

static void defaults_work(void **state) {
    (void)state;
    sag_context *c = sag_context_create(NULL);
    assert_non_null(c);
    assert_true(sag_context_thread_count(c) >= 1);
    assert_string_not_equal(sag_context_isa(c), "unknown");
    sag_context_destroy(c);
    sag_context_destroy(NULL);
}

static void isa_is_checked(void **state) {
    (void)state;
    unsetenv("SAG_ISA");
    assert_null(sag_context_create(&(sag_context_options){.isa = "vax"}));
    sag_context *c = sag_context_create(&(sag_context_options){.isa = "portable"});
    assert_string_equal(sag_context_isa(c), "portable");
    sag_context_destroy(c);
    setenv("SAG_ISA", "pdp11", 1);
    assert_null(sag_context_create(NULL));
    setenv("SAG_ISA", "", 1);
    c = sag_context_create(NULL);
    assert_non_null(c);
    sag_context_destroy(c);
    setenv("SAG_ISA", "portable", 1);
    c = sag_context_create(NULL);
    assert_string_equal(sag_context_isa(c), "portable");
    sag_context_destroy(c);
    unsetenv("SAG_ISA");
    assert_true(sagi_cpu_has(SAGI_ISA_PORTABLE));
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        sagi_isa isa;
        bool usable = sagi_cpu_has((sagi_isa)i) && sagi_isa_is_built((sagi_isa)i);
        assert_int_equal(sagi_isa_choose(sagi_isa_name((sagi_isa)i), &isa), usable);
    }
}

#if defined(__x86_64__)
static void detection_agrees_with_the_compiler(void **state) {
    (void)state;
    __builtin_cpu_init();
    assert_int_equal(sagi_cpu_has(SAGI_ISA_SSE42), !!__builtin_cpu_supports("sse4.2"));
    assert_int_equal(sagi_cpu_has(SAGI_ISA_AVX2), !!__builtin_cpu_supports("avx2"));
    assert_int_equal(sagi_cpu_has(SAGI_ISA_AVX512),
                     __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq"));
}
#endif

static void memory_is_counted(void **state) {
    (void)state;
    sag_context *c = sag_context_create(NULL);
    size_t before, now, peak;
    sag_context_memory(c, &before, NULL);
    void *a = sag_allocate(c, 1000), *b = sag_allocate(c, 1);
    assert_non_null(a);
    assert_int_equal((uintptr_t)a % 64, 0);
    assert_int_equal((uintptr_t)b % 64, 0);
    sag_context_memory(c, &now, &peak);
    assert_int_equal(now, before + 1001);
    assert_int_equal(peak, before + 1001);
    sag_release(c, a, 1000);
    sag_release(c, b, 1);
    sag_release(c, NULL, 5);
    sag_context_memory(c, &now, &peak);
    assert_int_equal(now, before);
    assert_int_equal(peak, before + 1001);
    assert_null(sag_allocate(c, 0));
    assert_null(sag_allocate(c, SIZE_MAX));
    assert_null(sag_allocate(c, SIZE_MAX / 2));
    sag_context_memory(c, &now, NULL);
    assert_int_equal(now, before);
    sag_context_destroy(c);
}

static void a_failed_allocation_is_null(void **state) {
    (void)state;
    failing_allocator f = {.fail_at = 0};
    assert_null(sag_context_create(&(sag_context_options){.allocator = failing_allocator_make(&f)}));
    f = (failing_allocator){.fail_at = NEVER};
    sag_context_options options = {.allocator = failing_allocator_make(&f), .thread_count = 4};
    sag_context *c = sag_context_create(&options);
    tally *t = calloc(1, sizeof *t);
    sag_parallel_for(c, COUNT, add_one, t);
    assert_each(t, 1);
    free(t);
    sag_context_destroy(c);
    failing_allocator_assert_empty(&f);
    options.allocator.release = NULL; // half an allocator
    assert_null(sag_context_create(&options));
}

static void every_index_runs_once(void **state) {
    (void)state;
    for (uint32_t threads = 1; threads <= 9; threads += 4) {
        sag_context *c = sag_context_create(&(sag_context_options){.thread_count = threads});
        assert_int_equal(sag_context_thread_count(c), threads);
        tally *t = calloc(1, sizeof *t);
        sag_parallel_for(c, 0, add_one, NULL);
        for (int i = 0; i < 20; i++) sag_parallel_for(c, COUNT, add_one, t);
        assert_each(t, 20);
        sag_parallel_for(c, 1, add_one, t);
        assert_int_equal(atomic_load(&t->at[0]), 21);
        free(t);
        sag_context_destroy(c);
    }
}

typedef struct inner {
    tally *t;
    pthread_t outer;
} inner;

static void count_nested(void *argument, size_t index) {
    inner *in = argument;
    (void)index;
    atomic_fetch_add(&in->t->nested, 1);
    if (!pthread_equal(in->outer, pthread_self())) atomic_fetch_add(&in->t->strangers, 1);
}

static void nest(void *argument, size_t index) {
    (void)index;
    inner in = {argument, pthread_self()};
    sag_parallel_for(in.t->context, 50, count_nested, &in);
}

static void nested_calls_stay_on_their_thread(void **state) {
    (void)state;
    sag_context *c = sag_context_create(&(sag_context_options){.thread_count = 4});
    tally *t = calloc(1, sizeof *t);
    t->context = c;
    sag_parallel_for(c, 200, nest, t);
    assert_int_equal(atomic_load(&t->nested), 200 * 50);
    assert_int_equal(atomic_load(&t->strangers), 0);
    free(t);
    sag_context_destroy(c);
}

static void *many_calls(void *argument) {
    tally *t = argument;
    for (int i = 0; i < 20; i++) sag_parallel_for(t->context, COUNT, add_one, t);
    return NULL;
}

static void calls_from_several_threads_are_safe(void **state) {
    (void)state;
    sag_context *c = sag_context_create(&(sag_context_options){.thread_count = 3});
    pthread_t threads[4];
    tally *t = calloc(1, sizeof *t);
    t->context = c;
    for (int i = 0; i < 4; i++) assert_int_equal(pthread_create(&threads[i], NULL, many_calls, t), 0);
    for (int i = 0; i < 4; i++) pthread_join(threads[i], NULL);
    assert_each(t, 80);
    free(t);
    sag_context_destroy(c);
}

static void run_backwards(void *user, void (*task)(void *argument, size_t index), void *argument,
                          size_t count) {
    ++*(int *)user;
    for (size_t i = count; i-- > 0;) task(argument, i);
}

static void the_callers_executor_does_the_work(void **state) {
    (void)state;
    int calls = 0;
    sag_context_options options = {.executor = {.user = &calls, .thread_count = 7, .run = run_backwards}};
    sag_context *c = sag_context_create(&options);
    assert_int_equal(sag_context_thread_count(c), 7);
    tally *t = calloc(1, sizeof *t);
    t->context = c;
    sag_parallel_for(c, COUNT, add_one, t);
    assert_each(t, 1);
    sag_parallel_for(c, 10, nest, t);
    assert_int_equal(calls, 2); // the nested calls never came to it
    assert_int_equal(atomic_load(&t->nested), 500);
    free(t);
    sag_context_destroy(c);
}

typedef struct journal {
    const sag_context *context;
    atomic_int inside;
    int count, worst, depth;
    char last[1100];
} journal;

static void write_down(void *user, sag_log_level level, const char *message) {
    journal *j = user;
    int inside = atomic_fetch_add(&j->inside, 1) + 1;
    if (j->depth == 0 && inside > j->worst) j->worst = inside;
    j->count++;
    snprintf(j->last, sizeof j->last, "%d %s", (int)level, message);
    if (strcmp(message, "again") == 0) { // a callback may log
        j->depth++;
        sag_context_log(j->context, SAG_LOG_INFO, "deeper");
        j->depth--;
    }
    atomic_fetch_sub(&j->inside, 1);
}

static void log_once(void *argument, size_t index) {
    const journal *j = argument;
    sag_context_log(j->context, SAG_LOG_WARNING, "message %zu", index);
}

static void the_log_is_one_at_a_time(void **state) {
    (void)state;
    journal j = {0};
    sag_context *c =
        sag_context_create(&(sag_context_options){.thread_count = 4, .log = write_down, .log_user = &j});
    j.context = c;
    sag_parallel_for(c, 2000, log_once, &j);
    assert_int_equal(j.count, 2000);
    assert_int_equal(j.worst, 1);
    sag_context_log(c, SAG_LOG_ERROR, "%s", "again");
    assert_string_equal(j.last, "0 deeper");
    sag_context_log(c, SAG_LOG_ERROR, "%2000d", 1); // cut, not overrun
    assert_int_equal(strlen(j.last), 2 + 1023);
    sag_context_destroy(c);
    c = sag_context_create(NULL);
    sag_context_log(c, SAG_LOG_ERROR, "nobody listens");
    sag_context_destroy(c);
}

#ifndef __SANITIZE_THREAD__ // which does not let a child start threads
static void count_one(void *argument, size_t index) {
    (void)index;
    atomic_fetch_add((atomic_size_t *)argument, 1);
}

// The child waited for ever for threads that only its parent has (Python's multiprocessing forks like that).
static void a_forked_child_goes_on_and_ends(void **state) {
    (void)state;
    sag_context *context = sag_context_create(&(sag_context_options){.thread_count = 4});
    atomic_size_t count = 0;
    sag_parallel_for(context, 1000, count_one, &count);
    assert_int_equal(count, 1000);
    pid_t child = fork();
    if (child == 0) {
        alarm(20);
        sag_parallel_for(context, 1000, count_one, &count);
        sag_context_destroy(context);
        _exit(count == 2000 ? 0 : 1);
    }
    int status = -1;
    assert_true(child > 0 && waitpid(child, &status, 0) == child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    sag_context_destroy(context);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_work),
        cmocka_unit_test(isa_is_checked),
#if defined(__x86_64__)
        cmocka_unit_test(detection_agrees_with_the_compiler),
#endif
        cmocka_unit_test(memory_is_counted),
        cmocka_unit_test(a_failed_allocation_is_null),
        cmocka_unit_test(every_index_runs_once),
        cmocka_unit_test(nested_calls_stay_on_their_thread),
        cmocka_unit_test(calls_from_several_threads_are_safe),
        cmocka_unit_test(the_callers_executor_does_the_work),
#ifndef __SANITIZE_THREAD__
        cmocka_unit_test(a_forked_child_goes_on_and_ends),
#endif
        cmocka_unit_test(the_log_is_one_at_a_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
