// SPDX-License-Identifier: MIT
// Shapes of a pbrt scene: pbrt's own, with pbrt's parameterisation, and Sagitta's words for the others.
// Meshes are in pbrt_mesh.c.
//
// Each shape is checked as it is read, so that an error has its place in the file, and placed by the current
// transform. Sides: the scene keeps outside outside under mirroring maps. So does pbrt with meshes, whose
// normals it makes in the scene's space, by a cross product that its "swaps handedness" turns back. Quadrics'
// normals it makes in their own space and takes along by the inverse transposed, which needs no turning, but
// turns them all the same: a mirrored sphere's front is inside. Scenes are made to look right that way.
#include "formats/pbrt_shape.h"
#include "math/affine_inverse.h"
#include "math/elementary.h"

#include "formats/pbrt_later.h"
#include "formats/pbrt_solid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846

static sag_vec3 triple(sagi_pbrt *p, const char *name, sag_vec3 otherwise) {
    double v[3];
    return sagi_params_triple(&p->params, name, v) ? sag_vec3_make(v[0], v[1], v[2]) : otherwise;
}

static double number(sagi_pbrt *p, const char *name, double otherwise) {
    return sagi_params_float(&p->params, name, otherwise);
}

// "phimax" in degrees; 360 gives 2π exactly.
static double sweep(sagi_pbrt *p) { return number(p, "phimax", 360) / 180 * PI; }

// In a solid what can be closed is.
static bool closed(sagi_pbrt *p) {
    return sagi_params_bool(&p->params, "closed", false) || p->solid.scene != NULL;
}

// ---- placing

// What multiplies an area light's colour: its power is spread over the shape. 0: there is no shape to speak
// of.
static double emission_scale(const sagi_pbrt *p, double area) {
    const sagi_area_light *light = &p->state.area_light;
    if (!(light->power > 0)) return light->scale;
    const double whole = area * PI * (light->two_sided ? 2 : 1) * light->luminance;
    return whole > 0 && isfinite(whole) && isfinite(1 / whole) ? light->scale * light->power / whole : 0;
}

double sagi_pbrt_area_factor(const sagi_pbrt *p) {
    const sag_affine now = sagi_pbrt_transform_now(p);
    const double factor = sagi_cbrt(fabs(sag_affine_determinant(&now)));
    return factor * factor;
}

// Whether pbrt turns the shape's front: ReverseOrientation, and mirrored quadrics (see above) but in solids,
// which have an inside, and lamps: points that pbrt samples on these are not turned, so that they shine to
// the outside (where pbrt shows them dark).
static bool is_turned(const sagi_pbrt *p, sag_shape_kind kind) {
    const bool is_quadric = kind == SAG_SHAPE_SPHERE || kind == SAG_SHAPE_DISK || kind == SAG_SHAPE_CYLINDER;
    const sag_affine now = sagi_pbrt_transform_now(p);
    const bool mirrored =
        is_quadric && !p->solid.scene && !p->state.area_light.on && sagi_affine_is_mirror(&now);
    return p->state.reverse_orientation != mirrored;
}

