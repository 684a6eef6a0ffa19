// SPDX-License-Identifier: MIT
// Boxes. An empty box need not be the canonical one (+∞, −∞): any with min > max, or a NaN, counts as empty.
#include <sagitta/math.h>

sag_box3 sag_box3_empty(void) {
    return (sag_box3){.min = {INFINITY, INFINITY, INFINITY}, .max = {-INFINITY, -INFINITY, -INFINITY}};
}

bool sag_box3_is_empty(const sag_box3 *box) {
    return !(box->min.x <= box->max.x && box->min.y <= box->max.y && box->min.z <= box->max.z);
}

sag_box3 sag_box3_union(sag_box3 a, sag_box3 b) {
    if (sag_box3_is_empty(&a)) return b;
    if (sag_box3_is_empty(&b)) return a;
    return (sag_box3){
        .min = {fmin(a.min.x, b.min.x), fmin(a.min.y, b.min.y), fmin(a.min.z, b.min.z)},
        .max = {fmax(a.max.x, b.max.x), fmax(a.max.y, b.max.y), fmax(a.max.z, b.max.z)},
    };
}

sag_box3 sag_box3_extend(sag_box3 box, sag_vec3 point) {
    return sag_box3_union(box, (sag_box3){.min = point, .max = point});
}
