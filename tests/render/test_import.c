// SPDX-License-Identifier: MIT
// Models that come without a scene: read whole and in order, staged so that the camera sees them; files that
// are not what their name says, cut short or noise are an error that names them, soon, with little memory.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sagitta/render.h>

#include "render/world.h"
#include "support/guarded_memory.h"

// Assimp 5.2 loses some kilobytes when it refuses a damaged file: not ours to mend, and not to hide our own
// leaks.
__attribute__((visibility("default"))) const char *__lsan_default_suppressions(void); // NOLINT: its name
const char *__lsan_default_suppressions(void) { return "leak:libassimp\n"; }

static char folder[64];
static sag_context *context;

static int setup(void **state) {
    (void)state;
    strcpy(folder, "/tmp/sagitta-import-XXXXXX");
    const sag_context_options options = {.thread_count = 1, .allocator = guarded_if_asked()};
    context = sag_context_create(&options);
    return mkdtemp(folder) && context ? 0 : 1;
}

static int teardown(void **state) {
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    sag_context_destroy(context);
    return system(command);
}

static const char *in_folder(const char *name) {
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_file(const char *name, const void *bytes, size_t size) {
    FILE *file = fopen(in_folder(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

// What the listener hears.
typedef struct heard {
    int meshes;
    uint32_t triangles, vertices;
    double first_x[8]; // of each triangle's first vertex
} heard;

static void on_mesh(void *user, const char *name, const sag_mesh *mesh) {
    heard *h = user;
    assert_non_null(name);
    for (uint32_t i = 0; i < mesh->triangle_count && h->triangles + i < 8; i++)
        h->first_x[h->triangles + i] = (double)mesh->positions_f32[3 * mesh->triangles[3 * i]];
    h->meshes++;
    h->triangles += mesh->triangle_count;
    h->vertices += mesh->vertex_count;
}

static const char obj[] = "# two triangles, a quad and one without area\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 "
                          "0\nv 3 0 0\nv 3 1 0\nv 2 1 0\n"
                          "f 1 2 3\nf 4 5 6 7\nf 2 3 1\nf 1 1 2\n";

static void test_order_and_number(void **state) {
    (void)state;
    write_file("a.obj", obj, sizeof obj - 1);
    sag_world *world = sag_world_create(context);
    heard h = {0};
    sag_error error;
    if (sag_world_load_geometry(world, in_folder("a.obj"), on_mesh, &h, &error) != SAG_OK)
        fail_msg("%s", error.message);
    assert_int_equal(h.meshes, 1);
    assert_int_equal(h.triangles, 5); // also the doubled one and the one without area
    assert_true(h.first_x[0] == 0 && h.first_x[1] >= 2 && h.first_x[2] >= 2 && h.first_x[3] == 1 &&
                h.first_x[4] == 0);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
    sag_scene_stats stats;
    sag_scene_get_stats(sag_world_scene(world), &stats);
    assert_true(stats.dropped_degenerate == 1 && stats.primitive_count == 4);
    sag_world_destroy(world);
}

// All eight corners of the bounds are within the picture, and there is ground and light.
static void test_stage(void **state) {
    (void)state;
    static const char box[] =
        "v 10 20 30\nv 16 20 30\nv 16 21 30\nv 10 20 32\nv 16 21 32\nf 1 2 3\nf 1 4 5\n";
    write_file("box.obj", box, sizeof box - 1);
    sag_world *world = sag_world_create(context);
    sag_error error;
    if (sag_world_load(world, in_folder("box.obj"), &error) != SAG_OK) fail_msg("%s", error.message);
    const sag_camera *camera = &sag_world_settings(world)->camera;
    sag_affine to_camera;
    assert_true(sag_affine_inverse(&camera->to_world, &to_camera));
    for (int i = 0; i < 8; i++) {
        const sag_vec3 corner = {i & 1 ? 16 : 10, i & 2 ? 21 : 20, i & 4 ? 32 : 30};
        const sag_vec3 p = sag_affine_point(&to_camera, corner);
        assert_true(p.z > 0 && fabs(p.x) < p.z * tan(camera->fov_rad / 2) &&
                    fabs(p.y) < p.z * tan(camera->fov_rad / 2));
    }
    assert_int_equal(sag_scene_commit(sag_world_scene(world), &error), SAG_OK);
    const sag_ray down = sag_ray_make(sag_vec3_make(1000, 100, 1000), sag_vec3_make(0, -1, 0));
    assert_true(sag_occluded(sag_world_scene(world), &down));
    sag_world_destroy(world);
}

// A model that its file turns by 45° still touches the ground: bounds are those of the turned triangles, not
// of the turned box.
static void test_turned_model_stands_on_the_ground(void **state) {
    (void)state;
    static const char turned[] =
        "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
        "version=\"1.4.1\"><asset><up_axis>Y_UP"
        "</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array "
        "id=\"a\" "
        "count=\"9\">0 1 0 0 -1 0 0 0 1</float_array><technique_common><accessor source=\"#a\" count=\"3\" "
        "stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" "
        "type=\"float\"/></accessor></technique_common></source><vertices id=\"v\"><input "
        "semantic=\"POSITION\" "
        "source=\"#p\"/></vertices><triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" "
        "offset=\"0\"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
        "<visual_scene id=\"s\"><node><rotate>1 0 0 45</rotate><instance_geometry url=\"#g\"/></node>"
        "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
    write_file("turned.dae", turned, sizeof turned - 1);
    sag_world *world = sag_world_create(context);
    sag_error error;
    if (sag_world_load(world, in_folder("turned.dae"), &error) != SAG_OK) fail_msg("%s", error.message);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), &error), SAG_OK);
    sag_hit hit;
    const sag_ray down = sag_ray_make(sag_vec3_make(1000, 0, 1000), sag_vec3_make(0, -1, 0));
    assert_true(sag_intersect(sag_world_scene(world), &down, &hit));
    assert_true(fabs(hit.t - sqrt(0.5)) < 0.001); // the box's corner would be √2 below
    sag_world_destroy(world);
}

static const char gltf[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":["
    "0,1]}],"
    "\"nodes\":[{\"mesh\":0,\"translation\":[0,0,5]},{\"mesh\":0,\"translation\":[0,0,9]}],"
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
    "\"buffers\":[{\"byteLength\":44,\"uri\":\"data:application/octet-stream;base64,"
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=\"}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":6}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],"
    "\"max\":[1,1,0]},"
    "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}]}";

