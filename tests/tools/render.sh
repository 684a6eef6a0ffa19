#!/bin/sh
# SPDX-License-Identifier: MIT
# sagitta render on a small scene and a mesh: every integrator and format, default names, statistics, the same picture
# on any number of threads, and no bar where there is no terminal.
. "$(dirname "$0")/../support/tool_test.sh"
make_scene scene.pbrt
make_cube cube.obj

expect 0 render scene.pbrt
only_files cube.obj scene-name.exr scene.pbrt
has err 'scene-name.exr: 32 x 24, 4 samples a pixel'
[ -s out ] && fail "something on the standard output"
od -An -tx1 -N4 scene-name.exr | grep -q '76 2f 31 01' || fail "no EXR"
rm scene-name.exr
expect 0 render cube.obj --size 16x12 --spp 1
only_files cube.obj cube.png scene.pbrt
od -An -tx1 -N8 cube.png | grep -q '89 50 4e 47 0d 0a 1a 0a' || fail "no PNG"
[ "$(od -An -tu1 -j16 -N8 cube.png | tr -d ' \n')" = "0001600012" ] || fail "the PNG is not 16 x 12"

for integrator in path direct ao normal uv depth id albedo; do
    expect 0 render scene.pbrt -q --integrator $integrator -o $integrator.pfm
    [ -s err ] && fail "--quiet was not"
    [ "$(head -2 $integrator.pfm | tail -1)" = "32 24" ] || fail "$integrator.pfm is not 32 x 24"
done
expect 0 render scene.pbrt --integrator depth -o depth.png
has err '^depth.png: brightness is [0-9.]* / distance'
rm depth.png
cmp -s path.pfm normal.pfm && fail "path and normal give the same picture"

expect 0 render scene.pbrt --threads 1 -o one.pfm
expect 0 render scene.pbrt --threads 3 -o three.pfm
cmp -s one.pfm three.pfm || fail "one thread and three differ"
expect 0 render scene.pbrt --seed 7 -o seven.pfm
expect 0 render scene.pbrt --seed=7 -o seven2.pfm
cmp -s seven.pfm seven2.pfm || fail "one seed, two pictures"
cmp -s seven.pfm one.pfm && fail "two seeds, one picture"

expect 0 render scene.pbrt --spp=2 --size=20x10 --stats stats.json -o stats.png
for key in load_seconds build_seconds trace_seconds rays rays_per_second camera_samples bad_samples peak_bytes \
    process_peak_bytes threads isa geometries primitives width height samples_per_pixel version; do
    has stats.json "\"$key\":"
done
has stats.json '"camera_samples":.*400,'
has stats.json '"width":.*20,'
grep -q "$(printf '\r')" err && fail "a progress bar in a file"

# A film without a name: the file's.
printf 'Film "rgb"\nWorldBegin\nLightSource "infinite"\nShape "sphere"\n' >nameless.pbrt
expect 0 render nameless.pbrt --spp 1 --size 8x8
[ -s nameless.png ] || fail "no nameless.png"
rm nameless.pbrt nameless.png

# A scene without a light is black, and says why.
printf 'WorldBegin\nShape "sphere"\n' >dark.pbrt
expect 0 render dark.pbrt --spp 1 --size 8x8 -o dark.png
has err 'warning: there is no light in the scene'
expect 0 render dark.pbrt --spp 1 --size 8x8 -o dark.png --integrator normal
grep -q 'no light' err && fail "light is asked for by the normal integrator"
rm dark.pbrt dark.png

# A name that begins with a dash, and one in a directory.
cp cube.obj ./-cube.obj
mkdir pictures
expect 0 render --spp 1 --size 8x8 -o pictures/x.png -- -cube.obj
[ -s pictures/x.png ] || fail "pictures/x.png"
# What was there is replaced.
echo old >old.png
expect 0 render cube.obj --spp 1 --size 8x8 -o old.png
echo old >target.png
ln -s target.png link.png
expect 0 render cube.obj --spp 1 --size 8x8 -o link.png
[ -L link.png ] || fail "the link became a file"
grep -q old target.png && fail "the file behind the link stayed"
grep -q old old.png && fail "the old picture stayed"
finish
