// SPDX-License-Identifier: MIT
// Which shapes have a outline (outline.h).
#include "shapes/outline.h"

bool sagi_outline_make(const sagi_quadric_form *form, double z_min, double z_max, sagi_outline *p) {
    *p = (sagi_outline){.form = *form, .z_min = z_min, .z_max = z_max};
    p->form.exact = NULL, p->form.shape = NULL;
    return form->exponent == 0 && !form->mixed;
}

bool sagi_shape_has_outline(sag_shape_kind kind) {
    return kind == SAG_SHAPE_CYLINDER || kind == SAG_SHAPE_CONE || kind == SAG_SHAPE_PARABOLOID ||
           kind == SAG_SHAPE_HYPERBOLOID || kind == SAG_SHAPE_ELLIPSOID;
}

bool sagi_shape_outline(sag_shape_kind kind, const void *shape, sagi_outline *p) {
    if (kind == SAG_SHAPE_CYLINDER) return sagi_cylinder_outline(shape, p);
    if (kind == SAG_SHAPE_CONE) return sagi_cone_outline(shape, p);
    if (kind == SAG_SHAPE_PARABOLOID) return sagi_paraboloid_outline(shape, p);
    if (kind == SAG_SHAPE_HYPERBOLOID) return sagi_hyperboloid_outline(shape, p);
    return kind == SAG_SHAPE_ELLIPSOID && sagi_ellipsoid_outline(shape, p);
}