// A mesh that two nodes show is there once and stands twice.
static void test_instances(void **state) {
    (void)state;
    write_file("a.gltf", gltf, sizeof gltf - 1);
    sag_world *world = sag_world_create(context);
    heard h = {0};
    sag_error error;
    if (sag_world_load_geometry(world, in_folder("a.gltf"), on_mesh, &h, &error) != SAG_OK)
        fail_msg("%s", error.message);
    assert_int_equal(h.meshes, 1);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
    const sag_ray ray = sag_ray_make(sag_vec3_make(0.25, 0.25, 0), sag_vec3_make(0, 0, 1));
    sag_hit hits[2];
    assert_int_equal(sag_intersect_all(sag_world_scene(world), &ray, hits, 2), 2);
    assert_true(hits[0].t == 5 && hits[1].t == 9);
    assert_true(hits[0].instance_depth == 1 && hits[1].instance_depth == 1);
    sag_world_destroy(world);
}

static void fails(const char *name, const void *bytes, size_t size, const char *what) {
    write_file(name, bytes, size);
    sag_world *world = sag_world_create(context);
    sag_error error = {0};
    if (sag_world_load_geometry(world, in_folder(name), NULL, NULL, &error) == SAG_OK)
        fail_msg("%s was read", name);
    if (!strstr(error.message, what) || !strstr(error.file, name))
        fail_msg("%s: %s", error.file, error.message);
    sag_world_destroy(world);
}

