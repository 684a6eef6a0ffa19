#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: make-big-scene.sh FILE.pbrt [MEGABYTES]
# Writes a scene of so many megabytes of text (500): hills in tiles of 20,000 triangles with normals and
# texture coordinates, every number with nine digits, as exporters write them; a sky.
# For the time to the first pixel:
#     bench/make-big-scene.sh /tmp/big.pbrt && time sagitta render /tmp/big.pbrt --spp 1 --crop 1x1+640+360 -o /tmp/big.exr
set -e
[ $# -ge 1 ] || { sed -n '3s/^# //p' "$0" >&2; exit 2; }
awk -v limit="${2:-500}" 'BEGIN {
    size = 101
    print "LookAt 0 -30 12  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 50"
    print "Film \"rgb\" \"integer xresolution\" 1280 \"integer yresolution\" 720"
    print "Sampler \"zsobol\" \"integer pixelsamples\" 16\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [ 1 1 1 ]"
    print "Material \"diffuse\" \"rgb reflectance\" [ 0.4 0.5 0.3 ]"
    # The indices are the same for all tiles.
    for (y = 0; y < size - 1; y++) {
        line = ""
        for (x = 0; x < size - 1; x++) {
            a = y * size + x
            line = line a " " a + 1 " " a + size + 1 " " a " " a + size + 1 " " a + size " "
        }
        faces = faces line "\n"
    }
    for (tile = 0; bytes < limit * 1e6; tile++) {
        # Outward in a spiral of squares, about as far as there are tiles.
        ring = int((sqrt(tile) + 1) / 2); side = 2 * ring; step = tile - (side - 1) * (side - 1)
        if (ring == 0) { u = v = 0 }
        else if (step < side) { u = ring; v = step - ring + 1 }
        else if (step < 2 * side) { u = ring - (step - side) - 1; v = ring }
        else if (step < 3 * side) { u = -ring; v = ring - (step - 2 * side) - 1 }
        else { u = step - 3 * side - ring + 1; v = -ring }
        points = normals = places = ""
        for (y = 0; y < size; y++) {
            p = n = t = ""
            for (x = 0; x < size; x++) {
                px = 4 * u + x * 0.04; py = 4 * v + y * 0.04
                dx = 1.3 * cos(px * 1.3) * cos(py * 0.9); dy = -0.9 * sin(px * 1.3) * sin(py * 0.9)
                d = sqrt(1 + dx * dx + dy * dy)
                p = p sprintf("%.9g %.9g %.9g ", px, py, sin(px * 1.3) * cos(py * 0.9))
                n = n sprintf("%.9g %.9g %.9g ", -dx / d, -dy / d, 1 / d)
                t = t sprintf("%.9g %.9g ", x / (size - 1), y / (size - 1))
            }
            points = points p "\n"; normals = normals n "\n"; places = places t "\n"
        }
        text = "Shape \"trianglemesh\" \"integer indices\" [\n" faces "]\n\"point3 P\" [\n" points "]\n\"normal N\" [\n" \
            normals "]\n\"point2 uv\" [\n" places "]\n"
        printf "%s", text
        bytes += length(text)
    }
}' >"$1"