// Material, alpha and light of the shape being read.
static sag_appearance look_of(sagi_pbrt *p, sag_shape_kind kind, double area) {
    sag_appearance look = {
        .material = p->state.material, .flip = is_turned(p, kind), .square_uv = !p->in_patches};
    if (p->state.inside) look.inside = p->media[p->state.inside - 1].id;
    if (p->state.outside) look.outside = p->media[p->state.outside - 1].id;
    if (p->corner_uv) look.has_uv = true, memcpy(look.uv, p->corner_uv, sizeof look.uv);
    look.alpha = sagi_pbrt_float_input(p, "alpha", 1);
    if (look.alpha.texture == 0 && look.alpha.value.r < 1) {
        const sag_texture constant = {.kind = SAG_TEXTURE_CONSTANT, .is_number = true, .a = look.alpha};
        look.alpha.texture = sag_world_add_texture(p->world, &constant);
        if (look.alpha.texture == 0) p->params.status = sagi_pbrt_out_of_memory(p);
    }
    if (look.alpha.texture && p->solid.scene) {
        sagi_pbrt_warn_once(p, p->params.place, "alpha of solids",
                            "%s: the \"alpha\" of a solid's part is not supported: all of it is there",
                            p->params.what);
        look.alpha = (sag_input){.value = {1, 1, 1}};
    }
    if (p->state.area_light.on && p->in_object && !p->solid.scene) {
        sagi_pbrt_warn_once(p, p->params.place, "object lights",
                            "area lights within objects are not supported: they do not shine");
    } else if (p->state.area_light.on && sagi_pbrt_is_interface(p, p->state.material)) {
        sagi_pbrt_warn_once(p, p->params.place, "interface lights",
                            "area lights of the material \"interface\" do not shine, as in pbrt");
    } else if (p->state.area_light.on) {
        const sag_input *const radiance = &p->state.area_light.radiance;
        // As in pbrt a triangle is a light of its own.
        look.emission_over_area = kind == SAG_SHAPE_MESH && p->state.area_light.power > 0;
        if (!(area > 0 && isfinite(1 / area)) && !p->solid.scene) {
            char key[sizeof p->params.what + 32];
            snprintf(key, sizeof key, "%s without area", p->params.what);
            sagi_pbrt_warn_once(p, p->params.place, key, "%s: a light without area: it does not shine",
                                p->params.what);
            return look;
        }
        const double scale = emission_scale(p, look.emission_over_area ? 1 : area);
        if (p->state.area_light.power > 0 && !(scale > 0))
            sagi_pbrt_warn_once(p, p->params.place, "light without power",
                                "%s: a light given by its power, too large or with a black picture: it does "
                                "not shine",
                                p->params.what);
        look.emission_texture = p->state.area_light.picture;
        look.emission =
            (sag_rgb){radiance->value.r * scale, radiance->value.g * scale, radiance->value.b * scale};
        look.emission_spectrum = radiance->spectrum;
        look.emission_scale = scale;
        if (!isfinite(look.emission.r) || !isfinite(look.emission.g) || !isfinite(look.emission.b))
            sagi_params_fail(&p->params, NULL, "its light is too bright: its power is spread over %g", area);
        look.two_sided = p->state.area_light.two_sided;
    }
    return look;
}

sag_status sagi_pbrt_add(sagi_pbrt *p, sag_shape_kind kind, const void *shape, double area,
                         const sag_affine *placed) {
    uint32_t geometry;
    return sagi_pbrt_add_numbered(p, kind, shape, area, placed, &geometry);
}

sag_status sagi_pbrt_add_numbered(sagi_pbrt *p, sag_shape_kind kind, const void *shape, double area,
                                  const sag_affine *placed, uint32_t *id) {
    if (p->params.status != SAG_OK) return p->params.status;
    const char *const wrong = p->solid.scene ? sagi_pbrt_not_closed(kind, shape) : NULL;
    if (wrong) return sagi_params_fail(&p->params, NULL, "it %s", wrong);
    sag_appearance look = {0};
    if (!p->options->geometry_only) look = look_of(p, kind, area);
    if (p->params.status != SAG_OK) return p->params.status;
    if (p->solid.scene) {
        sagi_pbrt_solid_operand(p);
        return sagi_pbrt_solid_shape(p, p->params.place, kind, shape, placed, &look);
    }
    const uint32_t geometry = sag_add_shape(p->scene, kind, shape);
    if (geometry == SAG_INVALID_ID) return sagi_pbrt_out_of_memory(p);
    *id = geometry;
    if (!sag_affine_is_identity(placed)) {
        const sag_status status = sag_geometry_set_transform(p->scene, geometry, placed);
        if (status == SAG_ERROR_MEMORY) return sagi_pbrt_out_of_memory(p);
        if (status != SAG_OK) return sagi_params_fail(&p->params, NULL, "the transform is singular");
    }
    if (p->in_object) {
        const sagi_part part = {.look = look, .place = p->params.place, .geometry = geometry};
        const sag_status status = sagi_pbrt_object_part(p, &part, sagi_pbrt_weight(kind, shape));
        if (status != SAG_OK) return status;
    }
    if (p->options->geometry_only) return SAG_OK;
    const sag_status status = sag_world_set_appearance(p->world, p->scene, geometry, &look);
    if (status != SAG_OK) return sagi_pbrt_out_of_memory(p);
    return SAG_OK;
}