static void test_foreign_files(void **state) {
    (void)state;
    uint8_t noise[4096];
    uint32_t random = 7;
    for (size_t i = 0; i < sizeof noise; i++) {
        random = random * 1664525u + 1013904223u;
        noise[i] = (uint8_t)(random >> 24);
    }
    static const char *const endings[] = {"n.obj", "n.off", "n.stl", "n.gltf", "n.glb",
                                          "n.fbx", "n.dae", "n.3ds", "n.3mf",  "n.blend"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        fails(endings[i], noise, sizeof noise, "not that of");
    fails("n.ply", noise, sizeof noise, "not a PLY file");
    fails("n.pbrt", noise, sizeof noise, "");
    fails("n.what", noise, sizeof noise, "unknown kind of scene");
    fails("none", noise, sizeof noise, "unknown kind of scene");
    fails("e.obj", "", 0, "empty");
    fails("e.ply", "", 0, "not a PLY file");
    fails("p.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n", 32, "no triangles");
    sag_world *world = sag_world_create(context);
    sag_error error;
    assert_int_equal(sag_world_load(world, in_folder("missing.obj"), &error), SAG_ERROR_IO);
    assert_non_null(strstr(error.message, "No such file"));
    assert_int_equal(sag_world_load(world, "", &error), SAG_ERROR_ARGUMENT);
    sag_world_destroy(world);
}

// Files cut anywhere are read or refused; Assimp must not fall over them.
static void test_truncated_files(void **state) {
    (void)state;
    static const char stl[] = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 "
                              "1 0\nendloop\nendfacet\nendsolid a\n";
    const struct {
        const char *name, *text;
        size_t size;
    } files[] = {
        {"t.obj", obj, sizeof obj - 1}, {"t.gltf", gltf, sizeof gltf - 1}, {"t.stl", stl, sizeof stl - 1}};
    for (size_t f = 0; f < 3; f++) {
        for (size_t cut = 0; cut < files[f].size; cut += 7) {
            write_file(files[f].name, files[f].text, cut);
            sag_world *world = sag_world_create(context);
            sag_error error = {0};
            if (sag_world_load(world, in_folder(files[f].name), &error) != SAG_OK)
                assert_true(error.message[0] != 0);
            sag_world_destroy(world);
        }
    }
}

// A model of a nanometre has its size: vertices are joined when they are the same, never because they are
// near.
static void test_small_models_keep_their_vertices(void **state) {
    (void)state;
    static const char small[] = "v 0 0 0\nv 1e-9 0 0\nv 1e-9 1e-9 0\nv 0 1e-9 0\nf 1 2 3\nf 1 3 4\n";
    write_file("small.obj", small, sizeof small - 1);
    sag_world *world = sag_world_create(context);
    heard h = {0};
    sag_error error;
    if (sag_world_load_geometry(world, in_folder("small.obj"), on_mesh, &h, &error) != SAG_OK)
        fail_msg("%s", error.message);
    assert_true(h.triangles == 2 && h.vertices == 4);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
    const sag_ray ray = sag_ray_make(sag_vec3_make(0.5e-9, 0.25e-9, -1), sag_vec3_make(0, 0, 1));
    assert_true(sag_occluded(sag_world_scene(world), &ray));
    sag_world_destroy(world);
}

// Each of these made Assimp or the reading of what it gives fall over: a node without children where one is
// counted (RAW), room for more vertices than a file has bytes (OFF), a solid without triangles (STL), faces
// without corners (OFF); text in UTF-16 came out as nothing.
static void test_what_the_importer_trips_over(void **state) {
    (void)state;
    static const char raw[] = "Name\n0.5 0.5 0.5 0 0 0 0 1 0 1 0 0\n";
    static const char stl[] = "solid a\nendsolid a\nsolid b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                              "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid b\n";
    const struct {
        const char *name, *text;
        size_t size;
    } files[] = {{"w.raw", raw, sizeof raw - 1}, {"w.stl", stl, sizeof stl - 1}};
    for (size_t f = 0; f < 2; f++) {
        write_file(files[f].name, files[f].text, files[f].size);
        sag_world *world = sag_world_create(context);
        heard h = {0};
        sag_error error;
        if (sag_world_load_geometry(world, in_folder(files[f].name), on_mesh, &h, &error) != SAG_OK)
            fail_msg("%s: %s", files[f].name, error.message);
        assert_int_equal(h.triangles, 1);
        sag_world_destroy(world);
    }
    static const char off[] = "OFF\n# 1\n353535235358 6 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    fails("w.off", off, sizeof off - 1, "not that of");
    static const char faces[] = "OFF\n3 99999 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    fails("w.off", faces, sizeof faces - 1, "not that of");
    // Faces without corners, beside triangles and beside what is to be cut.
    static const char empty[] = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n0\n";
    static const char quad[] = "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n0\n0\n";
    for (size_t f = 0; f < 2; f++) {
        write_file("e.off", f ? quad : empty, f ? sizeof quad - 1 : sizeof empty - 1);
        for (int only = 0; only < 2; only++) {
            sag_world *world = sag_world_create(context);
            sag_error error;
            const sag_status status =
                only ? sag_world_load_geometry(world, in_folder("e.off"), NULL, NULL, &error)
                     : sag_world_load(world, in_folder("e.off"), &error);
            if (status != SAG_OK) fail_msg("%s", error.message);
            sag_world_destroy(world);
        }
    }
    fails("w.obj",
          "\xff\xfev\0 \0"
          "0\0",
          8, "UTF-16");
}

// How much the process has read so far, where the system tells; else 0.
static double bytes_read(void) {
    double bytes = 0;
    FILE *file = fopen("/proc/self/io", "r");
    if (file && fscanf(file, "rchar: %lf", &bytes) != 1) bytes = 0;
    if (file) fclose(file);
    return bytes;
}

// A gigabyte of nothing (a sparse file) under every name: an error, without reading it.
static void test_huge_files(void **state) {
    (void)state;
    static const char *const names[] = {"h.obj", "h.stl", "h.gltf", "h.fbx", "h.ply", "h.pbrt"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        write_file(names[i], "\x01\x02\x03", 3);
        assert_int_equal(truncate(in_folder(names[i]), 1 << 30), 0);
        size_t before, peak;
        sag_context_memory(context, &before, NULL);
        const double start = bytes_read();
        sag_world *world = sag_world_create(context);
        sag_error error;
        assert_int_equal(sag_world_load(world, in_folder(names[i]), &error), SAG_ERROR_FORMAT);
        sag_world_destroy(world);
        assert_true(bytes_read() - start < 0x1p26);
        sag_context_memory(context, NULL, &peak);
        assert_true(peak < (size_t)64 << 20);
        unlink(in_folder(names[i]));
    }
}

static void test_shared_meshes(void **state) {
    (void)state;
    static const struct {
        const char *name;
        uint32_t triangles;
    } meshes[] = {{"dragon.ply", 871414},  {"stanford-bunny.obj", 69451}, {"teapot.obj", 6320},
                  {"spot.obj", 5856},      {"suzanne.obj", 968},          {"fandisk.obj", 12946},
                  {"nefertiti.obj", 99938}};
    const char *data = getenv("SAGITTA_DATA");
    char path[512];
    snprintf(path, sizeof path, "%s/meshes/dragon.ply", data ? data : "../shared");
    if (access(path, R_OK) != 0) {
        print_message("SAGITTA_DATA is not there: skipped\n");
        skip();
    }
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
        snprintf(path, sizeof path, "%s/meshes/%s", data ? data : "../shared", meshes[i].name);
        sag_world *world = sag_world_create(context);
        heard h = {.triangles = 0};
        sag_error error;
        if (sag_world_load_geometry(world, path, on_mesh, &h, &error) != SAG_OK)
            fail_msg("%s: %s", path, error.message);
        // suzanne's quads: 968 triangles after cutting them
        if (h.triangles != meshes[i].triangles) fail_msg("%s: %u triangles", path, h.triangles);
        sag_world_destroy(world);
    }
}

