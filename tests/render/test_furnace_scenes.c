// SPDX-License-Identifier: MIT
// Every finite shape that a scene can name, in every material: in light of radiance 1 from everywhere. What
// keeps all light shows 1, so that nothing can be told from anything; what shines as much as it swallows does
// too. What loses light shows no more than 1, and as much as a walk shows that knows neither lights nor
// weights: it only follows what the surface's own scattering says until it is outside.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
// clang-format on
#include "render/job.h"
#include "support/mean.h"
#include "support/picture.h"
#include "support/random.h"
#include "support/scene_text.h"

// How a shape is made.
enum { OPEN, CLOSED, BENT }; // BENT: open or closed, with normals of its own, which cost light at its rims

#define FLAT_MESH                                                                                            \
    "\"point3 P\" [1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1] \"integer indices\" [0 2 4 2 1 4 1 3 4 3 0 4 2 "  \
    "0 5 "                                                                                                   \
    "1 2 5 3 1 5 0 3 5]"
#define BOX  "Shape \"box\" \"point3 min\" [-1 -.7 -.5] \"point3 max\" [.9 .8 .7]\n"
#define BALL "Translate .7 .3 .4 Shape \"sphere\" \"float radius\" .6\n"
#define DIE  "ObjectBegin \"die\" " BOX "ObjectEnd "

