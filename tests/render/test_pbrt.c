// SPDX-License-Identifier: MIT
// pbrt scenes: every directive and every shape is read and stands where it should; what is wrong is told with
// file, line and column; what is not supported is named once; and no text, however broken, crashes the
// reader.
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
#include <zlib.h>

#include <sagitta/render.h>

#include "formats/spectra.h"
#include "render/world.h"
#include "support/failing_allocator.h"

static char folder[64];
static sag_context *context;
static char warnings[16384];
static int warning_count;

static void on_log(void *user, sag_log_level level, const char *message) {
    (void)user, (void)level;
    const size_t length = strlen(warnings);
    snprintf(warnings + length, sizeof warnings - length, "%s\n", message);
    warning_count++;
}

static int setup(void **state) {
    (void)state;
    strcpy(folder, "/tmp/sagitta-pbrt-XXXXXX");
    const sag_context_options options = {.log = on_log, .thread_count = 1};
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
    static char paths[4][256];
    static int next;
    next = (next + 1) % 4;
    snprintf(paths[next], sizeof paths[next], "%s/%s", folder, name);
    return paths[next];
}

static void write_file(const char *name, const void *bytes, size_t size) {
    FILE *file = fopen(in_folder(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

// Loads a text into a new world; the context's memory is watched: a failed load must give everything back.
static sag_status load(const char *text, sag_world **world, sag_error *error) {
    write_file("scene.pbrt", text, strlen(text));
    warnings[0] = '\0';
    warning_count = 0;
    *world = sag_world_create(context);
    memset(error, 0, sizeof *error);
    return sag_world_load(*world, in_folder("scene.pbrt"), error);
}

static sag_world *load_good(const char *text) {
    sag_world *world;
    sag_error error;
    if (load(text, &world, &error) != SAG_OK)
        fail_msg("%s:%d:%d: %s", error.file, error.line, error.column, error.message);
    if (sag_scene_commit(sag_world_scene(world), &error) != SAG_OK) fail_msg("%s", error.message);
    return world;
}

// The text must fail at this place with this in its message.
static void fails(const char *text, int line, int column, const char *what) {
    sag_world *world;
    sag_error error;
    size_t before, after;
    sag_context_memory(context, &before, NULL);
    if (load(text, &world, &error) == SAG_OK) fail_msg("loaded: %s", text);
    if (error.line != line || error.column != column || !strstr(error.message, what))
        fail_msg("%d:%d: %s\nwanted %d:%d: %s\nfor %s", error.line, error.column, error.message, line, column,
                 what, text);
    assert_non_null(strstr(error.file, "scene.pbrt"));
    sag_world_destroy(world);
    sag_context_memory(context, &after, NULL);
    assert_int_equal(before, after);
}

// t of the first hit along a ray of the loaded scene; NAN for a miss.
static double shoot(sag_world *world, double ox, double oy, double oz, double dx, double dy, double dz) {
    const sag_ray ray = sag_ray_make(sag_vec3_make(ox, oy, oz), sag_vec3_make(dx, dy, dz));
    sag_hit hit;
    return sag_intersect(sag_world_scene(world), &ray, &hit) ? hit.t : NAN;
}

static void near_to(double got, double wanted) {
    if (!(fabs(got - wanted) <= 1e-12 * fmax(1, fabs(wanted)))) fail_msg("%.17g, not %.17g", got, wanted);
}

#define W "WorldBegin\n"

static void test_transforms(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double x; // where the unit sphere's centre goes
        double y, z;
    } cases[] = {
        {"Translate 1 2 3", 1, 2, 3},
        {"Translate 1 2 3 Scale 2 2 2 Translate 1 1 1", 3, 4, 5},
        {"Rotate 90 0 0 1 Translate 5 0 0", 0, 5, 0},
        {"Transform [1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1]", 7, 8, 9},
        {"Transform [2 0 0 0  0 2 0 0  0 0 2 0  14 16 18 2]", 7, 8, 9},
        {"Translate 1 0 0 ConcatTransform [1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1]", 8, 8, 9},
        {"Translate 4 4 4 CoordinateSystem \"here\" Identity Translate 1 1 1 CoordSysTransform \"here\"", 4,
         4, 4},
        {"AttributeBegin Translate 9 9 9 AttributeEnd Translate 1 0 0", 1, 0, 0},
        {"TransformBegin Translate 9 9 9 TransformEnd Translate 1 0 0", 1, 0, 0},
        {"LookAt 0 0 0  0 0 1  0 1 0 Translate 0 0 6", 0, 0, 6},
        {"LookAt 0 0 0  1 0 0  0 1 0 Translate 6 0 0", 0, 0, 6}, // x of the world is the camera's z
        {"ActiveTransform EndTime Translate 9 9 9 ActiveTransform All Translate 1 0 0", 1, 0, 0},
        {"ActiveTransform StartTime Translate 2 0 0", 2, 0, 0},
        {"CoordSysTransform \"world\"", 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        snprintf(text, sizeof text, W "%s\nShape \"sphere\" \"float radius\" 0.25", cases[i].text);
        sag_world *world = load_good(text);
        const sag_box3 box = sag_scene_bounds(sag_world_scene(world));
        const double wanted[3] = {cases[i].x, cases[i].y, cases[i].z};
        for (int axis = 0; axis < 3; axis++) {
            const double middle = (sag_component(box.min, axis) + sag_component(box.max, axis)) / 2;
            if (fabs(middle - wanted[axis]) > 1e-9) fail_msg("%s: axis %d: %g", cases[i].text, axis, middle);
        }
        sag_world_destroy(world);
    }
}

static void test_settings(void **state) {
    (void)state;
    sag_world *world = load_good(
        "Film \"rgb\" \"integer xresolution\" 320 \"integer yresolution\" [ 200 ] \"string filename\" "
        "\"a.exr\"\n"
        "Sampler \"halton\" \"integer pixelsamples\" 33 PixelFilter \"box\" \"float xradius\" 1\n"
        "Integrator \"volpath\" \"integer maxdepth\" 9 Accelerator \"bvh\"\n"
        "Option \"bool disablepixeljitter\" true ColorSpace \"srgb\"\n"
        "TransformTimes 0 1\n"
        "LookAt 1 2 -3  1 2 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-2 2 -1 1]" W);
    const sag_settings *s = sag_world_settings(world);
    assert_true(s->film.width == 320 && s->film.height == 200 && s->film.filter == SAG_FILTER_BOX);
    assert_true(s->film.filter_radius_x == 1 && s->film.filter_radius_y == 0.5);
    assert_string_equal(s->film.file, "a.exr");
    assert_true(s->samples_per_pixel == 33 && s->sampler == SAG_SAMPLER_SOBOL && s->max_depth == 9);
    assert_true(s->camera.kind == SAG_CAMERA_ORTHOGRAPHIC && s->camera.screen_window[0] == -2);
    const sag_vec3 eye = sag_affine_point(&s->camera.to_world, sag_vec3_make(0, 0, 0));
    const sag_vec3 ahead = sag_affine_point(&s->camera.to_world, sag_vec3_make(0, 0, 1));
    near_to(eye.x, 1), near_to(eye.z, -3), near_to(ahead.z, -2);
    sag_world_destroy(world);
    world = load_good(W); // pbrt's defaults
    s = sag_world_settings(world);
    assert_true(s->film.width == 1280 && s->film.height == 720 && s->film.filter == SAG_FILTER_GAUSSIAN &&
                s->max_depth == 5);
    near_to(s->camera.fov_rad, 1.5707963267948966);
    sag_world_destroy(world);
    world = load_good("Sampler \"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5 Camera "
                      "\"spherical\" \"string mapping\" "
                      "\"equirectangular\" PixelFilter \"mitchell\" Integrator \"bdpt\"" W);
    s = sag_world_settings(world);
    assert_true(s->samples_per_pixel == 15 && s->sampler == SAG_SAMPLER_STRATIFIED &&
                s->camera.kind == SAG_CAMERA_ENVIRONMENT);
    assert_int_equal(warning_count, 2);
    sag_world_destroy(world);
}

static void test_shapes(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double o[3], d[3], t;
    } cases[] = {
        {"\"sphere\" \"float radius\" 2", {0, 0, -5}, {0, 0, 1}, 3},
        {"\"sphere\" \"float zmin\" -0.5 \"float zmax\" 0.5", {0, 0, -5}, {0, 0, 1}, NAN},
        {"\"sphere\" \"float phimax\" 90", {-5, 0.1, 0}, {1, 0, 0}, 5.9949874371066199},
        {"\"disk\" \"float height\" 1 \"float radius\" 3 \"float innerradius\" 1", {2, 0, 5}, {0, 0, -1}, 4},
        {"\"disk\" \"float radius\" 3 \"float innerradius\" 1", {0.5, 0, 5}, {0, 0, -1}, NAN},
        {"\"cylinder\" \"float radius\" 2 \"float zmin\" 0 \"float zmax\" 1", {-5, 0, 0.5}, {1, 0, 0}, 3},
        {"\"cylinder\" \"bool closed\" true", {0, 0, -5}, {0, 0, 1}, 4},
        {"\"trianglemesh\" \"point3 P\" [0 0 0 2 0 0 0 2 0] \"integer indices\" [0 1 2] \"normal N\" [0 0 1 "
         "0 0 1 0 0 1] \"point2 uv\" [0 0 1 0 0 1]",
         {0.5, 0.5, -1},
         {0, 0, 1},
         1},
        {"\"trianglemesh\" \"point3 P\" [0 0 0 2 0 0 0 2 0]", {0.5, 0.5, -1}, {0, 0, 1}, 1},
        {"\"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]", {0.5, 0.5, -1}, {0, 0, 1}, 1.25},
        {"\"loopsubdiv\" \"integer levels\" 3 \"point3 P\" [0 0 0 2 0 0 0 2 0] \"integer indices\" [0 1 2]",
         {0.5, 0.5, -1},
         {0, 0, 1},
         1},
        {"\"plane\" \"point3 point\" [0 0 2] \"normal normal\" [0 0 1] \"vector3 s\" [1 0 0] \"vector3 t\" "
         "[0 1 0]",
         {0, 0, 5},
         {0, 0, -1},
         3},
        {"\"rectangle\" \"point3 corner\" [-1 -1 1] \"vector3 edgeu\" [2 0 0] \"vector3 edgev\" [0 2 0]",
         {0, 0, 5},
         {0, 0, -1},
         4},
        {"\"polygon\" \"point3 P\" [-2 -2 0 2 -2 0 2 2 0 -2 2 0 -1 -1 0 1 -1 0 0 1 0] \"integer loops\" [4 "
         "3]",
         {0, 0, 5},
         {0, 0, -1},
         NAN},
        {"\"polygon\" \"point3 P\" [-2 -2 0 2 -2 0 2 2 0 -2 2 0 -1 -1 0 1 -1 0 0 1 0] \"integer loops\" [4 "
         "3]",
         {1.5, 0, 5},
         {0, 0, -1},
         5},
        {"\"ellipsoid\" \"vector3 radii\" [1 2 3] \"point3 center\" [0 0 1]", {0, 0, -5}, {0, 0, 1}, 3},
        {"\"cone\" \"float radius\" 1 \"float height\" 2", {-5, 0, 1}, {1, 0, 0}, 4.5},
        {"\"cone\" \"float height\" 2 \"bool closed\" true", {0.1, 0, -5}, {0, 0, 1}, 5},
        {"\"paraboloid\" \"float radius\" 1 \"float zmin\" 0 \"float zmax\" 1",
         {-5, 0, 0.25},
         {1, 0, 0},
         4.5},
        {"\"hyperboloid\" \"point3 p1\" [1 0 -1] \"point3 p2\" [1 0 1]", {-5, 0, 0}, {1, 0, 0}, 4},
        {"\"hyperboloid2\" \"float a\" 1 \"float c\" 1 \"float zmin\" -2 \"float zmax\" 2",
         {0, 0, -5},
         {0, 0, 1},
         4},
        {"\"quadric\" \"float coefficients\" [1 1 1 0 0 0 0 0 0 -1] \"point3 min\" [-2 -2 -2] \"point3 max\" "
         "[2 2 2]",
         {0, 0, -5},
         {0, 0, 1},
         4},
        {"\"box\" \"point3 min\" [-1 -1 -2] \"point3 max\" [1 1 1]", {0.1, 0.1, -5}, {0, 0, 1}, 3},
        {"\"orientedbox\" \"point3 center\" [0 0 1] \"vector3 halfaxes\" [1 0 0 0 1 0 0 0 2]",
         {0.1, 0.1, -5},
         {0, 0, 1},
         4},
        {"\"polyhedron\" \"float planes\" [1 0 0 1 -1 0 0 1 0 1 0 1 0 -1 0 1 0 0 1 1 0 0 -1 3]",
         {0.1, 0.1, -5},
         {0, 0, 1},
         2},
        {"\"capsule\" \"point3 p0\" [0 0 0] \"point3 p1\" [0 0 2] \"float radius\" 0.5",
         {0, 0, -5},
         {0, 0, 1},
         4.5},
        {"\"triangle\" \"point3 P\" [0 0 0 2 0 0 0 2 0]", {0.5, 0.5, -1}, {0, 0, 1}, 1},
        {"\"torus\" \"float majorradius\" 0.7 \"float minorradius\" 0.3", {-5, 0, 0}, {1, 0, 0}, 4},
        {"\"spheres\" \"point3 P\" [0 0 0 0 0 4] \"float radii\" [1 2]", {0, 0, -5}, {0, 0, 1}, 4},
        {"\"spheres\" \"point3 P\" [0 0 0 0 0 4] \"float radius\" 0.5", {0, 0, -5}, {0, 0, 1}, 4.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        snprintf(text, sizeof text, W "Shape %s", cases[i].text);
        sag_world *world = load_good(text);
        const double *o = cases[i].o, *d = cases[i].d, t = shoot(world, o[0], o[1], o[2], d[0], d[1], d[2]);
        if (isnan(cases[i].t) ? !isnan(t) : !(fabs(t - cases[i].t) < 1e-9))
            fail_msg("%s: t = %.17g", cases[i].text, t);
        if (warning_count != (strstr(cases[i].text, "loopsubdiv") ? 1 : 0))
            fail_msg("%s: %s", cases[i].text, warnings);
        sag_world_destroy(world);
    }
    sag_world *world = load_good(W "Shape \"curve\" \"point3 P\" [0 0 0 1 1 1]");
    assert_non_null(strstr(warnings, ":2:1: warning: the shape \"curve\" is not supported"));
    sag_world_destroy(world);
}

// pbrt's parameterisation of pbrt's sphere, and outward normals also where space is mirrored.
static void test_surface(void **state) {
    (void)state;
    sag_world *world =
        load_good(W "Shape \"sphere\" AttributeBegin Scale -1 1 1 Translate 10 0 0 Shape \"sphere\" \n"
                    "Translate 10 0 0 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" "
                    "[0 0 1 0 0 1 0 0 1] AttributeEnd");
    sag_hit hit;
    sag_surface surface;
    sag_ray ray = sag_ray_make(sag_vec3_make(-1, -1, 5), sag_vec3_make(0.6, 0.6, -5));
    assert_true(sag_intersect(sag_world_scene(world), &ray, &hit));
    sag_surface_at(sag_world_scene(world), &ray, &hit, &surface);
    const sag_vec3 q = surface.position;
    double phi = atan2(q.y, q.x);
    if (phi < 0) phi += 2 * 3.14159265358979323846;
    assert_true(fabs(surface.u - phi / (2 * 3.14159265358979323846)) < 1e-12);
    assert_true(fabs(surface.v - (acos(q.z) - 3.14159265358979323846) / -3.14159265358979323846) < 1e-12);
    ray = sag_ray_make(sag_vec3_make(-10, 0, 5), sag_vec3_make(0, 0, -1));
    assert_true(sag_intersect(sag_world_scene(world), &ray, &hit));
    sag_surface_at(sag_world_scene(world), &ray, &hit, &surface);
    assert_true(surface.geometric_normal.z > 0.999 && surface.side == SAG_SIDE_FRONT);
    ray = sag_ray_make(sag_vec3_make(-20.25, 0.25, 5), sag_vec3_make(0, 0, -1));
    assert_true(sag_intersect(sag_world_scene(world), &ray, &hit));
    sag_surface_at(sag_world_scene(world), &ray, &hit, &surface);
    assert_true(surface.geometric_normal.z > 0.999 && surface.shading_normal.z > 0.999);
    sag_world_destroy(world);
}

static void test_objects_and_attributes(void **state) {
    (void)state;
    sag_world *world =
        load_good(W "Attribute \"shape\" \"float radius\" 0.5\n"
                    "AttributeBegin Attribute \"shape\" \"float radius\" 2 Translate 0 0 10 Shape \"sphere\" "
                    "AttributeEnd\n"
                    "ObjectBegin \"o\" Translate 0 1 0 Shape \"sphere\" ObjectEnd\n"
                    "Translate 0 0 -10 ObjectInstance \"o\" Translate 0 0 -10 ObjectInstance \"o\"\n"
                    "Shape \"sphere\" \"float radius\" 3 Shape \"disk\"");
    assert_int_equal(warning_count, 0);
    near_to(shoot(world, 0, 0, 20, 0, 0, -1), 8);            // radius 2
    near_to(shoot(world, 5, 1, -10, -1, 0, 0), 4.5);         // an instance
    near_to(shoot(world, 5, 1, -20, -1, 0, 0), 5 - sqrt(8)); // the sphere of radius 3 around it
    sag_world_destroy(world);
}

static void test_lights_and_materials(void **state) {
    (void)state;
    sag_world *world = load_good(
        W "LightSource \"point\" \"rgb I\" [1 2 3] \"float scale\" 2 \"point3 from\" [1 0 0]\n"
          "Translate 0 1 0 LightSource \"spot\" \"float coneangle\" 40 \"blackbody I\" 5000 \"float power\" "
          "100\n"
          "LightSource \"distant\" \"point3 from\" [0 1 0] \"point3 to\" [0 0 0] \"float illuminance\" 3\n"
          "LightSource \"infinite\" \"rgb L\" [.1 .2 .3] LightSource \"goniometric\" \"string filename\" "
          "\"x\"\n"
          "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float scale\" 5 \"bool twosided\" true\n"
          "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\" \"float "
          "roughness\" 0.25\n"
          "Shape \"sphere\"\n"
          "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0] \"float uscale\" 4 Texture \"f\" "
          "\"float\" \"constant\" \"float value\" 0.5\n"
          "Texture \"s\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"float scale\" 0.5 Texture \"m\" "
          "\"spectrum\" \"mix\" \"texture tex1\" \"s\" \"rgb tex2\" [1 1 1] \"texture amount\" \"f\"\n"
          "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"texture reflectance\" \"m\" NamedMaterial "
          "\"a\"\n"
          "MakeNamedMaterial \"b\" \"string type\" \"mix\" \"string materials\" [\"a\" \"a\"]\n"
          "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\" Material \"thindielectric\" Material "
          "\"coateddiffuse\" Material \"interface\"\n"
          "Material \"coatedconductor\" Material \"diffusetransmission\" Material \"measured\" \"string "
          "filename\" \"x\" Material \"hair\" Material \"subsurface\"\n"
          "Material \"diffuse\" \"spectrum reflectance\" [400 .5 700 .5] Shape \"disk\" \"texture alpha\" "
          "\"f\" \"float power\" 1\n"
          "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" MediumInterface \"m\" \"\" MediumInterface "
          "\"m\"\n");
    // goniometric, mix, coatedconductor, diffusetransmission, measured, hair, subsurface, the unknown power,
    // media.
    if (warning_count != 9) fail_msg("%d warnings:\n%s", warning_count, warnings);
    assert_non_null(strstr(warnings, "Shape \"disk\": unknown parameter \"power\""));
    assert_int_equal(world->lights.count, 4);
    const sag_light *lights = world->lights.items;
    assert_true(lights[0].color.b == 6 && lights[0].from.x == 1);
    assert_true(lights[1].from.y == 1 &&
                fabs(lights[1].cone_rad - 40 * 3.14159265358979323846 / 180) < 1e-15);
    assert_true(fabs(lights[2].color.r - 3) < 1e-15 && lights[2].from.y > 0);
    assert_true(fabs(lights[3].color.g - 0.2) < 1e-15);
    sag_world_destroy(world);
}

static void test_colors(void **state) {
    (void)state;
    sag_rgb rgb = sagi_spectrum_blackbody(6504);
    assert_true(fabs(rgb.r - 1) < 0.06 && fabs(rgb.g - 1) < 0.06 && fabs(rgb.b - 1) < 0.06);
    rgb = sagi_spectrum_blackbody(2856);
    assert_true(rgb.r > 1.5 && rgb.g > 0.7 && rgb.b < 0.35);
    assert_true(fabs(0.2126390 * rgb.r + 0.7151687 * rgb.g + 0.0721923 * rgb.b - 1) < 1e-4);
    const double flat[] = {300, 0.25, 900, 0.25};
    rgb = sagi_spectrum_sampled(flat, 2, SAGI_SPECTRUM_REFLECTANCE);
    near_to(rgb.r, 0.25), near_to(rgb.g, 0.25), near_to(rgb.b, 0.25);
    rgb = sagi_spectrum_sampled(flat, 2, SAGI_SPECTRUM_INDEX);
    near_to(rgb.r, 0.25);
    rgb = sagi_spectrum_blackbody(NAN);
    assert_true(rgb.r == 0 && rgb.g == 0 && rgb.b == 0);
    assert_false(sagi_spectrum_named((sagi_slice){"metal-X", 7}, &rgb));
}

static void test_errors_have_their_place(void **state) {
    (void)state;
    fails("", 1, 1, "without WorldBegin");
    fails("Foo", 1, 1, "unknown directive Foo");
    fails(W "  # a comment\n   Bar \"x\"\n", 3, 4, "unknown directive Bar");
    fails(W "Shape \"sphere\"\n  \"float radius\" [ 1 \n", 3, 18, "never closed");
    fails(W "Shape \"sphere\" \"float radius\" [ 1 \nShape \"disk\"", 2, 31, "never closed");
    fails(W "Shape \"sphere", 2, 7, "no closing quote");
    fails(W "Shape \"sphere\" \"float radius\" \"two\"", 2, 31, "a number expected");
    fails(W "Shape \"sphere\" \"float radius\" [1 [2]]", 2, 34, "a [ within");
    fails(W "Shape \"sphere\" \"float radius\" [1 2]", 2, 16, "2 numbers, not 1");
    fails(W "Shape \"sphere\" \"float radius\"", 2, 16, "has no value");
    fails(W "Shape \"sphere\" \"string radius\" \"1\"", 2, 16, "of type string here, float expected");
    fails(W "Shape \"sphere\" \"flaot radius\" 1", 2, 16, "unknown parameter type \"flaot\"");
    fails(W "Shape \"sphere\" \"radius\" 1", 2, 16, "\"type name\"");
    fails(W "Shape \"sphere\" \"float radius\" 1x", 2, 31, "a number expected");
    fails(W "Shape \"sphere\" \"float radius\" -1", 2, 1, "radius");
    fails(W "Shape \"spheer\"", 2, 1, "unknown shape \"spheer\"");
    fails(W "Shape 5", 2, 7, "a string expected after Shape");
    fails(W "Shape", 2, 1, "a string expected after Shape");
    fails(W "\n\"float radius\" 1", 3, 1, "a directive expected");
    fails(W "Translate 1 2", 2, 1, "3 numbers expected");
    fails(W "Translate 1 2 x", 2, 15, "3 numbers expected");
    fails(W "Translate 1 2 inf", 2, 15, "finite");
    fails(W "Scale 0 1 1", 2, 1, "Scale by 0");
    fails(W "Rotate 5 0 0 0", 2, 1, "axis");
    fails(W "LookAt 0 0 0 0 1 0 0 1 0", 2, 1, "up vector");
    fails(W "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0]", 2, 41, "16 numbers");
    fails(W "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1]", 2, 44, "before the ]");
    fails(W "Transform [0 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1]", 2, 1, "singular");
    fails(W "Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]", 2, 1, "projective");
    fails(W "AttributeEnd", 2, 1, "without AttributeBegin");
    fails(W "AttributeBegin\nTransformBegin\nAttributeEnd", 4, 1, "TransformBegin of line 3 is open");
    fails(W "  AttributeBegin", 2, 3, "never closed by AttributeEnd");
    fails(W "ObjectBegin \"a\"", 2, 1, "never closed by ObjectEnd");
    fails(W "ObjectBegin \"a\" ObjectBegin \"b\"", 2, 17, "within an object");
    fails(W "ObjectBegin \"a\" ObjectEnd ObjectBegin \"a\"", 2, 27, "already");
    fails(W "ObjectInstance \"a\"", 2, 1, "there is no object \"a\"");
    fails(W "NamedMaterial \"a\"", 2, 1, "there is no material \"a\"");
    fails(W "Material \"matte\"", 2, 1, "unknown material \"matte\"");
    fails(W "MakeNamedMaterial \"a\"", 2, 1, "\"string type\" is missing");
    fails(W "Material \"diffuse\" \"texture reflectance\" \"t\"", 2, 20, "there is no texture \"t\"");
    fails(W "Material \"diffuse\" \"rgb reflectance\" [1 2]", 2, 20, "3 numbers");
    fails(W "Material \"conductor\" \"spectrum eta\" \"metal-Xx\"", 2, 22, "no spectrum and no file");
    fails(W "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"none.png\"", 2, 32,
          "none.png: cannot read: No such file");
    fails(W "Texture \"t\" \"vector\" \"constant\"", 2, 1, "\"float\" or \"spectrum\"");
    fails(W "LightSource \"lamp\"", 2, 1, "unknown light");
    fails(W "LightSource \"distant\" \"point3 from\" [0 0 1] \"point3 to\" [0 0 1]", 2, 1, "same point");
    fails(W "Camera \"perspective\"", 2, 1, "Camera after WorldBegin");
    fails("Shape \"sphere\"", 1, 1, "Shape before WorldBegin");
    fails("Camera \"perspective\" \"float fov\" 180 " W, 1, 22, "fov 180");
    fails("Camera \"fisheye\" " W, 1, 1, "unknown camera");
    fails("Film \"rgb\" \"integer xresolution\" 100000 " W, 1, 1, "100000×720");
    fails("Film \"rgb\" \"integer xresolution\" 1.5 " W, 1, 34, "not an integer");
    fails("Sampler \"halton\" \"integer pixelsamples\" 0 " W, 1, 1, "0 samples");
    fails(W "SolidBegin \"union\"", 2, 1, "not supported yet");
    fails(W "Include \"none.pbrt\"", 2, 1, "none.pbrt: cannot read: No such file");
    fails(W "Include \"scene.pbrt\"", 2, 1, "includes itself");
    fails(W "Import \"scene.pbrt\"", 2, 1, "includes itself");
    fails(W "Shape \"plymesh\" \"string filename\" \"none.ply\"", 2, 17,
          "none.ply: cannot read: No such file");
    fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]", 2, 53,
          "indices[2] is 3, but there are 3 points");
    fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 -1]", 2, 53,
          "indices[2] is -1");
    fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1]", 2, 53,
          "not a multiple of 3");
    fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" []", 2, 53,
          "no faces");
    fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 0]", 2, 1,
          "\"integer indices\" are missing");
    fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1]", 2, 22, "not a multiple of 3");
    fails(W "Shape \"trianglemesh\"", 2, 1, "\"point3 P\" is missing");
    fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1]", 2, 53,
          "1 of \"N\" for 3 of \"P\"");
    fails(W "Shape \"polygon\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer loops\" [4]", 2, 48,
          "the loops have 4 points");
    fails(W "Shape \"polygon\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 1]", 2, 1, "polygon");
    fails(W "Shape \"torus\" \"float minorradius\" 0", 2, 1, "torus");
    fails(W "Shape \"quadric\"", 2, 1, "ten numbers");
    fails(W "\x01\x02\x03", 2, 1, "no text");
}

