#!/bin/sh
# SPDX-License-Identifier: MIT
# Output that cannot be written: a message, exit code 1, no partial file; and Ctrl-C.
. "$(dirname "$0")/../support/tool_test.sh"
make_cube cube.obj
make_scene scene.pbrt
printf '0,0,-5,0,0,1\n' >rays.csv
awk 'BEGIN { for (i = 0; i < 100000; i++) print "0.5,0.25,-5,0,0,1" }' >many.csv

# Directories that are not there.
for output in nowhere/x.png nowhere/x.pfm nowhere/x.exr; do
    expect 1 render scene.pbrt -o $output
    has err "^sagitta: $output: cannot write: \|^$output: cannot write: "
done
expect 1 cast cube.obj --rays rays.csv -o nowhere/hits.csv
has err '^nowhere/hits.csv: cannot write: '
expect 1 render scene.pbrt -o x.png --stats nowhere/stats.json
has err 'nowhere/stats.json: cannot write: '
mkdir directory.png directory.npy
expect 1 render scene.pbrt -o directory.png
has err 'directory.png: cannot write: '
expect 1 cast cube.obj --rays rays.csv -o directory.npy
has err 'directory.npy: cannot write: '
rmdir directory.png directory.npy
only_files cube.obj many.csv rays.csv scene.pbrt

# A directory without the right to write (which does not stop root).
if [ "$(id -u)" -ne 0 ]; then
    mkdir locked
    chmod a-w locked
    expect 1 render scene.pbrt -o locked/x.png
    has err 'locked/x.png: cannot write: '
    expect 1 cast cube.obj --rays rays.csv -o locked/hits.csv
    has err 'locked/hits.csv: cannot write: '
    rmdir locked
fi

# A full disk.
if [ -c /dev/full ]; then
    expect 1 cast cube.obj --rays many.csv -o /dev/full
    has err '^/dev/full: cannot write: '
    code=0
    "$sagitta" cast cube.obj --rays many.csv >/dev/full 2>err || code=$?
    [ $code -eq 1 ] || fail "cast to a full disk: exit code $code"
    has err 'standard output: cannot write: '
    code=0
    "$sagitta" info cube.obj >/dev/full 2>err || code=$?
    [ $code -eq 1 ] || fail "info to a full disk: exit code $code"
    has err 'standard output: cannot write: '
    ln -s /dev/full full.png
    expect 1 render scene.pbrt -o full.png
    has err 'full.png: cannot write: '
    [ -L full.png ] && [ -c /dev/full ] || fail "a device was replaced by a file"
    rm full.png
fi
expect 1 cast cube.obj --rays rays.csv -o /dev/null/hits.csv
[ -c /dev/null ] || fail "/dev/null is gone"

# A closed pipe.
{ code=0; "$sagitta" cast cube.obj --rays many.csv 2>err || code=$?; echo $code >code; } | head -c 100 >/dev/null
[ "$(cat code)" -eq 1 ] || fail "closed pipe: exit code $(cat code)"
has err 'standard output: cannot write: '
rm code

# Ctrl-C, and a polite kill, in the middle of the work: no picture, no table, no temporary file.
for signal in INT TERM; do
    "$sagitta" render scene.pbrt --spp 1000000 --size 400x300 -o stopped.png >out 2>err &
    job=$!
    sleep 1
    kill -$signal $job
    code=0
    wait $job || code=$?
    [ $code -eq 130 ] || fail "render after SIG$signal: exit code $code"
    has err 'interrupted'
done
mkfifo pipe
"$sagitta" cast cube.obj --rays pipe -o stopped.csv >out 2>err &
job=$!
exec 3>pipe
cat many.csv >&3
sleep 1
kill -INT $job
code=0
wait $job || code=$?
exec 3>&-
[ $code -eq 130 ] || fail "cast after SIGINT: exit code $code"
has err 'interrupted'
rm pipe
only_files cube.obj many.csv rays.csv scene.pbrt
finish
