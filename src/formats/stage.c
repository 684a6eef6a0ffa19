// SPDX-License-Identifier: MIT
// The stage for a model that comes alone: a ground under it, sky and sun, and a camera that sees all of it
// from a little above, three quarters from the front. For geometry only, nothing of this.
#include "formats/import.h"
#include "math/elementary.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#define RADIANS (3.14159265358979323846 / 180)

static sag_rgb grey(double x) { return (sag_rgb){x, x, x}; }

uint32_t sagi_default_material(sag_world *world) {
    const sag_material material = {.kind = SAG_MATERIAL_COATED_DIFFUSE,
                                   .reflectance = {.value = {0.62, 0.55, 0.47}},
                                   .eta = {.value = {1.5, 1.5, 1.5}},
                                   .roughness_u = {.value = {0.15, 0.15, 0.15}},
                                   .roughness_v = {.value = {0.15, 0.15, 0.15}}};
    return sag_world_add_material(world, &material);
}

// The bounds of a mesh where it is placed; not those of its box's corners, which would leave it hovering
// above the ground. What the scene will drop does not count.
static sag_box3 placed_bounds(const sag_mesh *mesh, const sag_affine *placed) {
    if (sag_affine_is_identity(placed)) return sag_mesh_bounds(mesh);
    sag_box3 box = sag_box3_empty();
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        sag_vec3 p[3];
        for (size_t k = 0; k < 3; k++) {
            const float *from = &mesh->positions_f32[3 * (size_t)mesh->triangles[3 * i + k]];
            p[k] = sag_affine_point(placed, sag_vec3_make(from[0], from[1], from[2]));
        }
        const sag_triangle triangle = {.a = p[0], .b = p[1], .c = p[2]};
        if (sag_triangle_area(&triangle) > 0) box = sag_box3_union(box, sag_triangle_bounds(&triangle));
    }
    return box;
}

sag_status sagi_import_add(sag_world *world, const sagi_load_options *options, sag_scene *scene,
                           sagi_mesh_data *data, const char *name, const sag_appearance *look,
                           const sag_affine *placed, sag_box3 *bounds, sag_error *error) {
    sag_mesh mesh = sagi_mesh_data_view(data);
    const uint32_t dropped = options->on_mesh ? 0 : sagi_mesh_data_not_finite(data);
    if (options->on_mesh) options->on_mesh(options->user, name, &mesh);
    if (dropped)
        sag_context_log(data->context, SAG_LOG_WARNING,
                        "%s: warning: triangles with a vertex that is NaN, infinite or beyond 2^100 are left "
                        "out: %u of %u",
                        name, dropped, data->triangle_count);
    if (!options->geometry_only && !data->normals) {
        data->normals = sag_allocate(data->context, 3 * (size_t)data->vertex_count * sizeof(float));
        if (!data->normals)
            return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for the normals of %s", name);
        sag_mesh_compute_normals(&mesh, data->normals);
        mesh.normals_f32 = data->normals;
    }
    const uint32_t geometry = sag_add_mesh(scene, &mesh);
    if (geometry == SAG_INVALID_ID)
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "the mesh %s cannot be added", name);
    if (!sag_affine_is_identity(placed) && sag_geometry_set_transform(scene, geometry, placed) != SAG_OK)
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "the mesh %s is flattened by a singular transform",
                             name);
    if (bounds) *bounds = sag_box3_union(*bounds, placed_bounds(&mesh, placed));
    return options->geometry_only ? SAG_OK : sag_world_set_appearance(world, scene, geometry, look);
}

// How far from the centre the camera must be, looking along `forward`, for the point to lie within the square
// of the field of view.
static double distance_for(sag_vec3 point, sag_vec3 forward, sag_vec3 right, sag_vec3 up, double tangent) {
    const double side = fmax(fabs(sag_dot(point, right)), fabs(sag_dot(point, up)));
    return side / tangent - sag_dot(point, forward);
}

