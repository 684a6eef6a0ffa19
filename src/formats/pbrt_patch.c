// SPDX-License-Identifier: MIT
// Bilinear patches of a pbrt scene: each a shape of its own or, where they have normals, which a patch of the
// scene has none of, all together a mesh of triangles with the same normals. Every patch is then cut into a
// grid, so that its normals and its bend are bilinear to where the eye sees it: each cell's error is 1/n² of
// the whole patch's.
#include "formats/pbrt_shape.h"

#include <string.h>

#define FINE_CELLS   8u // a side
#define COARSE_CELLS 2u
#define MANY_PATCHES 2048u

// The value at (u, v) of what has `width` numbers at each of four corners.
static void between(const float *values, const size_t corners[4], size_t width, double u, double v,
                    float *out) {
    const double weights[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    for (size_t i = 0; i < width; i++) {
        double sum = 0;
        for (int k = 0; k < 4; k++) sum += weights[k] * (double)values[width * corners[k] + i];
        out[i] = (float)sum;
    }
}

typedef struct grid {
    const sagi_mesh_data *from;
    sagi_mesh_data *to;
    uint32_t cells, vertex;
} grid;

static bool cut(grid *g, const size_t corners[4]) {
    static const float square[] = {0, 0, 1, 0, 0, 1, 1, 1};
    static const size_t its_corners[4] = {0, 1, 2, 3};
    const sagi_mesh_data *from = g->from;
    const uint32_t n = g->cells, first = g->vertex;
    for (uint32_t j = 0; j <= n; j++)
        for (uint32_t i = 0; i <= n; i++, g->vertex++) {
            const double u = (double)i / n, v = (double)j / n;
            const double weights[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
            double *p = g->to->positions_f64 + 3 * (size_t)g->vertex;
            for (int axis = 0; axis < 3; axis++) {
                p[axis] = 0;
                for (int k = 0; k < 4; k++)
                    p[axis] += weights[k] * from->positions_f64[3 * corners[k] + (size_t)axis];
            }
            between(from->normals, corners, 3, u, v, g->to->normals + 3 * (size_t)g->vertex);
            float *uv = g->to->texcoords + 2 * (size_t)g->vertex;
            if (from->texcoords)
                between(from->texcoords, corners, 2, u, v, uv);
            else
                between(square, its_corners, 2, u, v, uv);
        }
    for (uint32_t j = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t a = first + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            if (!sagi_mesh_data_add(g->to, a, b, d) || !sagi_mesh_data_add(g->to, a, d, c)) return false;
        }
    return true;
}

// The corners of face `face`: p00, p10, p01, p11.
static void corners_of(const double *indices, size_t face, size_t corners[4]) {
    for (size_t k = 0; k < 4; k++) corners[k] = indices ? (size_t)indices[4 * face + k] : k;
}

static sag_status add_mesh(sagi_pbrt *p, const sagi_mesh_data *data, const double *indices, size_t count) {
    sagi_mesh_data mesh = {.context = p->context};
    grid g = {data, &mesh, count > MANY_PATCHES ? COARSE_CELLS : FINE_CELLS, 0};
    const size_t vertices = count * (g.cells + 1) * (g.cells + 1);
    if (vertices > UINT32_MAX) return sagi_params_fail(&p->params, NULL, "too many patches");
    mesh.vertex_count = (uint32_t)vertices;
    mesh.positions_f64 = sag_allocate(p->context, 3 * vertices * sizeof(double));
    mesh.normals = sag_allocate(p->context, 3 * vertices * sizeof(float));
    mesh.texcoords = sag_allocate(p->context, 2 * vertices * sizeof(float));
    bool made = mesh.positions_f64 && mesh.normals && mesh.texcoords;
    for (size_t i = 0; i < count && made; i++) {
        size_t corners[4];
        corners_of(indices, i, corners);
        made = cut(&g, corners);
    }
    if (!made) {
        sagi_mesh_data_clear(&mesh);
        return sagi_pbrt_out_of_memory(p);
    }
    p->in_patches = true;
    const sag_status status = sagi_pbrt_finish_text_mesh(p, &mesh);
    p->in_patches = false;
    return status;
}

// The area by which pbrt-v4 shares a power out: that of nine pieces taken for flat, 0.2 % less than the whole
// where a side is bent by a fifth of its length.
static double area_for_power(const sag_bilinear_patch *patch) {
    enum { PIECES = 3 };
    sag_vec3 p[PIECES + 1][PIECES + 1];
    double area = 0;
    for (int i = 0; i <= PIECES; i++)
        for (int j = 0; j <= PIECES; j++) {
            const double u = (double)i / PIECES, v = (double)j / PIECES;
            const sag_vec3 low = sag_madd(patch->p00, u, sag_sub(patch->p10, patch->p00)),
                           high = sag_madd(patch->p01, u, sag_sub(patch->p11, patch->p01));
            p[i][j] = sag_madd(low, v, sag_sub(high, low));
        }
    for (int i = 0; i < PIECES; i++)
        for (int j = 0; j < PIECES; j++)
            area += 0.5 * sag_length(sag_cross(sag_sub(p[i + 1][j + 1], p[i][j]),
                                               sag_sub(p[i + 1][j], p[i][j + 1])));
    return area;
}

static sag_status add_patch(sagi_pbrt *p, const sagi_mesh_data *data, const double *indices, size_t face) {
    size_t corners[4];
    sag_vec3 points[4], placed[4];
    float uv[4][2];
    corners_of(indices, face, corners);
    for (size_t k = 0; k < 4; k++) {
        const double *q = data->positions_f64 + 3 * corners[k];
        points[k] = sag_vec3_make(q[0], q[1], q[2]);
        placed[k] = sag_affine_point(&p->state.ctm, points[k]);
        if (data->texcoords) memcpy(uv[k], data->texcoords + 2 * corners[k], sizeof uv[k]);
    }
    const sag_bilinear_patch patch = {points[0], points[1], points[2], points[3]};
    sag_error reason = {0};
    if (sag_bilinear_patch_validate(&patch, &reason) != SAG_OK) {
        sagi_pbrt_warn_once(p, p->params.place, "bilinearmesh patch",
                            "Shape \"bilinearmesh\": patch %zu is left out: %.300s", face, reason.message);
        return SAG_OK;
    }
    const sag_bilinear_patch there = {placed[0], placed[1], placed[2], placed[3]};
    p->corner_uv = data->texcoords ? &uv[0] : NULL;
    const sag_status status =
        sagi_pbrt_add(p, SAG_SHAPE_BILINEAR_PATCH, &patch,
                      p->state.area_light.on ? area_for_power(&there) : 0, &p->state.ctm);
    p->corner_uv = NULL;
    return status;
}

sag_status sagi_pbrt_bilinearmesh(sagi_pbrt *p) {
    sagi_mesh_data data = {.context = p->context};
    const double *indices;
    size_t count;
    sag_status status = sagi_pbrt_read_arrays(p, 4, &data, &indices, &count);
    sagi_pbrt_ignore(p, "emissionfilename", NULL); // says only where pbrt samples the light
    sagi_pbrt_ignore(p, "faceIndices", NULL);
    if (count == 0) indices = NULL;
    const size_t faces = count ? count / 4 : 1;
    // A light that is given by its power gives that to each patch, not to its triangles; a solid wants
    // patches no more than meshes.
    const bool whole = !data.normals || (p->state.area_light.on && p->state.area_light.power > 0);
    if (status == SAG_OK && whole && data.normals)
        sagi_pbrt_warn_once(
            p, p->params.place, "bilinearmesh",
            "Shape \"bilinearmesh\": \"N\" is not supported where it shines with a \"power\"");
    if (status == SAG_OK && !whole) status = add_mesh(p, &data, indices, faces);
    for (size_t i = 0; status == SAG_OK && whole && i < faces; i++) status = add_patch(p, &data, indices, i);
    sagi_mesh_data_clear(&data);
    return status;
}
