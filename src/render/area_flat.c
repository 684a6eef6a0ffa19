// SPDX-License-Identifier: MIT
// Flat lights: triangles of meshes, rectangles, parallelograms.
//
// Near ones are sampled over the directions they fill (spherical.c), unless they fill so little that rounding
// shows, or so much that the point is nearly on them (pbrt-v4's limits). Far ones are sampled by area, for
// less: of a light of size s at distance d, at height h over its plane, the radiance per area
// goes with cos θ/d² = h/d³, h being the same all over it. Over the light d changes by s at most, so with
// s²/d² ≤ 1/8 that changes by 1.5 s/d ≤ 0.53 of its middle at most: if evenly, a variance of 2.3 % of the
// square of what arrives, and less where the light is not seen end on. Of the Cornell box and three more
// scenes (64 samples) the mean square error beside a limit of 1/16 stays as it was to 0.1 %; the box
// takes 2.8 % fewer instructions. On a floor that sees nothing but one lamp, where there is little other
// noise, the error of 0.22 % (1/16) becomes 0.27 %. Whether a light is far is told from its middle, without
// looking at its corners.
//
// All that does not depend on the point that is shone on is worked out once, unless the light has textures or
// vertex normals that do not agree which side is its front: plane, front, and how far off the traced surface
// a point may be. That last is known at the corners and linear in between (triangles, see triangle.c), or all
// but that (rectangles); for the rest twice as much is taken. The point itself is off the plane by some
// roundings of its coordinates and of t: with h over the plane and cos θ, both off by roundings of |p| and 1,
// t = h/cos θ is off by roundings of (|p|/h + 1/cos θ) t, which along the normal is |p| + t.
#include "area.h"

#include "math/map.h"

#define LEAST_SOLID_ANGLE 3e-4
#define MOST_SOLID_ANGLE  6.22
#define MOST_FLATS        (1u << 20) // lights, beyond which memory counts more

bool sagi_facet_fills(const sagi_facet *facet, const sagi_shading_point *from, sagi_facet_view *view) {
    if (sagi_facet_is_far(facet, from->position)) return false;
    sagi_facet_see(facet, from->position, from->normal, from->reflects_only, view);
    return view->solid_angle >= LEAST_SOLID_ANGLE && view->solid_angle <= MOST_SOLID_ANGLE;
}

static sag_vec3 greater(sag_vec3 a, sag_vec3 b) {
    return sag_vec3_make(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
}

// The surface at a corner as a ray along the normal finds it, from the front or the back.
static void corner_at(const sagi_areas *areas, uint32_t index, const sagi_facet *facet, sag_vec2 uv,
                      sag_vec3 across, sag_surface *surface) {
    const sagi_area_group *group = sagi_area_group_of(areas, index);
    const sag_vec3 at = sag_madd(sag_madd(facet->a, uv.x, facet->e), uv.y, facet->f);
    sagi_area_meet(areas, group, index - group->first, sag_add(at, across), sag_neg(across), 1, uv, surface);
}

static void make_ready(sagi_areas *areas, uint32_t index) {
    sagi_flat *flat = &areas->flats[index];
    const sagi_appearance *appearance = sagi_area_appearance(areas, index);
    flat->ready = false;
    if (appearance->look.emission_texture || appearance->look.alpha.texture) return;
    sagi_facet *facet = &flat->facet;
    sagi_area_facet(areas, index, facet);
    const sag_vec3 n = sag_cross(facet->e, facet->f);
    const double size = sag_length(n);
    if (!(size > 0) || !isfinite(size)) return;
    const sag_vec3 across = sag_scale(n, 1 / sqrt(size));
    sag_surface at;
    corner_at(areas, index, facet, (sag_vec2){0, 0}, sag_neg(across), &at);
    sagi_orient(appearance, &at);
    flat->normal = at.geometric_normal;
    flat->error = at.position_error;
    for (int i = 0; i < 3 + facet->parallelogram; i++) {
        corner_at(areas, index, facet, (sag_vec2){i & 1, i >> 1}, across, &at);
        if (!(fabs(sag_dot(at.geometric_normal, at.shading_normal)) > 0x1p-20)) return;
        sagi_orient(appearance, &at);
        if (!(sag_dot(flat->normal, at.geometric_normal) > 1 - 0x1p-30)) return;
        flat->error = greater(flat->error, at.position_error);
    }
    flat->error = sag_scale(flat->error, 2);
    flat->ready = sag_is_finite(flat->error) && sag_is_finite(flat->normal);
}

bool sagi_flats_init(sagi_areas *areas, const sag_context *context) {
    const sagi_area_group *groups = areas->groups.items;
    bool any = false;
    for (uint32_t g = 0; g < areas->groups.count; g++) any |= groups[g].kind == SAGI_AREA_FACET;
    if (!any || areas->count > MOST_FLATS) return true;
    areas->flats = sag_allocate(context, areas->count * sizeof *areas->flats);
    if (!areas->flats) return false;
    for (uint32_t i = 0; i < areas->count; i++) {
        areas->flats[i].ready = false;
        if (sagi_area_group_of(areas, i)->kind == SAGI_AREA_FACET && areas->areas[i].density > 0)
            make_ready(areas, i);
    }
    return true;
}

// By area: a point, as evenly spread as the two numbers.
static sag_vec3 spread(const sagi_facet *facet, sag_vec2 u) {
    if (!facet->parallelogram) {
        const double s = sqrt(u.x);
        u.x = s * (1 - u.y);
        u.y = s * u.y;
    }
    return sag_madd(sag_madd(facet->a, u.x, facet->e), u.y, facet->f);
}

bool sagi_flat_sample(const sagi_areas *areas, uint32_t index, const sagi_shading_point *from, sag_vec2 u,
                      sag_surface *surface, sag_vec3 *wi, double *pdf) {
    const sagi_flat *flat = &areas->flats[index];
    const sagi_facet *facet = &flat->facet;
    const double height = sag_dot(flat->normal, sag_sub(from->position, facet->a));
    if (!(height > 0) && !sagi_area_appearance(areas, index)->look.two_sided) return false;
    surface->geometric_normal = flat->normal;
    surface->primitive = index - sagi_area_group_of(areas, index)->first;
    sagi_facet_view view;
    double t, cosine;
    if (sagi_facet_fills(facet, from, &view)) {
        *wi = sagi_facet_sample(&view, u, pdf);
        cosine = sag_dot(flat->normal, *wi);
        t = -height / cosine;
        surface->position = sag_madd(from->position, t, *wi);
    } else {
        surface->position = spread(facet, u);
        const sag_vec3 d = sag_sub(surface->position, from->position);
        const double distance2 = sag_dot(d, d);
        t = sqrt(distance2);
        *wi = sag_scale(d, 1 / t);
        cosine = sag_dot(flat->normal, *wi);
        *pdf = areas->areas[index].density * distance2 / fabs(cosine);
    }
    const sag_vec3 p = sag_abs(from->position);
    const double margin = 0x1p-49 * (p.x + p.y + p.z + t);
    surface->position_error = sag_add(flat->error, sag_vec3_make(margin, margin, margin));
    return t > 0 && fabs(cosine) > 0 && *pdf > 0 && t < INFINITY && *pdf < INFINITY;
}
