// SPDX-License-Identifier: MIT
// Ray tables: what is read from CSV and .npy, and what malformed ones are told. Every table is a file in a
// temporary directory; what is wrong must be reported with its place, and no memory may stay behind.
#include "formats/ray_table.h"

#include "formats/npy.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define MANY 200000

static sag_context *context;
static char path[64];

static void write_bytes(const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

// Reads the whole table; how many rays there are, the first `capacity` of which are kept.
static sag_status read_all(sag_ray *rays, size_t capacity, size_t *total, sag_error *error) {
    size_t before, after;
    sag_context_memory(context, &before, NULL);
    sagi_ray_reader *reader = NULL;
    *total = 0;
    sag_status status = sagi_ray_reader_open(context, path, &reader, error);
    while (status == SAG_OK) {
        const sag_ray *block;
        size_t count;
        status = sagi_ray_reader_next(reader, &block, &count, error);
        if (status != SAG_OK || count == 0) break;
        for (size_t i = 0; i < count && *total + i < capacity; i++) rays[*total + i] = block[i];
        *total += count;
    }
    if (status == SAG_OK) assert_true(sagi_ray_reader_fraction(reader) == 1);
    sagi_ray_reader_close(reader);
    sag_context_memory(context, &after, NULL);
    assert_int_equal(before, after);
    return status;
}

static void good_csv(const char *text, size_t count, sag_ray *rays) {
    sag_error error = {0};
    size_t total;
    write_bytes(text, strlen(text));
    if (read_all(rays, 4, &total, &error) != SAG_OK)
        fail_msg("%s: %d:%d: %s", text, error.line, error.column, error.message);
    assert_int_equal(total, count);
}

static void bad_csv(const char *text, int line, int column, const char *part) {
    sag_error error = {0};
    sag_ray rays[4];
    size_t total;
    write_bytes(text, strlen(text));
    assert_int_equal(read_all(rays, 4, &total, &error), SAG_ERROR_FORMAT);
    assert_string_equal(error.file, path);
    if (error.line != line || error.column != column || !strstr(error.message, part)) {
        fail_msg("'%s': got %d:%d: %s", text, error.line, error.column, error.message);
    }
}

static void csv_forms(void **state) {
    (void)state;
    sag_ray rays[4];
    good_csv("", 0, rays);
    good_csv("\n\n# nothing\n", 0, rays);
    good_csv("1,2,3,4,5,6\n", 1, rays);
    assert_true(rays[0].origin.x == 1 && rays[0].direction.z == 6 && rays[0].t_min == 0 &&
                rays[0].t_max == INFINITY);
    assert_int_equal(rays[0].mask, 0);
    good_csv("1,2,3,4,5,6,-7,8", 1, rays);
    assert_true(rays[0].t_min == -7 && rays[0].t_max == 8);
    good_csv("ox,oy,oz,dx,dy,dz\r\n1,2,3,4,5,6\r\n\r\n  7 , 8,9,10,11,12 # a comment\r\n", 2, rays);
    assert_true(rays[1].origin.x == 7 && rays[1].direction.z == 12);
    good_csv("\xEF\xBB\xBFOX;OY;OZ;DX;DY;DZ;TMIN;TMAX\n1;2;3;4;5;6;0;inf\n", 1, rays);
    assert_true(rays[0].t_max == INFINITY);
    good_csv("dx,dy,dz,x,y,z\n1,2,3,4,5,6\n", 1, rays);
    assert_true(rays[0].direction.x == 1 && rays[0].origin.x == 4);
    good_csv("# made by hand\n1.000000000000000000e+00 2 3\t4 5 6\n", 1, rays);
    assert_true(rays[0].origin.x == 1 && rays[0].direction.x == 4);
    good_csv("0,0,0,0,0,-1e-300,-inf,inf\n", 1, rays);
    assert_true(rays[0].t_min == -INFINITY);
}

static void csv_errors(void **state) {
    (void)state;
    bad_csv("hello\n", 1, 1, "'hello' is not a number");
    bad_csv("1,2,3,4,5,6\n1,2,foo,4,5,6\n", 2, 5, "'foo' is not a number");
    bad_csv("1,2,3,4,5,6\n\n1,2,3x,4,5,6\n", 3, 5, "'3x' is not a number");
    bad_csv("1,2,3,4,5\n", 1, 9, "5 columns");
    bad_csv("1,2,3,4,5,6,7\n", 1, 13, "7 columns");
    bad_csv("1,2,3,4,5,6\n1,2,3,4,5,6,7,8\n", 2, 15, "8 columns, but 6 in the first ray");
    bad_csv("1,2,3,4,5,6,7,8,9\n", 1, 17, "more than 8 columns");
    bad_csv("1,2,,4,5,6\n", 1, 5, "column 3 is empty");
    bad_csv("1,2,3,4,5,6,\n", 1, 13, "column 7 is empty");
    bad_csv(",2,3,4,5,6\n", 1, 1, "column 1 is empty");
    bad_csv("1,2,3,0,0,-0\n", 1, 7, "the direction is zero");
    bad_csv("1,2,nan,0,0,1\n", 1, 5, "oz is NaN");
    bad_csv("1,2,3,0,NaN,1\n", 1, 9, "dy is NaN");
    bad_csv("inf,2,3,0,0,1\n", 1, 1, "the origin is infinite");
    bad_csv("1,1e999,3,0,0,1\n", 1, 3, "the origin is infinite");
    bad_csv("1,2,3,0,0,-inf\n", 1, 11, "the direction is infinite");
    bad_csv("1,2,3,0,0,1,5,4\n", 1, 13, "tmin is greater than tmax");
    bad_csv("ox,oy,oz,dx,dy,dy\n", 1, 16, "twice");
    bad_csv("ox,oy,oz,dx,dy\n", 1, 13, "must name");
    bad_csv("ox,oy,oz,dx,dy,dz\nox,oy,oz,dx,dy,dz\n", 2, 1, "'ox' is not a number");
    bad_csv("ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6,7,8\n", 2, 15, "6 in the header");
    bad_csv("\x01\x02\x03\xFF\xFE garbage\n", 1, 1, "is not a number");
}

static void csv_of_many_blocks(void **state) {
    (void)state;
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    for (int i = 0; i < MANY; i++) {
        fprintf(file, "%d,%.17g,-3e-5,0.25,%d,1.5%s", i, sqrt(i), i % 7, i % 3 ? "\n" : "\r\n");
        if (i % 100 == 0) fputs("\n# a comment\n", file);
    }
    fclose(file);
    sag_ray *rays = malloc(MANY * sizeof *rays);
    assert_non_null(rays);
    size_t total;
    sag_error error = {0};
    assert_int_equal(read_all(rays, MANY, &total, &error), SAG_OK);
    assert_int_equal(total, MANY);
    for (int i = 0; i < MANY; i++) {
        const sag_ray *r = &rays[i];
        assert_true(r->origin.x == i && r->origin.y == sqrt(i) && r->origin.z == -3e-5);
        assert_true(r->direction.x == 0.25 && r->direction.y == i % 7 && r->direction.z == 1.5);
    }
    free(rays);
    // An error far down is still reported with its line.
    file = fopen(path, "ab");
    fputs("1,2,3,0,0,0", file);
    fclose(file);
    assert_int_equal(read_all(NULL, 0, &total, &error), SAG_ERROR_FORMAT);
    assert_int_equal(error.line, MANY + 2 * (MANY / 100) + 1);
    assert_int_equal(error.column, 7);
}

static void endless_line(void **state) {
    (void)state;
    size_t size = (size_t)9 << 20;
    char *text = malloc(size);
    assert_non_null(text);
    memset(text, ' ', size);
    write_bytes(text, size);
    free(text);
    sag_error error = {0};
    size_t total;
    assert_int_equal(read_all(NULL, 0, &total, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "longer than"));
}

// A version 1.0 file with this dictionary and these data.
static void write_npy(const char *dictionary, const void *data, size_t size) {
    char *bytes = malloc(10 + strlen(dictionary) + size);
    assert_non_null(bytes);
    size_t length = strlen(dictionary);
    memcpy(bytes, "\x93NUMPY\x01\x00", 8);
    bytes[8] = (char)(length & 0xFF), bytes[9] = (char)(length >> 8);
    memcpy(bytes + 10, dictionary, length);
    if (size) memcpy(bytes + 10 + length, data, size);
    write_bytes(bytes, 10 + length + size);
    free(bytes);
}

static void good_npy(const char *dictionary, const void *data, size_t size, size_t count, sag_ray *rays) {
    sag_error error = {0};
    size_t total;
    write_npy(dictionary, data, size);
    if (read_all(rays, 4, &total, &error) != SAG_OK) fail_msg("%s: %s", dictionary, error.message);
    assert_int_equal(total, count);
}

static void bad_npy(const char *dictionary, const void *data, size_t size, const char *part) {
    sag_error error = {0};
    size_t total;
    write_npy(dictionary, data, size);
    assert_int_equal(read_all(NULL, 0, &total, &error), SAG_ERROR_FORMAT);
    assert_string_equal(error.file, path);
    if (!strstr(error.message, part)) fail_msg("%s: got %s", dictionary, error.message);
}

static void reverse(char *bytes, size_t item, size_t count) {
    for (char *p = bytes; count--; p += item) {
        for (size_t i = 0; i < item / 2; i++) {
            char c = p[i];
            p[i] = p[item - 1 - i], p[item - 1 - i] = c;
        }
    }
}

static void npy_forms(void **state) {
    (void)state;
    sag_ray rays[4];
    double numbers[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    const char *own = sagi_is_big_endian() ? ">" : "<", *other = sagi_is_big_endian() ? "<" : ">";
    char text[128];
    snprintf(text, sizeof text, "{'descr': '%sf8', 'fortran_order': False, 'shape': (2, 6), }   \n", own);
    good_npy(text, numbers, sizeof numbers, 2, rays);
    assert_true(rays[1].origin.x == 7 && rays[1].direction.z == 12 && rays[1].t_max == INFINITY);
    snprintf(text, sizeof text, "{\"shape\":(2,6),\"fortran_order\":True,\"descr\":\"%sf8\"}", own);
    good_npy(text, numbers, sizeof numbers, 2, rays);
    assert_true(rays[0].origin.x == 1 && rays[0].origin.y == 3 && rays[1].origin.x == 2 &&
                rays[1].direction.z == 12);
    snprintf(text, sizeof text, "{'descr': '%sf8', 'fortran_order': False, 'shape': (1, 8), }", own);
    good_npy(text, numbers, 64, 1, rays);
    assert_true(rays[0].t_min == 7 && rays[0].t_max == 8);
    snprintf(text, sizeof text, "{'descr': '%sf8', 'fortran_order': False, 'shape': (0, 6), }", own);
    write_npy(text, NULL, 0);
    float singles[6] = {1, 2, 3, 4, 5, 0.1f};
    snprintf(text, sizeof text, "{'descr': '%sf4', 'fortran_order': False, 'shape': (1, 6), }", own);
    good_npy(text, singles, sizeof singles, 1, rays);
    assert_true(rays[0].direction.z == (double)0.1f);
    reverse((char *)singles, 4, 6);
    snprintf(text, sizeof text, "{'descr': '%sf4', 'fortran_order': False, 'shape': (1, 6), }", other);
    good_npy(text, singles, sizeof singles, 1, rays);
    assert_true(rays[0].direction.z == (double)0.1f);
    reverse((char *)numbers, 8, 12);
    snprintf(text, sizeof text, "{'descr': '%sf8', 'fortran_order': False, 'shape': (2, 6), }", other);
    good_npy(text, numbers, sizeof numbers, 2, rays);
    assert_true(rays[1].origin.x == 7 && rays[1].direction.z == 12);
}

static void npy_errors(void **state) {
    (void)state;
    double numbers[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 0, 0};
    bad_npy("", NULL, 0, "damaged");
    bad_npy("{ ", NULL, 0, "malformed");
    bad_npy("{}", NULL, 0, "malformed");
    bad_npy("garbage", NULL, 0, "malformed");
    bad_npy("{'descr': '<f8', 'fortran_order': False}", NULL, 0, "malformed");
    bad_npy("{'descr': '<f8', 'fortran_order': Maybe, 'shape': (2, 6)}", NULL, 0, "malformed");
    bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 6}", NULL, 0, "malformed");
    bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999, 6)}", NULL, 0,
            "malformed");
    bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1,1,1,1,1)}", NULL, 0, "malformed");
    bad_npy("{'descr': '<f8', 'descr': '<f8', 'shape': (2, 6)}", NULL, 0, "malformed");
    bad_npy("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (2,)}", NULL, 0, "structured");
    bad_npy("{'descr': '<i8', 'fortran_order': False, 'shape': (2, 6)}", numbers, 96, "type 'i8'");
    bad_npy("{'descr': '<f2', 'fortran_order': False, 'shape': (2, 6)}", numbers, 96, "type 'f2'");
    bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (12,)}", numbers, 96, "shape (N, 6)");
    bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (4, 3)}", numbers, 96, "shape (N, 6)");
    bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 6)}", numbers, 96,
            "says 3 rows, there are 2");
    bad_npy("{'descr': '<f8', 'fortran_order': True, 'shape': (3, 6)}", numbers, 96,
            "says 3 rows, there are 2");
    bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (18446744073709551615, 8)}", numbers, 96,
            "more rows");
    if (!sagi_is_big_endian()) {
        bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 6)}", numbers, 96,
                "row 1 (the first is 0): the direction is zero");
        numbers[0] = NAN;
        bad_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 6)}", numbers, 96,
                "row 0 (the first is 0): ox is NaN");
    }
    sag_error error = {0};
    size_t total;
    write_bytes("\x93NUMPY\x01", 7);
    assert_int_equal(read_all(NULL, 0, &total, &error), SAG_ERROR_FORMAT);
    write_bytes("\x93NUMPY\x07\x00\x10\x00{}{}{}{}{}", 20);
    assert_int_equal(read_all(NULL, 0, &total, &error), SAG_ERROR_FORMAT);
    write_bytes("\x93NUMPY\x02\x00\xFF\xFF\xFF\x7F{}{}{}", 18); // a header of 2 GiB
    assert_int_equal(read_all(NULL, 0, &total, &error), SAG_ERROR_FORMAT);
}

