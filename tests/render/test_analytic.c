// SPDX-License-Identifier: MIT
// Scenes whose light can be worked out on paper, averaged over whole surfaces and through all bounces: form
// factors of discs, rectangles and balls (Howell, "A Catalog of Radiation Heat Transfer Configuration
// Factors", C-11, C-14, C-41, C-121), the integrating sphere, panes and plates of glass, light scattered once
// in fog, and what white looks like to every sensor.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
// clang-format on
#include "render/fresnel.h"
#include "render/medium.h"
#include "render/sensor.h"
#include "support/mean.h"
#include "support/picture.h"

#define PI 3.14159265358979323846

// The mean of the picture is the expected one within five standard deviations, which several seeds tell, and
// these are below one half percent.
static void expect(studio *s, const char *what, double expected) {
    enum { SEEDS = 10 };
    mean m = {0};
    s->settings->sampler = SAG_SAMPLER_SOBOL;
    s->settings->samples_per_pixel /= 2;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        s->settings->seed = seed;
        mean_add(&m, studio_measure(s).mean);
    }
    // (Of so few the deviation is itself uncertain: Student's t.)
    const double deviation = deviation_of(&m) * sqrt(SEEDS / (SEEDS - 1.0));
    if (!(fabs(mean_of(&m) - expected) <= 6 * deviation + 1e-4 * expected))
        fail_msg("%s: %.6g +- %.2g instead of %.6g", what, mean_of(&m), deviation, expected);
    if (!(deviation <= 0.01 * expected)) fail_msg("%s: %g +- %g", what, mean_of(&m), deviation);
    studio_close(s);
}

static uint32_t look(studio *s, uint32_t id, sag_appearance appearance) {
    assert_int_equal(sag_world_set_appearance(s->world, s->scene, id, &appearance), SAG_OK);
    return id;
}

// ---- form factors

// Looking straight down on the square |x|, |y| ≤ half in z = 0 and nothing else; what is above is not seen.
static studio from_above(double half, sag_strategy strategy) {
    studio s = studio_open(0);
    s.settings->camera.kind = SAG_CAMERA_ORTHOGRAPHIC;
    for (int i = 0; i < 4; i++) s.settings->camera.screen_window[i] = i % 2 ? half : -half;
    s.settings->strategy = strategy;
    s.settings->integrator = SAG_INTEGRATOR_DIRECT;
    return s;
}

static void shine_from_above(studio *s, uint32_t id) {
    look(s, id, (sag_appearance){.emission = {2, 2, 2}, .two_sided = true});
    sag_geometry_set_mask(s->scene, id, ~(uint32_t)SAG_RAY_CAMERA);
}

static void form_factors(void **state) {
    (void)state;
    for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_SURFACES; strategy++) {
        // Coaxial discs: of radius 1 the one that is lit, 0.7 the lamp, 0.5 apart. The picture is the disc's
        // square; a grey (½) disc of irradiance π L F shows ½ L F.
        const sag_vec3 down = {0, 0, -1}, up = {0, 0, 1};
        studio s = from_above(1, (sag_strategy)strategy);
        sag_add_disk(s.scene, &(sag_disk){.normal = up, .radius = 1});
        shine_from_above(&s, sag_add_disk(s.scene, &(sag_disk){{0, 0, 0.5}, down, .radius = 0.7}));
        double r1 = 1 / 0.5, r2 = 0.7 / 0.5, x = 1 + (1 + r2 * r2) / (r1 * r1);
        expect(&s, "discs", PI / 4 * 0.5 * 2 * (x - sqrt(x * x - 4 * r2 * r2 / (r1 * r1))) / 2);

        // A ball of radius 0.4 at height 0.8 over the disc: half of the share of the sphere that the disc
        // takes of all that leaves it. F(disc to ball) is that times the ratio of the areas.
        s = from_above(1, (sag_strategy)strategy);
        sag_add_disk(s.scene, &(sag_disk){.normal = up, .radius = 1});
        shine_from_above(&s, sag_add_sphere(s.scene, &(sag_sphere){.center = {0, 0, 0.8}, .radius = 0.4}));
        const double to_disc = (1 - 1 / sqrt(1 + 1 / 0.64)) / 2;
        expect(&s, "ball over a disc", PI / 4 * 0.5 * 2 * to_disc * 4 * 0.16);

        // Squares of side 2 face to face, 0.8 apart.
        s = from_above(1, (sag_strategy)strategy);
        sag_add_rectangle(s.scene, &(sag_rectangle){{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}});
        shine_from_above(&s,
                         sag_add_rectangle(s.scene, &(sag_rectangle){{-1, -1, 0.8}, {2, 0, 0}, {0, 2, 0}}));
        x = 2 / 0.8, r1 = sqrt(1 + x * x);
        const double facing =
            2 / (PI * x * x) *
            (log(r1 * r1 / sqrt(1 + 2 * x * x)) + 2 * x * r1 * atan(x / r1) - 2 * x * atan(x));
        expect(&s, "squares", 0.5 * 2 * facing);

        // A wall of height 1.5 along the edge of a square of side 2.
        s = from_above(1, (sag_strategy)strategy);
        sag_add_rectangle(s.scene, &(sag_rectangle){{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}});
        shine_from_above(&s,
                         sag_add_rectangle(s.scene, &(sag_rectangle){{-1, -1, 0}, {2, 0, 0}, {0, 0, 1.5}}));
        const double w = 1, h = 1.5 / 2, w2 = w * w, h2 = h * h, both = 1 + w2 + h2, d = sqrt(h2 + w2);
        const double logs = log((1 + w2) * (1 + h2) / both) + w2 * log(w2 * both / ((1 + w2) * (w2 + h2))) +
                            h2 * log(h2 * both / ((1 + h2) * (h2 + w2)));
        const double edge = (w * atan(1 / w) + h * atan(1 / h) - d * atan(1 / d) + logs / 4) / (PI * w);
        expect(&s, "wall and floor", 0.5 * 2 * edge);
    }
}

