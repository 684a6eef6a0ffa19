// SPDX-License-Identifier: MIT
// Shining shapes of every kind, in instances of instances: what light sampling says of the light that arrives
// is what rays in all directions find, whichever way lights are chosen; and the density of a sample is the
// density that its ray's hit is said to have.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/light.h"
#include "support/mean.h"
#include "support/picture.h"
#include "support/random_shape.h"

#define PI 3.14159265358979323846

static sag_affine random_map(rng *r, bool similarity) {
    const sag_affine turn = sag_affine_rotate(rng_uniform(r, 0, 6), rng_direction(r));
    const double size = rng_uniform(r, 0.6, 1.5);
    sag_vec3 factors = {size, size, size};
    if (!similarity) factors.y *= rng_uniform(r, 0.5, 1.8), factors.z *= rng_uniform(r, 0.5, 1.8);
    if (rng_one_in(r, 3)) factors.x = -factors.x;
    const sag_affine scale = sag_affine_scale(factors), shift = sag_affine_translate(rng_vec3(r, 0.5));
    const sag_affine both = sag_affine_multiply(&turn, &scale);
    return sag_affine_multiply(&shift, &both);
}

static const float corners[] = {-1, 0, -1, -1, 0.3F, 1, 1, 0, 1, 1, 0.2F, -1};
static const float normals[] = {0, 1, 0, 0.2F, 1, 0, 0, 1, 0.3F, 0, 1, 0};
static const uint32_t faces[] = {0, 1, 2, 0, 2, 3};
// Kinds of which a whole is bounded; then meshes with normals, flat patches.
static const sag_shape_kind kinds[] = {SAG_SHAPE_DISK,    SAG_SHAPE_RECTANGLE,    SAG_SHAPE_POLYGON,
                                       SAG_SHAPE_SPHERE,  SAG_SHAPE_ELLIPSOID,    SAG_SHAPE_CYLINDER,
                                       SAG_SHAPE_CONE,    SAG_SHAPE_PARABOLOID,   SAG_SHAPE_HYPERBOLOID,
                                       SAG_SHAPE_BOX,     SAG_SHAPE_ORIENTED_BOX, SAG_SHAPE_POLYHEDRON,
                                       SAG_SHAPE_CAPSULE, SAG_SHAPE_TRIANGLE,     SAG_SHAPE_BILINEAR_PATCH,
                                       SAG_SHAPE_TORUS,   SAG_SHAPE_SPHERES,      SAG_SHAPE_MESH};
enum { KINDS = sizeof kinds / sizeof *kinds, SHAPES = KINDS + 2 };

static uint32_t add_shape(sag_scene *scene, rng *r, int which) {
    if (which == KINDS)
        return sag_add_mesh(scene, &(sag_mesh){.positions_f32 = corners,
                                               .vertex_count = 4,
                                               .triangles = faces,
                                               .triangle_count = 2,
                                               .normals_f32 = normals});
    if (which == KINDS + 1)
        return sag_add_bilinear_patch(scene,
                                      &(sag_bilinear_patch){{0, 0, 0}, {1, 0.1, 0}, {0, 0, 1}, {1, 0.1, 1}});
    random_shape shape;
    random_shape_make(r, kinds[which], 1, &shape);
    return sag_add_shape(scene, kinds[which], &shape.as);
}

typedef struct scenery {
    studio s;
    sag_error error;
    sagi_lights lights;
} scenery;

