#!/bin/sh
# SPDX-License-Identifier: MIT
# sagitta measure: what it says of a closed mesh, an open one and a scene; JSON; wrong options.
. "$(dirname "$0")/../support/tool_test.sh"
make_cube cube.obj
expect 0 measure cube.obj
has out '^cube.obj: 1 body'
has out 'measured  *exact'
has out 'volume  *8$'
has out 'area  *24$'
has out 'centre of mass  *(0, 0, 0)'
has out 'principal  *(5.33333333, 5.33333333, 5.33333333)'
has out 'median 2;'
expect 0 measure cube.obj --no-thickness --density 2.5 --threads 1
has out ': 1 body.* 0 rays'
has out 'mass  *20$'
grep -q thickness out && fail "--no-thickness was not"

# Inside out, and with a hole.
awk '$1 == "f" { print $1, $3, $2, $4; next } { print }' cube.obj >turned.obj
expect 0 measure turned.obj
has out 'inside out'
has out 'volume  *8$'
grep -v 'f 2 7 6' cube.obj >open.obj
expect 0 measure open.obj
has out 'not closed: no volume (open edge between vertices . and .; 3 open edges)'
has out 'Nothing here has an inside'
has out 'area  *22$'

# Rays, and the same bits whatever the threads.
expect 0 measure cube.obj --sample --error=0.01 --seed 5 --json one.json --threads 1 -q
has out 'by rays ([0-9,]*); 95 % intervals'
expect 0 measure cube.obj --sample --error=0.01 --seed 5 --json two.json --threads 3 --confidence 0.95
grep -v _seconds one.json >one
grep -v _seconds two.json >two
cmp -s one two || fail "other threads, other numbers"
expect 0 measure cube.obj --json -
has out '^{'
if command -v python3 >/dev/null; then
    python3 - <<'PYTHON' || fail "not the JSON it should be"
import json
body, = json.load(open('out'))['bodies']
assert body['state'] == 'closed' and body['exact'] and body['volume'] == {'value': 8, 'error': 0}
assert body['instances'] == [] and body['geometry'] == 0 and body['kind'] == 'mesh'
assert abs(body['inertia']['value'][2][2] - 16 / 3) < 1e-12
assert len(body['axes']) == 3 and body['thickness']['percentiles']['50'] == 2
assert abs(sum(body['thickness']['histogram']['shares']) - 1) < 1e-12
assert abs(body['mean_chord'] - 4 / 3) < 1e-12
body, = json.load(open('one.json'))['bodies']
assert not body['exact'] and body['reached'] and abs(body['volume']['value'] - 8) < 0.1
PYTHON
fi

make_scene scene.pbrt
expect 0 measure scene.pbrt
has out '^sphere 0'
has out 'volume  *0.523598776'
has out '^disk 1'
has out 'not closed: no volume$'

# A name that is no UTF-8 still gives JSON.
bad=$(printf 'm\377.obj')
cp cube.obj "$bad"
expect 0 measure "$bad" --json -
has out "\"file\":.*m$(printf '\357\277\275').obj"
rm "$bad"

expect 2 measure
expect 2 measure cube.obj open.obj
expect 2 measure cube.obj --error 0
has err 'error 0: expected a number between 0 and 1'
expect 2 measure cube.obj --error 1e-3x
expect 2 measure cube.obj --error nan
expect 2 measure cube.obj --confidence 1
expect 2 measure cube.obj --density -1
has err 'density -1: expected a finite number greater than 0'
expect 2 measure cube.obj --eror 1e-3
has err "did you mean '--error'"
expect 2 measure cube.obj --max-rays 0
expect 2 measure cube.obj --seed 18446744073709551616 # one more than 64 bits hold
expect 0 measure cube.obj --seed 18446744073709551615 -q
expect 1 measure absent.obj
has err absent.obj
expect 1 measure cube.obj --json nowhere/x.json
has err nowhere/x.json
finish
