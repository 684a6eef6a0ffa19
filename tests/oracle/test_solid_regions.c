// SPDX-License-Identifier: MIT
// The closed shapes' `contains` beside the signs of their equations, decided exactly (support/region.h); and
// those by the quick way beside those by fractions. Points in general position and on a lattice.
#include "shapes/shape.h"
#include "support/closed_shape.h"
#include "support/region.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

static void check(bool lattice, size_t shapes) {
    rng r = rng_make(lattice ? 51 : 50);
    size_t decisions = 0, fractions = 0, surface = 0, wrong = 0;
    for (size_t i = 0; i < shapes; i++) {
        double size = ldexp(1, (int)rng_below(&r, 60) - 30);
        random_shape s;
        closed_shape_make(&r, size, lattice, &s);
        const sagi_shape_class *kind = &sagi_shape_classes[s.kind];
        if (kind->validate(&s.as, NULL) != SAG_OK) continue;
        shape_region region;
        region_make(&region, s.kind, &s.as);
        for (int k = 0; k < 100; k++) {
            sag_vec3 p = rng_vec3(&r, 1.5 * size);
            if (lattice)
                p = (sag_vec3){0.125 * size * rint(8 * p.x / size), 0.125 * size * rint(8 * p.y / size),
                               0.125 * size * rint(8 * p.z / size)};
            spot at = spot_at(p);
            membership quick = region_filter(&region, &at), exact = quick;
            if (quick == MEMBER_UNKNOWN || k < 3) exact = region_exact(&region, &at), fractions++;
            wrong += quick != MEMBER_UNKNOWN && quick != exact;
            if (exact == MEMBER_UNKNOWN) {
                surface++;
                continue;
            }
            decisions++;
            if (kind->contains(&s.as, p) != (exact == MEMBER_IN) && wrong++ < 20)
                print_message("%s: %a %a %a is %s\n", kind->name, p.x, p.y, p.z,
                              exact == MEMBER_IN ? "in" : "out");
        }
        region_clear(&region);
    }
    print_message("%zu decisions, %zu wrong; %zu in fractions, %zu on a surface\n", decisions, wrong,
                  fractions, surface);
    assert_int_equal(wrong, 0);
}

static void general(void **state) {
    (void)state;
    check(false, soak(30000));
}
static void lattice(void **state) {
    (void)state;
    check(true, soak(10000));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(general), cmocka_unit_test(lattice)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
