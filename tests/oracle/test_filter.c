// SPDX-License-Identifier: MIT
// The proof that the kernel's float filters only save work: millions of rays at blocks of triangles made to
// break them (support/filter_adversary.h), through committed scenes and by every question, against exact
// whole numbers (support/exact_block.h). Each ray and each triangle of its scene is one decision, whether the
// filter took it, the tree's boxes or the exact test. Not one may be wrong: not which triangles are met, not
// which of them lie within [t_min, t_max], not which comes first; and t is within 4 ulp of the true one.
#include "support/context.h"
#include "support/exact_triangle.h"
#include "support/filter_adversary.h"
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { LINES = 96, BUNDLE = 16, SCENES = 1300 }; // LINES is a number of bundles

typedef struct tally {
    size_t rays, decisions, hits, wrong;
} tally;

typedef struct expected {
    size_t count;
    sag_hit hit[EXACT_BLOCK_MAX];
} expected;

static sag_scene *scene_from(const exact_block *b, bool one_sided, sag_quality quality) {
    double p[9 * EXACT_BLOCK_MAX];
    uint32_t t[3 * EXACT_BLOCK_MAX];
    for (uint32_t i = 0; i < 3 * b->count; i++) {
        const sag_vec3 *v = &b->at[i / 3][i % 3];
        p[3 * i] = v->x, p[3 * i + 1] = v->y, p[3 * i + 2] = v->z, t[i] = i;
    }
    sag_mesh mesh = {.positions_f64 = p,
                     .vertex_count = 3 * b->count,
                     .triangles = t,
                     .triangle_count = b->count,
                     .one_sided = one_sided};
    sag_scene *scene = sag_scene_create(context);
    sag_add_mesh(scene, &mesh);
    sag_scene_set_quality(scene, quality);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    return scene;
}

static void report(const char *what, const exact_block *b, const exact_line *l, uint32_t i) {
    printf("WRONG: %s, triangle %u of %u%s\n", what, i, b->count, l->lattice && b->lattice ? " (whole)" : "");
    const sag_vec3 *v[5] = {&l->ray.origin, &l->ray.direction, &b->at[i][0], &b->at[i][1], &b->at[i][2]};
    for (int k = 0; k < 5; k++) printf("  {%a, %a, %a},\n", v[k]->x, v[k]->y, v[k]->z);
    printf("  t_min %a, t_max %a\n", l->ray.t_min, l->ray.t_max);
}

// What the exact numbers say. t, u and v are those of the triangle alone, once the exact numbers have agreed
// that it is met and where.
static bool truth(const exact_block *b, const exact_line *l, bool one_sided, expected *out) {
    out->count = 0;
    for (uint32_t i = 0; i < b->count; i++) {
        int side = exact_block_side(l, i);
        if (side == 0) continue;
        sag_triangle triangle = {b->at[i][0], b->at[i][1], b->at[i][2], false};
        sag_ray line = l->ray;
        line.t_min = -INFINITY, line.t_max = INFINITY;
        sag_hit hit;
        if (!sag_triangle_hit(&triangle, &line, &hit)) {
            if (!exact_block_time_is_huge()) return report("a triangle that is met", b, l, i), false;
            continue;
        }
        if (fabs(hit.t) > 0x1p-960 && !exact_block_time(hit.t)) return report("its t", b, l, i), false;
        if ((one_sided && side > 0) || !(hit.t >= l->ray.t_min && hit.t <= l->ray.t_max)) continue;
        size_t place = out->count++;
        hit.primitive = i;
        for (; place > 0 && out->hit[place - 1].t > hit.t; place--) out->hit[place] = out->hit[place - 1];
        out->hit[place] = hit;
    }
    return true;
}

static bool same(const sag_hit *a, const sag_hit *b) {
    return a->primitive == b->primitive && memcmp(&a->t, &b->t, sizeof a->t) == 0 &&
           memcmp(&a->u, &b->u, sizeof a->u) == 0 && memcmp(&a->v, &b->v, sizeof a->v) == 0;
}

// NULL, or which question was answered wrongly; *i is a triangle that it is about.
static const char *ask(const sag_scene *scene, const sag_ray *ray, const expected *e, uint32_t *i) {
    sag_hit hits[EXACT_BLOCK_MAX], first;
    *i = e->count > 0 ? e->hit[0].primitive : 0;
    size_t count = sag_intersect_all(scene, ray, hits, EXACT_BLOCK_MAX);
    for (size_t k = 0; k < count && k < e->count; k++)
        if (!same(&hits[k], &e->hit[k])) {
            *i = hits[k].t < e->hit[k].t ? hits[k].primitive : e->hit[k].primitive;
            return "sag_intersect_all";
        }
    if (count != e->count) {
        *i = count > e->count ? hits[e->count].primitive : e->hit[count].primitive;
        return "how many sag_intersect_all has";
    }
    if (sag_count_crossings(scene, ray) != count) return "sag_count_crossings";
    if (sag_occluded(scene, ray) != (count > 0)) return "sag_occluded";
    if (sag_intersect(scene, ray, &first) != (count > 0)) return "sag_intersect";
    return count > 0 && !same(&first, &e->hit[0]) ? "the hit of sag_intersect" : NULL;
}

