// SPDX-License-Identifier: MIT
// Light and solids: a solid looks like the same surface put together from open shapes, pixel by pixel, in
// glass, metal and paint; and in a furnace nothing of it can be seen, from outside and from inside.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "support/picture.h"
#include <sagitta/solid.h>

// A solid scene of the studio's world; its parts are yet to be added.
typedef struct builder {
    sag_scene *scene;
    sag_solid_step steps[32];
    uint32_t step_count;
} builder;

static void step(builder *b, sag_solid_operation operation, uint32_t number) {
    b->steps[b->step_count++] = (sag_solid_step){operation, number};
}

static void part(studio *s, builder *b, sag_shape_kind kind, const void *shape, const sag_appearance *look) {
    const uint32_t id = sag_add_shape(b->scene, kind, shape);
    assert_int_equal(sag_world_set_appearance(s->world, b->scene, id, look), SAG_OK);
    step(b, SAG_SOLID_PART, id);
}

static void place(studio *s, builder *b, const sag_affine *where) {
    const sag_solid solid = {b->steps, b->step_count};
    const sag_affine identity = sag_affine_identity();
    sag_error error = {.status = SAG_OK};
    if (sag_scene_set_solid(b->scene, &solid, &error) != SAG_OK ||
        sag_scene_commit(b->scene, &error) != SAG_OK)
        fail_msg("%s", error.message);
    assert_int_not_equal(sag_add_instance(s->scene, b->scene, where ? where : &identity), SAG_INVALID_ID);
}

static uint32_t surface(studio *s, sag_shape_kind kind, const void *shape, sag_appearance look) {
    const uint32_t id = sag_add_shape(s->scene, kind, shape);
    assert_int_equal(sag_world_set_appearance(s->world, s->scene, id, &look), SAG_OK);
    return id;
}

// ---- the same surface, made in two ways

// What stands around: a wall of squares behind, a lamp, a sky.
static void furnish(studio *s) {
    const sag_texture squares = {.kind = SAG_TEXTURE_CHECKERBOARD,
                                 .a.value = {0.8, 0.3, 0.2},
                                 .b.value = {0.1, 0.4, 0.7},
                                 .mapping.u_scale = 1};
    const sag_texture_id texture = sag_world_add_texture(s->world, &squares);
    const uint32_t wall =
        studio_material(s, (sag_material){.kind = SAG_MATERIAL_DIFFUSE, .reflectance.texture = texture});
    surface(s, SAG_SHAPE_PLANE,
            &(sag_plane){.point = {0, 0, -3}, .normal = {0, 0, 1}, .s = {0.5, 0, 0}, .t = {0, 0.5, 0}},
            (sag_appearance){.material = wall});
    surface(s, SAG_SHAPE_SPHERE, &(sag_sphere){.center = {-3, 4, 4}, .radius = 1},
            (sag_appearance){.emission = {20, 18, 15}});
    sag_world_add_light(s->world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {0.3, 0.4, 0.5}});
    s->settings->max_depth = 12;
    s->settings->samples_per_pixel = 8;
}

#define RADIUS 2.0
#define HALF   0.4 // of the lens's thickness

// A lens: two balls' common part, or the two caps, clipped where they meet.
static void lens(studio *s, bool as_solid, const sag_appearance *look) {
    const double offset = RADIUS - HALF;
    sag_sphere front = {.center = {0, 0, -offset}, .radius = RADIUS},
               back = {.center = {0, 0, offset}, .radius = RADIUS};
    if (as_solid) {
        builder b = {.scene = sag_world_add_object(s->world)};
        part(s, &b, SAG_SHAPE_SPHERE, &front, look);
        part(s, &b, SAG_SHAPE_SPHERE, &back, look);
        step(&b, SAG_SOLID_INTERSECTION, 2);
        place(s, &b, NULL);
    } else {
        front.z_min = offset, front.z_max = RADIUS;
        back.z_min = -RADIUS, back.z_max = -offset;
        surface(s, SAG_SHAPE_SPHERE, &front, *look);
        surface(s, SAG_SHAPE_SPHERE, &back, *look);
    }
}

// A round block with a hollow towards the camera: a cylinder minus a ball, or wall, base, rim and the ball's
// cap, whose front is its inner side. The hollow shines, the block does not.
static void hollow(studio *s, bool as_solid, const sag_appearance *look) {
    const sag_cylinder body = {.radius = 1, .z_min = -0.5, .z_max = 0.5};
    const sag_sphere ball = {.center = {0, 0, 1.3}, .radius = 1};
    const sag_appearance dark = {.material = look->material};
    if (as_solid) {
        sag_cylinder closed = body;
        closed.closed = true;
        builder b = {.scene = sag_world_add_object(s->world)};
        part(s, &b, SAG_SHAPE_CYLINDER, &closed, &dark);
        part(s, &b, SAG_SHAPE_SPHERE, &ball, look);
        step(&b, SAG_SOLID_DIFFERENCE, 2);
        place(s, &b, NULL);
    } else {
        sag_sphere cap = ball;
        sag_appearance inner = *look;
        inner.flip = true;
        cap.z_min = -1, cap.z_max = -0.8;
        surface(s, SAG_SHAPE_CYLINDER, &body, dark);
        surface(s, SAG_SHAPE_DISK, &(sag_disk){.center = {0, 0, -0.5}, .normal = {0, 0, -1}, .radius = 1},
                dark);
        surface(s, SAG_SHAPE_DISK,
                &(sag_disk){.center = {0, 0, 0.5}, .normal = {0, 0, 1}, .radius = 1, .inner_radius = 0.6},
                dark);
        surface(s, SAG_SHAPE_SPHERE, &cap, inner);
    }
}

