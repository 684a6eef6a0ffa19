// SPDX-License-Identifier: MIT
// pbrt's camera "realistic", as far as a thin lens can stand for one: it has the same field of view, the same
// opening and is sharp at the same distance.
//
// A file has four numbers for each surface, from the front: radius of curvature (0: the stop), way to the
// next, index of refraction behind it, diameter, in millimetres. A ray along the axis at height y, with slope
// s, goes on from a surface with n' s' = n s − y (n' − n)/R (paraxial optics); from a ray that comes in at y
// = 1, s = 0, the focal length is f = −1/s at the end, and the pupil is the stop's diameter by its y there.
#include "formats/pbrt.h"
#include "math/elementary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MAX_SURFACES 256
#define MILLIMETER   1e-3
#define PI           3.14159265358979323846

// All in millimetres.
typedef struct lens {
    double focal, pupil; // focal length and the entrance pupil's diameter
    double back, height; // from the last surface to the focus, and the ray's height there
} lens;

static bool paraxial(const double (*surfaces)[4], size_t count, double stop, lens *l) {
    double y = 1, slope = 0, n = 1;
    l->pupil = stop;
    for (size_t i = 0; i < count; i++) {
        const double radius = surfaces[i][0], behind = surfaces[i][2] == 0 ? 1 : surfaces[i][2];
        if (radius == 0) {
            l->pupil = fmin(stop, surfaces[i][3]) / fabs(y);
        } else {
            slope = (n * slope - y * (behind - n) / radius) / behind;
            n = behind;
        }
        if (i + 1 < count) y += slope * surfaces[i][1];
    }
    l->focal = -1 / slope;
    l->back = -y / slope;
    l->height = y;
    return l->focal > 0 && isfinite(l->focal) && l->pupil > 0 && isfinite(l->pupil) && l->back > 0;
}

sag_status sagi_pbrt_lens(sagi_pbrt *p, sagi_place place, sag_camera *camera) {
    sagi_params *params = &p->params;
    sagi_pbrt_warn(p, place,
                   "Camera \"realistic\" is not supported: a thin lens of its field takes its place");
    camera->focal_distance = sagi_params_float(params, "focusdistance", 10);
    const double stop = sagi_params_float(params, "aperturediameter", 1);
    sagi_pbrt_ignore(p, "aperture", NULL);
    const sagi_param *file = sagi_params_find(params, "lensfile", SAGI_TYPE_STRING);
    if (!file || file->string_count != 1)
        return sagi_params_fail(params, file, "its \"string lensfile\" is missing");
    double surfaces[MAX_SURFACES][4];
    lens l;
    size_t count;
    const sag_status status = sagi_pbrt_read_numbers(p, file, params->strings[file->first_string],
                                                     &surfaces[0][0], 4 * MAX_SURFACES, &count);
    if (status != SAG_OK) return status;
    if (count == 0 || count % 4)
        return sagi_params_fail(params, file, "a lens has four numbers for each surface, not %zu in all",
                                count);
    if (!(stop > 0) || !paraxial((const double(*)[4])surfaces, count / 4, stop, &l)) {
        sagi_pbrt_warn(p, place, "Camera \"realistic\": its lens gathers no light: a field of 90 degrees");
        return SAG_OK;
    }
    const double focal = l.focal * MILLIMETER;
    if (!(camera->focal_distance > focal))
        return sagi_params_fail(params, sagi_params_find(params, "focusdistance", ~0u),
                                "focusdistance %g: within the focal length of %g", camera->focal_distance,
                                focal);
    camera->lens_radius = l.pupil / 2 * MILLIMETER;
    p->image_distance = 1 / (1 / focal - 1 / camera->focal_distance);
    const double behind = l.back * MILLIMETER + (p->image_distance - focal),
                 beam = l.height * camera->lens_radius;
    p->lens_share = PI * beam * beam / (behind * behind);
    return SAG_OK;
}

void sagi_pbrt_apply_lens(sagi_pbrt *p) {
    if (!(p->image_distance > 0) || p->options->geometry_only) return;
    sag_settings *settings = sag_world_settings(p->world);
    const double width = settings->film.width, height = settings->film.height;
    const double shorter =
        p->film_diagonal * MILLIMETER * fmin(width, height) / sqrt(width * width + height * height);
    settings->camera.fov_rad = 2 * sagi_atan2(shorter / 2, p->image_distance);
}
