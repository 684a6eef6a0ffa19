// SPDX-License-Identifier: MIT
// Hit tables: what CSV and .npy rows look like, byte for byte, and that a table which fails leaves no file.
#include "formats/hit_table.h"

#include "formats/npy.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[64], csv_path[80], npy_path[80];

static sagi_hit_row example(void) {
    return (sagi_hit_row){.ray = 12345678901u,
                          .hit = true,
                          .count = 3,
                          .t = 0.1,
                          .position = {1, -2.5, 1e-300},
                          .normal = {0, -0.0, 1},
                          .u = 0.25,
                          .v = 1e22,
                          .geometry = 4,
                          .primitive = 4294967294,
                          .instance = -1,
                          .t_leave = 0.5,
                          .length = 0.75,
                          .geometry_leave = -1,
                          .primitive_leave = 6};
}

static size_t read_file(const char *path, char *bytes, size_t capacity) {
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    size_t size = fread(bytes, 1, capacity, file);
    fclose(file);
    return size;
}

static void write_table(const char *path, sagi_hit_columns columns) {
    sagi_hit_table table;
    sag_error error = {0};
    assert_int_equal(sagi_hit_table_open(&table, path, columns, &error), SAG_OK);
    sagi_hit_row rows[2] = {example(), columns == SAGI_HIT_SPAN ? sagi_hit_no_span(7) : sagi_hit_miss(7)};
    for (int i = 0; i < 2; i++) {
        char bytes[SAGI_HIT_ROW_BYTES];
        size_t size = sagi_hit_encode(&table, &rows[i], bytes);
        assert_int_equal(sagi_hit_table_append(&table, bytes, size, 1, &error), SAG_OK);
    }
    assert_int_equal(access(path, F_OK), -1); // not before it is whole
    assert_int_equal(sagi_hit_table_commit(&table, &error), SAG_OK);
    sagi_hit_table_discard(&table);
    assert_int_equal(access(path, F_OK), 0);
}

static void csv_rows(void **state) {
    (void)state;
    static const char *const expected[] = {
        "ray,hit,t,x,y,z,nx,ny,nz,u,v,geometry,primitive,instance\n"
        "12345678901,1,0.10000000000000001,1,-2.5,1e-300,0,-0,1,0.25,1e+22,4,4294967294,-1\n"
        "7,0,inf,nan,nan,nan,nan,nan,nan,nan,nan,-1,-1,-1\n",
        "ray,hit\n12345678901,1\n7,0\n", "ray,count\n12345678901,3\n7,0\n",
        "ray,hit,t_enter,t_leave,length,geometry_enter,primitive_enter,geometry_leave,primitive_leave,"
        "instance\n"
        "12345678901,1,0.10000000000000001,0.5,0.75,4,4294967294,-1,6,-1\n"
        "7,0,nan,nan,0,-1,-1,-1,-1,-1\n"};
    for (int columns = SAGI_HIT_FULL; columns <= SAGI_HIT_SPAN; columns++) {
        char text[1024];
        write_table(csv_path, (sagi_hit_columns)columns);
        text[read_file(csv_path, text, sizeof text - 1)] = 0;
        assert_string_equal(text, expected[columns]);
        unlink(csv_path);
    }
}

static void npy_rows(void **state) {
    (void)state;
    static const size_t row_bytes[] = {8 + 1 + 9 * 8 + 3 * 8, 9, 16, 8 + 1 + 3 * 8 + 5 * 8};
    for (int columns = SAGI_HIT_FULL; columns <= SAGI_HIT_SPAN; columns++) {
        char bytes[1024];
        write_table(npy_path, (sagi_hit_columns)columns);
        size_t size = read_file(npy_path, bytes, sizeof bytes);
        assert_int_equal(size, SAGI_NPY_WRITTEN_HEADER + 2 * row_bytes[columns]);
        assert_int_equal(sagi_npy_header_length(bytes), SAGI_NPY_WRITTEN_HEADER);
        assert_int_equal(SAGI_NPY_WRITTEN_HEADER % 64, 0);
        assert_int_equal(bytes[SAGI_NPY_WRITTEN_HEADER - 1], '\n');
        assert_non_null(strstr(bytes + 10, "'shape': (2,), }"));
        assert_non_null(strstr(bytes + 10, columns == SAGI_HIT_COUNT ? "('count', '" : "('hit', '|b1')"));
        int64_t ray;
        memcpy(&ray, bytes + SAGI_NPY_WRITTEN_HEADER, 8);
        assert_true(ray == 12345678901);
        if (columns == SAGI_HIT_FULL || columns == SAGI_HIT_SPAN) {
            double t;
            int64_t instance;
            memcpy(&t, bytes + SAGI_NPY_WRITTEN_HEADER + 9, 8);
            memcpy(&instance, bytes + size - 8, 8);
            assert_true(t == 0.1 && instance == -1);
        }
        unlink(npy_path);
    }
}

// The longest row fits in the room it is promised.
static void longest_row(void **state) {
    (void)state;
    const double x = -2.2250738585072014e-308;
    sagi_hit_table table = {.columns = SAGI_HIT_FULL};
    sagi_hit_row row = {.ray = INT64_MAX,
                        .hit = true,
                        .t = x,
                        .position = {x, x, x},
                        .normal = {x, x, x},
                        .u = x,
                        .v = x,
                        .geometry = INT64_MIN,
                        .primitive = INT64_MIN,
                        .instance = INT64_MIN};
    char bytes[SAGI_HIT_ROW_BYTES];
    assert_true(sagi_hit_encode(&table, &row, bytes) <= sizeof bytes);
}

static void failure_leaves_nothing(void **state) {
    (void)state;
    sagi_hit_table table;
    sag_error error = {0};
    assert_int_equal(sagi_hit_table_open(&table, "/nonexistent/hits.csv", SAGI_HIT_FULL, &error),
                     SAG_ERROR_IO);
    assert_string_equal(error.file, "/nonexistent/hits.csv");
    assert_int_equal(sagi_hit_table_open(&table, csv_path, SAGI_HIT_FULL, &error), SAG_OK);
    sagi_hit_table_discard(&table);
    assert_int_equal(access(csv_path, F_OK), -1);
    assert_int_equal(rmdir(folder), 0); // nothing was left in it
    assert_non_null(strcpy(folder, "/tmp/sagitta-hits-XXXXXX"));
    assert_non_null(mkdtemp(folder));
}

static int set_up(void **state) {
    (void)state;
    strcpy(folder, "/tmp/sagitta-hits-XXXXXX");
    if (!mkdtemp(folder)) return -1;
    snprintf(csv_path, sizeof csv_path, "%s/hits.csv", folder);
    snprintf(npy_path, sizeof npy_path, "%s/hits.npy", folder);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    return rmdir(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(csv_rows),
        cmocka_unit_test(npy_rows),
        cmocka_unit_test(longest_row),
        cmocka_unit_test(failure_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