// A shape that has passed its check; sag_error's message becomes one with a place.
static sag_status add_checked(sagi_pbrt *p, sag_shape_kind kind, const void *shape, sag_status check,
                              const sag_error *reason, double area) {
    if (p->params.status != SAG_OK) return p->params.status;
    if (check != SAG_OK) return sagi_params_fail(&p->params, NULL, "%.380s", reason->message);
    if (p->state.area_light.on) area *= sagi_pbrt_area_factor(p);
    return sagi_pbrt_add(p, kind, shape, area, &p->state.ctm);
}

#define ADD(KIND, name, shape)                                                                               \
    do {                                                                                                     \
        sag_error reason = {0};                                                                              \
        const sag_status check =                                                                             \
            p->params.status == SAG_OK ? sag_##name##_validate(&(shape), &reason) : SAG_OK;                  \
        return add_checked(p, SAG_SHAPE_##KIND, &(shape), check, &reason,                                    \
                           check == SAG_OK && p->state.area_light.on ? sag_##name##_area(&(shape)) : 0);     \
    } while (0)

// ---- pbrt's shapes

// Where a sphere has been moved, or scaled by the same positive number in all directions, the sphere that
// stands there says the same without a transform: spheres without one are traced eight at a time.
static bool stands_upright(const sag_affine *m) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (m->m[i][j] != (i == j ? m->m[0][0] : 0)) return false;
    return m->m[0][0] > 0;
}

static sag_status placed_sphere(sagi_pbrt *p, sag_sphere s) {
    const sag_affine *m = &p->state.ctm, unmoved = sag_affine_identity();
    const double scale = m->m[0][0];
    const bool shines = p->state.area_light.on;
    sag_error reason = {0};
    sag_status check = p->params.status == SAG_OK ? sag_sphere_validate(&s, &reason) : SAG_OK;
    if (check == SAG_OK && stands_upright(m)) {
        sag_sphere there = s;
        there.center = sag_affine_point(m, s.center);
        there.radius *= scale, there.z_min *= scale, there.z_max *= scale;
        if (sag_sphere_validate(&there, NULL) == SAG_OK)
            return sagi_pbrt_add(p, SAG_SHAPE_SPHERE, &there, shines ? sag_sphere_area(&there) : 0, &unmoved);
    }
    return add_checked(p, SAG_SHAPE_SPHERE, &s, check, &reason,
                       check == SAG_OK && shines ? sag_sphere_area(&s) : 0);
}

static sag_status sphere(sagi_pbrt *p) {
    const double radius = number(p, "radius", 1);
    const double z0 = number(p, "zmin", -radius), z1 = number(p, "zmax", radius);
    sag_sphere s = {
        .center = triple(p, "center", sag_vec3_make(0, 0, 0)), .radius = radius, .phi_max_rad = sweep(p)};
    const double low = fmax(fmin(z0, z1), -radius), high = fmin(fmax(z0, z1), radius);
    if (low > -radius || high < radius) s.z_min = low, s.z_max = high;
    if (s.z_min == 0 && s.z_max == 0 && (low > -radius || high < radius))
        return sagi_params_fail(&p->params, NULL, "nothing is left between zmin and zmax");
    return placed_sphere(p, s);
}

static sag_status disk(sagi_pbrt *p) {
    const sag_disk s = {.center = {0, 0, number(p, "height", 0)},
                        .normal = {0, 0, 1},
                        .radius = number(p, "radius", 1),
                        .inner_radius = number(p, "innerradius", 0),
                        .phi_max_rad = sweep(p),
                        .x_axis = {1, 0, 0}};
    ADD(DISK, disk, s);
}

static sag_status cylinder(sagi_pbrt *p) {
    const sag_cylinder s = {number(p, "radius", 1), number(p, "zmin", -1), number(p, "zmax", 1), sweep(p),
                            closed(p)};
    ADD(CYLINDER, cylinder, s);
}

// ---- Sagitta's words

static sag_status plane(sagi_pbrt *p) {
    const sag_vec3 zero = {0, 0, 0};
    const sag_plane s = {triple(p, "point", zero), triple(p, "normal", sag_vec3_make(0, 1, 0)),
                         triple(p, "s", zero), triple(p, "t", zero)};
    ADD(PLANE, plane, s);
}

static sag_status rectangle(sagi_pbrt *p) {
    const sag_rectangle s = {triple(p, "corner", sag_vec3_make(0, 0, 0)),
                             triple(p, "edgeu", sag_vec3_make(1, 0, 0)),
                             triple(p, "edgev", sag_vec3_make(0, 1, 0))};
    ADD(RECTANGLE, rectangle, s);
}