static const struct {
    const char *name, *text;
    int kind;
} shapes[] = {
    {"sphere", "Shape \"sphere\"", CLOSED},
    {"part of a sphere", "Shape \"sphere\" \"float zmin\" -.6 \"float zmax\" .8 \"float phimax\" 230", OPEN},
    {"disk", "Shape \"disk\" \"float radius\" 1.2", OPEN},
    {"part of a disk", "Shape \"disk\" \"float innerradius\" .3 \"float phimax\" 250", OPEN},
    {"cylinder", "Shape \"cylinder\" \"float radius\" .7 \"float zmin\" -.8 \"float zmax\" .9", OPEN},
    {"part of a cylinder", "Shape \"cylinder\" \"float radius\" .7 \"float phimax\" 200", OPEN},
    {"closed cylinder", "Shape \"cylinder\" \"float radius\" .7 \"bool closed\" true", CLOSED},
    {"mesh", "Shape \"trianglemesh\" " FLAT_MESH, CLOSED},
    {"mesh with normals",
     "Shape \"trianglemesh\" " FLAT_MESH "\"normal N\" [1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1]", BENT},
    {"bilinear mesh", "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 .5 -1 1 .5 1 1 0]", OPEN},
    {"bilinear mesh with normals",
     "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 .5 -1 1 .5 1 1 0] \"normal N\" [-.2 -.2 1 .2 -.2 1 "
     "-.2 .2 1 .2 "
     ".2 1]",
     BENT},
    {"two patches",
     "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 0 -1 .5 -1 1 .5 0 1 0 1 -1 0 1 1 .4] \"integer indices\" "
     "[0 1 2 3 1 4 3 5]",
     OPEN},
    {"loop subdivision", "Shape \"loopsubdiv\" \"integer levels\" 2 " FLAT_MESH, BENT},
    {"rectangle",
     "Shape \"rectangle\" \"point3 corner\" [-1 -1 0] \"vector3 edgeu\" [2 0 .5] \"vector3 edgev\" [.3 2 0]",
     OPEN},
    {"polygon with a hole",
     "Shape \"polygon\" \"point3 P\" [-1 -1 0 1 -1 0 .5 0 0 1 1 0 -1 1 0 -.5 -.5 0 0 -.5 0 -.2 .4 0] "
     "\"integer loops\" [5 3]",
     OPEN},
    {"ellipsoid", "Shape \"ellipsoid\" \"vector3 radii\" [1 .6 1.3]", CLOSED},
    {"cone", "Shape \"cone\" \"float radius\" .9 \"float height\" 1.2", OPEN},
    {"part of a cone", "Shape \"cone\" \"float radius\" .9 \"float height\" 1.2 \"float phimax\" 220", OPEN},
    {"closed cone", "Shape \"cone\" \"float radius\" .9 \"float height\" 1.2 \"bool closed\" true", CLOSED},
    {"paraboloid", "Shape \"paraboloid\" \"float radius\" .9 \"float zmax\" 1.2", OPEN},
    {"part of a paraboloid",
     "Shape \"paraboloid\" \"float radius\" .9 \"float zmin\" .3 \"float zmax\" 1.2 \"float phimax\" 220",
     OPEN},
    {"closed paraboloid", "Shape \"paraboloid\" \"float radius\" .9 \"float zmax\" 1.2 \"bool closed\" true",
     CLOSED},
    {"hyperboloid", "Shape \"hyperboloid\" \"point3 p1\" [.9 0 -.8] \"point3 p2\" [0 .9 .9]", OPEN},
    {"part of a hyperboloid",
     "Shape \"hyperboloid\" \"point3 p1\" [.9 0 -.8] \"point3 p2\" [0 .9 .9] \"float phimax\" 220", OPEN},
    {"closed hyperboloid",
     "Shape \"hyperboloid\" \"point3 p1\" [.9 0 -.8] \"point3 p2\" [0 .9 .9] \"bool closed\" true", CLOSED},
    {"hyperboloid of two sheets",
     "Shape \"hyperboloid2\" \"float a\" .6 \"float c\" .4 \"float zmin\" -1.2 \"float zmax\" 1.2", OPEN},
    {"quadric",
     "Shape \"quadric\" \"float coefficients\" [1 1.5 .7 .1 0 -.2 0 0 0 -1] \"point3 min\" [-2 -2 -2] "
     "\"point3 max\" [2 2 2]",
     CLOSED},
    {"clipped quadric",
     "Shape \"quadric\" \"float coefficients\" [1 -1 0 0 0 0 0 0 1 0] \"point3 min\" [-1 -1 -1] \"point3 "
     "max\" [1 1 1]",
     OPEN},
    {"box", BOX, CLOSED},
    {"oriented box", "Shape \"orientedbox\" \"vector3 halfaxes\" [.8 .3 0 -.3 .8 .1 .1 -.1 1]", CLOSED},
    {"polyhedron",
     "Shape \"polyhedron\" \"float planes\" [1 0 0 1 -1 0 0 1 0 1 .2 1 0 -1 0 1 .1 .2 1 .9 0 0 -1 1]",
     CLOSED},
    {"capsule", "Shape \"capsule\" \"point3 p0\" [-.8 -.3 0] \"point3 p1\" [.7 .4 .5] \"float radius\" .5",
     CLOSED},
    {"triangle", "Shape \"triangle\" \"point3 P\" [-1 -1 0 1 -1 .2 0 1 0]", OPEN},
    {"torus", "Shape \"torus\" \"float majorradius\" .8 \"float minorradius\" .3", CLOSED},
    {"spheres", "Shape \"spheres\" \"point3 P\" [-.8 0 0 .8 0 0 0 .9 .3] \"float radius\" .45", CLOSED},
    {"union", "SolidBegin \"union\" " BOX BALL "SolidEnd", CLOSED},
    {"difference", "SolidBegin \"difference\" " BOX BALL "SolidEnd", CLOSED},
    {"intersection", "SolidBegin \"intersection\" " BOX BALL "SolidEnd", CLOSED},
    {"xor", "SolidBegin \"xor\" " BOX BALL "SolidEnd", CLOSED},
    {"a ball less a mesh",
     "SolidBegin \"difference\" Shape \"sphere\" Translate .8 0 .3 Shape \"trianglemesh\" " FLAT_MESH
     "SolidEnd",
     CLOSED},
    {"stretched sphere", "Scale 1 .5 1.4 Shape \"sphere\"", CLOSED},
    {"mirrored torus", "Scale -1 1 .7 Shape \"torus\" \"float majorradius\" .8 \"float minorradius\" .3",
     CLOSED},
    {"turned inside out and back", "ReverseOrientation Scale 1 -1 1 Shape \"disk\"", OPEN},
    {"instances", DIE "ObjectInstance \"die\" Translate -1.7 .3 1 Rotate 30 1 0 1 ObjectInstance \"die\"",
     CLOSED},
    {"mirrored instance", DIE "Scale 1 -1 1 ObjectInstance \"die\"", CLOSED},
    {"stretched instance", DIE "Rotate 20 1 1 0 Scale .5 1.3 1 ObjectInstance \"die\"", CLOSED},
    {"sheared instance of a mesh",
     "ObjectBegin \"o\" Shape \"trianglemesh\" " FLAT_MESH
     " ObjectEnd ConcatTransform [1 .3 0 0 0 1 .2 0 -.4 "
     "0 1 0 0 0 0 1] ObjectInstance \"o\"",
     CLOSED},
    {"instance of a solid",
     "ObjectBegin \"o\" SolidBegin \"difference\" " BOX BALL
     "SolidEnd ObjectEnd Scale -1.2 .8 1 ObjectInstance \"o\"",
     CLOSED},
};
#define SHAPES (sizeof shapes / sizeof *shapes)