// A world of one shining shape, under `depth` instances, shown twice when there are any.
// `painted`: the light's colour is a texture, and the shape's corners have coordinates of their own.
static void make_scenery(scenery *w, rng *r, int which, int depth, sag_light_sampler sampler, bool both,
                         bool painted) {
    w->s = studio_open(1);
    sag_scene *scene = depth > 0 ? sag_world_add_object(w->s.world) : w->s.scene;
    const uint32_t id = add_shape(scene, r, which);
    assert_int_not_equal(id, SAG_INVALID_ID);
    const sag_affine own = random_map(r, rng_one_in(r, 2));
    sag_geometry_set_transform(scene, id, &own);
    sag_appearance look = {.emission = {2, 2, 2}, .two_sided = both, .flip = rng_one_in(r, 2)};
    if (painted) {
        const sag_texture texture = {.kind = SAG_TEXTURE_BILERP,
                                     .mapping = {.u_scale = 1, .v_scale = 1},
                                     .b = {.value = {0.2, 0.2, 0.2}},
                                     .c = {.value = {1, 1, 1}},
                                     .d = {.value = {0.6, 0.6, 0.6}}};
        static const float uv[4][2] = {{0.5F, 0}, {1, 0.2F}, {0, 0.6F}, {0.4F, 1}};
        look.emission_texture = sag_world_add_texture(w->s.world, &texture);
        assert_int_not_equal(look.emission_texture, 0);
        look.square_uv = true;
        look.has_uv = which == KINDS + 1 || (which < KINDS && kinds[which] == SAG_SHAPE_BILINEAR_PATCH);
        memcpy(look.uv, uv, sizeof uv);
    }
    assert_int_equal(sag_world_set_appearance(w->s.world, scene, id, &look), SAG_OK);
    for (int i = 0; i < depth; i++) {
        assert_int_equal(sag_scene_commit(scene, &w->error), SAG_OK);
        sag_scene *outer = i + 1 < depth ? sag_world_add_object(w->s.world) : w->s.scene;
        for (int k = 0; k < 2; k++) {
            sag_affine map = random_map(r, rng_one_in(r, 2));
            map.m[0][3] += k ? 2 : -2;
            assert_int_not_equal(sag_add_instance(outer, scene, &map), SAG_INVALID_ID);
        }
        scene = outer;
    }
    // Beside a light that is far, which is chosen as often as all others together.
    if (rng_one_in(r, 2))
        sag_world_add_light(w->s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
    w->s.settings->light_sampler = sampler;
    assert_int_equal(sag_scene_commit(w->s.scene, &w->error), SAG_OK);
    assert_int_equal(sagi_lights_init(&w->lights, w->s.world, &w->error), SAG_OK);
}

// What the receiver makes of light from a direction.
static double receive(const sagi_shading_point *from, sag_vec3 wi) {
    const double cosine = sag_dot(from->normal, wi);
    return from->reflects_only ? fmax(0, cosine) : fabs(cosine);
}

static const sagi_spectrum green = {540, 540, 540, 540};
static double radiance_in(const sagi_light_sample *sample) { return sample->radiance[0]; }
static double radiance_of(const sagi_appearance *look, const sag_surface *at, sag_vec3 wo) {
    return sagi_emission(look, at, wo, green)[0];
}

static void check(const scenery *w, rng *r, const sagi_shading_point *from, int which, int depth) {
    enum { SAMPLES = 1200, RAYS = 4000 };
    const sag_scene *scene = w->s.scene;
    mean sampled = {0}, found = {0};
    int compared = 0, differing = 0;
    for (int i = 0; i < SAMPLES; i++) {
        sagi_light_sample sample;
        double x = 0;
        if (sagi_lights_sample(&w->lights, from, green, rng_unit(r), rng_vec2(r), &sample) &&
            sample.target == SAGI_TARGET_SURFACE) {
            assert_true(sample.pdf > 0 && fabs(sag_dot(sample.wi, sample.wi) - 1) < 1e-9);
            sag_ray ray = sag_ray_make(from->position, sample.wi);
            sag_hit hit;
            sag_surface at;
            if (sag_intersect(scene, &ray, &hit)) {
                sag_surface_at(scene, &ray, &hit, &at);
                const double distance = sag_length(sag_sub(sample.surface.position, from->position));
                if (fabs(hit.t / distance - 1) < 1e-6) { // nothing before it
                    x = radiance_in(&sample) * receive(from, sample.wi) / sample.pdf;
                    const double pdf = sagi_lights_area_pdf(&w->lights, from, sample.wi, &hit, &at);
                    const sagi_appearance *look = sagi_appearance_of(w->s.world, &at);
                    sagi_replace_texcoords(look, &at);
                    sagi_orient(look, &at);
                    const double seen = radiance_of(look, &at, sag_neg(sample.wi));
                    compared++;
                    // (At rims the cosine is sensitive, at seams the texture.)
                    differing += !(fabs(pdf / sample.pdf - 1) < 1e-3 &&
                                   fabs(seen - radiance_in(&sample)) < 1e-3 * radiance_in(&sample) + 1e-6);
                }
            }
        }
        mean_add(&sampled, x);
    }
    double nearest = INFINITY;
    for (int i = 0; i < RAYS; i++) {
        const sag_vec3 wi = rng_direction(r);
        const sag_ray ray = sag_ray_make(from->position, wi);
        sag_hit hit;
        double x = 0;
        if (sag_intersect(scene, &ray, &hit)) {
            sag_surface at;
            sag_surface_at(scene, &ray, &hit, &at);
            nearest = fmin(nearest, hit.t);
            const sagi_appearance *look = sagi_appearance_of(w->s.world, &at);
            sagi_replace_texcoords(look, &at);
            sagi_orient(look, &at);
            x = radiance_of(look, &at, sag_neg(wi)) * receive(from, wi) * 4 * PI;
            // What rays find can be sampled.
            if (x > 0) assert_true(sagi_lights_area_pdf(&w->lights, from, wi, &hit, &at) > 0);
        }
        mean_add(&found, x);
    }
    // (Where few rays find it, or none, their spread is reckoned from what the samples say.)
    const double most = 2 * 4 * PI / RAYS,
                 spread = fmax(deviation_of(&found), sqrt(mean_of(&sampled) * most));
    const double error = fabs(mean_of(&sampled) - mean_of(&found)),
                 allowed = 5 * hypot(deviation_of(&sampled), spread) + most;
    if (nearest < 0.3) return; // (samples by area have a variance that samples do not show)
    if (!(error <= allowed) || differing > compared / 200)
        fail_msg("shape %d, depth %d: %g +- %g, but %g +- %g found; %d of %d samples differ", which, depth,
                 mean_of(&sampled), deviation_of(&sampled), mean_of(&found), deviation_of(&found), differing,
                 compared);
}

// What rays find, with lights whose colour varies: once balls were sampled as if all of them had the colour
// of one point, and other shapes' coordinates were replaced twice.
static void samples_are_what_rays_find(bool painted) {
    rng r = rng_make(painted ? 3 : 1);
    for (int which = 0; which < SHAPES; which++)
        for (int depth = 0; depth < 3; depth++) {
            scenery w;
            const sag_light_sampler sampler = (sag_light_sampler)rng_below(&r, 3);
            make_scenery(&w, &r, which, depth, sampler, rng_one_in(&r, 2), painted);
            for (int k = depth > 0; k < 2; k++) {
                const sagi_shading_point from = {.position = rng_vec3(&r, 3),
                                                 .normal = rng_direction(&r),
                                                 .reflects_only = rng_one_in(&r, 2)};
                check(&w, &r, &from, which, depth);
            }
            sagi_lights_clear(&w.lights);
            studio_close(&w.s);
        }
}

static void plain_lights(void **state) {
    (void)state;
    samples_are_what_rays_find(false);
}

static void painted_lights(void **state) {
    (void)state;
    samples_are_what_rays_find(true);
}

// The instances are lights, one for each primitive and way.
static void instances_are_counted(void **state) {
    (void)state;
    rng r = rng_make(2);
    scenery w;
    make_scenery(&w, &r, KINDS, 2, SAG_LIGHT_SAMPLER_BVH, false, false);
    assert_int_equal(w.lights.areas.count, 2 * 2 * 2);
    const sagi_shading_point from = {.position = {0, 9, 0}};
    double sum = 0;
    for (uint32_t i = 0; i < 8; i++) sum += sagi_lights_choice(&w.lights, &from, i);
    assert_true(sum <= 1 + 1e-6 && sum > 0);
    sagi_lights_clear(&w.lights);
    studio_close(&w.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plain_lights),
        cmocka_unit_test(painted_lights),
        cmocka_unit_test(instances_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
