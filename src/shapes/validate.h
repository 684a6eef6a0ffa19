// SPDX-License-Identifier: MIT
// What the shapes' validate functions share: a check that fails writes a message naming shape, field and
// value.
#ifndef SAGI_SHAPES_VALIDATE_H
#define SAGI_SHAPES_VALIDATE_H

#include <sagitta/shapes.h>

static inline bool sagi_is_coordinate(double x) { return fabs(x) <= SAG_MAX_COORDINATE; }

static inline bool sagi_is_coordinate3(sag_vec3 v) {
    return sagi_is_coordinate(v.x) && sagi_is_coordinate(v.y) && sagi_is_coordinate(v.z);
}

static inline bool sagi_is_zero3(sag_vec3 v) { return v.x == 0 && v.y == 0 && v.z == 0; }

static inline sag_status sagi_invalid3(sag_error *error, const char *shape, const char *field, sag_vec3 v,
                                       const char *why) {
    return sag_error_set(error, SAG_ERROR_GEOMETRY, "%s: %s (%.17g, %.17g, %.17g) %s", shape, field, v.x, v.y,
                         v.z, why);
}

static inline sag_status sagi_invalid(sag_error *error, const char *shape, const char *field, double value,
                                      const char *why) {
    return sag_error_set(error, SAG_ERROR_GEOMETRY, "%s: %s %.17g %s", shape, field, value, why);
}

// Finite and no larger than SAG_MAX_COORDINATE; NaN fails.
static inline sag_status sagi_check_point(sag_error *error, const char *shape, const char *field,
                                          sag_vec3 v) {
    return sagi_is_coordinate3(v) ? SAG_OK
                                  : sagi_invalid3(error, shape, field, v, "must be finite and at most 2^100");
}

// The same, and not 0.
static inline sag_status sagi_check_direction(sag_error *error, const char *shape, const char *field,
                                              sag_vec3 v) {
    if (sagi_is_zero3(v)) return sagi_invalid3(error, shape, field, v, "must not be 0");
    return sagi_check_point(error, shape, field, v);
}

// 0 < value ≤ SAG_MAX_COORDINATE.
static inline sag_status sagi_check_positive(sag_error *error, const char *shape, const char *field,
                                             double value) {
    return value > 0 && sagi_is_coordinate(value)
               ? SAG_OK
               : sagi_invalid(error, shape, field, value, "must be positive and at most 2^100");
}

#endif