// As other programs and pbrt itself write: a byte order mark, Option with a plain name. What is given twice,
// or dropped, is named.
static void test_marks_options_and_repetitions(void **state) {
    (void)state;
    sag_world_destroy(
        load_good("\xef\xbb\xbfOption \"seed\" 3\nOption \"bool disablepixeljitter\" [ true ]\n" W
                  "Shape \"sphere\" \"float radius\" 2 \"float radius\" 1"));
    assert_int_equal(warning_count, 3);
    assert_non_null(strstr(warnings, "scene.pbrt:1:4: warning: Option \"seed\" has no effect"));
    assert_non_null(
        strstr(warnings, ":4:33: warning: Shape \"sphere\": \"radius\" is given again: the first one"));
    fails("Option \"seed\"", 1, 14, "no value");
    fails("Option \"seed\" [3 4]", 1, 18, "] expected");
    fails(W "LightSource \"infinite\" \"string filename\" \"nowhere.exr\"", 2, 24,
          "nowhere.exr: cannot read");
    sag_world_destroy(load_good(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 nan 0 1e31 0 0] "
                                  "\"integer indices\" [0 1 2 0 1 3 0 1 4]"));
    assert_int_equal(warning_count, 1);
    assert_non_null(
        strstr(warnings, ":2:1: warning: Shape \"trianglemesh\": triangles with a vertex that is NaN"));
    assert_non_null(strstr(warnings, "2 of 3"));
}