static void place_camera(sag_camera *camera, const sag_box3 *box) {
    const sag_vec3 center = sag_scale(sag_add(box->min, box->max), 0.5);
    const double turn = 30 * RADIANS, rise = 17 * RADIANS, fov = 32 * RADIANS;
    const sag_vec3 backward = {sagi_sin(turn) * sagi_cos(rise), sagi_sin(rise),
                               sagi_cos(turn) * sagi_cos(rise)},
                   forward = sag_neg(backward);
    const sag_vec3 right = sag_normalize(sag_cross(forward, sag_vec3_make(0, 1, 0))),
                   up = sag_cross(right, forward);
    double distance = 0;
    for (int i = 0; i < 8; i++) {
        const sag_vec3 corner = {i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y,
                                 i & 4 ? box->max.z : box->min.z};
        distance =
            fmax(distance, distance_for(sag_sub(corner, center), forward, right, up, sagi_tan(fov / 2)));
    }
    camera->kind = SAG_CAMERA_PERSPECTIVE;
    camera->fov_rad = fov;
    camera->to_world =
        sag_camera_look_at(sag_madd(center, 1.02 * distance, backward), center, sag_vec3_make(0, 1, 0));
}

// Ground, sky, sun and camera around what is in the world's scene, which nothing has been built of yet: the
// bounds come from the meshes.
static sag_status set_stage(sag_world *world, const char *path, sag_box3 box, sag_error *error) {
    sag_scene *scene = sag_world_scene(world);
    if (sag_box3_is_empty(&box) || !sag_is_finite(box.min) || !sag_is_finite(box.max))
        return sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0, "no triangle in it has an area");
    const double size = sag_max_component(sag_sub(box.max, box.min));
    // A hair below the model, whose flat underside would otherwise lie in the ground.
    const sag_plane ground = {.point = {0, box.min.y - 1e-4 * size, 0}, .normal = {0, 1, 0}};
    const sag_material matt = {.kind = SAG_MATERIAL_DIFFUSE, .reflectance = {.value = grey(0.42)}};
    const sag_light sky = {.kind = SAG_LIGHT_SKY, .color = {0.30, 0.46, 0.80}, .horizon = {0.86, 0.90, 0.95}};
    const sag_light sun = {.kind = SAG_LIGHT_DISTANT, .color = {2.3, 2.1, 1.8}, .from = {-0.25, 1.0, 0.85}};
    const sag_appearance look = {.material = sag_world_add_material(world, &matt)};
    const uint32_t geometry = sag_add_plane(scene, &ground);
    if (!look.material || geometry == SAG_INVALID_ID ||
        sag_world_set_appearance(world, scene, geometry, &look) != SAG_OK ||
        !sag_world_add_light(world, &sky) || !sag_world_add_light(world, &sun))
        return sag_error_set_at(error, SAG_ERROR_MEMORY, path, 0, 0, "out of memory");
    sag_settings *settings = sag_world_settings(world);
    place_camera(&settings->camera, &box);
    settings->sampler = SAG_SAMPLER_ZSOBOL;
    settings->film.filter = SAG_FILTER_GAUSSIAN;
    settings->film.filter_radius_x = settings->film.filter_radius_y = 1.5;
    settings->film.filter_sigma = 0.5;
    settings->samples_per_pixel = 64;
    settings->max_depth = 8;
    settings->regularize = true;
    return SAG_OK;
}

static bool ends_with(const char *path, const char *ending) {
    const size_t length = strlen(path), n = strlen(ending);
    return length > n && strcasecmp(path + length - n, ending) == 0;
}

static sag_status load_ply(sag_world *world, const char *path, const sagi_load_options *options,
                           sag_box3 *bounds, sag_error *error) {
    const sag_affine identity = sag_affine_identity();
    sagi_mesh_data data = {.context = sag_world_context(world)};
    sag_status status = sagi_ply_read(data.context, path, &data, error);
    if (status != SAG_OK) return status;
    const sag_appearance look = {.material = options->geometry_only ? 0 : sagi_default_material(world)};
    status =
        sagi_import_add(world, options, sag_world_scene(world), &data, path, &look, &identity, bounds, error);
    sagi_mesh_data_clear(&data);
    return status;
}

sag_status sagi_import_load(sag_world *world, const char *path, const sagi_load_options *options,
                            sag_error *error) {
    // Machines that print put z up; everybody else here y.
    sag_affine upright = sag_affine_identity();
    if (!options->geometry_only && (ends_with(path, ".stl") || ends_with(path, ".3mf")))
        upright = sag_affine_rotate(-90 * RADIANS, sag_vec3_make(1, 0, 0));
    const bool is_ply = ends_with(path, ".ply") || ends_with(path, ".ply.gz");
    sag_box3 box = sag_box3_empty(), *const bounds = options->geometry_only ? NULL : &box;
    sag_status status = is_ply ? load_ply(world, path, options, bounds, error)
                               : sagi_assimp_load(world, path, options, &upright, bounds, error);
    if (status == SAG_OK && !options->geometry_only) status = set_stage(world, path, box, error);
    return status;
}
