// SPDX-License-Identifier: MIT
// Whether a mesh bounds a volume, quickly and without memory.
//
// Parity. Let every edge have an even number of triangles. A line that is moved across the mesh, without
// passing through vertices, gains or loses crossings only where it passes an edge, an even number there; far
// away it has none. So every line has an even number of crossings, and two points that can be joined without
// crossing the mesh have, on any ray, numbers of the same parity: inside is well defined. It does not matter
// which way round the triangles are, how many meet at an edge, or whether the mesh crosses itself. Lines
// through edges and vertices are decided as if moved a little, consistently (triangle_test.c), so they are no
// exception. A triangle without area is crossed by no line, but has three edges like any other: one between
// the long edge of one neighbour and the two short ones of others closes the mesh there. The argument needs
// only that edges are the same when they are in the same place, so their ends' positions decide. It holds
// after any motion of the vertices, also one that rounds.
//
// Counting evenly. Each edge gets a fingerprint of 128 bits, made from its ends' positions; the exclusive or
// of all of them is 0 if every edge occurs an even number of times. If not, it is 0 with a chance of 2⁻¹²⁸:
// never, for a mesh that does not come from somebody who has looked for one. (He gets nonsense from his mesh,
// but no more.) Sorting is certain, takes two to three times as long, and memory, which a query does not
// ask for. 35 ms for a million triangles.
#include "math/hash.h"
#include "shapes/closed.h"
#include "shapes/mesh.h"

// Of an edge whichever way it goes; an edge of no length is none.
static inline void add_edge(sagi_fingerprint *sum, sagi_fingerprint a, sagi_fingerprint b) {
    if (a.part[0] == b.part[0] && a.part[1] == b.part[1]) return;
    for (int i = 0; i < 2; i++) sum->part[i] ^= sagi_mix(a.part[i] + b.part[i]);
}

bool sagi_mesh_is_closed(const sag_mesh *mesh) {
    sagi_fingerprint sum = {{0, 0}};
    bool any = false;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        sag_vec3 p[3];
        sagi_fingerprint f[3];
        sagi_mesh_triangle(mesh, i, p);
        if (!sagi_triangle_is_finite(&p[0], &p[1], &p[2])) continue;
        for (int k = 0; k < 3; k++) f[k] = sagi_fingerprint_of(p[k]);
        for (int k = 0; k < 3; k++) add_edge(&sum, f[k], f[(k + 1) % 3]);
        any = true;
    }
    return any && sum.part[0] == 0 && sum.part[1] == 0;
}
