// SPDX-License-Identifier: MIT
// Shapes with arrays in a pbrt scene: meshes of triangles, polygons, sets of spheres.
// Points written in the file are kept in double precision, those of a PLY file in the precision they have
// there. A vertex that is no number stays: the scene drops its triangles and counts them.
#include "formats/pbrt_shape.h"

#include "formats/loop_subdivision.h"
#include "formats/pbrt_later.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Tells the listener, adds, and frees.
static sag_status finish_mesh(sagi_pbrt *p, sagi_mesh_data *data, const char *name) {
    const sag_mesh mesh = sagi_mesh_data_view(data);
    const uint32_t dropped = p->options->on_mesh ? 0 : sagi_mesh_data_not_finite(data);
    if (p->options->on_mesh) p->options->on_mesh(p->options->user, name, &mesh);
    if (dropped)
        sagi_pbrt_warn(
            p, p->params.place,
            "%s: triangles with a vertex that is NaN, infinite or beyond 2^100 are left out: %u of %u",
            p->params.what, dropped, data->triangle_count);
    // What counts of it here is whether there is any: a mesh given by its power is a light for each triangle.
    const bool shines = p->state.area_light.on && !p->options->geometry_only;
    const double area = !shines || sagi_mesh_data_has_area(data, &p->state.ctm) ? 1 : 0;
    const sag_status status = sagi_pbrt_add(p, SAG_SHAPE_MESH, &mesh, area, &p->state.ctm);
    sagi_mesh_data_clear(data);
    return status;
}

sag_status sagi_pbrt_finish_text_mesh(sagi_pbrt *p, sagi_mesh_data *data) {
    char name[SAGI_MAX_PATH + 32];
    int line = 0, column;
    if (p->options->on_mesh) sagi_place_find(p->params.place, &line, &column); // counts all lines before
    snprintf(name, sizeof name, "%s:%d", p->params.place.source->path, line);
    return finish_mesh(p, data, name);
}

sag_status sagi_pbrt_plymesh(sagi_pbrt *p) {
    char name[SAGI_MAX_PATH], path[SAGI_MAX_PATH];
    sagi_params_string(&p->params, "filename", "", name, sizeof name);
    sagi_pbrt_ignore(p, "displacement", "is not supported");
    sagi_pbrt_ignore(p, "edgelength", NULL);
    if (p->params.status != SAG_OK) return p->params.status;
    if (!name[0]) return sagi_params_fail(&p->params, NULL, "its \"string filename\" is missing");
    sagi_pbrt_path(p, name, path);
    if (sagi_pbrt_may_wait(p))
        return sagi_pbrt_ply_later(p, path, sagi_params_find(&p->params, "filename", ~0u)->place);
    sagi_mesh_data data = {.context = p->context};
    sag_error reason;
    const sag_status status = sagi_ply_read(p->context, path, &data, &reason);
    if (status == SAG_OK) return finish_mesh(p, &data, path);
    if (status == SAG_ERROR_IO) // the place of the name is what helps
        sagi_params_fail(&p->params, sagi_params_find(&p->params, "filename", ~0u), "%.250s: %.120s", path,
                         reason.message);
    else
        *p->error = reason;
    p->error->status = status;
    return status;
}

// Copies an array of the parameter list as floats; NULL when it is not there. Its length must be `group` for
// each vertex.
static sag_status copy_floats(sagi_pbrt *p, const char *name, unsigned types, size_t group,
                              size_t vertex_count, float **out) {
    size_t count;
    const double *numbers = sagi_params_numbers(&p->params, name, types, group, &count);
    if (p->params.status != SAG_OK || count == 0) return p->params.status;
    if (count != group * vertex_count)
        return sagi_params_fail(&p->params, sagi_params_find(&p->params, name, ~0u),
                                "%zu of \"%s\" for %zu of \"P\"", count / group, name, vertex_count);
    *out = sag_allocate(p->context, count * sizeof(float));
    if (!*out) return sagi_pbrt_out_of_memory(p);
    for (size_t i = 0; i < count; i++) (*out)[i] = (float)numbers[i];
    return SAG_OK;
}