static sag_status ellipsoid(sagi_pbrt *p) {
    const sag_ellipsoid s = {triple(p, "center", sag_vec3_make(0, 0, 0)),
                             triple(p, "radii", sag_vec3_make(1, 1, 1))};
    ADD(ELLIPSOID, ellipsoid, s);
}

static sag_status cone(sagi_pbrt *p) {
    const sag_cone s = {number(p, "radius", 1), number(p, "height", 1), sweep(p), closed(p)};
    ADD(CONE, cone, s);
}

static sag_status paraboloid(sagi_pbrt *p) {
    const sag_paraboloid s = {number(p, "radius", 1), number(p, "zmin", 0), number(p, "zmax", 1), sweep(p),
                              closed(p)};
    ADD(PARABOLOID, paraboloid, s);
}

static sag_status hyperboloid(sagi_pbrt *p) {
    const sag_hyperboloid s = {triple(p, "p1", sag_vec3_make(0, 0, 0)),
                               triple(p, "p2", sag_vec3_make(1, 1, 1)), sweep(p), closed(p)};
    ADD(HYPERBOLOID, hyperboloid, s);
}

static sag_status hyperboloid2(sagi_pbrt *p) {
    const sag_hyperboloid2 s = {number(p, "a", 1),    number(p, "c", 1), number(p, "zmin", -2),
                                number(p, "zmax", 2), sweep(p),          closed(p)};
    ADD(HYPERBOLOID2, hyperboloid2, s);
}

static sag_status quadric(sagi_pbrt *p) {
    sag_quadric s = {
        .clip = {triple(p, "min", sag_vec3_make(-1, -1, -1)), triple(p, "max", sag_vec3_make(1, 1, 1))}};
    size_t count;
    const double *coefficients = sagi_params_numbers(&p->params, "coefficients", SAGI_TYPE_FLOAT, 10, &count);
    if (count != 10)
        return sagi_params_fail(&p->params, NULL, "\"float coefficients\" with ten numbers expected");
    memcpy(s.coefficients, coefficients, sizeof s.coefficients);
    ADD(QUADRIC, quadric, s);
}

static sag_status box(sagi_pbrt *p) {
    const sag_box s = {triple(p, "min", sag_vec3_make(-1, -1, -1)), triple(p, "max", sag_vec3_make(1, 1, 1))};
    ADD(BOX, box, s);
}