static void not_files(void **state) {
    (void)state;
    sagi_ray_reader *reader = NULL;
    sag_error error = {0};
    assert_int_equal(sagi_ray_reader_open(context, "/nonexistent/rays.csv", &reader, &error), SAG_ERROR_IO);
    assert_string_equal(error.file, "/nonexistent/rays.csv");
    assert_int_equal(sagi_ray_reader_open(context, "/", &reader, &error), SAG_ERROR_IO);
    assert_null(reader);
}

// Random bytes are told apart from tables, whatever they are.
static void random_bytes(void **state) {
    (void)state;
    uint32_t seed = 7;
    for (int round = 0; round < 300; round++) {
        char bytes[512] = "\x93NUMPY\x01\x00\x20\x00{'descr': '<f8',1,2,3,4,5,6\nox";
        size_t from = (size_t)(round % 40);
        for (size_t i = from; i < sizeof bytes; i++) {
            seed = seed * 1664525u + 1013904223u;
            bytes[i] = (char)(seed >> 24);
        }
        sag_error error = {0};
        size_t total;
        write_bytes(bytes, sizeof bytes);
        assert_int_equal(read_all(NULL, 0, &total, &error), SAG_ERROR_FORMAT);
    }
}

static int set_up(void **state) {
    (void)state;
    context = sag_context_create(NULL);
    strcpy(path, "/tmp/sagitta-rays-XXXXXX");
    int descriptor = mkstemp(path);
    if (descriptor >= 0) close(descriptor);
    return context && descriptor >= 0 ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    unlink(path);
    sag_context_destroy(context);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(csv_forms),    cmocka_unit_test(csv_errors),   cmocka_unit_test(csv_of_many_blocks),
        cmocka_unit_test(endless_line), cmocka_unit_test(npy_forms),    cmocka_unit_test(npy_errors),
        cmocka_unit_test(not_files),    cmocka_unit_test(random_bytes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
