// SPDX-License-Identifier: MIT
#include "support/random_model.h"
#include "shapes/shape.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

// By whole steps, quarter turns, mirrors and factors of two.
static void lattice_map(rng *r, double size, sag_affine *map) {
    sag_affine turn = sag_affine_rotate(1.57079632679489661923 * rng_below(r, 4),
                                        (sag_vec3){rng_one_in(r, 2), rng_one_in(r, 2), 1});
    if (turn.m[2][2] != 1) turn = sag_affine_identity(); // about z alone the turns are exact
    sag_affine scale = sag_affine_scale((sag_vec3){rng_one_in(r, 2) ? 1 : -1, rng_one_in(r, 2) ? 1 : 2, 1});
    sag_affine shift = sag_affine_translate(lattice_point(r, size));
    *map = sag_affine_multiply(&turn, &scale);
    *map = sag_affine_multiply(&shift, map);
}

static void add_part(rng *r, sag_context *context, const solid_recipe *how, solid_model *model) {
    model_part *part = solid_model_add(model);
    uint32_t others = model->part_count - 1;
    const model_part *twin = others && rng_one_in(r, 6) ? model->parts[rng_below(r, others)] : NULL;
    part->disabled = rng_one_in(r, 25);
    if (twin && !twin->child) {
        closed_shape_copy(&part->shape, &twin->shape);
        if (twin->mapped) solid_model_map(part, &twin->map);
        return;
    }
    if (how->nesting && rng_one_in(r, 3)) {
        solid_recipe below = *how;
        below.nesting--, below.leaves = 1 + how->leaves / 3, below.depth = 1 + how->depth / 2;
        part->child = random_model_make(r, context, &below);
    } else {
        for (;;) {
            closed_shape_make(r, how->size, how->lattice, &part->shape);
            if (sagi_shape_classes[part->shape.kind].validate(&part->shape.as, NULL) == SAG_OK) break;
        }
    }
    sag_affine map;
    if (how->unmapped || rng_one_in(r, 2)) return;
    if (how->lattice)
        lattice_map(r, how->size, &map);
    else if (!random_place(r, 0.5 * how->size, &map))
        return;
    solid_model_map(part, &map);
}

// A tree of at most `leaves` parts; returns how many it has.
static uint32_t add_tree(rng *r, sag_context *context, const solid_recipe *how, solid_model *model,
                         uint32_t depth, uint32_t leaves) {
    if (depth == 0 || leaves < 2) {
        add_part(r, context, how, model);
        return 1;
    }
    uint32_t used = 0, operands = 0, wanted = 1 + rng_below(r, 4);
    while (used < leaves && operands < wanted) {
        bool deep = !rng_one_in(r, operands == 0 ? 8 : 2);
        uint32_t left = leaves - used, below = deep ? depth - 1 : rng_below(r, depth);
        uint32_t share = operands + 1 == wanted ? left : deep && left > 1 ? left - 1 : (left + 1) / 2;
        used += add_tree(r, context, how, model, below, share);
        operands++;
    }
    uint32_t pick = rng_below(r, 8); // intersections leave little, so there are fewer
    solid_model_step(model,
                     pick < 3   ? SAG_SOLID_UNION
                     : pick < 4 ? SAG_SOLID_INTERSECTION
                     : pick < 6 ? SAG_SOLID_DIFFERENCE
                                : SAG_SOLID_XOR,
                     operands);
    return used;
}

solid_model *random_model_make(rng *r, sag_context *context, const solid_recipe *how) {
    solid_model *model = solid_model_create();
    assert_non_null(model);
    add_tree(r, context, how, model, how->depth, how->leaves);
    sag_error error = {0};
    if (solid_model_finish(model, context, r, &error) != SAG_OK) fail_msg("%s", error.message);
    return model;
}