// ---- materials

#define PIXEL                                                                                                \
    "data:image/"                                                                                            \
    "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4nGP432DsAAAGJwHz++"                  \
    "tttAAAAABJRU5ErkJggg=="

static const sagi_material *material_of(const sag_world *world, uint32_t geometry_user_data,
                                        const sagi_appearance **look) {
    const sagi_appearance *looks = world->appearances.items;
    *look = &looks[geometry_user_data];
    return (const sagi_material *)world->materials.items + ((*look)->look.material - 1);
}

// Loads a glTF triangle with this material.
static sag_world *with_gltf_material(const char *material) {
    static char text[8192];
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_materials_transmission\",\"KHR_"
             "materials_ior\",\"KHR_materials_unlit\"],\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{"
             "\"mesh\":0}],\"images\":[{\"uri\":\"" PIXEL
             "\"}],\"textures\":[{\"source\":0}],\"materials\":[%s],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0}]}]"
             ",%s",
             material, strstr(gltf, "\"buffers\""));
    write_file("m.gltf", text, strlen(text));
    sag_world *world = sag_world_create(context);
    sag_error error;
    if (sag_world_load(world, in_folder("m.gltf"), &error) != SAG_OK) fail_msg("%s", error.message);
    return world;
}

static double number_at(const sag_world *world, const sag_input *input) {
    return sagi_input_number(world, input, &(sagi_spot){.u = 0.5, .v = 0.5});
}

