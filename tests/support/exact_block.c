// SPDX-License-Identifier: MIT
// With A, B, C the corners minus o and n = (b − a) × (c − a): e(a, b) = d · (A × B) and so on,
// t = (A · n)/(d · n). Of an e that is 0 the sign is that of the first component of d × (b − a) that is not 0
// (triangle_test.c says why, exact_triangle.c finds the same by moving the origin).
#include "support/exact_block.h"
#include <gmp.h>
#include <string.h>

__extension__ typedef __int128 wide;

static const exact_block *block;
static mpz_t num, den, left, right; // t = num/den · 2^time_exponent
static int time_exponent;
static bool ready;
typedef mpz_t big3[3];
static big3 o, d, corner[3], edge[3], moment;
static mpz_t e[3], product;

static void prepare(void) {
    if (ready) return;
    mpz_inits(num, den, left, right, e[0], e[1], e[2], product, NULL);
    for (int k = 0; k < 3; k++) {
        mpz_inits(o[k], d[k], moment[k], NULL);
        for (int i = 0; i < 3; i++) mpz_inits(corner[i][k], edge[i][k], NULL);
    }
    ready = true;
}

void exact_block_end(void) {
    if (!ready) return;
    mpz_clears(num, den, left, right, e[0], e[1], e[2], product, NULL);
    for (int k = 0; k < 3; k++) {
        mpz_clears(o[k], d[k], moment[k], NULL);
        for (int i = 0; i < 3; i++) mpz_clears(corner[i][k], edge[i][k], NULL);
    }
    ready = false;
}

void exact_block_use(const exact_block *b) {
    prepare();
    block = b;
}

static int sign(wide x) { return (x > 0) - (x < 0); }

static lattice3 minus(const lattice3 *a, const lattice3 *b) {
    return (lattice3){{a->x[0] - b->x[0], a->x[1] - b->x[1], a->x[2] - b->x[2]}};
}
// Parts below 2³⁰, so the result's are below 2⁶¹.
static lattice3 cross(const lattice3 *a, const lattice3 *b) {
    return (lattice3){{a->x[1] * b->x[2] - a->x[2] * b->x[1], a->x[2] * b->x[0] - a->x[0] * b->x[2],
                       a->x[0] * b->x[1] - a->x[1] * b->x[0]}};
}
static wide dot(const lattice3 *a, const lattice3 *b) {
    return (wide)a->x[0] * b->x[0] + (wide)a->x[1] * b->x[1] + (wide)a->x[2] * b->x[2];
}

static int lattice_edge(const lattice3 *dir, const lattice3 *a, const lattice3 *b) {
    lattice3 m = cross(a, b);
    int s = sign(dot(dir, &m));
    if (s != 0) return s;
    lattice3 ab = minus(b, a);
    m = cross(dir, &ab);
    for (int k = 0; k < 3 && s == 0; k++) s = sign(m.x[k]);
    return s;
}

static void set_wide(mpz_t z, wide x) {
    __extension__ unsigned __int128 size = x < 0 ? -(unsigned __int128)x : (unsigned __int128)x;
    mpz_import(z, 1, -1, sizeof size, 0, 0, &size);
    if (x < 0) mpz_neg(z, z);
}

static int lattice_side(const exact_line *line, uint32_t i) {
    lattice3 at[3];
    for (int k = 0; k < 3; k++) at[k] = minus(&block->corner_of[i][k], &line->origin);
    int s = lattice_edge(&line->direction, &at[0], &at[1]);
    if (s == 0 || lattice_edge(&line->direction, &at[1], &at[2]) != s ||
        lattice_edge(&line->direction, &at[2], &at[0]) != s)
        return 0;
    lattice3 ab = minus(&at[1], &at[0]), ac = minus(&at[2], &at[0]), n = cross(&ab, &ac);
    set_wide(num, dot(&at[0], &n)), set_wide(den, dot(&line->direction, &n));
    time_exponent = block->exponent - line->exponent;
    return s;
}