sag_status sagi_pbrt_read_arrays(sagi_pbrt *p, size_t corners, sagi_mesh_data *data, const double **indices,
                                 size_t *index_count) {
    sagi_params *params = &p->params;
    size_t count;
    const double *positions = sagi_params_numbers(params, "P", SAGI_TYPE_POINT3, 3, &count);
    if (params->status != SAG_OK) return params->status;
    if (count == 0) return sagi_params_fail(params, NULL, "its \"point3 P\" is missing or empty");
    if (count / 3 > UINT32_MAX) return sagi_params_fail(params, NULL, "more than 2³² points");
    *indices = sagi_params_numbers(params, "indices", SAGI_TYPE_INTEGER, corners, index_count);
    if (params->status != SAG_OK) return params->status;
    const sagi_param *given = sagi_params_find(params, "indices", ~0u);
    if (!given && count / 3 != corners)
        return sagi_params_fail(params, NULL, "its \"integer indices\" are missing");
    if (given && *index_count == 0)
        return sagi_params_fail(params, given, "\"indices\" is empty: the mesh has no faces");
    for (size_t i = 0; i < *index_count; i++)
        if (!((*indices)[i] >= 0 && (*indices)[i] < (double)(count / 3)))
            return sagi_params_fail(params, given, "indices[%zu] is %.0f, but there are %zu points", i,
                                    (*indices)[i], count / 3);
    data->vertex_count = (uint32_t)(count / 3);
    data->positions_f64 = sag_allocate(p->context, count * sizeof(double));
    if (!data->positions_f64) return sagi_pbrt_out_of_memory(p);
    memcpy(data->positions_f64, positions, count * sizeof(double));
    sag_status status =
        copy_floats(p, "N", SAGI_TYPE_NORMAL | SAGI_TYPE_VECTOR3, 3, count / 3, &data->normals);
    if (status == SAG_OK)
        status = copy_floats(p, "uv", SAGI_TYPE_POINT2 | SAGI_TYPE_VECTOR2 | SAGI_TYPE_FLOAT, 2, count / 3,
                             &data->texcoords);
    return status;
}

sag_status sagi_pbrt_read_triangles(sagi_pbrt *p, sagi_mesh_data *data) {
    const double *indices;
    size_t count;
    const sag_status status = sagi_pbrt_read_arrays(p, 3, data, &indices, &count);
    if (status != SAG_OK) return status;
    if (count == 0 && !sagi_mesh_data_add(data, 0, 1, 2)) return sagi_pbrt_out_of_memory(p);
    for (size_t i = 0; i < count; i += 3)
        if (!sagi_mesh_data_add(data, (uint32_t)indices[i], (uint32_t)indices[i + 1],
                                (uint32_t)indices[i + 2]))
            return sagi_pbrt_out_of_memory(p);
    return SAG_OK;
}

sag_status sagi_pbrt_trianglemesh(sagi_pbrt *p) {
    sagi_mesh_data data = {.context = p->context};
    const sag_status status = sagi_pbrt_read_triangles(p, &data);
    sagi_pbrt_ignore(p, "S", NULL); // tangents: made from uv
    sagi_pbrt_ignore(p, "faceIndices", NULL);
    if (status != SAG_OK) {
        sagi_mesh_data_clear(&data);
        return status;
    }
    return sagi_pbrt_finish_text_mesh(p, &data);
}

// Levels of subdivision, few enough that the triangles can be counted and held.
static sag_status read_levels(sagi_pbrt *p, uint32_t triangle_count, uint32_t *levels) {
    const int32_t wanted = sagi_params_integer(&p->params, "levels", 3);
    const sagi_param *given = sagi_params_find(&p->params, "levels", ~0u);
    if (p->params.status != SAG_OK) return p->params.status;
    if (wanted < 0) return sagi_params_fail(&p->params, given, "levels %d: it must not be negative", wanted);
    uint64_t triangles = triangle_count;
    for (int32_t i = 0; i < wanted && triangles <= SAGI_MAX_SUBDIVIDED_TRIANGLES; i++) triangles *= 4;
    if (triangles > SAGI_MAX_SUBDIVIDED_TRIANGLES)
        return sagi_params_fail(&p->params, given,
                                "%d levels make more than %llu triangles of the %u there are", wanted,
                                (unsigned long long)SAGI_MAX_SUBDIVIDED_TRIANGLES, triangle_count);
    *levels = (uint32_t)wanted;
    return SAG_OK;
}

sag_status sagi_pbrt_loopsubdiv(sagi_pbrt *p) {
    sagi_mesh_data cage = {.context = p->context}, mesh = cage;
    uint32_t levels = 0, borders = 0;
    sag_status status = sagi_pbrt_read_triangles(p, &cage);
    if (status == SAG_OK) status = read_levels(p, cage.triangle_count, &levels);
    sagi_pbrt_ignore(p, "scheme", NULL); // pbrt has one
    if (status == SAG_OK && (cage.normals || cage.texcoords))
        sagi_pbrt_warn_once(p, p->params.place, "loopsubdiv", "%s: its \"N\" and \"uv\" are not used",
                            p->params.what);
    if (status == SAG_OK && !sagi_loop_subdivide(&cage, levels, &mesh, &borders))
        status = sagi_pbrt_out_of_memory(p);
    sagi_mesh_data_clear(&cage);
    if (status != SAG_OK) return status;
    if (borders)
        sagi_pbrt_warn(p, p->params.place,
                       "%s: %u edges of more than two triangles, or of two that are turned differently, are "
                       "taken for borders",
                       p->params.what, borders);
    return sagi_pbrt_finish_text_mesh(p, &mesh);
}

