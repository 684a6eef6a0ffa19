// SPDX-License-Identifier: MIT
// Threads that share a loop, the clock, memory and random numbers.
#include "bench.h"
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

enum { MAX_THREADS = 1024 };

typedef struct crew {
    atomic_size_t next;
    size_t count, piece;
    void (*work)(void *argument, size_t first, size_t end);
    void *argument;
} crew;

static void *take_pieces(void *shared) {
    crew *c = shared;
    for (;;) {
        size_t first = atomic_fetch_add(&c->next, c->piece);
        if (first >= c->count) return NULL;
        c->work(c->argument, first, c->count - first < c->piece ? c->count : first + c->piece);
    }
}

// One thread runs the plain loop from end to end, as a program with one thread does.
double crew_run(uint32_t threads, size_t count, void (*work)(void *argument, size_t first, size_t end),
                void *argument) {
    double start = seconds_now();
    if (threads <= 1) {
        work(argument, 0, count);
        return seconds_now() - start;
    }
    size_t piece = count / (32 * (size_t)threads) + 1; // small enough for all to end together
    crew c = {.count = count, .piece = piece, .work = work, .argument = argument};
    pthread_t helpers[MAX_THREADS];
    uint32_t helping = 0;
    while (helping + 1 < threads && helping < MAX_THREADS &&
           pthread_create(&helpers[helping], NULL, take_pieces, &c) == 0)
        helping++;
    take_pieces(&c);
    for (uint32_t i = 0; i < helping; i++) pthread_join(helpers[i], NULL);
    return seconds_now() - start;
}

void *need(size_t bytes) {
    void *memory = aligned_alloc(64, (bytes / 64 + 1) * 64);
    if (memory == NULL) {
        fprintf(stderr, "bench-rays: %zu bytes of memory are not to be had\n", bytes);
        exit(1);
    }
    return memory;
}

// Steele, Lea & Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
uint64_t random_next(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

double random_unit(uint64_t *state) { return (double)(random_next(state) >> 11) * 0x1p-53; }