typedef void (*two_ways)(studio *s, bool as_solid, const sag_appearance *look);

// Paths are the same up to rounding; where that tips a choice, a pixel may differ. Shining parts of a solid
// are found by rays alone: with them only rays look for light.
static void looks_the_same(two_ways build, sag_material material, sag_rgb emission, sag_vec3 eye) {
    studio s[2];
    sag_image image[2];
    for (int i = 0; i < 2; i++) {
        s[i] = studio_open(1);
        furnish(&s[i]);
        const sag_appearance look = {.material = studio_material(&s[i], material), .emission = emission};
        if (emission.r > 0) s[i].settings->strategy = SAG_STRATEGY_SURFACES;
        build(&s[i], i == 0, &look);
        studio_aim(&s[i], eye, sag_vec3_make(0, 0, 0));
        image[i] = studio_render(&s[i], NULL);
    }
    const size_t count = (size_t)image[0].width * image[0].height;
    size_t differing = 0;
    double least = INFINITY, most = 0;
    for (size_t i = 0; i < count; i++) {
        double off = 0;
        for (size_t k = 3 * i; k < 3 * i + 3; k++)
            off = fmax(off, fabs((double)image[0].pixels[k] - (double)image[1].pixels[k]));
        if (!(off < 1e-5)) differing++;
        least = fmin(least, (double)image[0].pixels[3 * i]);
        most = fmax(most, (double)image[0].pixels[3 * i]);
    }
    if (differing > count / 200) fail_msg("%zu of %zu pixels differ", differing, count);
    assert_true(most > least + 0.1); // there was something to see
    for (int i = 0; i < 2; i++) sag_image_clear(s[i].context, &image[i]), studio_close(&s[i]);
}

static const sag_material materials[] = {
    {.kind = SAG_MATERIAL_DIELECTRIC, .eta.value = {1.5, 0, 0}},
    {.kind = SAG_MATERIAL_DIELECTRIC,
     .eta.value = {1.5, 0, 0},
     .roughness_u.value = {0.1, 0, 0},
     .roughness_v.value = {0.1, 0, 0}},
    {.kind = SAG_MATERIAL_CONDUCTOR, .reflectance.value = {0.9, 0.8, 0.5}},
    {.kind = SAG_MATERIAL_COATED_DIFFUSE, .reflectance.value = {0.7, 0.2, 0.2}},
    {.kind = SAG_MATERIAL_DIFFUSE, .reflectance.value = {0.7, 0.2, 0.2}},
};

static void test_same_as_open_shapes(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof materials / sizeof *materials; i++) {
        looks_the_same(lens, materials[i], (sag_rgb){0, 0, 0}, sag_vec3_make(0, 0, 8));
        looks_the_same(hollow, materials[i], (sag_rgb){0, 0, 0}, sag_vec3_make(3, 2, 6));
        looks_the_same(hollow, materials[i], (sag_rgb){2, 1, 3}, sag_vec3_make(3, 2, 6));
    }
}

// ---- the furnace (test_furnace.c), of solids

typedef void (*furnace_subject)(studio *s, const sag_appearance *look);

static const sag_box cube = {{-1, -1, -1}, {1, 1, 1}};

static void die(studio *s, const sag_appearance *look) {
    builder b = {.scene = sag_world_add_object(s->world)};
    part(s, &b, SAG_SHAPE_BOX, &cube, look);
    part(s, &b, SAG_SHAPE_SPHERE, &(sag_sphere){.radius = 1.4}, look);
    step(&b, SAG_SOLID_INTERSECTION, 2);
    for (int i = 0; i < 3; i++)
        part(s, &b, SAG_SHAPE_SPHERE, &(sag_sphere){.center = {i - 1, i - 1, 1.05}, .radius = 0.35}, look);
    step(&b, SAG_SOLID_DIFFERENCE, 4);
    sag_affine turn = sag_affine_rotate(0.5, sag_vec3_make(1, 1, 0));
    place(s, &b, &turn);
}

