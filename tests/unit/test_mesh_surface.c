// SPDX-License-Identifier: MIT
// Surfaces of triangles: every instruction set's kernel gives the bits of sag_mesh_surface, and these are
// what the formulas say, also where texture coordinates or normals are of no use.
#define _DEFAULT_SOURCE // MAP_ANONYMOUS
#include "kernel/kernel.h"
#include "support/random.h"

#include <sagitta/shapes.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

enum { VERTICES = 30, TRIANGLES = 60 };

typedef struct subject {
    float positions[3 * VERTICES], normals[3 * VERTICES], texcoords[2 * VERTICES];
    double fine[3 * VERTICES];
    uint32_t triangles[3 * TRIANGLES];
} subject;

static void fill(subject *s, rng *r) {
    for (int k = 0; k < 3 * VERTICES; k++) {
        s->positions[k] = (float)(s->fine[k] = rng_uniform(r, -2, 2));
        s->normals[k] = rng_one_in(r, 20) ? 0 : (float)rng_uniform(r, -1, 1);
    }
    for (int v = 0; v < VERTICES; v++) {
        float *n = &s->normals[3 * v];
        const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (length > 0 && !rng_one_in(r, 4))
            for (int k = 0; k < 3; k++) n[k] /= length;
    }
    // Many are equal: then there are no derivatives.
    for (int k = 0; k < 2 * VERTICES; k++) s->texcoords[k] = (float)rng_below(r, 3);
    for (int t = 0; t < TRIANGLES; t++)
        for (uint32_t k = 0; k < 3; k++)
            s->triangles[3 * t + (int)k] = (rng_below(r, VERTICES / 3) * 3 + k) % VERTICES;
}

static bool same(sag_vec3 a, sag_vec3 b) { return memcmp(&a, &b, sizeof a) == 0; }

static void assert_same(const sag_surface *a, const sag_surface *b) {
    assert_true(same(a->position, b->position) && same(a->position_error, b->position_error));
    assert_true(same(a->geometric_normal, b->geometric_normal) && same(a->shading_normal, b->shading_normal));
    assert_true(same(a->dpdu, b->dpdu) && same(a->dpdv, b->dpdv));
    assert_true(a->u == b->u && a->v == b->v && a->side == b->side && a->primitive == b->primitive);
    assert_true(a->geometry == b->geometry && a->user_data == b->user_data);
}

// Unit normals on the side of the ray, a frame, and the position within its error of the weighted vertices.
static void assert_sound(const sag_mesh *m, const subject *s, const sag_ray *ray, const sag_hit *hit,
                         const sag_surface *at) {
    const double weight[3] = {1 - hit->u - hit->v, hit->u, hit->v};
    double p[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            const size_t place = 3 * (size_t)s->triangles[3 * hit->primitive + (uint32_t)k] + (size_t)i;
            p[i] += weight[k] * (m->positions_f64 ? s->fine[place] : (double)s->positions[place]);
        }
    assert_true(fabs(p[0] - at->position.x) <= at->position_error.x + 1e-14);
    assert_true(fabs(p[1] - at->position.y) <= at->position_error.y + 1e-14);
    assert_true(fabs(p[2] - at->position.z) <= at->position_error.z + 1e-14);
    assert_true(fabs(sag_length(at->geometric_normal) - 1) < 1e-15);
    assert_true(fabs(sag_length(at->shading_normal) - 1) < 1e-15);
    assert_true((at->side == SAG_SIDE_BACK) == (sag_dot(ray->direction, at->geometric_normal) > 0));
    const sag_vec3 across = sag_cross(at->dpdu, at->dpdv);
    assert_true(sag_dot(across, across) > 0 && sag_is_finite(across));
    assert_true(fabs(sag_dot(sag_normalize(across), at->geometric_normal)) > 1 - 1e-9);
}

static void kernels_agree(void **state) {
    (void)state;
    static const sagi_isa all[] = {SAGI_ISA_PORTABLE, SAGI_ISA_SSE42, SAGI_ISA_AVX2, SAGI_ISA_AVX512,
                                   SAGI_ISA_NEON};
    rng r = rng_make(77);
    int checked = 0;
    for (int round = 0; round < 200; round++) {
        static subject s;
        fill(&s, &r);
        sag_mesh m = {.triangles = s.triangles, .triangle_count = TRIANGLES, .vertex_count = VERTICES};
        if (round & 1)
            m.positions_f64 = s.fine;
        else
            m.positions_f32 = s.positions;
        if (round & 2) m.normals_f32 = s.normals;
        if (round & 4) m.texcoords_f32 = s.texcoords;
        for (uint32_t i = 0; i < TRIANGLES; i++) {
            const uint32_t *corner = &s.triangles[3 * i];
            if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
            const double u = rng_unit(&r), v = rng_unit(&r) * (1 - u);
            const sag_hit hit = {.t = 1, .u = u, .v = v, .primitive = i};
            const sag_ray ray = {.direction = {rng_uniform(&r, -1, 1), rng_uniform(&r, -1, 1), 1}};
            sag_surface expected = {0};
            sag_mesh_surface(&m, &ray, &hit, &expected);
            assert_sound(&m, &s, &ray, &hit, &expected);
            for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
                if (!sagi_isa_is_built(all[k]) || !sagi_cpu_has(all[k])) continue;
                sag_surface found;
                sagi_kernel_pick(all[k])->mesh_surface(&m, &ray, &hit, &found);
                assert_same(&found, &expected);
                checked++;
            }
        }
    }
    assert_true(checked > 5000);
}

// A copy that ends where memory ends: to read beyond it is a crash. Never given back.
static void *at_the_end(const void *bytes, size_t size) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    uint8_t *pages = mmap(NULL, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_true(pages != MAP_FAILED && size <= page);
    assert_int_equal(mprotect(pages + page, page, PROT_NONE), 0);
    return memcpy(pages + page - size, bytes, size);
}

// Regression: a user's vertices were fetched with the number after them.
static void nothing_is_read_beyond_the_last_vertex(void **state) {
    (void)state;
    const float p[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, n[9] = {0, 0, 1, 0, 0, 1, 0, 0, 1},
                uv[6] = {0, 0, 1, 0, 0, 1};
    const double fine[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t corners[3] = {0, 1, 2};
    sag_mesh m = {.triangles = at_the_end(corners, sizeof corners),
                  .normals_f32 = at_the_end(n, sizeof n),
                  .texcoords_f32 = at_the_end(uv, sizeof uv),
                  .vertex_count = 3,
                  .triangle_count = 1};
    const sag_ray ray = {.origin = {0.25, 0.25, 1}, .direction = {0, 0, -1}, .t_max = INFINITY};
    for (int doubles = 0; doubles < 2; doubles++) {
        m.positions_f32 = doubles ? NULL : at_the_end(p, sizeof p);
        m.positions_f64 = doubles ? at_the_end(fine, sizeof fine) : NULL;
        sag_hit hit;
        sag_surface surface;
        assert_true(sag_mesh_hit(&m, &ray, &hit));
        sag_mesh_surface(&m, &ray, &hit, &surface);
        assert_true(surface.position.x == 0.25 && surface.position.y == 0.25 && surface.position.z == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_agree),
                                       cmocka_unit_test(nothing_is_read_beyond_the_last_vertex)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