static void test_gltf_materials(void **state) {
    (void)state;
    const sagi_appearance *look;
    sag_world *world = with_gltf_material(
        "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.4,0.2,1],\"metallicFactor\":1,"
        "\"roughnessFactor\":0.5}}");
    const sagi_material *m = material_of(world, 0, &look);
    assert_int_equal(m->material.kind, SAG_MATERIAL_CONDUCTOR);
    assert_true(fabs(m->material.roughness_u.value.r - 0.25) < 1e-6);
    assert_true(fabs(m->material.reflectance.value.g - 0.4) < 1e-6 && look->look.alpha.texture == 0);
    sag_world_destroy(world);

    world =
        with_gltf_material("{\"pbrMetallicRoughness\":{\"metallicFactor\":1,\"roughnessFactor\":0.5,"
                           "\"metallicRoughnessTexture\":{\"index\":0},\"baseColorTexture\":{\"index\":0}},"
                           "\"normalTexture\":{\"index\":0},\"alphaMode\":\"BLEND\",\"extensions\":{"
                           "\"KHR_materials_emissive_strength\":{\"emissiveStrength\":10}},"
                           "\"emissiveFactor\":[1,0.5,0],\"emissiveTexture\":{\"index\":0}}");
    m = material_of(world, 0, &look);
    assert_int_equal(m->material.kind, SAG_MATERIAL_MIX);
    assert_true(fabs(number_at(world, &m->material.amount) - 0.2) < 1e-3);
    const sagi_material *all = world->materials.items;
    const sagi_material *base = &all[m->material.materials[0] - 1],
                        *metal = &all[m->material.materials[1] - 1];
    assert_int_equal(base->material.kind, SAG_MATERIAL_COATED_DIFFUSE);
    assert_int_equal(metal->material.kind, SAG_MATERIAL_CONDUCTOR);
    assert_true(base->material.normal_map != 0 && metal->material.reflectance.texture != 0);
    const double alpha = 128.0 / 255 * 0.5;
    assert_true(fabs(number_at(world, &metal->material.roughness_u) - alpha * alpha) < 1e-3);
    assert_true(fabs(number_at(world, &look->look.alpha) - 64.0 / 255) < 1e-3);
    assert_true(look->look.emission.r == 10 && look->look.emission.g == 5 &&
                look->look.emission_texture != 0);
    sag_world_destroy(world);

    world = with_gltf_material("{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":"
                               "{\"index\":0}},\"alphaMode\":\"MASK\",\"alphaCutoff\":0.5}");
    m = material_of(world, 0, &look);
    assert_int_equal(m->material.kind, SAG_MATERIAL_COATED_DIFFUSE);
    assert_true(look->look.alpha.texture != 0 && number_at(world, &look->look.alpha) == 0);
    sag_world_destroy(world);

    world = with_gltf_material("{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0},"
                               "\"extensions\":{\"KHR_materials_ior\":{\"ior\":1.25},"
                               "\"KHR_materials_transmission\":{\"transmissionFactor\":1}}}");
    m = material_of(world, 0, &look);
    if (m->material.kind != SAG_MATERIAL_DIELECTRIC)
        print_message("this Assimp does not tell of transmission\n");
    else
        assert_true(m->material.eta.value.r == 1.25);
    sag_world_destroy(world);

    world = with_gltf_material(
        "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,1,1],"
        "\"baseColorTexture\":{\"index\":0}},\"extensions\":{\"KHR_materials_unlit\":{}}}");
    m = material_of(world, 0, &look);
    assert_int_equal(m->material.kind, SAG_MATERIAL_DIFFUSE);
    assert_true(look->look.emission.r == 0.5 && look->look.emission.b == 1 && look->look.two_sided);
    assert_true(look->look.emission_texture != 0 && m->material.reflectance.value.r == 0);
    sag_world_destroy(world);
}