// The exponent of the last bit of a double that is not 0.
static int last_bit(double x) {
    int exponent;
    int64_t m = (int64_t)ldexp(frexp(x, &exponent), 53);
    return exponent - 53 + __builtin_ctzll((uint64_t)m);
}
static int last_bit3(sag_vec3 a, int exponent) {
    const double x[3] = {a.x, a.y, a.z};
    for (int k = 0; k < 3; k++)
        if (x[k] != 0 && last_bit(x[k]) < exponent) exponent = last_bit(x[k]);
    return exponent;
}
static void set_big3(big3 z, sag_vec3 a, int exponent) { // a · 2^-exponent
    const double x[3] = {a.x, a.y, a.z};
    for (int k = 0; k < 3; k++) {
        mpz_set_ui(z[k], 0);
        if (x[k] == 0) continue;
        int last = last_bit(x[k]);
        mpz_set_d(z[k], ldexp(x[k], -last));
        mpz_mul_2exp(z[k], z[k], (mp_bitcnt_t)(last - exponent));
    }
}
static void big_cross(big3 r, const big3 a, const big3 b) {
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        mpz_mul(r[k], a[i], b[j]);
        mpz_submul(r[k], a[j], b[i]);
    }
}
static void big_dot(mpz_t r, const big3 a, const big3 b) {
    mpz_mul(r, a[0], b[0]);
    mpz_addmul(r, a[1], b[1]);
    mpz_addmul(r, a[2], b[2]);
}

static int big_edge(int i, int j) {
    big_cross(moment, corner[i], corner[j]);
    big_dot(product, d, moment);
    int s = mpz_sgn(product);
    if (s != 0) return s;
    for (int k = 0; k < 3; k++) mpz_sub(edge[0][k], corner[j][k], corner[i][k]);
    big_cross(moment, d, edge[0]);
    for (int k = 0; k < 3 && s == 0; k++) s = mpz_sgn(moment[k]);
    return s;
}

static int big_side(const exact_line *line, uint32_t i) {
    int exponent = last_bit3(line->ray.origin, 2000), turn = last_bit3(line->ray.direction, 2000);
    for (int k = 0; k < 3; k++) exponent = last_bit3(block->at[i][k], exponent);
    set_big3(o, line->ray.origin, exponent), set_big3(d, line->ray.direction, turn);
    for (int j = 0; j < 3; j++) {
        set_big3(corner[j], block->at[i][j], exponent);
        for (int k = 0; k < 3; k++) mpz_sub(corner[j][k], corner[j][k], o[k]);
    }
    int s = big_edge(0, 1);
    if (s == 0 || big_edge(1, 2) != s || big_edge(2, 0) != s) return 0;
    for (int k = 0; k < 3; k++) {
        mpz_sub(edge[1][k], corner[1][k], corner[0][k]);
        mpz_sub(edge[2][k], corner[2][k], corner[0][k]);
    }
    big_cross(moment, edge[1], edge[2]);
    big_dot(num, corner[0], moment), big_dot(den, d, moment);
    time_exponent = exponent - turn;
    return s;
}

int exact_block_side(const exact_line *line, uint32_t i) {
    return block->lattice && line->lattice ? lattice_side(line, i) : big_side(line, i);
}

// t = m·2^q: |num/den·2^x − m·2^q| ≤ 4·2^q, multiplied out.
bool exact_block_time(double t) {
    if (mpz_sgn(num) == 0 || t == 0) return mpz_sgn(num) == 0 && t == 0;
    int q;
    double m = ldexp(frexp(t, &q), 53);
    q -= 53;
    mpz_set_d(right, m);
    mpz_mul(right, right, den);
    mpz_mul_ui(product, den, 4);
    mpz_set(left, num);
    if (time_exponent >= q) {
        mpz_mul_2exp(left, left, (mp_bitcnt_t)(time_exponent - q));
    } else {
        mpz_mul_2exp(right, right, (mp_bitcnt_t)(q - time_exponent));
        mpz_mul_2exp(product, product, (mp_bitcnt_t)(q - time_exponent));
    }
    mpz_sub(left, left, right);
    return mpz_cmpabs(left, product) <= 0;
}

bool exact_block_time_is_huge(void) {
    return mpz_sgn(num) != 0 &&
           (long)mpz_sizeinbase(num, 2) - (long)mpz_sizeinbase(den, 2) + time_exponent > 1020;
}
