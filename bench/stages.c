// SPDX-License-Identifier: MIT
// How often each stage of a ray's way runs: a set of rays through a kernel that counts, in place of the
// scene's own. Nothing is timed.
#include "bench.h"
#include "counting.h"
#include "scene/scene.h"
#include <stdio.h>
#include <string.h>

static void print(const char *what, size_t count, const ray_set *set) {
    printf("  %s %.3f", what, (double)count / (double)(set->count > 0 ? set->count : 1));
}

void print_stages(const subject *s, const ray_set *set, subject_run *run) {
    const sagi_kernel *own = s->scene->kernel;
    s->scene->kernel = &bench_counting_kernel;
    memset(&bench_counts, 0, sizeof bench_counts);
    subject_single(run);
    printf("  %-8s", set->name);
    print("nodes", bench_counts.nodes, set);
    print("blocks", bench_counts.blocks, set);
    print("uncertain", bench_counts.uncertain, set);
    print("exact decisions", bench_counts.exact_tests, set);
    print("solved", bench_counts.solved, set);
    if (set->packets) {
        memset(&bench_counts, 0, sizeof bench_counts);
        subject_batch(run);
        print("packet nodes", bench_counts.packet_nodes, set);
        print("packet blocks", bench_counts.packet_blocks, set);
    }
    printf("\n");
    s->scene->kernel = own;
}