static sag_status oriented_box(sagi_pbrt *p) {
    sag_oriented_box s = {.center = triple(p, "center", sag_vec3_make(0, 0, 0))};
    size_t count;
    const double *v = sagi_params_numbers(&p->params, "halfaxes", SAGI_TYPE_VECTOR3, 9, &count);
    if (count != 9)
        return sagi_params_fail(&p->params, NULL, "\"vector3 halfaxes\" with three vectors expected");
    for (int i = 0; i < 3; i++) s.half_axes[i] = sag_vec3_make(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    ADD(ORIENTED_BOX, oriented_box, s);
}

static sag_status polyhedron(sagi_pbrt *p) {
    sag_half_space planes[SAG_MAX_POLYHEDRON_PLANES];
    size_t count;
    const double *v = sagi_params_numbers(&p->params, "planes", SAGI_TYPE_FLOAT, 4, &count);
    if (count == 0 || count / 4 > SAG_MAX_POLYHEDRON_PLANES)
        return sagi_params_fail(&p->params, NULL,
                                "\"float planes\" with 1 to %d times nx ny nz offset expected",
                                SAG_MAX_POLYHEDRON_PLANES);
    for (size_t i = 0; i < count / 4; i++)
        planes[i] = (sag_half_space){{v[4 * i], v[4 * i + 1], v[4 * i + 2]}, v[4 * i + 3]};
    const sag_polyhedron s = {planes, (uint32_t)(count / 4)};
    ADD(POLYHEDRON, polyhedron, s);
}

static sag_status capsule(sagi_pbrt *p) {
    const sag_capsule s = {triple(p, "p0", sag_vec3_make(0, 0, 0)), triple(p, "p1", sag_vec3_make(0, 0, 1)),
                           number(p, "radius", 1)};
    ADD(CAPSULE, capsule, s);
}

static sag_status torus(sagi_pbrt *p) {
    const sag_torus s = {number(p, "majorradius", 1), number(p, "minorradius", 0.25)};
    ADD(TORUS, torus, s);
}

static sag_status triangle(sagi_pbrt *p) {
    size_t count;
    const double *v = sagi_params_numbers(&p->params, "P", SAGI_TYPE_POINT3, 9, &count);
    if (count != 9) return sagi_params_fail(&p->params, NULL, "\"point3 P\" with three points expected");
    const sag_triangle s = {.a = {v[0], v[1], v[2]},
                            .b = {v[3], v[4], v[5]},
                            .c = {v[6], v[7], v[8]},
                            .one_sided = sagi_params_bool(&p->params, "onesided", false)};
    ADD(TRIANGLE, triangle, s);
}

static sag_status unsupported(sagi_pbrt *p, const char *name) {
    if (p->solid.scene)
        return sagi_params_fail(&p->params, NULL, "it is not supported, and a solid cannot do without");
    sagi_pbrt_warn_once(p, p->params.place, name, "the shape \"%s\" is not supported: left out", name);
    for (size_t i = 0; i < p->params.count; i++) p->params.items[i].used = true;
    return SAG_OK;
}

static sag_status curve(sagi_pbrt *p) { return unsupported(p, "curve"); }

static const struct {
    const char *name;
    sag_status (*read)(sagi_pbrt *p);
} shapes[] = {
    {"plymesh", sagi_pbrt_plymesh},
    {"trianglemesh", sagi_pbrt_trianglemesh},
    {"sphere", sphere},
    {"disk", disk},
    {"cylinder", cylinder},
    {"bilinearmesh", sagi_pbrt_bilinearmesh},
    {"loopsubdiv", sagi_pbrt_loopsubdiv},
    {"curve", curve},
    {"plane", plane},
    {"rectangle", rectangle},
    {"polygon", sagi_pbrt_polygon},
    {"ellipsoid", ellipsoid},
    {"cone", cone},
    {"paraboloid", paraboloid},
    {"hyperboloid", hyperboloid},
    {"hyperboloid2", hyperboloid2},
    {"quadric", quadric},
    {"box", box},
    {"orientedbox", oriented_box},
    {"polyhedron", polyhedron},
    {"capsule", capsule},
    {"triangle", triangle},
    {"torus", torus},
    {"spheres", sagi_pbrt_spheres},
};

// Reads the parameters of a mesh without its numbers, if it is large: they are for later. True when that is
// done; else the cursor is where it was.
static bool skimmed(sagi_pbrt *p, sagi_place place, const char *name) {
    sagi_cursor *cursor = &p->files[p->file_count - 1];
    const sagi_cursor before = *cursor;
    if (strcmp(name, "trianglemesh") != 0 || !sagi_pbrt_may_wait(p)) return false;
    for (size_t i = 0; i < p->state.attribute_count; i++)
        if (p->attributes[i].target == SAGI_TARGET_SHAPE) return false;
    p->params.skim = true;
    sag_status status = sagi_pbrt_parameters_of(p, place, SAGI_TARGET_SHAPE, "Shape", name);
    p->params.skim = false;
    bool good = false;
    for (size_t i = 0; i < p->params.count && status == SAG_OK; i++) good |= p->params.items[i].skimmed;
    if (p->options->geometry_only) sagi_pbrt_ignore(p, "alpha", NULL);
    good = good && sagi_pbrt_triangles_later(p, before, &status);
    if (!good) *cursor = before;
    return good;
}

sag_status sagi_pbrt_shape(sagi_pbrt *p, sagi_place place) {
    char name[64];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status == SAG_OK && skimmed(p, place, name)) return sagi_pbrt_parameters_done(p);
    if (status == SAG_OK) status = sagi_pbrt_parameters_of(p, place, SAGI_TARGET_SHAPE, "Shape", name);
    if (status != SAG_OK) return status;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (strcmp(name, shapes[i].name) != 0) continue;
        if (p->options->geometry_only) sagi_pbrt_ignore(p, "alpha", NULL);
        status = shapes[i].read(p);
        // A failed look-up is the list's; what went wrong afterwards stays.
        return status == SAG_OK ? sagi_pbrt_parameters_done(p) : status;
    }
    return sagi_place_error(place, p->error, "unknown shape \"%.60s\"", name);
}
