#!/bin/sh
# SPDX-License-Identifier: MIT
# Bad scenes get an error with file, line and column within two seconds, and leave no file behind: truncated ones, ones that
# include themselves, missing textures and meshes, lamps without area, singular transforms, endless samples, films of no size or
# of any, ten thousand nested attributes.
. "$(dirname "$0")/../support/tool_test.sh"
mkdir results

# The place and a pattern for the message, then the scene, of which the first line is a small film.
refuse() {
    place=$1 pattern=$2
    { printf 'Film "rgb" "integer xresolution" 8 "integer yresolution" 8 Sampler "halton" "integer pixelsamples" 1\n'; cat; } >bad.pbrt
    start=$(date +%s)
    expect 1 render bad.pbrt -o results/picture.exr
    [ $(($(date +%s) - start)) -le 2 ] || fail "slow: $place $pattern"
    has err "^bad.pbrt:$place: .*$pattern"
    [ "$(ls -A results)" = "" ] || { fail "left behind: $(ls -A results)"; rm -rf results; mkdir results; }
}

# Truncated: within numbers, a name, a block; within a mesh's file.
printf 'WorldBegin\nShape "trianglemesh" "point3 P" [0 0 0 1 0' | refuse 3:33 'never closed'
printf 'WorldBegin\nShape "sph' | refuse 3:7 'no closing quote'
printf 'WorldBegin\n  AttributeBegin\nShape "sphere"' | refuse 3:3 'never closed'
printf 'LookAt 0 0 1' | refuse 2:1 '9 numbers'
printf 'ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n' >short.ply
printf 'element face 1\nproperty list uchar int vertex_indices\nend_header\n1234' >>short.ply
printf 'WorldBegin\nShape "plymesh" "string filename" "short.ply"\n' >bad.pbrt
expect 1 render bad.pbrt -o results/picture.exr
has err '^short.ply: byte [0-9]*: the file is cut short'

# Including itself, and through others.
printf 'WorldBegin\n Include "bad.pbrt"' | refuse 3:2 'includes itself'
printf 'WorldBegin\nImport "bad.pbrt"' | refuse 3:1 'includes itself'
printf '\nInclude "bad.pbrt"\n' >other.pbrt
printf 'WorldBegin\nInclude "other.pbrt"' >bad.pbrt
expect 1 render bad.pbrt -o results/picture.exr
has err '^other.pbrt:2:1: .*includes itself'

# What is not there.
printf 'WorldBegin\nTexture "t" "spectrum" "imagemap" "string filename" "none.png"' | refuse 3:35 'none.png: .*No such file'
printf 'WorldBegin\nMaterial "diffuse" "texture reflectance" "none"' | refuse 3:20 'no texture'
printf 'WorldBegin\nLightSource "infinite" "string filename" "none.exr"' | refuse 3:24 'none.exr: .*No such file'
printf 'WorldBegin\nShape "plymesh" "string filename" "none.ply"' | refuse 3:17 'none.ply: .*No such file'

# Lamps without area.
for shape in '"disk" "float radius" 0' '"sphere" "float radius" 0' '"cylinder" "float zmin" 1 "float zmax" 1' \
    '"sphere" "float zmin" 2 "float zmax" 3'; do
    printf 'WorldBegin\nAreaLightSource "diffuse"\n  Shape %s' "$shape" | refuse 4:3 ''
done

# Lamps of which the shape is good and nothing is left where it stands: named with their place, and left dark.
without_area() {
    place=$1
    { printf 'Film "rgb" "integer xresolution" 8 "integer yresolution" 8 Sampler "halton" "integer pixelsamples" 1\n'; cat; } >dark.pbrt
    expect 0 render dark.pbrt -o dark.exr
    has err "^dark.pbrt:$place: warning: Shape .*: a light without area: it does not shine"
    ! grep -q 'geometry [0-9]' err || fail "a message without its place: $(grep 'geometry [0-9]' err)"
}
line='"point3 P" [0 0 0 1 0 0 2 0 0] "integer indices" [0 1 2]'
bent='"point3 P" [0 0 0 1 0 0 2 0 0 3 0 0] "normal N" [0 0 1 0 0 1 0 0 1 0 0 1]'
for shape in "\"trianglemesh\" $line" "\"loopsubdiv\" $line" "\"bilinearmesh\" $bent" '"disk" "float radius" 1e-200' \
    '"sphere" "float radius" 1e-200'; do
    printf 'WorldBegin\nAreaLightSource "diffuse"\n  Shape %s' "$shape" | without_area 4:3
done
for shape in '"disk"' '"cylinder"' '"sphere"' '"rectangle"' '"bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 0]' \
    '"trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0]'; do
    printf 'WorldBegin\nAreaLightSource "diffuse"\nScale 1e-160 1e-160 1e-160\n Shape %s' "$shape" | without_area 5:2
done
printf 'WorldBegin\nAreaLightSource "diffuse" "float power" 1e308\nShape "sphere" "float radius" 1e-9' | refuse 4:1 'too bright'
rm -f dark.pbrt dark.exr

# What can only be told when all of the settings are known, or of a light and its transform.
printf 'Film "rgb" "float whitebalance" 100\nWorldBegin' | refuse 2:1 'white balance'
printf 'Film "rgb" "float iso" 1e300\nCamera "perspective"\nWorldBegin' | refuse 2:1 'exposure'
printf 'PixelFilter "mitchell" "float B" 100\nWorldBegin' | refuse 2:1 'negative'
printf 'WorldBegin\nTranslate 1e308 0 0 Translate 1e308 0 0\nLightSource "point"' | refuse 4:1 'finite'

# Transforms that flatten space, at once or little by little.
printf 'WorldBegin\nScale 1 0 1' | refuse 3:1 'Scale by 0'
printf 'WorldBegin\n Transform [1 0 0 0 1 0 0 0 0 0 1 0 0 0 0 1]' | refuse 3:2 'singular'
printf 'WorldBegin\n ConcatTransform [1 0 0 0 1 0 0 0 0 0 1 0 0 0 0 1]' | refuse 3:2 'singular'
printf 'WorldBegin\nScale 1e-200 1e-200 1e-200\nScale 1e-200 1 1\nShape "sphere"' | refuse 5:1 'singular'
printf 'Rotate 9 0 0 0' | refuse 2:1 'axis'

# Too much of everything.
printf 'Sampler "halton" "integer pixelsamples" 1000000000 WorldBegin' | refuse 2:1 '1000000000 samples'
printf 'Film "rgb" "integer xresolution" 0 "integer yresolution" 0 WorldBegin' | refuse 2:1 '0×0'
printf 'Film "rgb" "integer xresolution" 1000000 "integer yresolution" 1000000 WorldBegin' | refuse 2:1 '1000000×1000000'
awk 'BEGIN { print "WorldBegin"; for (i = 0; i < 10000; i++) print "AttributeBegin" }' | refuse 10002:1 'never closed'
awk 'BEGIN { print "WorldBegin"; for (i = 0; i < 10000; i++) print "AttributeBegin Scale 2 2 2"
             print "Shape \"sphere\""; for (i = 0; i < 10000; i++) print "AttributeEnd" }' | refuse 10003:1 'singular'
[ "$(ls -A results)" = "" ] || fail "left behind: $(ls -A results)"
finish
