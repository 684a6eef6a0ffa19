# SPDX-License-Identifier: MIT
# What the tests of the program share; to be read with `.`. Argument 1 of the test is the program's path. The test runs
# in a directory of its own, $work, which goes at the end.
sagitta=$1
[ -x "$sagitta" ] || { echo "usage: $0 PROGRAM"; exit 2; }
case $sagitta in /*) ;; *) sagitta=$PWD/$sagitta ;; esac
work=$(mktemp -d "${TMPDIR:-/tmp}/sagitta-test-XXXXXX") || exit 2
trap 'chmod -R u+w "$work" 2>/dev/null; rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit 2
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# Runs the program: its exit code to $code, what it says to the files out and err.
try() {
    code=0
    "$sagitta" "$@" >out 2>err </dev/null || code=$?
}

# try, and the exit code must be this.
expect() {
    wanted=$1
    shift
    try "$@"
    [ "$code" -eq "$wanted" ] || { fail "exit code $code, not $wanted: sagitta $*"; sed 's/^/    /' err; }
}

# The file must have a line that matches the pattern (grep's basic ones).
has() {
    grep -q -e "$2" "$1" || { fail "no '$2' in $1:"; head -5 "$1" | sed 's/^/    /'; }
}

# What is in the directory must be these names and nothing else, hidden files and our own out and err aside.
only_files() {
    found=$(ls -A | grep -v -x -e out -e err | sort | tr '\n' ' ')
    wanted=$(printf '%s\n' "$@" | sort | tr '\n' ' ')
    [ "$found" = "$wanted" ] || fail "files: $found; expected: $wanted"
}

finish() {
    [ "$failures" -eq 0 ] || { echo "$failures failed"; exit 1; }
    exit 0
}

# The box from -1 to 1, closed, as an OBJ of 12 triangles.
make_cube() {
    cat >"$1" <<'END'
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 4 8 7
f 4 7 3
f 1 5 8
f 1 8 4
f 2 3 7
f 2 7 6
END
}

# A small pbrt scene: a sphere on a plane under a light, 32 by 24 pixels.
make_scene() {
    cat >"$1" <<'END'
LookAt 0 1 -5  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 32 "integer yresolution" 24 "string filename" "scene-name.exr"
Sampler "independent" "integer pixelsamples" 4
WorldBegin
LightSource "infinite" "rgb L" [ 0.4 0.5 0.7 ]
LightSource "distant" "point3 from" [ 1 2 -1 ] "point3 to" [ 0 0 0 ] "rgb L" [ 2 2 2 ]
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
AttributeBegin
  Translate 0 0.5 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
Shape "disk" "float radius" 3
END
}
