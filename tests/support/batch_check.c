// SPDX-License-Identifier: MIT
#include "support/batch_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

void batch_check(const sag_scene *scene, const sag_ray *rays, size_t count, batch_counts *counts) {
    sag_hit *hits = malloc(count * sizeof *hits);
    assert_non_null(hits);
    memset(hits, 0xA5, count * sizeof *hits);
    sag_intersect_batch(scene, rays, hits, count);
    for (size_t i = 0; i < count; i++) {
        sag_hit hit;
        memset(&hit, 0xA5, sizeof hit);
        if (sag_intersect(scene, &rays[i], &hit)) {
            assert_memory_equal(&hit, &hits[i], sizeof hit);
            counts->met++, counts->flipped += hit.flipped;
        } else {
            assert_true(hits[i].t == INFINITY);
            assert_int_equal(hits[i].geometry, SAG_INVALID_ID);
            counts->missed++;
        }
    }
    free(hits);
}