static void test_included_files(void **state) {
    (void)state;
    const char *part = "Translate 0 0 5\nShape \"sphere\"\n", *bad = "\n  Oops\n", *open = "AttributeBegin\n";
    write_file("part.pbrt", part, strlen(part));
    write_file("bad.pbrt", bad, strlen(bad));
    write_file("open.pbrt", open, strlen(open));
    gzFile gz = gzopen(in_folder("zipped.pbrt.gz"), "wb");
    gzputs(gz, part);
    gzclose(gz);
    sag_world *world = load_good(W "Include \"part.pbrt\" Shape \"sphere\" \"float radius\" 2");
    near_to(shoot(world, 0, 0, 0, 0, 0, 1), 3); // the translation stays
    sag_world_destroy(world);
    world = load_good(W "Import \"part.pbrt\" Shape \"sphere\" \"float radius\" 2");
    near_to(shoot(world, 0, 0, -9, 0, 0, 1), 7); // and does not
    sag_world_destroy(world);
    world = load_good(W "Include \"zipped.pbrt.gz\"");
    near_to(shoot(world, 0, 0, 0, 0, 0, 1), 4);
    sag_world_destroy(world);
    sag_error error;
    assert_int_equal(load(W "Include \"bad.pbrt\"", &world, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.file, "/bad.pbrt"));
    assert_true(error.line == 2 && error.column == 3);
    sag_world_destroy(world);
    assert_int_equal(load(W "Include \"open.pbrt\"\nAttributeEnd", &world, &error), SAG_OK);
    sag_world_destroy(world);
    assert_int_equal(load(W "Import \"open.pbrt\"\nAttributeEnd", &world, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.file, "/open.pbrt"));
    sag_world_destroy(world);
    for (int i = 0; i < 80; i++) { // a chain longer than the bound
        char name[32], text[64];
        snprintf(name, sizeof name, "chain%d.pbrt", i);
        snprintf(text, sizeof text, "Include \"chain%d.pbrt\"\n", i + 1);
        write_file(name, text, strlen(text));
    }
    assert_int_equal(load(W "Include \"chain0.pbrt\"", &world, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "64 deep"));
    sag_world_destroy(world);
}