// What becomes of light that a material gets. KEEPS: all of it comes back, to one side or the other. GLASS:
// all, if the shape has an inside. FOG: the same, and there is none where it has not. LOSES: not all.
enum { KEEPS, GLASS, FOG, LOSES };

#define MIRROR "\"rgb eta\" [1 1 1] \"rgb k\" [1e8 1e8 1e8] "
#define BASE   "\"rgb conductor.eta\" [1 1 1] \"rgb conductor.k\" [1e8 1e8 1e8] "
#define SMOOTH "\"bool remaproughness\" false "
#define BUMPS                                                                                                \
    "Texture \"b\" \"float\" \"fbm\" Texture \"bumps\" \"float\" \"scale\" \"texture tex\" \"b\" \"float "   \
    "scale\" .05 "

static const struct {
    const char *name, *text;
    int kind;
} materials[] = {
    {"white paint", "Material \"diffuse\" \"rgb reflectance\" [1 1 1]", KEEPS},
    {"shining paint",
     "Material \"diffuse\" \"rgb reflectance\" [.3 .3 .3] AreaLightSource \"diffuse\" \"rgb L\" [.7 .7 .7] "
     "\"bool twosided\" true",
     KEEPS},
    {"mirror", "Material \"conductor\" " MIRROR, KEEPS},
    {"glass", "Material \"dielectric\"", GLASS},
    {"glass that disperses", "Material \"dielectric\" \"spectrum eta\" \"glass-F11\"", GLASS},
    {"pane", "Material \"thindielectric\"", KEEPS},
    {"varnish",
     "Material \"coateddiffuse\" \"rgb reflectance\" [1 1 1] \"float thickness\" 0 \"integer maxdepth\" 4000",
     KEEPS},
    {"paint in white fog",
     "Material \"coateddiffuse\" \"rgb reflectance\" [1 1 1] \"float thickness\" .5 \"rgb albedo\" [1 1 1] "
     "\"float g\" .4 \"integer maxdepth\" 4000",
     KEEPS},
    {"lacquered mirror",
     "Material \"coatedconductor\" " BASE "\"float thickness\" 0 \"float conductor.roughness\" 0 \"float "
     "interface.roughness\" 0 \"integer maxdepth\" 4000",
     KEEPS},
    {"paper",
     "Material \"diffusetransmission\" \"rgb reflectance\" [.3 .3 .3] \"rgb transmittance\" [.7 .7 .7]",
     KEEPS},
    {"mix",
     "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 1 1] MakeNamedMaterial "
     "\"m\" "
     "\"string type\" \"conductor\" " MIRROR
     "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" .2 \"float "
     "tex2\" .9 Material \"mix\" \"string materials\" [\"a\" \"m\"] \"texture amount\" \"t\"",
     KEEPS},
    {"nothing", "Material \"interface\"", KEEPS},
    {"holes", BUMPS "Material \"diffuse\" \"rgb reflectance\" [1 1 1] Attribute \"shape\" \"float alpha\" .4",
     KEEPS},
    {"cloud",
     "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0 0 0] \"rgb sigma_s\" [1 1.3 "
     ".8] \"float g\" .5 MediumInterface \"fog\" \"\" Material \"interface\"",
     FOG},
    {"warm glass",
     "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 .5] \"rgb sigma_s\" [1 1 "
     "1] \"rgb Le\" [1.44 1.44 1.44] MediumInterface \"fog\" \"\" Material \"dielectric\" \"float eta\" 1.2",
     FOG},
    {"grey paint", "Material \"diffuse\" \"rgb reflectance\" [.5 .2 .8]", LOSES},
    {"bumpy paint",
     BUMPS "Material \"diffuse\" \"rgb reflectance\" [1 1 1] \"texture displacement\" \"bumps\"", LOSES},
    {"copper", "Material \"conductor\"", LOSES},
    {"rough mirror", "Material \"conductor\" " SMOOTH MIRROR "\"float roughness\" .4", LOSES},
    {"brushed mirror",
     "Material \"conductor\" " SMOOTH MIRROR "\"float uroughness\" .1 \"float vroughness\" .5", LOSES},
    {"bumpy mirror",
     BUMPS "Material \"conductor\" " SMOOTH MIRROR "\"float roughness\" .1 \"texture "
           "displacement\" \"bumps\"",
     LOSES},
    {"rough glass", "Material \"dielectric\" " SMOOTH "\"float roughness\" .3", LOSES},
    {"brushed glass", "Material \"dielectric\" " SMOOTH "\"float uroughness\" .4 \"float vroughness\" .1",
     LOSES},
    {"plastic", "Material \"coateddiffuse\" \"rgb reflectance\" [.7 .7 .7]", LOSES},
    {"dull plastic",
     "Material \"coateddiffuse\" " SMOOTH "\"rgb reflectance\" [1 1 1] \"float roughness\" .3", LOSES},
    {"dull plastic and fog",
     "Material \"coateddiffuse\" " SMOOTH "\"rgb reflectance\" [1 1 1] \"float roughness\" .3 \"float "
     "thickness\" .3 \"rgb albedo\" [.9 .9 .9]",
     LOSES},
    {"lacquered gold",
     "Material \"coatedconductor\" \"spectrum conductor.eta\" \"metal-Au-eta\" \"spectrum conductor.k\" "
     "\"metal-Au-k\" \"float conductor.roughness\" .1 \"float interface.roughness\" .05",
     LOSES},
    {"leaf",
     "Material \"diffusetransmission\" \"rgb reflectance\" [.3 .2 .1] \"rgb transmittance\" [.1 .2 .3]",
     LOSES},
};
#define MATERIALS (sizeof materials / sizeof *materials)