// ---- all bounces

// A hollow ball: every point lights every other alike. That it shines with E and reflects ρ makes E/(1 − ρ);
// n bounces of it E (1 − ρⁿ⁺¹)/(1 − ρ). A point light of intensity I in the middle makes ρ/(1 − ρ) I/(π r²).
static void integrating_sphere(void **state) {
    (void)state;
    const double rho = 0.7;
    for (int way = 0; way < 5; way++) {
        studio s = studio_open(0);
        const bool lamp = way == 4;
        if (way < 3) s.settings->strategy = (sag_strategy)way;
        s.settings->max_depth = way == 3 ? 2 : 1000;
        s.settings->camera.fov_rad = 2;
        studio_aim(&s, (sag_vec3){0.5, 0.3, 0}, (sag_vec3){0, 0, 1});
        const uint32_t paint = studio_material(
            &s, (sag_material){.kind = SAG_MATERIAL_DIFFUSE, .reflectance.value = {rho, rho, rho}});
        const double light = lamp ? 0 : 0.3;
        look(&s, sag_add_sphere(s.scene, &(sag_sphere){.radius = 2}),
             (sag_appearance){.material = paint, .emission = {light, light, light}, .two_sided = true});
        if (lamp) sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_POINT, .color = {5, 5, 5}});
        expect(&s, "hollow ball",
               lamp       ? rho / (1 - rho) * 5 / (PI * 4)
               : way == 3 ? light * (1 - rho * rho * rho) / (1 - rho)
                          : light / (1 - rho));
    }
}

// ---- glass

// A plate of glass, or a pane without thickness, between a sky of 1 and a ground of 3: R of the sky comes
// back and T of the ground comes through, with all bounces in the plate: for a share a that its own colour
// lets through on a way across, T = (1 − F)² a/(1 − F² a²) and R = F (1 + a T).
static void plates_of_glass(void **state) {
    (void)state;
    const double angles[] = {0, 50 * PI / 180, 75 * PI / 180};
    for (int i = 0; i < 3; i++)
        for (int kind = 0; kind < 3; kind++) { // a pane, a plate, a green plate
            studio s = studio_open(0);
            s.settings->max_depth = 100;
            s.settings->integrator = kind == 2 ? SAG_INTEGRATOR_VOLPATH : SAG_INTEGRATOR_PATH;
            const uint32_t glass = studio_material(
                &s, (sag_material){.kind = kind == 0 ? SAG_MATERIAL_THIN_DIELECTRIC : SAG_MATERIAL_DIELECTRIC,
                                   .eta.value = {1.5, 0, 0}});
            const uint32_t black = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_DIFFUSE});
            sag_appearance pane = {.material = glass};
            if (kind == 2)
                pane.inside = sag_world_add_medium(s.world, &(sag_medium){.absorption.value = {2, 2, 2}});
            if (kind == 0)
                look(&s, sag_add_plane(s.scene, &(sag_plane){.normal = {0, 1, 0}}), pane);
            else
                look(&s, sag_add_box(s.scene, &(sag_box){{-1e3, -0.3, -1e3}, {1e3, 0, 1e3}}), pane);
            look(&s, sag_add_plane(s.scene, &(sag_plane){.point = {0, -2, 0}, .normal = {0, 1, 0}}),
                 (sag_appearance){.material = black, .emission = {3, 3, 3}});
            sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
            const double cosine = cos(angles[i]), sine = sin(angles[i]);
            studio_aim_point(&s, (sag_vec3){0.01, 5 * cosine, 5 * sine}, (sag_vec3){0, 0, 0});
            const double f = sagi_fresnel_dielectric(cosine, 1.5),
                         within = 0.3 / sqrt(1 - sine * sine / 2.25), a = kind == 2 ? exp(-2 * within) : 1,
                         t = (1 - f) * (1 - f) * a / (1 - f * f * a * a), r = f * (1 + a * t);
            char what[64];
            snprintf(what, sizeof what, "glass %d at %g", kind, angles[i]);
            expect(&s, what, r + 3 * t);
        }
}