static void test_deep_nesting(void **state) {
    (void)state;
    char textures[8192] = W "Texture \"t0\" \"float\" \"constant\"\n";
    for (int i = 1; i < 60; i++)
        sprintf(textures + strlen(textures), "Texture \"t%d\" \"float\" \"scale\" \"texture tex\" \"t%d\"\n",
                i, i - 1);
    sag_world *deep;
    sag_error error;
    assert_int_equal(load(textures, &deep, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "nest too deep"));
    sag_world_destroy(deep);
    const int depth = 10000;
    char *text = malloc(64 + (size_t)depth * 64), *p = text;
    p += sprintf(p, W);
    for (int i = 0; i < depth; i++) p += sprintf(p, "AttributeBegin Translate 0 0 1\n");
    p += sprintf(p, "Shape \"sphere\"\n");
    for (int i = 0; i < depth; i++) p += sprintf(p, "AttributeEnd\n");
    sag_world *world = load_good(text);
    near_to(shoot(world, 0, 0, 0, 0, 0, 1), depth - 1);
    sag_world_destroy(world);
    free(text);
}

// ---- PLY through Shape "plymesh"

static sag_status load_ply(const void *bytes, size_t size, sag_world **world, sag_error *error) {
    write_file("mesh.ply", bytes, size);
    return load(W "Shape \"plymesh\" \"string filename\" \"mesh.ply\"", world, error);
}

