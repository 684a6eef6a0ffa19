#!/bin/sh
# SPDX-License-Identifier: MIT
# Bad input gets a message that says where and what, exit code 1, and leaves no file behind.
. "$(dirname "$0")/../support/tool_test.sh"
mkdir results
make_cube cube.obj
make_scene scene.pbrt
printf '0,0,-5,0,0,1\n' >rays.csv

# What must fail: a pattern for the message, then the arguments.
refuse() {
    pattern=$1
    shift
    expect 1 "$@"
    has err "$pattern"
    [ "$(ls -A results)" = "" ] || { fail "left behind by sagitta $*: $(ls -A results)"; rm -rf results; mkdir results; }
}
# A file that none of the subcommands may take.
refuse_file() {
    refuse "$2" render "$1" --spp 1 --size 8x8 -o results/x.png
    refuse "$2" cast "$1" --rays rays.csv -o results/hits.csv
    refuse "$2" info "$1"
}
# A table of rays that is not one.
refuse_rays() {
    printf "$2" >bad.csv
    refuse "^bad.csv:$1" cast cube.obj --rays bad.csv -o results/hits.csv
    refuse "^bad.csv:$1" cast cube.obj --rays bad.csv -o results/hits.npy
}

# Files that are not there, or are none.
refuse_file missing.obj '^missing.obj: '
refuse_file missing.pbrt '^missing.pbrt: '
refuse_file results 'results'
refuse '^missing.csv: ' cast cube.obj --rays missing.csv -o results/hits.csv

# Scenes: an unclosed bracket, an unknown directive, a missing file in the middle.
printf 'WorldBegin\nShape "sphere" "float radius" [ 1\n' >bracket.pbrt
refuse_file bracket.pbrt '^bracket.pbrt:2:'
printf 'WorldBegin\nFrobnicate "x"\n' >directive.pbrt
refuse_file directive.pbrt '^directive.pbrt:2:1: .*Frobnicate'
printf 'WorldBegin\n  Shape "plymesh" "string filename" "nowhere.ply"\n' >nowhere.pbrt
refuse_file nowhere.pbrt 'nowhere.ply'
printf 'WorldBegin\nAttributeBegin\nShape "sphere"\n' >attribute.pbrt
refuse_file attribute.pbrt '^attribute.pbrt:'
printf 'WorldBegin\nShape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 7 ]\n' >index.pbrt
refuse_file index.pbrt '^index.pbrt:2:'

# Meshes: an index out of range, a truncated PLY, no triangles.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n' >index.obj
refuse_file index.obj '^index.obj'
ply_header='ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n'
printf "$ply_header"'0 0 0\n1 0 0\n' >short.ply
refuse_file short.ply '^short.ply'
printf "$ply_header"'0 0 0\n1 0 0\n0 1 0\n3 0 1 5\n' >index.ply
refuse_file index.ply '^index.ply'
printf "$ply_header"'0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' | sed 's/face 1/face 0/' | head -11 >none.ply
refuse_file none.ply '^none.ply'
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' >points.obj
refuse_file points.obj '^points.obj'
: >empty.obj
refuse_file empty.obj '^empty.obj'

# A vertex that is NaN or infinite: its triangles go, with a word, and the others stay.
{
    printf "$ply_header" | sed 's/vertex 3/vertex 6/;s/face 1/face 3/'
    printf 'nan 0 0\n1 0 0\n0 1 0\n-1 -1 5\n1 -1 5\ninf 1 5\n3 0 1 2\n3 3 4 1\n3 3 4 5\n'
} >nan.ply
expect 0 info nan.ply
has out '2 triangles with a vertex that is NaN'
has out 'y  *-1 to 0 '
expect 0 render nan.ply --spp 1 --size 8x8 -o nan.png
has err '^nan.ply: warning: triangles with a vertex that is NaN.*: 2 of 3$'
expect 0 cast nan.ply --rays rays.csv
has err '^nan.ply: warning: triangles with a vertex that is NaN.*: 2 of 3$'
rm -f nan.png

# Rays.
refuse_rays '1:1: .hello. is not a number' 'hello world\n'
refuse_rays '2:5: .two. is not a number' '0,0,-5,0,0,1\n0,1,two,0,0,1\n'
refuse_rays '3:9: 5 columns' 'ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1\n1,2,3,4,5\n'
refuse_rays '2:7: the direction is zero' '0,0,-5,0,0,1\n0,0,0,0,0,0\n'
refuse_rays '1:3: oy is NaN' '0,nan,-5,0,0,1\n'
refuse_rays '1:1: the origin is infinite' 'inf,0,-5,0,0,1\n'
refuse_rays '1:5: column 3 is empty' '0,0,,0,0,1\n'
refuse_rays '1:14: tmin is greater than tmax' '0,0,-5,0,0,1,2,1\n'
printf '\223NUMPY\001\000\020\000{garbage garbage' >bad.npy
refuse '^bad.npy: ' cast cube.obj --rays bad.npy -o results/hits.csv
printf '\223NUMPY' >bad.npy
refuse '^bad.npy: ' cast cube.obj --rays bad.npy -o results/hits.npy
# An error far down a long table: what was written until then goes too.
awk 'BEGIN { for (i = 0; i < 200000; i++) print "0,0,-5,0,0,1"; print "0,0,-5,0,0,oops" }' >long.csv
refuse '^long.csv:200001:12: ' cast cube.obj --rays long.csv -o results/hits.csv

# Random bytes, whatever they pretend to be; 1 GiB of them when asked.
mebibytes=16
[ -n "$SAGITTA_SOAK" ] && mebibytes=1024
head -c ${mebibytes}M /dev/urandom >random
for name in random.pbrt random.obj random.ply random.stl random.glb random.fbx random.xyz; do
    ln -sf random $name
    refuse 'random' info $name
done
refuse_file random.ply '^random.ply'
refuse '^random' cast cube.obj --rays random -o results/hits.csv
finish
