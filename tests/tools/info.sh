#!/bin/sh
# SPDX-License-Identifier: MIT
# sagitta info: what it says of a closed mesh, an open one and a scene.
source=$(cd "$(dirname "$0")/../.." && pwd)
. "$(dirname "$0")/../support/tool_test.sh"
make_cube cube.obj
expect 0 info cube.obj
has out '^cube.obj$'
has out '12 in 1 mesh'
has out 'x  *-1 to 1 '
has out ' yes '
grep -q '^warnings' out && fail "warnings about a good cube"

grep -v 'f 2 7 6' cube.obj >open.obj
printf 'f 1 3 2\nf 1 1 2\n' >>open.obj
expect 0 info open.obj
has out ' no '
has out 'open edge'
has out 'without area'
has out 'same three positions'
expect 0 info open.obj --json
has out '"closed":.*false'
has out '"duplicate":.*1'
has out '"isa":'
has out '"build_seconds":'
if command -v python3 >/dev/null; then
    python3 - <<'END' || fail "not JSON"
import json
json.load(open('out'))
END
fi

# A name that is no UTF-8 still gives JSON.
bad=$(printf 'm\377.obj')
cp cube.obj "$bad"
expect 0 info "$bad" --json
has out "\"file\":.*m$(printf '\357\277\275').obj"
rm "$bad"

make_scene scene.pbrt
expect 0 info scene.pbrt
has out 'sphere'
has out 'disk'
expect 0 info -q scene.pbrt
[ -s err ] && fail "--quiet was not"

# Solids: how many, of what, how large.
cat >solids.pbrt <<'END'
WorldBegin
ObjectBegin "pip" Shape "sphere" "float radius" 0.5 ObjectEnd
SolidBegin "difference"
  SolidBegin "intersection" Shape "box" Shape "sphere" "float radius" 1.4 SolidEnd
  Translate 0 0 1 ObjectInstance "pip"
SolidEnd
END
expect 0 info solids.pbrt
has out 'solids  *1: 3 parts; 1 union, 1 intersection, 1 difference'
has out '1  *3  *-1 -1 -1 to 1 1 1  *1 union, 1 intersection, 1 difference'
expect 0 info solids.pbrt --json
has out '"solids":'
has out '"differences":.*1'

# The gallery of solids loads without a warning.
for scene in "$source"/examples/solids/*.pbrt; do
    case $scene in */studio.pbrt) continue ;; esac
    expect 0 info "$scene"
    has out '  solids  '
    [ -s err ] && fail "warnings about $scene"
done

# So do the pictures of the gallery; what other scenes include is no scene.
for scene in "$source"/examples/showcase.pbrt "$source"/examples/gallery/*/*.pbrt; do
    case $scene in */stages/* | */soft.pbrt | */edges.pbrt | */hall.pbrt | */room_lit.pbrt | */prism.pbrt | */caustic.pbrt) continue ;; esac
    expect 0 info "$scene"
    [ -s err ] && fail "warnings about $scene: $(cat err)"
done

# Without a file: the program itself.
expect 0 info --json
has out '"threads":'
finish
