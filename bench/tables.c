// SPDX-License-Identifier: MIT
// What the terminal shows.
#include "bench.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double ratio_of(const result *r, int contender, int base) {
    return r->mrays[contender] > 0 && r->mrays[base] > 0 ? r->mrays[contender] / r->mrays[base] : 0;
}

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

// The geometric mean of a ratio over those results that have it; 0: none has.
static double mean_ratio(const result *results, size_t count, uint32_t threads, int contender, int base) {
    double sum = 0;
    size_t used = 0;
    for (size_t i = 0; i < count; i++) {
        double ratio = ratio_of(&results[i], contender, base);
        if (!(ratio > 0) || (threads != 0 && results[i].threads != threads)) continue;
        sum += log(ratio);
        used++;
    }
    return used > 0 ? exp(sum / (double)used) : 0;
}

void print_set_means(const result *results, size_t count) {
    if (!(mean_ratio(results, count, 0, SAGITTA_SINGLE, EMBREE_FAST) > 0)) return;
    printf("  %-22s  %15s  %33s ", "geometric mean", "", "");
    cell(7, 2, mean_ratio(results, count, 0, SAGITTA_SINGLE, EMBREE_FAST));
    cell(7, 2, mean_ratio(results, count, 0, SAGITTA_BATCH, EMBREE_FAST));
    printf(" ");
    cell(7, 2, mean_ratio(results, count, 0, SAGITTA_BATCH, EMBREE_PACKET));
    cell(9, 2, mean_ratio(results, count, 0, SAGITTA_BATCH, EMBREE_COHERENT));
    printf("\n");
}

// The result of the same rays by one thread.
static const result *by_one_thread(const report *r, const result *of) {
    for (size_t i = 0; i < r->result_count; i++) {
        const result *other = &r->results[i];
        if (other->threads == 1 && strcmp(other->model, of->model) == 0 && strcmp(other->set, of->set) == 0 &&
            strcmp(other->isa, of->isa) == 0 && strcmp(other->quality, of->quality) == 0)
            return other;
    }
    return NULL;
}

static double mean_scaling(const report *r, uint32_t threads, int contender) {
    double sum = 0;
    size_t used = 0;
    for (size_t i = 0; i < r->result_count; i++) {
        const result *many = &r->results[i], *one = by_one_thread(r, many);
        if (many->threads != threads || one == NULL || !(many->mrays[contender] > 0)) continue;
        sum += log(many->mrays[contender] / one->mrays[contender]);
        used++;
    }
    return used > 0 ? exp(sum / (double)used) : 0;
}

static void print_lowest(const report *r) {
    const result *lowest = NULL;
    for (size_t i = 0; i < r->result_count; i++) {
        const result *now = &r->results[i];
        double ratio = ratio_of(now, SAGITTA_SINGLE, EMBREE_FAST);
        if (now->threads == 1 && ratio > 0 &&
            (lowest == NULL || ratio < ratio_of(lowest, SAGITTA_SINGLE, EMBREE_FAST)))
            lowest = now;
    }
    if (lowest != NULL)
        printf("  lowest of single rays: %.2f (%s, %s)\n", ratio_of(lowest, SAGITTA_SINGLE, EMBREE_FAST),
               lowest->model, lowest->set);
}

void print_summary(const report *r) {
    size_t rays = 0, disagree = 0, wrong = 0, differs = 0;
    uint32_t most = 0;
    for (size_t i = 0; i < r->result_count; i++) {
        rays += r->results[i].rays;
        disagree += r->results[i].settled.fast.disagree;
        wrong += r->results[i].settled.sagitta_wrong;
        differs += r->results[i].batch_differs;
        if (r->results[i].threads > most) most = r->results[i].threads;
    }
    if (r->result_count == 0) return;
    printf("\nall models, all sets, one thread\n");
    if (peer_name() != NULL) {
        printf("  to Embree fast, geometric mean: single %.2f, batch %.2f; batch to its packets %.2f, to "
               "coherent ones %.2f\n",
               mean_ratio(r->results, r->result_count, 1, SAGITTA_SINGLE, EMBREE_FAST),
               mean_ratio(r->results, r->result_count, 1, SAGITTA_BATCH, EMBREE_FAST),
               mean_ratio(r->results, r->result_count, 1, SAGITTA_BATCH, EMBREE_PACKET),
               mean_ratio(r->results, r->result_count, 1, SAGITTA_BATCH, EMBREE_COHERENT));
        print_lowest(r);
        printf("  answers: Sagitta and Embree (fast) differ on %zu of %zu rays; Sagitta wrong on %zu\n",
               disagree, rays, wrong);
    }
    if (differs > 0) printf("  batch and single call DIFFER on %zu rays\n", differs);
    if (most > 1)
        printf("  %u threads to one: Sagitta single %.2f, batch %.2f; Embree fast %.2f\n", most,
               mean_scaling(r, most, SAGITTA_SINGLE), mean_scaling(r, most, SAGITTA_BATCH),
               mean_scaling(r, most, EMBREE_FAST));
}