static void ply_fails(const char *text, int line, int column, const char *what) {
    sag_world *world;
    sag_error error;
    if (load_ply(text, strlen(text), &world, &error) == SAG_OK) fail_msg("loaded: %s", text);
    if (error.line != line || error.column != column || !strstr(error.message, what))
        fail_msg("%d:%d: %s\nwanted %d:%d: %s\nfor %s", error.line, error.column, error.message, line, column,
                 what, text);
    assert_non_null(strstr(error.file, "mesh.ply"));
    sag_world_destroy(world);
}

#define PLY_HEAD                                                                                             \
    "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty "      \
    "float z\nproperty uchar red\n"                                                                          \
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"

static void test_ply(void **state) {
    (void)state;
    const char *quad = PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 2 3\n";
    sag_world *world;
    sag_error error;
    if (load_ply(quad, strlen(quad), &world, &error) != SAG_OK) fail_msg("%s", error.message);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
    near_to(shoot(world, 0.75, 0.5, 2, 0, 0, -1), 2);
    near_to(shoot(world, 0.25, 0.5, 2, 0, 0, -1), 2);
    sag_world_destroy(world);
    const char *nan_vertex = PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\nnan 1 0 255\n4 0 1 2 3\n";
    assert_int_equal(load_ply(nan_vertex, strlen(nan_vertex), &world, &error), SAG_OK);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
    sag_scene_stats stats;
    sag_scene_get_stats(sag_world_scene(world), &stats);
    assert_true(stats.dropped_not_finite == 1 && stats.primitive_count == 1);
    sag_world_destroy(world);

    ply_fails("nope", 1, 1, "not a PLY file");
    ply_fails("ply\nformat ascii 1.0\n", 3, 1, "no end_header");
    ply_fails("ply\nformat binary_middle_endian 1.0\nend_header\n", 2, 1, "unknown format");
    ply_fails("ply\nformat ascii 1.0\nelement vertex -3\nend_header\n", 3, 1, "NAME COUNT");
    ply_fails("ply\nformat ascii 1.0\nelement vertex 3\nproperty list float\nend_header\n", 4, 1,
              "property TYPE NAME");
    ply_fails("ply\nformat ascii 1.0\nwhat\nend_header\n", 3, 1, "unknown word");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 x 255\n0 1 0 255\n4 0 1 2 3\n", 14, 5, "a number expected");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 2", 16, 8, "cut short");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 9 3\n", 16, 7,
              "index 9 is out of range: there are 4 vertices");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 -1 3\n", 16, 7,
              "no natural number");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n2 0 1\n", 0, 0, "no triangles");
    ply_fails("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float "
              "y\nproperty float z\nend_header\n0 0 0",
              8, 6, "cut short");
}