static studio open_studio(size_t shape, size_t material) {
    char text[4096];
    snprintf(text, sizeof text,
             "LookAt 0 0 8  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 23\n"
             "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 PixelFilter \"box\"\n"
             "Sampler \"independent\" \"integer pixelsamples\" 6\n"
             "Integrator \"%s\" \"integer maxdepth\" 1000\nWorldBegin\n"
             "LightSource \"infinite\" \"rgb L\" [1 1 1]\n%s\nRotate -57 1 .4 .2\n%s\n",
             materials[material].kind == FOG ? "volpath" : "path", materials[material].text,
             shapes[shape].text);
    studio s = {.context = scene_context, .world = scene_load_good(text)};
    if (scene_warning_count) fail_msg("%s", scene_warnings);
    s.scene = sag_world_scene(s.world), s.settings = sag_world_settings(s.world);
    return s;
}

// What a ray brings that is sent on as surfaces scatter, until it is away.
static double walk(const sag_render *render, rng *r) {
    const sagi_color white = sagi_color_of_rgb(SAG_COLOR_SRGB, (sag_rgb){1, 1, 1}, SAGI_RGB_ILLUMINANT);
    const float part = (float)rng_unit(r);
    sagi_spectrum lambda, weight = {1, 1, 1, 1}, sum = {0, 0, 0, 0};
    for (int i = 0; i < 4; i++)
        lambda[i] = SAGI_WAVELENGTH_MIN + (SAGI_WAVELENGTH_MAX - SAGI_WAVELENGTH_MIN) * ((float)i + part) / 4;
    sag_ray ray = sagi_camera_ray(&render->camera, 16 * rng_unit(r), 16 * rng_unit(r), rng_vec2(r));
    bool dispersed = false;
    for (int depth = 0; depth < 1000; depth++) {
        sag_hit hit;
        if (!sag_intersect(render->scene, &ray, &hit)) {
            sum += weight;
            break;
        }
        sag_surface surface;
        sag_surface_at(render->scene, &ray, &hit, &surface);
        const sagi_appearance *look = sagi_appearance_of(render->world, &surface);
        sagi_replace_texcoords(look, &surface);
        sagi_orient(look, &surface);
        sagi_bsdf bsdf;
        if (!sagi_alpha_is_there(look, &surface, &ray) ||
            !sagi_material_evaluate(render->world, look, &surface, NULL, NULL, sag_neg(ray.direction), lambda,
                                    &bsdf)) {
            ray = sag_spawn_ray(&surface, ray.direction);
            continue;
        }
        sum += weight * sagi_emission(look, &surface, sag_neg(ray.direction), lambda) /
               sagi_color_at(&white, lambda);
        dispersed |= bsdf.dispersed;
        sagi_bsdf_sample sample;
        if (!sagi_bsdf_sample_wi(&bsdf, rng_unit(r), rng_vec2(r), &sample)) break;
        weight *= sample.weight;
        ray = sag_spawn_ray(&surface, sample.wi);
    }
    return dispersed ? (double)sum[0] : (double)(sum[0] + sum[1] + sum[2] + sum[3]) / 4;
}

