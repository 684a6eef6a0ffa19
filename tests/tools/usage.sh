#!/bin/sh
# SPDX-License-Identifier: MIT
# Help, version, exit codes, and what a mistyped command line is answered.
. "$(dirname "$0")/../support/tool_test.sh"

expect 0 --version
has out '^sagitta [0-9]*\.[0-9]*\.[0-9]*$'
expect 0 --help
for command in render cast info; do
    has out "^  $command "
done
for command in render cast info; do
    expect 0 "$command" --help
    has out "^usage: sagitta $command "
    cp out first
    expect 0 help "$command"
    cmp -s out first || fail "help $command differs from $command --help"
    [ "$(awk 'length > 118' out | wc -l)" -eq 0 ] || fail "$command --help has long lines"
done
rm first

expect 2
has err '^usage: sagitta'
[ -s out ] && fail "usage went to the standard output"
expect 2 rendr
has err "did you mean 'render'"
expect 2 --frobnicate
has err "unknown option '--frobnicate'"
make_cube cube.obj
expect 2 cube.obj
has err 'sagitta render cube.obj'
expect 2 render
has err 'which file'
expect 2 render a.obj b.obj
has err "'b.obj'"
expect 2 render cube.obj --intgrator path
has err "did you mean '--integrator'"
expect 2 render cube.obj --integrator pth
has err "did you mean 'path'"
expect 2 render cube.obj --spp
has err 'needs a value'
for spp in 0 -1 x 1.5 99999999999999999999; do
    expect 2 render cube.obj --spp "$spp"
    has err 'expected a whole number'
done
for size in 10 10x x10 0x10 10x70000 10x10x10 -1x10; do
    expect 2 render cube.obj --size="$size"
    has err 'expected WIDTHxHEIGHT'
done
expect 2 render cube.obj -o picture.gif
has err '\.png, \.pfm or \.exr'
expect 2 render cube.obj --quiet=yes
has err 'takes no value'
expect 2 cast cube.obj
has err 'which rays'
expect 2 cast cube.obj --rays r.csv --query nearest
has err 'closest, any, all, count'
only_files cube.obj
expect 0 info
has out 'threads'
SAG_ISA=z80 "$sagitta" info >out 2>err && fail "SAG_ISA=z80 was taken"
has err 'z80'
finish