// Binary in both byte orders, with doubles and every prefix of it.
static void test_binary_ply(void **state) {
    (void)state;
    for (int big = 0; big < 2; big++) {
        char bytes[1024];
        size_t size = (size_t)sprintf(
            bytes,
            "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty double x\nproperty double "
            "y\nproperty double z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n"
            "element face 1\nproperty list uchar uint vertex_indices\nproperty int "
            "face_indices\nend_header\n",
            big ? "big" : "little");
        const size_t header = size;
        const double positions[9] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0};
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++) {
                uint64_t bits;
                memcpy(&bits, &positions[3 * i + k], 8);
                for (int b = 0; b < 8; b++) bytes[size++] = (char)(bits >> (8 * (big ? 7 - b : b)));
            }
            memset(bytes + size, 0, 20);
            size += 20;
        }
        bytes[size++] = 3;
        for (int i = 0; i < 4; i++)
            for (int b = 0; b < 4; b++) bytes[size++] = (char)((b == (big ? 3 : 0)) ? i % 3 : 0);
        sag_world *world;
        sag_error error;
        if (load_ply(bytes, size, &world, &error) != SAG_OK) fail_msg("%s", error.message);
        assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
        near_to(sag_scene_bounds(sag_world_scene(world)).max.x, 0.1); // not a float's 0.1
        sag_world_destroy(world);
        for (size_t cut = 0; cut < size; cut++) {
            assert_int_equal(load_ply(bytes, cut, &world, &error), SAG_ERROR_FORMAT);
            if (cut >= header) assert_non_null(strstr(error.message, "cut short"));
            sag_world_destroy(world);
        }
    }
}

