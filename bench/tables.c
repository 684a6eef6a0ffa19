// SPDX-License-Identifier: MIT
// What the terminal shows.
#include "bench.h"
#include <stdio.h>

// A number in `width` columns, or a dash where there is none (0, NAN, ∞).
static void cell(int width, int digits, double value) {
    if (value > 0 && isfinite(value))
        printf(" %*.*f", width, digits, value);
    else
        printf(" %*s", width, "-");
}

static double per_second(const built *b, uint32_t primitives) {
    return b->seconds > 0 ? primitives / b->seconds / 1e6 : 0;
}

static double per_primitive(const built *b, uint32_t primitives) {
    return b->seconds > 0 ? (b->structure_bytes + b->geometry_bytes) / primitives : 0;
}

void print_build(const build_result *builds, size_t count) {
    printf("\n  %-19s  %-26s  %-26s   SAH cost\n", "building", "    million a second",
           "  bytes each, all counted");
    printf("  %-19s  %8s %8s %8s  %8s %8s %8s   %8s\n", "", "Sagitta", "Embree", "ratio", "Sagitta", "Embree",
           "ratio", "Sagitta");
    for (size_t i = 0; i < count; i++) {
        const build_result *b = &builds[i];
        char what[32];
        snprintf(what, sizeof what, "%u thread%s, %s", b->threads, b->threads == 1 ? "" : "s", b->quality);
        printf("  %-19s ", what);
        double ours = per_second(&b->sagitta, b->primitives), theirs = per_second(&b->embree, b->primitives);
        cell(8, 2, ours);
        cell(8, 2, theirs);
        cell(8, 2, ours / theirs);
        ours = per_primitive(&b->sagitta, b->primitives);
        theirs = per_primitive(&b->embree, b->primitives);
        printf(" ");
        cell(8, 1, ours);
        cell(8, 1, theirs);
        cell(8, 2, ours / theirs);
        printf("  ");
        cell(8, 2, b->sagitta.sah);
        printf("\n");
    }
}

void print_set_heading(uint32_t threads, const char *isa, const char *quality) {
    printf("\n  tracing, %u thread%s, %s, %s quality\n", threads, threads == 1 ? "" : "s", isa, quality);
    printf("  %-22s  %-15s  %-33s  %-15s  %-17s  %s\n", "", "    Sagitta", "              Embree",
           " to Embree fast", "  batch to", "answers that differ");
    printf("  %-7s %6s %7s  %7s %7s  %7s %7s %7s %9s  %7s %7s  %7s %9s  %6s %9s %9s %6s\n", "rays", "count",
           "met", "single", "batch", "fast", "robust", "packet", "coherent", "single", "batch", "packet",
           "coherent", "all", "S. wrong", "E. wrong", "tie");
}

void print_set(const result *r) {
    char met[16];
    snprintf(met, sizeof met, "%.1f %%", 100 * (double)r->met / (double)(r->rays ? r->rays : 1));
    char rays[16];
    snprintf(rays, sizeof rays, "%.2f M", (double)r->rays / 1e6);
    printf("  %-7s %6s %7s", r->set, rays, met);
    printf(" ");
    cell(7, 2, r->mrays[SAGITTA_SINGLE]);
    cell(7, 2, r->mrays[SAGITTA_BATCH]);
    printf(" ");
    for (int i = EMBREE_FAST; i < EMBREE_COHERENT; i++) cell(7, 2, r->mrays[i]);
    cell(9, 2, r->mrays[EMBREE_COHERENT]);
    printf(" ");
    cell(7, 2, ratio_of(r, SAGITTA_SINGLE, EMBREE_FAST));
    cell(7, 2, ratio_of(r, SAGITTA_BATCH, EMBREE_FAST));
    printf(" ");
    cell(7, 2, ratio_of(r, SAGITTA_BATCH, EMBREE_PACKET));
    cell(9, 2, ratio_of(r, SAGITTA_BATCH, EMBREE_COHERENT));
    const settled *s = &r->settled;
    if (r->mrays[EMBREE_FAST] > 0) {
        printf("  %6zu %9zu %9zu %6zu", s->fast.disagree, s->sagitta_wrong, s->fast.wrong, s->fast.ties);
        if (s->unsearched > 0) printf("  (%zu settled without a search)", s->unsearched);
    }
    if (r->batch_differs > 0) printf("  BATCH DIFFERS FROM SINGLE ON %zu", r->batch_differs);
    printf("\n");
    fflush(stdout);
}

void print_set_means(const result *results, size_t count) {
    if (!(mean_ratio(results, count, SAGITTA_SINGLE, EMBREE_FAST) > 0)) return;
    printf("  %-22s  %15s  %33s ", "geometric mean", "", "");
    cell(7, 2, mean_ratio(results, count, SAGITTA_SINGLE, EMBREE_FAST));
    cell(7, 2, mean_ratio(results, count, SAGITTA_BATCH, EMBREE_FAST));
    printf(" ");
    cell(7, 2, mean_ratio(results, count, SAGITTA_BATCH, EMBREE_PACKET));
    cell(9, 2, mean_ratio(results, count, SAGITTA_BATCH, EMBREE_COHERENT));
    printf("\n");
}