// ---- fog

// Half a space of fog down to a depth D, seen straight from above, under a light of irradiance E from the
// direction of cosine μ: scattered once, σs p(θ) E (1 − exp(−σt D (1 + 1/μ)))/(σt (1 + 1/μ)).
static void fog_scatters_once(void **state) {
    (void)state;
    static const double gs[] = {0, 0.6, -0.4};
    for (int i = 0; i < 3; i++) {
        studio s = studio_open(0);
        s.settings->integrator = SAG_INTEGRATOR_VOLPATH;
        s.settings->max_depth = 1;
        s.settings->samples_per_pixel = 64;
        const double sa = 0.3, ss = 0.8, depth = 1.2, mu = 0.6, sigma = sa + ss;
        const uint32_t air = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_INTERFACE});
        const uint32_t fog = sag_world_add_medium(
            s.world,
            &(sag_medium){.absorption.value = {sa, sa, sa}, .scattering.value = {ss, ss, ss}, .g = gs[i]});
        look(&s, sag_add_box(s.scene, &(sag_box){{-1e3, -1e3, -depth}, {1e3, 1e3, 0}}),
             (sag_appearance){.material = air, .inside = fog});
        sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_DISTANT,
                                                  .color = {10, 10, 10},
                                                  .from = {sqrt(1 - mu * mu), 0, mu}});
        studio_aim_point(&s, (sag_vec3){0, 0, 5}, (sag_vec3){0, 0, 0});
        // Light goes down at μ and on up: it is turned by the angle of cosine −μ.
        const double way = 1 + 1 / mu,
                     phase = (1 - gs[i] * gs[i]) / (4 * PI * pow(1 + gs[i] * gs[i] + 2 * gs[i] * mu, 1.5));
        expect(&s, "fog", ss * phase * 10 * (1 - exp(-sigma * depth * way)) / (sigma * way));
    }
}

// ---- white

// A white wall in the light that a sensor is balanced for is neutral, and as bright as that light: the eye's
// in D65 as it is; every sensor when it is told the light's temperature. Cameras as near as pbrt's fit to 24
// patches brings them.
static void white_is_neutral(void **state) {
    (void)state;
    static const double kelvins[] = {0, 6500, 5000, 9000};
    static float daylight[SAGI_WAVELENGTH_COUNT];
    static double pairs[2 * SAGI_WAVELENGTH_COUNT];
    for (int sensor = -1; sensor < SAGI_CAMERA_COUNT; sensor++)
        for (int i = 0; i < 4; i++) {
            studio s = studio_open(0);
            s.in_color = true;
            s.settings->film.width = s.settings->film.height = 8;
            s.settings->samples_per_pixel = 64;
            s.settings->sampler = SAG_SAMPLER_SOBOL;
            s.settings->film.white_balance_kelvin = kelvins[i];
            if (sensor >= 0) strcpy(s.settings->film.sensor, sagi_cameras[sensor].name);
            // (Without a balance, the eye's white is D65, of 6504 K.)
            sagi_daylight_table(kelvins[i] > 0 ? kelvins[i] : sensor < 0 ? 6504 : 6500, daylight);
            for (int k = 0; k < SAGI_WAVELENGTH_COUNT; k++)
                pairs[2 * k] = SAGI_WAVELENGTH_MIN + k, pairs[2 * k + 1] = (double)daylight[k];
            sag_spectrum_id id;
            const sag_spectrum lamp = {.kind = SAG_SPECTRUM_SAMPLED,
                                       .pairs = pairs,
                                       .pair_count = SAGI_WAVELENGTH_COUNT,
                                       .normalize = true};
            assert_int_equal(sag_world_add_spectrum(s.world, &lamp, &id), SAG_OK);
            const uint32_t white = studio_material(
                &s, (sag_material){.kind = SAG_MATERIAL_DIFFUSE, .reflectance.value = {1, 1, 1}});
            look(&s, sag_add_plane(s.scene, &(sag_plane){.normal = {0, 0, 1}}),
                 (sag_appearance){.material = white});
            sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_DISTANT,
                                                      .color = {PI, PI, PI},
                                                      .spectrum = id,
                                                      .from = {0, 0, 1}});
            sag_image image = studio_render(&s, NULL);
            double sum[3] = {0, 0, 0};
            for (size_t k = 0; k < 8 * 8 * 3; k++) sum[k % 3] += (double)image.pixels[k] / (8 * 8);
            const double within = sensor < 0 ? 0.005 : 0.03;
            for (int k = 0; k < 3; k++)
                if (!(fabs(sum[k] - 1) < within))
                    fail_msg("%s at %g K: %g %g %g", s.settings->film.sensor, kelvins[i], sum[0], sum[1],
                             sum[2]);
            sag_image_clear(s.context, &image);
            studio_close(&s);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(form_factors),     cmocka_unit_test(integrating_sphere),
        cmocka_unit_test(plates_of_glass),  cmocka_unit_test(fog_scatters_once),
        cmocka_unit_test(white_is_neutral),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
