// SPDX-License-Identifier: MIT
// XXH64 with seed 0, from its specification (Y. Collet, "XXH fast digest algorithm", doc/xxhash_spec.md of
// the xxHash project): it finds damage, not malice, at several bytes a cycle, so that a file is checked in
// less time than it takes to read. Four lanes of 64 bits take eight bytes each in turn; what is left over is
// mixed in one by one. tests/unit/test_save.c has the test vectors.
#include "base/checksum.h"

#define PRIME_1 0x9E3779B185EBCA87u
#define PRIME_2 0xC2B2AE3D27D4EB4Fu
#define PRIME_3 0x165667B19E3779F9u
#define PRIME_4 0x85EBCA77C2B2AE63u
#define PRIME_5 0x27D4EB2F165667C5u

static uint64_t rotated(uint64_t x, int bits) { return x << bits | x >> (64 - bits); }

// Numbers are little-endian in the specification; compilers make one load of this.
static uint64_t load_4(const unsigned char *p) {
    return (uint64_t)p[0] | (uint64_t)p[1] << 8 | (uint64_t)p[2] << 16 | (uint64_t)p[3] << 24;
}
static uint64_t load_8(const unsigned char *p) { return load_4(p) | load_4(p + 4) << 32; }

static uint64_t turn(uint64_t lane, uint64_t input) { return rotated(lane + input * PRIME_2, 31) * PRIME_1; }

static uint64_t merge(uint64_t sum, uint64_t lane) { return (sum ^ turn(0, lane)) * PRIME_1 + PRIME_4; }

uint64_t sagi_checksum(const void *data, size_t bytes) {
    const unsigned char *p = data;
    size_t left = bytes;
    uint64_t sum = PRIME_5;
    if (left >= 32) {
        uint64_t a = PRIME_1 + PRIME_2, b = PRIME_2, c = 0, d = 0 - PRIME_1;
        for (; left >= 32; p += 32, left -= 32) {
            a = turn(a, load_8(p)), b = turn(b, load_8(p + 8));
            c = turn(c, load_8(p + 16)), d = turn(d, load_8(p + 24));
        }
        sum = rotated(a, 1) + rotated(b, 7) + rotated(c, 12) + rotated(d, 18);
        sum = merge(merge(merge(merge(sum, a), b), c), d);
    }
    sum += bytes;
    for (; left >= 8; p += 8, left -= 8) sum = rotated(sum ^ turn(0, load_8(p)), 27) * PRIME_1 + PRIME_4;
    for (; left >= 4; p += 4, left -= 4) sum = rotated(sum ^ load_4(p) * PRIME_1, 23) * PRIME_2 + PRIME_3;
    for (; left > 0; p++, left--) sum = rotated(sum ^ *p * PRIME_5, 11) * PRIME_1;
    sum = (sum ^ sum >> 33) * PRIME_2;
    sum = (sum ^ sum >> 29) * PRIME_3;
    return sum ^ sum >> 32;
}