// The corners and the middle of a shape's box, and the vertices of a mesh, in the model's space.
static uint32_t part_points(rng *r, const model_part *part, sag_vec3 *points, uint32_t room) {
    sag_vec3 found[27];
    uint32_t count = 0;
    if (part->child) {
        sag_vec3 below[SOLID_POINTS];
        uint32_t n = random_model_points(r, part->child, below);
        for (; count < n && count < 27; count++) found[count] = below[count];
    } else {
        sag_box3 box = sagi_shape_classes[part->shape.kind].bounds(&part->shape.as);
        sag_vec3 middle = sag_add(sag_scale(box.min, 0.5), sag_scale(box.max, 0.5));
        for (int i = 0; i < 27; i++) {
            const double x[3] = {box.min.x, middle.x, box.max.x}, y[3] = {box.min.y, middle.y, box.max.y},
                         z[3] = {box.min.z, middle.z, box.max.z};
            found[count++] = (sag_vec3){x[i % 3], y[i / 3 % 3], z[i / 9]};
        }
        const sag_mesh *m = &part->shape.as.mesh;
        for (uint32_t i = 0; part->shape.kind == SAG_SHAPE_MESH && m->positions_f64 && i < 6; i++)
            found[i] =
                (sag_vec3){m->positions_f64[3 * i], m->positions_f64[3 * i + 1], m->positions_f64[3 * i + 2]};
        if (part->shape.kind == SAG_SHAPE_PLANE) found[0] = part->shape.as.plane.point;
    }
    uint32_t kept = 0;
    for (uint32_t k = 0; k < 6 && kept < room; k++) {
        sag_vec3 p = found[k == 0 && count == 27 ? 13 : rng_below(r, count)];
        if (part->mapped) p = sag_affine_point(&part->map, p);
        if (sag_is_finite(p)) points[kept++] = p;
    }
    return kept;
}

uint32_t random_model_points(rng *r, const solid_model *model, sag_vec3 points[SOLID_POINTS]) {
    uint32_t count = 0, start = rng_below(r, model->part_count);
    for (uint32_t i = 0; i < model->part_count && count < SOLID_POINTS; i++) {
        const model_part *part = model->parts[(start + i) % model->part_count];
        count += part_points(r, part, points + count, SOLID_POINTS - count);
    }
    if (!count) points[count++] = (sag_vec3){0, 0, 0};
    return count;
}

static sag_ray lattice_ray(rng *r, double size) {
    sag_vec3 d = {0, 0, 0}, o = lattice_point(r, size);
    while (d.x == 0 && d.y == 0 && d.z == 0)
        d = (sag_vec3){(int)rng_below(r, 3) - 1, rng_one_in(r, 2) ? 0 : (int)rng_below(r, 5) - 2,
                       rng_one_in(r, 2) ? 0 : (int)rng_below(r, 3) - 1};
    if (rng_one_in(r, 2)) o.x += 0.125 * size, o.z -= 0.125 * size;
    return sag_ray_make(sag_madd(o, -(double)rng_below(r, 5) * size, d), d);
}

sag_ray random_model_ray(rng *r, const solid_recipe *how, const adversary *a, bool *random) {
    uint32_t choice = rng_below(r, how->lattice ? 4 : 2);
    *random = choice == 0;
    sag_ray ray;
    if (choice == 1) {
        ray = adversarial_ray(r, a);
        // Denormal coordinates have too few bits left for any of the bounds.
        for (int i = 0; i < 3; i++) {
            double *o = i == 0 ? &ray.origin.x : i == 1 ? &ray.origin.y : &ray.origin.z;
            if (fabs(*o) < 0x1p-1000) *o = 0;
        }
        return ray;
    }
    if (choice == 0) {
        sag_vec3 o = rng_vec3(r, (rng_one_in(r, 3) ? 1 : 3) * how->size);
        ray = sag_ray_make(o, sag_sub(rng_vec3(r, how->size), o));
    } else {
        ray = lattice_ray(r, how->size);
    }
    if (rng_one_in(r, 3)) ray.t_min = -INFINITY;
    if (rng_one_in(r, 6)) {
        ray.t_min = rng_uniform(r, -0.5, 1.2) * how->size / sag_length(ray.direction);
        ray.t_max = ray.t_min + rng_uniform(r, 0, 2) * how->size / sag_length(ray.direction);
    }
    return ray;
}
