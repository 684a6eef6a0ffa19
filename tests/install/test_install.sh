#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs into a temporary prefix, moves it elsewhere, and builds and runs the examples from there: by find_package, static and
# shared, and by pkg-config, static and shared. test_install.sh BUILD SOURCE
set -eu
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cc=${CC:-cc} cxx=${CXX:-c++}

cmake --install "$build" --prefix "$work/first" >"$work/log" || { cat "$work/log"; exit 1; }
mv "$work/first" "$work/prefix"
prefix=$work/prefix
libraries=$(dirname "$(find "$prefix" -name libsagitta.so)")

expect() { # expect NAME WHAT COMMAND…: its output
  name=$1 what=$2
  shift 2
  got=$("$@") || { echo "$name: exit code $?"; exit 1; }
  [ "$got" = "$what" ] || { echo "$name: got \"$got\" instead of \"$what\""; exit 1; }
  echo "$name: ok"
}
first_ray="geometry 1 at t = 4"
shape_alone="t = 2.5 at x = -2.5, entering
t = 3.5 at x = -1.5, leaving
t = 6.5 at x = 1.5, entering
t = 7.5 at x = 2.5, leaving"
solid="bead 0: cube at t = 4, entering
bead 0: hole at t = 4.5, leaving, cut
bead 0: hole at t = 5.5, entering, cut
bead 0: cube at t = 6, leaving
bead 1: cube at t = 8, entering
bead 1: hole at t = 8.5, leaving, cut
bead 1: hole at t = 9.5, entering, cut
bead 1: cube at t = 10, leaving
4 intervals, 2 in all"

echo "== CMake package"
cmake -S "$source/examples" -B "$work/examples" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" \
  -DCMAKE_CXX_COMPILER="$cxx" >"$work/log" 2>&1 && cmake --build "$work/examples" >>"$work/log" 2>&1 ||
  { cat "$work/log"; exit 1; }
for form in "" -shared; do
  expect "first_ray$form" "$first_ray" "$work/examples/first_ray$form"
  expect "shape_alone$form" "$shape_alone" "$work/examples/shape_alone$form"
  expect "solid$form" "$solid" "$work/examples/solid$form"
  if [ -x "$work/examples/gradient$form" ]; then
    expect "render_sphere" "" "$work/examples/render_sphere" "$work/sphere.png"
    expect "gradient$form" "" "$work/examples/gradient$form" "$work/gradient$form.png"
    [ -s "$work/gradient$form.png" ]
  fi
done

echo "== pkg-config"
export PKG_CONFIG_PATH="$libraries/pkgconfig" LD_LIBRARY_PATH="$libraries"
# shellcheck disable=SC2046 # words are meant
{
  $cc "$source/examples/first_ray.c" $(pkg-config --cflags --libs sagitta) -o "$work/c"
  $cxx -std=c++17 "$source/examples/shape_alone.cpp" $(pkg-config --cflags --libs sagitta) -o "$work/cxx"
  $cc -static "$source/examples/first_ray.c" $(pkg-config --cflags --static --libs sagitta) -o "$work/c-static"
  expect "C" "$first_ray" "$work/c"
  expect "C++" "$shape_alone" "$work/cxx"
  expect "C, static" "$first_ray" "$work/c-static"
  if pkg-config --exists sagitta-render; then
    $cc "$source/examples/gradient.c" $(pkg-config --cflags --libs sagitta-render) -o "$work/render"
    expect "C, render" "" "$work/render" "$work/pc.png"
    [ -s "$work/pc.png" ]
  fi
}
if [ -x "$prefix/bin/sagitta" ]; then
  "$prefix/bin/sagitta" --help >/dev/null
  echo "the installed program: ok"
fi

# `make demo` on a bare machine has no test libraries: that configures, and what asks for the tests says what is missing.
echo "== without the tests' libraries"
bare() { cmake -S "$source" -B "$work/bare" -G Ninja -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" -DCMOCKA= "$@" >"$work/log" 2>&1; }
bare || { cat "$work/log"; exit 1; }
if bare -DSAGITTA_REQUIRE_TESTS=ON || ! grep -q "need cmocka, GMP and MPFR" "$work/log"; then
  echo "SAGITTA_REQUIRE_TESTS without cmocka: no error"
  exit 1
fi
echo "configures: ok"