static int check(size_t shape, size_t material, rng *r) {
    studio s = open_studio(shape, material);
    const studio_mean m = studio_measure(&s);
    double wanted = 1, deviation = 0;
    const int kind = shapes[shape].kind, loss = materials[material].kind;
    if (loss == LOSES || kind == BENT || (loss == GLASS && kind != CLOSED)) {
        sag_error error;
        sag_render *render = sag_render_create(s.world, &error);
        mean walked = {0};
        for (int i = 0; i < 1500; i++) mean_add(&walked, walk(render, r));
        wanted = mean_of(&walked), deviation = deviation_of(&walked);
        sag_render_destroy(render);
    }
    // (White that is made of a colour is white to 1e-4 or so.)
    // Radiance is higher in glass; what glass has no inside does not give that back.
    const bool glass = strstr(materials[material].text, "\"dielectric\"") != NULL;
    const double most = kind == BENT || (glass && kind == OPEN) ? INFINITY : 1;
    const bool wrong =
        !(m.mean < most + 5 * m.deviation + 1e-3) ||
        !(fabs(m.mean - wanted) < 5 * hypot(m.deviation, deviation) + 1e-3 && m.deviation < 0.04);
    if (wrong)
        print_message("%s, %s: %g +- %g instead of %g +- %g\n", shapes[shape].name, materials[material].name,
                      m.mean, m.deviation, wanted, deviation);
    sag_world_destroy(s.world);
    return wrong;
}

// There is no fog without an inside; what shines in a file's object does not, as in pbrt; parts of solids are
// there as a whole.
static bool senseless(size_t shape, size_t material) {
    return (materials[material].kind == FOG && shapes[shape].kind != CLOSED) ||
           (strstr(materials[material].text, "AreaLight") && strstr(shapes[shape].text, "ObjectBegin")) ||
           (strstr(materials[material].text, "alpha") && strstr(shapes[shape].text, "SolidBegin"));
}

static void every_shape_in_every_material(void **state) {
    (void)state;
    rng r = rng_make(1);
    int wrong = 0;
    for (size_t material = 0; material < MATERIALS; material++)
        for (size_t shape = 0; shape < SHAPES; shape++)
            if (!senseless(shape, material)) wrong += check(shape, material, &r);
    assert_int_equal(wrong, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_shape_in_every_material)};
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
