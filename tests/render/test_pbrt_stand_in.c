// SPDX-License-Identifier: MIT
// What of pbrt's scenes is not supported: one warning for each kind, with its place, something sensible in
// its stead, and never a failure where pbrt renders.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/world.h"
#include "support/scene_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define W    "WorldBegin\n"
#define BALL " Shape \"sphere\"\n"

static void each_kind_is_named_once(void **state) {
    (void)state;
    static const struct {
        const char *text, *warning;
    } cases[] = {
        {W "Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 2 1 0 ] \"float width0\" .1 \"string type\" "
           "\"flat\" "
           "\"integer degree\" 3 Shape \"curve\" \"float width\" .1" BALL,
         "2:1: warning: the shape \"curve\""},
        {W "Material \"hair\" \"float eumelanin\" .3 \"float beta_m\" .2" BALL
           "Material \"hair\" \"rgb sigma_a\" [1 2 3]" BALL,
         "2:1: warning: the material \"hair\""},
        {W "Material \"subsurface\" \"string name\" \"Skin1\" \"float scale\" 2" BALL
           "Material \"subsurface\" \"rgb reflectance\" [.5 .4 .3] \"rgb mfp\" [1 1 1]" BALL,
         "2:1: warning: the material \"subsurface\""},
        {W "Material \"measured\" \"string filename\" \"none.bsdf\"" BALL,
         "2:1: warning: the material \"measured\""},
        {W "MakeNamedMedium \"c\" \"string type\" \"cloud\" \"float density\" 1 \"float frequency\" 5\n"
           "MakeNamedMedium \"d\" \"string type\" \"cloud\" MediumInterface \"c\" \"d\"" BALL,
         "2:1: warning: media \"cloud\""},
        {W "MakeNamedMedium \"c\" \"string type\" \"uniformgrid\" \"integer nx\" 1 \"float density\" [ 1 "
           "]" BALL,
         "2:1: warning: media \"uniformgrid\""},
        {W "MakeNamedMedium \"c\" \"string type\" \"rgbgrid\" \"rgb sigma_a\" [ 1 1 1 2 2 2 ]" BALL,
         "2:1: warning: media \"rgbgrid\""},
        {W "MakeNamedMedium \"c\" \"string type\" \"nanovdb\" \"string filename\" \"none.nvdb\"" BALL,
         "2:1: warning: media \"nanovdb\""},
        {W "Texture \"p\" \"spectrum\" \"ptex\" \"string filename\" \"none.ptx\" \"float scale\" 2 Material "
           "\"diffuse\" \"texture reflectance\" \"p\"" BALL,
         "2:1: warning: the texture \"ptex\""},
        {W "ActiveTransform EndTime Translate 1 0 0\nRotate 5 0 1 0 ActiveTransform All" BALL,
         "warning: motion is not supported"},
        {"Sampler \"pmj02bn\" \"integer pixelsamples\" 4\n" W BALL, "1:1: warning: Sampler \"pmj02bn\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sag_world *world = scene_load_good(cases[i].text);
        if (scene_warning_count != 1 || !strstr(scene_warnings, cases[i].warning))
            print_message("%s\n%s\n", cases[i].text, scene_warnings);
        assert_int_equal(scene_warning_count, 1);
        assert_non_null(strstr(scene_warnings, cases[i].warning));
        sag_world_destroy(world);
    }
}

static sag_rgb reflectance_of(const char *material) {
    char text[256];
    snprintf(text, sizeof text, W "Material %s" BALL, material);
    sag_world *world = scene_load_good(text);
    const sag_rgb c = ((const sagi_material *)world->materials.items)[0].material.reflectance.value;
    sag_world_destroy(world);
    return c;
}

// The colour of hair is that of its pigments: more is darker, and blue goes first.
static void hair_has_its_colour(void **state) {
    (void)state;
    const sag_rgb brown = reflectance_of("\"hair\""),
                  blond = reflectance_of("\"hair\" \"float eumelanin\" .3"),
                  same = reflectance_of("\"hair\" \"float eumelanin\" 1.3"),
                  red = reflectance_of("\"hair\" \"float pheomelanin\" 1.3"),
                  given = reflectance_of("\"hair\" \"rgb reflectance\" [.1 .2 .3]");
    assert_true(brown.r == same.r && brown.g == same.g && brown.b == same.b);
    assert_true(blond.r > blond.g && blond.g > blond.b && brown.r < blond.r && brown.b < brown.r);
    assert_true(red.r > brown.r && red.r / red.b > brown.r / brown.b);
    assert_true(given.r == 0.1 && given.b == 0.3);
    scene_near(brown.r, exp(-sqrt(0.419 * 1.3) * (5.969 - 0.215 * 0.3 + 2.532 * 0.09 - 10.73 * 0.027 +
                                                  5.574 * 0.0081 + 0.245 * 0.00243)));
}

// A patch with normals is shaded by them, on the surface as it is.
static void patches_have_normals(void **state) {
    (void)state;
    sag_world *world = scene_load_good(
        W "Rotate 90 1 0 0 Translate 5 0 0 Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 0  1 -1 0  -1 1 0  1 "
          "1 .5 ] "
          "\"normal N\" [ 0 0 1  1 0 1  0 1 1  -1 -1 1 ] \"point2 uv\" [ 0 0  2 0  0 3  2 3 ]");
    assert_int_equal(scene_warning_count, 0);
    sag_scene *scene = sag_world_scene(world);
    const double u = 0.3, v = 0.6;
    // Seen from z = 5 of its own space, which stands at x = 5 and is turned: its z is the world's −y.
    const double x = 2 * u - 1 + 5, height = 0.5 * u * v;
    const sag_ray ray = sag_ray_make((sag_vec3){x, -5, 2 * v - 1}, (sag_vec3){0, 1, 0});
    sag_hit hit;
    sag_surface surface;
    assert_true(sag_intersect(scene, &ray, &hit));
    assert_true(fabs(hit.t - (5 - height)) < 0.002);
    sag_surface_at(scene, &ray, &hit, &surface);
    assert_true(fabs(surface.u - 2 * u) < 1e-6 && fabs(surface.v - 3 * v) < 1e-6);
    const sag_vec3 n = {u * (1 - v) - u * v, (1 - u) * v - u * v, 1};
    const sag_vec3 expected = sag_normalize((sag_vec3){n.x, -n.z, n.y});
    assert_true(sag_length(sag_sub(surface.shading_normal, expected)) < 0.01);
    sag_world_destroy(world);
    world =
        scene_load_good(W "AreaLightSource \"diffuse\" \"float power\" 5 Shape \"bilinearmesh\" \"point3 P\" "
                          "[ -1 -1 0  1 -1 0  -1 1 0  1 1 .5 ] \"normal N\" [ 0 0 1  1 0 1  0 1 1  -1 -1 1 ] "
                          "\"string emissionfilename\" \"none.png\"");
    assert_int_equal(scene_warning_count, 1);
    sag_world_destroy(world);
    scene_fails(
        W "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 0  1 -1 0  -1 1 0  1 1 .5 ] \"normal N\" [ 0 0 1 ]", 2,
        69, "1 of \"N\" for 4 of \"P\"");
    scene_fails_without_memory(
        W "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 0  1 -1 0  -1 1 0  1 1 .5 ] \"normal "
          "N\" [ 0 0 1  1 0 1  0 1 1  -1 -1 1 ]");
}

// A double Gauss lens (pbrt's dgauss) of 50 mm, and a plain lens whose focal length is known.
static void lenses_keep_their_field(void **state) {
    (void)state;
    static const char gauss[] =
        "# D-GAUSS F/2 22deg HFOV\n29.475 3.76 1.67 25.2\n84.83 0.12 1 25.2\n19.275 4.025 "
        "1.67 23\n40.77 3.275 1.699 23\n12.75 5.705 1 18\n0 4.5 0 17.1\n-14.495 1.18 1.603 "
        "17\n40.77 6.065 1.658 20\n-20.385 0.19 1 20\n437.065 3.22 1.717 20\n-39.73 0 1 20\n";
    static const char thin[] = "100 0 1.5 50 -100 0 1 50 0 1 1 20"; // 1/f = 0.5 · 2/100
    scene_write("gauss.dat", gauss, strlen(gauss));
    scene_write("thin.dat", thin, strlen(thin));
    static const struct {
        const char *file;
        double focal, tolerance, pupil;
    } lenses[] = {{"gauss.dat", 50, 1, 0}, {"thin.dat", 100, 1e-6, 5}};
    for (int i = 0; i < 2; i++) {
        char text[400];
        snprintf(
            text, sizeof text,
            "Camera \"realistic\" \"string lensfile\" \"%s\" \"float aperturediameter\" 5 \"float "
            "focusdistance\" 4\nFilm \"rgb\" \"integer xresolution\" 300 \"integer yresolution\" 400 \"float "
            "diagonal\" 50\n" W,
            lenses[i].file);
        sag_world *world = scene_load_good(text);
        assert_int_equal(scene_warning_count, 1);
        const sag_camera *camera = &sag_world_settings(world)->camera;
        const double focal = lenses[i].focal, image = 1 / (1 / focal - 1.0 / 4000);
        assert_true(fabs(15 / tan(camera->fov_rad / 2) - image) < lenses[i].tolerance);
        assert_true(camera->focal_distance == 4 && camera->lens_radius > 0.001 &&
                    camera->lens_radius < 0.005);
        if (lenses[i].pupil > 0) scene_near(camera->lens_radius, lenses[i].pupil / 2000);
        sag_world_destroy(world);
    }
    scene_write("bad.dat", "1 2 3", 5);
    scene_fails("Camera \"realistic\"\n" W, 1, 1, "\"string lensfile\" is missing");
    scene_fails("Camera \"realistic\" \"string lensfile\" \"none.dat\"\n" W, 1, 20,
                "no file called \"none.dat\"");
    scene_fails("Camera \"realistic\" \"string lensfile\" \"bad.dat\"\n" W, 1, 20, "four numbers");
    scene_fails("Camera \"realistic\" \"string lensfile\" \"thin.dat\" \"float focusdistance\" .05\n" W, 1,
                49, "within the focal length");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_is_named_once),
        cmocka_unit_test(hair_has_its_colour),
        cmocka_unit_test(patches_have_normals),
        cmocka_unit_test(lenses_keep_their_field),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