static void test_mtl_materials(void **state) {
    (void)state;
    static const char mtl[] = "newmtl matt\nKd 0.2 0.4 0.6\nKs 0 0 0\nNs 0\n"
                              "newmtl shiny\nKd 0.2 0.4 0.6\nKs 0.5 0.5 0.5\nNs 98\n"
                              "newmtl metal\nKd 0 0 0\nKs 0.9 0.8 0.3\nNs 200\n"
                              "newmtl glass\nKd 1 1 1\nd 0.1\nNi 1.4\n"
                              "newmtl veil\nKd 1 1 1\nd 0.75\n"
                              "newmtl lamp\nKd 0 0 0\nKe 3 2 1\n";
    static const char model[] =
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl matt\nf 1 2 3\nusemtl shiny\nf 1 2 3\n"
        "usemtl metal\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl veil\nf 1 2 3\nusemtl lamp\nf 1 2 3\n";
    write_file("m.mtl", mtl, sizeof mtl - 1);
    write_file("m.obj", model, sizeof model - 1);
    sag_world *world = sag_world_create(context);
    sag_error error;
    if (sag_world_load(world, in_folder("m.obj"), &error) != SAG_OK) fail_msg("%s", error.message);
    static const sag_material_kind kinds[] = {SAG_MATERIAL_DIFFUSE,   SAG_MATERIAL_COATED_DIFFUSE,
                                              SAG_MATERIAL_CONDUCTOR, SAG_MATERIAL_DIELECTRIC,
                                              SAG_MATERIAL_DIFFUSE,   SAG_MATERIAL_DIFFUSE};
    const sagi_appearance *look;
    for (uint32_t i = 0; i < 6; i++)
        if (material_of(world, i, &look)->material.kind != kinds[i]) fail_msg("material %u", i);
    assert_true(fabs(material_of(world, 1, &look)->material.roughness_u.value.r - sqrt(0.02)) < 1e-6);
    assert_true(fabs(material_of(world, 2, &look)->material.reflectance.value.g - 0.8) < 1e-6);
    assert_true(fabs(material_of(world, 3, &look)->material.eta.value.r - 1.4) < 1e-6);
    material_of(world, 4, &look);
    assert_true(look->look.alpha.texture != 0 && fabs(number_at(world, &look->look.alpha) - 0.75) < 1e-6);
    material_of(world, 5, &look);
    assert_true(look->look.emission.r == 3 && look->look.emission.b == 1);
    sag_world_destroy(world);
}