// Whatever allocation fails, it is an error code and nothing leaks.
static void test_out_of_memory(void **state) {
    (void)state;
    const char *text = W "Attribute \"shape\" \"float radius\" 2 ObjectBegin \"o\" Shape \"sphere\" "
                         "ObjectEnd ObjectInstance \"o\"\n"
                         "Texture \"t\" \"float\" \"constant\" Material \"diffuse\" AttributeBegin "
                         "LightSource \"point\" AttributeEnd\n"
                         "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1 0 0 1 "
                         "0 0 1] Shape \"plymesh\" \"string "
                         "filename\" \"four.ply\" Shape \"polygon\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    const char *quad = PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 2 3\n";
    write_file("four.ply", quad, strlen(quad));
    write_file("memory.pbrt", text, strlen(text));
    for (size_t k = 0;; k++) {
        failing_allocator books = {.fail_at = k};
        const sag_context_options options = {.allocator = failing_allocator_make(&books), .thread_count = 1};
        sag_context *small = sag_context_create(&options);
        sag_world *world = small ? sag_world_create(small) : NULL;
        sag_error error = {0};
        const sag_status status =
            world ? sag_world_load(world, in_folder("memory.pbrt"), &error) : SAG_ERROR_MEMORY;
        if (status != SAG_OK && status != SAG_ERROR_MEMORY) fail_msg("allocation %zu: %s", k, error.message);
        sag_world_destroy(world);
        sag_context_destroy(small);
        failing_allocator_assert_empty(&books);
        if (status == SAG_OK) break;
    }
}