// Two rings through each other and what both have in common left out; a mirrored and stretched instance.
static void rings(studio *s, const sag_appearance *look) {
    builder ring = {.scene = sag_world_add_object(s->world)};
    part(s, &ring, SAG_SHAPE_TORUS, &(sag_torus){.major_radius = 0.8, .minor_radius = 0.25}, look);
    step(&ring, SAG_SOLID_UNION, 1);
    sag_error error;
    assert_int_equal(sag_scene_set_solid(ring.scene, &(sag_solid){ring.steps, 2}, &error), SAG_OK);
    assert_int_equal(sag_scene_commit(ring.scene, &error), SAG_OK);
    builder b = {.scene = sag_world_add_object(s->world)};
    part(s, &b, SAG_SHAPE_TORUS, &(sag_torus){.major_radius = 0.9, .minor_radius = 0.25}, look);
    sag_affine turn = sag_affine_rotate(1.2, sag_vec3_make(1, 0, 0));
    step(&b, SAG_SOLID_PART, sag_add_instance(b.scene, ring.scene, &turn));
    step(&b, SAG_SOLID_XOR, 2);
    sag_affine mirror = sag_affine_scale(sag_vec3_make(-1.1, 1, 0.8));
    place(s, &b, &mirror);
}

// A mesh with a hole through it, cut by a half-space.
static void drilled_mesh(studio *s, const sag_appearance *look) {
    static const float corners[] = {1.2f, 0,     0, -1.2f, 0, 0,    0, 1.2f, 0,
                                    0,    -1.2f, 0, 0,     0, 1.2f, 0, 0,    -1.2f};
    static const uint32_t faces[] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    builder b = {.scene = sag_world_add_object(s->world)};
    part(s, &b, SAG_SHAPE_MESH,
         &(sag_mesh){.positions_f32 = corners, .triangles = faces, .vertex_count = 6, .triangle_count = 8},
         look);
    part(s, &b, SAG_SHAPE_CYLINDER, &(sag_cylinder){.radius = 0.3, .z_min = -2, .z_max = 2, .closed = true},
         look);
    part(s, &b, SAG_SHAPE_PLANE, &(sag_plane){.point = {0, 0.5, 0}, .normal = {0.1, -1, 0}}, look);
    step(&b, SAG_SOLID_DIFFERENCE, 3);
    sag_affine turn = sag_affine_rotate(0.6, sag_vec3_make(0.3, 1, 0));
    place(s, &b, &turn);
}

// The camera within: a block of 40 that has a room of 20 in it, and a pillar in the room.
static void room(studio *s, const sag_appearance *look) {
    builder b = {.scene = sag_world_add_object(s->world)};
    part(s, &b, SAG_SHAPE_BOX, &(sag_box){{-20, -20, -20}, {20, 20, 20}}, look);
    part(s, &b, SAG_SHAPE_BOX, &(sag_box){{-10, -10, -10}, {10, 10, 10}}, look);
    part(s, &b, SAG_SHAPE_CYLINDER, &(sag_cylinder){.radius = 1, .z_min = -10, .z_max = 3, .closed = true},
         look);
    step(&b, SAG_SOLID_DIFFERENCE, 2);
    step(&b, SAG_SOLID_DIFFERENCE, 2);
    place(s, &b, NULL);
}

static const struct {
    const char *name;
    furnace_subject build;
    bool inside;
} subjects[] = {{"die", die, false},
                {"rings", rings, false},
                {"drilled mesh", drilled_mesh, false},
                {"room", room, true}};

static void check_furnace(size_t which, sag_appearance look, sag_material material, double below) {
    studio s = studio_open(0);
    s.settings->film.width = s.settings->film.height = 24;
    s.settings->max_depth = 1000;
    sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
    look.material = studio_material(&s, material);
    subjects[which].build(&s, &look);
    const studio_mean m = studio_measure(&s);
    if (!(m.mean > 1 - below - 5 * m.deviation - 1e-6 && m.mean < 1 + 5 * m.deviation + 1e-6))
        fail_msg("%s: %g +- %g", subjects[which].name, m.mean, m.deviation);
    assert_true(m.deviation < 0.01);
    studio_close(&s);
}

static void test_furnace(void **state) {
    (void)state;
    const sag_appearance plain = {0}, shining = {.emission = {0.5, 0.5, 0.5}};
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
        check_furnace(i, shining,
                      (sag_material){.kind = SAG_MATERIAL_DIFFUSE, .reflectance.value = {0.5, 0.5, 0.5}}, 0);
        if (subjects[i].inside) continue; // a closed room of mirrors or glass has no light to show
        check_furnace(i, plain,
                      (sag_material){
                          .kind = SAG_MATERIAL_CONDUCTOR, .eta.value = {1, 1, 1}, .k.value = {1e8, 1e8, 1e8}},
                      0);
        check_furnace(i, plain, (sag_material){.kind = SAG_MATERIAL_DIELECTRIC, .eta.value = {1.5, 0, 0}},
                      1e-3);
        check_furnace(i, plain,
                      (sag_material){.kind = SAG_MATERIAL_COATED_DIFFUSE,
                                     .reflectance.value = {1, 1, 1},
                                     .eta.value = {1.5, 0, 0}},
                      1e-3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_as_open_shapes),
        cmocka_unit_test(test_furnace),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