// A slope to the right makes the normal lean to the left, one that rises up the picture, down; "norm" is
// taken as it is; map_d is alpha.
static void test_mtl_pictures(void **state) {
    (void)state;
    sag_image heights;
    assert_int_equal(sag_image_create(context, 64, 32, 3, &heights, NULL), SAG_OK);
    for (uint32_t y = 0; y < 32; y++)
        for (uint32_t x = 0; x < 64; x++)
            for (uint32_t k = 0; k < 3; k++)
                heights.pixels[(y * 64 + x) * 3 + k] =
                    y < 16 ? (float)(x < 32 ? x : 64 - x) / 64 : (float)(y - 16) / 32;
    assert_int_equal(sag_image_write(context, &heights, in_folder("bump.pfm"), NULL), SAG_OK);
    sag_image_clear(context, &heights);
    static const char mtl[] = "newmtl bumpy\nKd 0.5 0.5 0.5\nmap_bump -bm 2 bump.pfm\n"
                              "newmtl mapped\nKd 0.5 0.5 0.5\nnorm bump.pfm\nmap_d bump.pfm\n";
    static const char model[] = "mtllib p.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                "usemtl bumpy\nf 1/1 2/2 3/3\nusemtl mapped\nf 1/1 2/2 3/3\n";
    write_file("p.mtl", mtl, sizeof mtl - 1);
    write_file("p.obj", model, sizeof model - 1);
    sag_world *world = sag_world_create(context);
    sag_error error;
    if (sag_world_load(world, in_folder("p.obj"), &error) != SAG_OK) fail_msg("%s", error.message);
    const sagi_appearance *look;
    const sag_picture_id bumps = material_of(world, 0, &look)->material.normal_map;
    assert_true(bumps != 0 && look->look.alpha.texture == 0);
    const sag_texture show = {.kind = SAG_TEXTURE_IMAGE, .picture = bumps};
    const sag_input input = {.texture = sag_world_add_texture(world, &show)};
    sagi_spot at = {.u = 0.25, .v = 0.75, .normal = {0, 0, 1}};
    // Heights of 1/64 a texel by 64 texels, a hundredth, doubled: a slope of 0.02.
    sag_rgb n = sagi_input_rgb(world, &input, &at);
    assert_true(fabs((n.r * 2 - 1) + 0.02) < 2e-3 && fabs(n.g * 2 - 1) < 2e-3 && n.b > 0.999);
    at.u = 0.75;
    n = sagi_input_rgb(world, &input, &at);
    assert_true(fabs((n.r * 2 - 1) - 0.02) < 2e-3);
    at.v = 0.25; // down the picture by 1/32 a texel: falling upward
    n = sagi_input_rgb(world, &input, &at);
    assert_true(fabs(n.r * 2 - 1) < 2e-3 && fabs((n.g * 2 - 1) - 0.04) < 3e-3);
    assert_true(material_of(world, 1, &look)->material.normal_map != 0 && look->look.alpha.texture != 0);
    sag_world_destroy(world);
}

// Every model that Debian's assimp-testmodels has loads or says why not, and renders.
static void test_foreign_models(void **state) {
    (void)state;
    static const char *const models[] = {
        "OBJ/spider.obj",
        "OBJ/box_mat_with_spaces.obj",
        "OBJ/cube_with_vertexcolors.obj",
        "OBJ/regr_3429812.obj",
        "OBJ/space_in_material_name.obj",
        "glTF2/BoxTextured-glTF/BoxTextured.gltf",
        "glTF2/BoxTextured-glTF-Binary/BoxTextured.glb",
        "glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf",
        "glTF2/BoxTextured-glTF-pbrSpecularGlossiness/BoxTextured.gltf",
        "glTF2/ClearCoat-glTF/ClearCoatTest.gltf",
        "glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb",
        "glTF2/textureTransform/TextureTransformTest.gltf",
        "glTF2/simple_skin/simple_skin.gltf",
    };
    const char *const folder_of_models = "/usr/share/assimp/models/";
    int found = 0;
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s%s", folder_of_models, models[i]);
        if (access(path, R_OK) != 0) continue;
        found++;
        sag_world *world = sag_world_create(context);
        sag_error error;
        if (sag_world_load(world, path, &error) != SAG_OK) fail_msg("%s", error.message);
        sag_settings *settings = sag_world_settings(world);
        settings->film.width = settings->film.height = 16;
        settings->samples_per_pixel = 2;
        sag_render *render = sag_render_create(world, &error);
        if (!render) fail_msg("%s: %s", path, error.message);
        assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
        sag_render_stats stats;
        sag_render_get_stats(render, &stats);
        assert_int_equal(stats.bad_samples, 0);
        sag_render_destroy(render);
        sag_world_destroy(world);
    }
    if (!found) {
        print_message("assimp-testmodels is not installed\n");
        skip();
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order_and_number),
        cmocka_unit_test(test_stage),
        cmocka_unit_test(test_turned_model_stands_on_the_ground),
        cmocka_unit_test(test_what_the_importer_trips_over),
        cmocka_unit_test(test_small_models_keep_their_vertices),
        cmocka_unit_test(test_instances),
        cmocka_unit_test(test_gltf_materials),
        cmocka_unit_test(test_mtl_materials),
        cmocka_unit_test(test_mtl_pictures),
        cmocka_unit_test(test_foreign_models),
        cmocka_unit_test(test_foreign_files),
        cmocka_unit_test(test_truncated_files),
        cmocka_unit_test(test_huge_files),
        cmocka_unit_test(test_shared_meshes),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
