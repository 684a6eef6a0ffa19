// SPDX-License-Identifier: MIT
// What all of it comes to: geometric means over the sets of all meshes, and of all models of spheres, for
// each instruction set and quality that was asked for.
#include "bench.h"
#include <stdio.h>
#include <string.h>

double ratio_of(const result *r, int contender, int base) {
    return r->mrays[contender] > 0 && r->mrays[base] > 0 ? r->mrays[contender] / r->mrays[base] : 0;
}

// Of numbers that are not 0 (which says "not measured"); 0 when there are none.
typedef struct mean {
    double sum;
    size_t count;
} mean;

static void mean_add(mean *m, double value) {
    if (!(value > 0)) return;
    m->sum += log(value);
    m->count++;
}

static double mean_of(const mean *m) { return m->count > 0 ? exp(m->sum / (double)m->count) : 0; }

double mean_ratio(const result *results, size_t count, int contender, int base) {
    mean m = {0};
    for (size_t i = 0; i < count; i++) mean_add(&m, ratio_of(&results[i], contender, base));
    return mean_of(&m);
}

static bool same_variant(const result *a, const result *b) {
    return strcmp(a->isa, b->isa) == 0 && strcmp(a->quality, b->quality) == 0;
}

static bool same_rays(const result *a, const result *b) {
    return strcmp(a->model, b->model) == 0 && strcmp(a->set, b->set) == 0;
}

// The result of the same rays by so many threads of this variant.
static const result *find(const report *r, const result *rays, const result *variant, uint32_t threads) {
    for (size_t i = 0; i < r->result_count; i++) {
        const result *other = &r->results[i];
        if (other->threads == threads && same_rays(other, rays) && same_variant(other, variant)) return other;
    }
    return NULL;
}

static double speed_to(const result *r, const result *other, int contender) {
    return other != NULL && other->mrays[contender] > 0 ? r->mrays[contender] / other->mrays[contender] : 0;
}

static void print_line(const char *what, const char *unit, double value) {
    if (value > 0) printf(", %s %.2f%s", what, value, unit);
}

// One variant on meshes or on spheres; `first` is the variant it is compared with, itself when it is that.
static void print_variant(const report *r, const result *variant, const result *first, uint32_t most) {
    mean to_fast[2] = {{0}}, to_packet = {0}, to_coherent = {0}, to_first[2] = {{0}}, scaling[3] = {{0}};
    const result *lowest = NULL;
    for (size_t i = 0; i < r->result_count; i++) {
        const result *now = &r->results[i];
        if (now->spheres != variant->spheres || !same_variant(now, variant)) continue;
        if (now->threads > 1) {
            const result *one = find(r, now, now, 1);
            for (int k = SAGITTA_SINGLE; now->threads == most && k <= EMBREE_FAST; k++)
                mean_add(&scaling[k], speed_to(now, one, k));
            continue;
        }
        for (int k = SAGITTA_SINGLE; k <= SAGITTA_BATCH; k++) {
            mean_add(&to_fast[k], ratio_of(now, k, EMBREE_FAST));
            mean_add(&to_first[k], speed_to(now, find(r, now, first, 1), k));
        }
        mean_add(&to_packet, ratio_of(now, SAGITTA_BATCH, EMBREE_PACKET));
        mean_add(&to_coherent, ratio_of(now, SAGITTA_BATCH, EMBREE_COHERENT));
        double ratio = ratio_of(now, SAGITTA_SINGLE, EMBREE_FAST);
        if (ratio > 0 && (lowest == NULL || ratio < ratio_of(lowest, SAGITTA_SINGLE, EMBREE_FAST)))
            lowest = now;
    }
    printf("  %s, %s, %s quality\n", variant->spheres ? "spheres" : "meshes", variant->isa, variant->quality);
    if (lowest != NULL) {
        printf("    to Embree fast: single %.2f (lowest %.2f: %s, %s), batch %.2f", mean_of(&to_fast[0]),
               ratio_of(lowest, SAGITTA_SINGLE, EMBREE_FAST), lowest->model, lowest->set,
               mean_of(&to_fast[1]));
        print_line("camera batches to its packets", "", mean_of(&to_packet));
        print_line("to coherent ones", "", mean_of(&to_coherent));
        printf("\n");
    }
    if (variant != first && to_first[0].count > 0)
        printf("    to %s, %s quality: single %.2f, batch %.2f\n", first->isa, first->quality,
               mean_of(&to_first[0]), mean_of(&to_first[1]));
    if (scaling[0].count > 0) {
        printf("    %u threads to one: single %.2f, batch %.2f", most, mean_of(&scaling[0]),
               mean_of(&scaling[1]));
        print_line("Embree", "", mean_of(&scaling[2]));
        printf("\n");
    }
}

static void print_answers(const report *r) {
    size_t rays = 0, disagree = 0, wrong = 0, theirs = 0, differs = 0;
    for (size_t i = 0; i < r->result_count; i++) {
        const settled *s = &r->results[i].settled;
        rays += r->results[i].rays;
        disagree += s->fast.disagree;
        wrong += s->sagitta_wrong;
        theirs += s->fast.wrong;
        differs += r->results[i].batch_differs;
    }
    if (peer_name() != NULL)
        printf("  answers: of %zu rays Sagitta and Embree fast differ on %zu; Sagitta is wrong on %zu, "
               "Embree on %zu\n",
               rays, disagree, wrong, theirs);
    printf("  answers of batch and single call that differ: %zu\n", differs);
}

void print_summary(const report *r) {
    if (r->result_count == 0) return;
    uint32_t most = 0;
    for (size_t i = 0; i < r->result_count; i++)
        if (r->results[i].threads > most) most = r->results[i].threads;
    printf("\nall together: one thread, geometric means over the sets of all models\n");
    for (int spheres = 0; spheres < 2; spheres++) {
        const result *first = NULL;
        for (size_t i = 0; i < r->result_count; i++) {
            const result *now = &r->results[i];
            if (now->spheres != (spheres == 1)) continue;
            if (first == NULL) first = now;
            bool shown = false;
            for (size_t k = 0; k < i; k++)
                shown |= r->results[k].spheres == now->spheres && same_variant(&r->results[k], now);
            if (!shown) print_variant(r, now, first, most);
        }
    }
    print_answers(r);
}