// Texts made from a good one by chance: never a crash, never memory that is not given back.
static void test_broken_texts(void **state) {
    (void)state;
    const char *good =
        "LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" [45] Film \"rgb\" \"integer "
        "xresolution\" 10\n"
        "Sampler \"stratified\" \"integer xsamples\" 2 PixelFilter \"triangle\" Integrator \"path\" "
        "\"integer maxdepth\" 3\n" W
        "Attribute \"shape\" \"float radius\" 2 AttributeBegin Translate 1 2 3 Rotate 45 0 1 0 Scale 1 2 3\n"
        "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0] Material \"diffuse\" \"texture "
        "reflectance\" \"t\"\n"
        "AreaLightSource \"diffuse\" \"blackbody L\" 5000 \"float power\" 10 Shape \"sphere\" AttributeEnd # "
        "comment\n"
        "ObjectBegin \"o\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 "
        "2] ObjectEnd ObjectInstance \"o\"\n"
        "MakeNamedMaterial \"m\" \"string type\" \"conductor\" \"spectrum eta\" [400 1 700 2] NamedMaterial "
        "\"m\" ReverseOrientation\n"
        "Shape \"polygon\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer loops\" 3 Shape \"torus\" Shape "
        "\"spheres\" \"point3 P\" [1 2 3]\n"
        "LightSource \"spot\" \"rgb I\" [1 1 1] \"point3 to\" [0 0 1] CoordinateSystem \"c\" "
        "CoordSysTransform \"c\" Include \"part.pbrt\"\n";
    static const char *const pieces[] = {"[",
                                         "]",
                                         "\"",
                                         " ",
                                         "\n",
                                         "1e999",
                                         "-",
                                         "nan",
                                         "\"float radius\"",
                                         "\"integer indices\" [9]",
                                         "AttributeBegin ",
                                         "AttributeEnd ",
                                         "ObjectEnd ",
                                         "WorldBegin ",
                                         "Shape ",
                                         "\\",
                                         "#",
                                         "0",
                                         "1e-320",
                                         "true",
                                         "\"bool closed\" true "};
    const size_t length = strlen(good);
    char *text = malloc(2 * length + 4096);
    uint32_t random = 2026;
    size_t before, after;
    sag_context_memory(context, &before, NULL);
    for (int round = 0; round < 2000; round++) {
        strcpy(text, good);
        for (int change = 0; change < 1 + round % 4; change++) {
            random = random * 1664525u + 1013904223u;
            const size_t n = strlen(text), at = (random >> 8) % n, what = (random >> 4) % 4;
            random = random * 1664525u + 1013904223u;
            const size_t span = (random >> 8) % 20 % (n - at);
            const char *piece = pieces[(random >> 12) % (sizeof pieces / sizeof *pieces)];
            if (what == 0) {
                memmove(text + at, text + at + span, n - at - span + 1);
            } else if (what == 1) {
                text[at] = (char)(random >> 16) ? (char)(random >> 16) : ' ';
            } else if (what == 2 && n + strlen(piece) < 2 * length) {
                memmove(text + at + strlen(piece), text + at, n - at + 1);
                memcpy(text + at, piece, strlen(piece));
            } else {
                text[at + 1] = '\0';
            }
        }
        sag_world *world;
        sag_error error;
        if (load(text, &world, &error) != SAG_OK && (error.message[0] == '\0' || error.line < 0))
            fail_msg("no message for %s", text);
        sag_world_destroy(world);
    }
    sag_context_memory(context, &after, NULL);
    assert_int_equal(before, after);
    free(text);
}

static void count_mesh(void *user, const char *name, const sag_mesh *mesh) {
    uint64_t *counts = user;
    assert_true(name && name[0]);
    counts[0]++;
    counts[1] += mesh->triangle_count;
}

static void test_shared_scenes(void **state) {
    (void)state;
    static const struct {
        const char *name;
        uint64_t meshes;
    } scenes[] = {{"coffee", 23},    {"cornell-box", 8}, {"dining-room", 53},
                  {"spaceship", 90}, {"staircase2", 27}, {"veach-mis", 6}};
    const char *data = getenv("SAGITTA_DATA");
    char path[512];
    snprintf(path, sizeof path, "%s/scenes/coffee/scene-v4.pbrt", data ? data : "../shared");
    if (access(path, R_OK) != 0) {
        print_message("SAGITTA_DATA is not there: skipped\n");
        skip();
    }
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        snprintf(path, sizeof path, "%s/scenes/%s/scene-v4.pbrt", data ? data : "../shared", scenes[i].name);
        sag_error error;
        for (int geometry_only = 0; geometry_only < 2; geometry_only++) {
            sag_world *world = sag_world_create(context);
            uint64_t counts[2] = {0, 0};
            warnings[0] = '\0';
            warning_count = 0;
            const sag_status status = geometry_only
                                          ? sag_world_load_geometry(world, path, count_mesh, counts, &error)
                                          : sag_world_load(world, path, &error);
            if (status != SAG_OK)
                fail_msg("%s:%d:%d: %s", error.file, error.line, error.column, error.message);
            const int wanted = strcmp(scenes[i].name, "staircase2") == 0; // its green glass is a medium
            if (warning_count != wanted) fail_msg("%s", warnings);
            if (geometry_only && counts[0] != scenes[i].meshes)
                fail_msg("%s: %d meshes", scenes[i].name, (int)counts[0]);
            sag_world_destroy(world);
        }
    }
}

// The picture of `make demo` shows every kind of shape, and loads without a word.
static void test_showcase(void **state) {
    (void)state;
    char path[1024];
    snprintf(path, sizeof path, "%s", __FILE__); // tests/render/test_pbrt.c
    for (int up = 0; up < 3; up++) *strrchr(path, '/') = '\0';
    strcat(path, "/examples/showcase.pbrt");
    warnings[0] = '\0';
    sag_world *world = sag_world_create(context);
    sag_error error;
    if (sag_world_load(world, path, &error) != SAG_OK)
        fail_msg("%s:%d:%d: %s", error.file, error.line, error.column, error.message);
    assert_string_equal(warnings, "");
    bool seen[SAG_SHAPE_INSTANCE + 1] = {false};
    sag_shape_kind kind;
    for (uint32_t id = 0; sag_geometry_get(sag_world_scene(world), id, &kind, NULL) == SAG_OK; id++)
        seen[kind] = true;
    for (int k = 0; k <= SAG_SHAPE_INSTANCE; k++)
        if (!seen[k] && k != SAG_SHAPE_USER)
            fail_msg("no %s in the showcase", sag_shape_kind_name((sag_shape_kind)k));
    sag_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_transforms),
        cmocka_unit_test(test_settings),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_surface),
        cmocka_unit_test(test_objects_and_attributes),
        cmocka_unit_test(test_lights_and_materials),
        cmocka_unit_test(test_colors),
        cmocka_unit_test(test_errors_have_their_place),
        cmocka_unit_test(test_marks_options_and_repetitions),
        cmocka_unit_test(test_included_files),
        cmocka_unit_test(test_deep_nesting),
        cmocka_unit_test(test_ply),
        cmocka_unit_test(test_binary_ply),
        cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_broken_texts),
        cmocka_unit_test(test_shared_scenes),
        cmocka_unit_test(test_showcase),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
