#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the packages that are missing: scripts/deps.sh build|test|lint|bench|embree|povray|cross …; does nothing, and needs no network, when all are
# there. Knows apt (Debian 12, Ubuntu 22.04 and 24.04); elsewhere it says what is needed.
set -eu

build="gcc g++ cmake ninja-build pkg-config libc6-dev zlib1g-dev libpng-dev libjpeg-dev libopenexr-dev libassimp-dev libcjson-dev libstb-dev"
test="libcmocka-dev libgmp-dev libmpfr-dev clang python3 python3-numpy"
lint="clang-14 clang-format-14 clang-tidy-14 cppcheck binutils"
bench="libgmp-dev"
embree="libembree-dev"
povray="povray"
cross="gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user"

wanted=""
for set in "$@"; do
  case $set in
  build) wanted="$wanted $build" ;;
  test) wanted="$wanted $test" ;;
  lint) wanted="$wanted $lint" ;;
  bench) wanted="$wanted $bench" ;;
  embree) wanted="$wanted $embree" ;;
  povray) wanted="$wanted $povray" ;;
  cross) wanted="$wanted $cross" ;;
  *) echo "usage: $0 build|test|lint|bench|embree|povray|cross …" >&2; exit 2 ;;
  esac
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  for tool in cc c++ cmake ninja pkg-config; do
    command -v $tool >/dev/null || missing_tools="${missing_tools:-} $tool"
  done
  if [ -z "${missing_tools:-}" ] && pkg-config --exists zlib libpng libjpeg OpenEXR assimp libcjson; then
    exit 0 # somebody has seen to it
  fi
  cat >&2 <<END
This system's package manager is not one that this script knows. Please install, under the names it has for them:
  a C17 and a C++17 compiler, CMake 3.22 or newer, Ninja, pkg-config
  with headers: zlib, libpng, libjpeg(-turbo), OpenEXR 3.1 or newer, Assimp, cJSON, stb
  for the tests: cmocka, GMP, MPFR, clang, Python 3 with NumPy
  for "make lint": clang-format, clang-tidy and cppcheck
(Debian calls them:$wanted)
END
  exit 1
fi

missing=""
for package in $wanted; do
  state=$(dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | head -n 1)
  [ "$state" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "These packages are missing; install them as root:$missing" >&2; exit 1; }
  as_root="sudo"
fi
echo "Installing:$missing"
apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 "$@"; }
# The lists may be absent (a bare system) or stale (a package has moved on): then fetch them and try once more.
# shellcheck disable=SC2086 # a list of words is meant
apt install -y --no-install-recommends $missing >/dev/null 2>&1 || {
  apt update
  apt install -y --no-install-recommends $missing >/dev/null
}
