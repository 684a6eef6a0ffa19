// SPDX-License-Identifier: MIT
// The umbrella header compiles and its version agrees with itself.
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static void version_is_consistent(void **state) {
    (void)state;
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", SAG_VERSION_MAJOR, SAG_VERSION_MINOR, SAG_VERSION_PATCH);
    assert_string_equal(text, SAG_VERSION);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(version_is_consistent)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