sag_status sagi_pbrt_polygon(sagi_pbrt *p) {
    sagi_params *params = &p->params;
    size_t count, loop_count;
    const double *positions = sagi_params_numbers(params, "P", SAGI_TYPE_POINT3, 3, &count);
    const double *loops = sagi_params_numbers(params, "loops", SAGI_TYPE_INTEGER, 1, &loop_count);
    if (params->status != SAG_OK) return params->status;
    if (count / 3 > UINT32_MAX || loop_count > UINT32_MAX)
        return sagi_params_fail(params, NULL, "too many points");
    const size_t n = count / 3, loops_used = loop_count ? loop_count : 1;
    double total = 0;
    for (size_t i = 0; i < loop_count; i++) {
        if (!(loops[i] >= 3))
            return sagi_params_fail(params, sagi_params_find(params, "loops", ~0u),
                                    "loops[%zu] is %.0f: a loop has 3 points or more", i, loops[i]);
        total += loops[i];
    }
    if (n == 0) return sagi_params_fail(params, NULL, "its \"point3 P\" is missing or empty");
    if (loop_count && total != (double)n)
        return sagi_params_fail(params, sagi_params_find(params, "loops", ~0u),
                                "the loops have %.0f points, \"P\" has %zu", total, n);
    sag_vec3 *points = sag_allocate(p->context, n * sizeof *points);
    uint32_t *sizes = sag_allocate(p->context, loops_used * sizeof *sizes);
    sag_status status = points && sizes ? SAG_OK : sagi_pbrt_out_of_memory(p);
    if (status == SAG_OK) {
        for (size_t i = 0; i < n; i++)
            points[i] = sag_vec3_make(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
        for (size_t i = 0; i < loops_used; i++) sizes[i] = loop_count ? (uint32_t)loops[i] : (uint32_t)n;
        const sag_polygon polygon = {.positions = points,
                                     .position_count = (uint32_t)n,
                                     .loop_sizes = sizes,
                                     .loop_count = (uint32_t)loops_used};
        sag_error reason = {0};
        if (sag_polygon_validate(&polygon, &reason) != SAG_OK)
            status = sagi_params_fail(params, NULL, "%.380s", reason.message);
        else
            status = sagi_pbrt_add(p, SAG_SHAPE_POLYGON, &polygon,
                                   sag_polygon_area(&polygon) * sagi_pbrt_area_factor(p), &p->state.ctm);
    }
    sag_release(p->context, points, n * sizeof *points);
    sag_release(p->context, sizes, loops_used * sizeof *sizes);
    return status;
}

sag_status sagi_pbrt_spheres(sagi_pbrt *p) {
    sagi_params *params = &p->params;
    size_t count;
    const double *centers = sagi_params_numbers(params, "P", SAGI_TYPE_POINT3, 3, &count);
    if (params->status != SAG_OK) return params->status;
    if (count == 0 || count / 3 > UINT32_MAX)
        return sagi_params_fail(params, NULL, "its \"point3 P\" is missing or empty");
    float *radii = NULL;
    sag_status status = copy_floats(p, "radii", SAGI_TYPE_FLOAT, 1, count / 3, &radii);
    const sag_spheres spheres = {.centers_f64 = centers,
                                 .radii_f32 = radii,
                                 .radius = sagi_params_float(params, "radius", 1),
                                 .count = (uint32_t)(count / 3)};
    sag_error reason = {0};
    if (status == SAG_OK && params->status == SAG_OK && sag_spheres_validate(&spheres, &reason) != SAG_OK)
        status = sagi_params_fail(params, NULL, "%.380s", reason.message);
    uint32_t dropped = 0;
    for (size_t i = 0; i < count / 3; i++) {
        const double *c = &centers[3 * i], radius = radii ? (double)radii[i] : spheres.radius;
        const double largest = fmax(fabs(c[0]), fmax(fabs(c[1]), fabs(c[2])));
        if (!(largest <= SAG_MAX_COORDINATE) || isnan(c[0] + c[1] + c[2]) ||
            !(radius > 0 && radius <= SAG_MAX_COORDINATE))
            dropped++;
    }
    if (dropped && status == SAG_OK)
        sagi_pbrt_warn(p, params->place,
                       "%s: spheres that are not finite or have no positive radius are left out: %u of %u",
                       params->what, dropped, spheres.count);
    if (status == SAG_OK)
        status =
            sagi_pbrt_add(p, SAG_SHAPE_SPHERES, &spheres,
                          p->state.area_light.on ? sag_spheres_area(&spheres) * sagi_pbrt_area_factor(p) : 0,
                          &p->state.ctm);
    sag_release(p->context, radii, count / 3 * sizeof(float));
    return status;
}
