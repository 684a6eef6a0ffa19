// SPDX-License-Identifier: MIT
// A shape's verbs as a table entry, for a shape that is not in the library's own table (sagi_shape_classes).
// SHAPE_KIND(trough) defines trough_kind.
#ifndef TESTS_SUPPORT_SHAPE_KIND_H
#define TESTS_SUPPORT_SHAPE_KIND_H

#include "shapes/shape.h"

#define SHAPE_KIND(X)                                                                                        \
    static sag_status X##_kind_validate(const void *s, sag_error *e) { return sag_##X##_validate(s, e); }    \
    static sag_box3 X##_kind_bounds(const void *s) { return sag_##X##_bounds(s); }                           \
    static bool X##_kind_hit(const void *s, const sag_ray *r, sag_hit *h) { return sag_##X##_hit(s, r, h); } \
    static bool X##_kind_occluded(const void *s, const sag_ray *r) { return sag_##X##_occluded(s, r); }      \
    static size_t X##_kind_crossings(const void *s, const sag_ray *r, sag_hit *h, size_t n) {                \
        return sag_##X##_crossings(s, r, h, n);                                                              \
    }                                                                                                        \
    static void X##_kind_surface(const void *s, const sag_ray *r, const sag_hit *h, sag_surface *f) {        \
        sag_##X##_surface(s, r, h, f);                                                                       \
    }                                                                                                        \
    static double X##_kind_area(const void *s) { return sag_##X##_area(s); }                                 \
    static bool X##_kind_sample(const void *s, sag_vec2 u, sag_surface *f) {                                 \
        return sag_##X##_sample(s, u, f);                                                                    \
    }                                                                                                        \
    static sagi_shape_class X##_kind = {.name = #X,                                                          \
                                        .struct_bytes = sizeof(sag_##X),                                     \
                                        .validate = X##_kind_validate,                                       \
                                        .bounds = X##_kind_bounds,                                           \
                                        .hit = X##_kind_hit,                                                 \
                                        .occluded = X##_kind_occluded,                                       \
                                        .crossings = X##_kind_crossings,                                     \
                                        .surface = X##_kind_surface,                                         \
                                        .area = X##_kind_area,                                               \
                                        .sample = X##_kind_sample};
#define SHAPE_CONTAINS(X)                                                                                    \
    static bool X##_kind_contains(const void *s, sag_vec3 p) { return sag_##X##_contains(s, p); }            \
    static double X##_kind_volume(const void *s) { return sag_##X##_volume(s); }
#define SHAPE_CLOSEST(X)                                                                                     \
    static sag_vec3 X##_kind_closest(const void *s, sag_vec3 p) { return sag_##X##_closest_point(s, p); }

#endif