static void check_batch(const sag_scene *scene, const exact_block *b, const exact_line *lines,
                        const expected *truths, tally *t) {
    sag_ray rays[LINES];
    sag_hit hits[LINES];
    bool dark[LINES];
    for (int i = 0; i < LINES; i++) rays[i] = lines[i].ray;
    sag_intersect_batch(scene, rays, hits, LINES);
    sag_occluded_batch(scene, rays, dark, LINES);
    for (int i = 0; i < LINES; i++) {
        const expected *e = &truths[i];
        bool right = e->count > 0 ? same(&hits[i], &e->hit[0]) : hits[i].geometry == SAG_INVALID_ID;
        if (right && dark[i] == (e->count > 0)) continue;
        if (t->wrong++ < 3) report("a batch", b, &lines[i], e->count > 0 ? e->hit[0].primitive : 0);
    }
}

static void examine(rng *r, int kind, tally *t) {
    static exact_block block;
    static exact_line lines[LINES];
    static expected truths[LINES];
    adversary_block(r, kind, &block);
    if (rng_one_in(r, 6)) adversary_disturb(r, &block);
    bool one_sided = rng_one_in(r, 5);
    sag_scene *scene = scene_from(&block, one_sided, (sag_quality)rng_below(r, 3));
    exact_block_use(&block);
    for (int i = 0; i < LINES; i++) {
        do adversary_line(r, &block, &lines[i]);
        while (!sag_ray_is_valid(&lines[i].ray));
        t->rays++, t->decisions += block.count;
        if (!truth(&block, &lines[i], one_sided, &truths[i])) {
            t->wrong++;
            continue;
        }
        t->hits += truths[i].count;
        uint32_t about;
        const char *wrong = ask(scene, &lines[i].ray, &truths[i], &about);
        if (wrong && t->wrong++ < 3) report(wrong, &block, &lines[i], about);
    }
    check_batch(scene, &block, lines, truths, t);
    for (int i = 0; i < LINES; i++) {
        if (i % BUNDLE == 0) adversary_bundle(r, &block, &lines[i], BUNDLE);
        t->rays++, t->decisions += block.count;
        if (!truth(&block, &lines[i], one_sided, &truths[i])) t->wrong++;
    }
    check_batch(scene, &block, lines, truths, t);
    sag_scene_destroy(scene);
}

static void filters_only_save_work(void **state) {
    (void)state;
    tally all = {0};
    for (int kind = 0; kind < ADVERSARY_KINDS; kind++) {
        rng r = rng_make(100 + (uint64_t)kind);
        tally t = {0};
        for (size_t i = 0, n = soak(SCENES); i < n; i++) examine(&r, kind, &t);
        printf("%-10s %8zu rays, %9zu decisions, %8zu hits, %zu wrong\n", adversary_names[kind], t.rays,
               t.decisions, t.hits, t.wrong);
        all.rays += t.rays, all.decisions += t.decisions, all.wrong += t.wrong;
    }
    printf("%s: %zu rays, %zu decisions, %zu wrong\n", sag_context_isa(context), all.rays, all.decisions,
           all.wrong);
    assert_int_equal(all.wrong, 0);
}

// The oracle itself against the other one, which moves the origin where there is a tie.
static void oracles_agree(void **state) {
    (void)state;
    rng r = rng_make(99);
    size_t ties = 0;
    for (size_t i = 0, n = soak(600); i < n; i++) {
        static exact_block block, copy;
        exact_line line, doubles;
        adversary_block(&r, (int)(i % ADVERSARY_KINDS), &block);
        for (int k = 0; k < 10; k++) {
            do adversary_line(&r, &block, &line);
            while (!sag_ray_is_valid(&line.ray));
            uint32_t j = rng_below(&r, block.count);
            exact_triangle e =
                exact_triangle_examine(&line.ray, block.at[j][0], block.at[j][1], block.at[j][2], 1);
            exact_block_use(&block);
            assert_int_equal(exact_block_side(&line, j), e.side);
            copy = block, doubles = line;
            copy.lattice = doubles.lattice = false;
            exact_block_use(&copy);
            assert_int_equal(exact_block_side(&doubles, j), e.side);
            ties += e.tie;
        }
    }
    assert_true(ties > soak(600));
    exact_triangle_end();
}

static int end(void **state) {
    exact_block_end();
    return teardown(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(oracles_agree),
        cmocka_unit_test(filters_only_save_work),
    };
    return cmocka_run_group_tests(tests, setup, end);
}
