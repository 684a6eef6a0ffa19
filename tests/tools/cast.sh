#!/bin/sh
# SPDX-License-Identifier: MIT
# sagitta cast on a cube: every query, both kinds of table in and out, the standard streams, any number of threads.
. "$(dirname "$0")/../support/tool_test.sh"
make_cube cube.obj

# What comes out, to the last digit.
cat >rays.csv <<'END'
ox,oy,oz,dx,dy,dz
0.25,0.5,-5,0,0,1
# a miss, and one that starts inside
0.25,9,-5,0,0,1

0.25,0.5,0,0,0,-2
END
expect 0 cast cube.obj --rays rays.csv
cut -d, -f1-9,14 out >few
cat >wanted <<'END'
ray,hit,t,x,y,z,nx,ny,nz,instance
0,1,4,0.25,0.5,-1,0,0,-1,-1
1,0,inf,nan,nan,nan,nan,nan,nan,-1
2,1,0.5,0.25,0.5,-1,0,0,-1,-1
END
cmp -s few wanted || { fail "closest"; diff few wanted; }
[ "$(awk -F, 'NF != 14' out | wc -l)" -eq 0 ] || fail "not 14 columns"
has err '3 rays, 2 hit'
cp out closest.csv

expect 0 cast cube.obj --rays rays.csv --query any
printf 'ray,hit\n0,1\n1,0\n2,1\n' | cmp -s - out || { fail "any"; cat out; }
expect 0 cast cube.obj --rays rays.csv --query count
printf 'ray,count\n0,2\n1,0\n2,1\n' | cmp -s - out || { fail "count"; cat out; }
expect 0 cast cube.obj --rays rays.csv --query=all
cut -d, -f1-3 out | tr '\n' ' ' >few
[ "$(cat few)" = "ray,hit,t 0,1,4 0,1,6 1,0,inf 2,1,0.5 " ] || { fail "all"; cat few; }

expect 0 cast cube.obj --rays rays.csv --query spans
cat >wanted <<'END'
ray,hit,t_enter,t_leave,length,geometry_enter,primitive_enter,geometry_leave,primitive_leave,instance
0,1,4,6,2,0,P,0,P,-1
1,0,nan,nan,0,-1,-1,-1,-1,-1
2,1,0,0.5,1,0,-1,0,P,-1
END
sed 's/\(0,\)[0-9][0-9]*,0,/\1P,0,/; s/,0,[0-9][0-9]*,-1$/,0,P,-1/' out | cmp -s - wanted || { fail "spans"; cat out; }
has err '3 rays, 2 spans'

# A range of t.
printf '0,0.5,-5,0,0,1,4.5,100\n0,0.5,-5,0,0,1,0,3\n0,0.5,-5,0,0,1,4,inf\n' >range.csv
expect 0 cast cube.obj --rays range.csv -q
[ "$(cut -d, -f1-3 out | tr '\n' ' ')" = "ray,hit,t 0,1,6 1,0,inf 2,1,4 " ] || { fail "range"; cat out; }
[ -s err ] && fail "--quiet was not"

expect 0 cast cube.obj --rays range.csv -q --query spans
[ "$(cut -d, -f1-5 out | tail -n +2 | tr '\n' ' ')" = "0,1,4.5,6,1.5 1,0,nan,nan,0 2,1,4,6,2 " ] || { fail "range of spans"; cat out; }

# Directions of any length: the length of a span is not lost where the square of the direction's is.
printf '0.25,0.5,-5,0,0,1e-300,0,inf\n0.25,0.5,-5,0,0,1e300,0,inf\n0.25,0.5,0,0,0,1e-200,0,0\n' >lengths.csv
expect 0 cast cube.obj --rays lengths.csv -q --query spans
awk -F, 'FNR > 1 && FNR < 4 && !($5 > 1.999999 && $5 < 2.000001) { exit 1 } FNR == 4 && $5 != 0 { exit 1 }' out ||
    { fail "lengths of spans along short and long directions"; cat out; }

# Standard input; lines that end in \r\n; into a file.
"$sagitta" cast cube.obj --rays - -o hits.csv <rays.csv 2>err || fail "rays from the standard input"
cmp -s hits.csv closest.csv || fail "-o hits.csv differs from the standard output"
sed 's/$/\r/' rays.csv >crlf.csv
expect 0 cast cube.obj --rays crlf.csv
cmp -s out closest.csv || fail "lines that end in CR LF"
: >empty.csv
expect 0 cast cube.obj --rays empty.csv
[ "$(wc -l <out)" -eq 1 ] || fail "no rays, so a header alone"

# The same rays as .npy (0.25 0.5 -5 0 0 1, 0.25 9 -5 0 0 1, 0.25 0.5 0 0 0 -2): the same rows, bit for bit.
zero='\000\000\000\000\000\000\000\000' quarter='\000\000\000\000\000\000\320\077' half='\000\000\000\000\000\000\340\077'
one='\000\000\000\000\000\000\360\077' minus_two='\000\000\000\000\000\000\000\300' minus_five='\000\000\000\000\000\000\024\300'
nine='\000\000\000\000\000\000\042\100'
{
    printf '\223NUMPY\001\000\106\000'
    printf '%-69s\n' "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 6), }"
    printf "$quarter$half$minus_five$zero$zero$one"
    printf "$quarter$nine$minus_five$zero$zero$one"
    printf "$quarter$half$zero$zero$zero$minus_two"
} >rays.npy
expect 0 cast cube.obj --rays rays.npy
cmp -s out closest.csv || { fail "rays from .npy differ from those of CSV"; diff out closest.csv; }
"$sagitta" cast cube.obj --rays - <rays.npy >out 2>err || fail ".npy from the standard input"
cmp -s out closest.csv || fail "rays from a .npy pipe differ"

# A conversation: each ray is answered before the next is asked.
mkfifo to from
"$sagitta" cast cube.obj --rays - -q <to >from 2>err &
exec 3>to 4<from
echo '0,0,-5,0,0,1' >&3
read -r row <&4
read -r row <&4
[ "${row%%,-*}" = "0,1,4,0,0" ] || fail "the first answer: $row"
echo '0,0,-7,0,0,1' >&3
read -r row <&4
[ "${row%%,-*}" = "1,1,6,0,0" ] || fail "the second answer: $row"
exec 3>&- 4<&-
wait $! || fail "the conversation's end: $(cat err)"
rm to from

# Many rays on one thread and on four.
awk 'BEGIN { srand(3); for (i = 0; i < 100000; i++) print 4*rand()-2 "," 4*rand()-2 ",-5," rand()-.5 "," rand()-.5 ",3" }' >many.csv
expect 0 cast cube.obj --rays many.csv --threads 1 -o one.csv
expect 0 cast cube.obj --rays many.csv --threads 4 -o four.csv
cmp -s one.csv four.csv || fail "one thread and four differ"
[ "$(wc -l <one.csv)" -eq 100001 ] || fail "a row for each ray"
awk -F, 'NR > 1 && $1 != NR - 2 { exit 1 }' one.csv || fail "the rays' numbers"
expect 0 cast cube.obj --rays many.csv --query all -o all1.csv --threads 1
expect 0 cast cube.obj --rays many.csv --query all -o all4.csv --threads 4
cmp -s all1.csv all4.csv || fail "all: one thread and four differ"
expect 0 cast cube.obj --rays many.csv --query count -o count.csv
awk -F, 'NR > 1 && $2 != 0 && $2 != 2 { exit 1 }' count.csv || fail "a closed cube is crossed 0 or 2 times from outside"
# Where a ray is in the cube and how far: the two crossings of `all`.
expect 0 cast cube.obj --rays many.csv --query spans -o spans1.csv --threads 1
expect 0 cast cube.obj --rays many.csv --query spans -o spans4.csv --threads 4
cmp -s spans1.csv spans4.csv || fail "spans: one thread and four differ"
awk -F, 'FNR > 1 && $2 == 1 { if (FNR == NR) t[$1] = t[$1] " " $3; else if (t[$1] != " " $3 " " $4) exit 1; else n++ }
    END { if (n < 1000) exit 1 }' all1.csv spans1.csv || fail "spans are not between the crossings of all"
# The nearest crossing is the first of all.
awk -F, '!seen[$1]++' all1.csv | cmp -s - one.csv || fail "closest is not the first of all"

# .npy out.
expect 0 cast cube.obj --rays many.csv -o one.npy --threads 1
expect 0 cast cube.obj --rays many.csv -o four.npy --threads 4
cmp -s one.npy four.npy || fail ".npy: one thread and four differ"
expect 0 cast cube.obj --rays many.csv --query spans -o spans.npy
[ "$(wc -c <one.npy)" -eq $((512 + 100000 * 105)) ] || fail "the size of hits.npy"
python=
for p in python3 /usr/bin/python3; do
    [ -z "$python" ] && "$p" -c 'import numpy' 2>/dev/null && python=$p
done
if [ -n "$python" ]; then
    "$python" - <<'END' || fail "NumPy reads something else from .npy than from CSV"
import numpy
table = numpy.load('one.npy')
names = 'ray,hit,t,x,y,z,nx,ny,nz,u,v,geometry,primitive,instance'.split(',')
assert list(table.dtype.names) == names and table.shape == (100000,)
csv = numpy.loadtxt('one.csv', delimiter=',', skiprows=1)
for i, name in enumerate(names):
    assert numpy.array_equal(table[name].astype(float), csv[:, i], equal_nan=True), name
spans, csv = numpy.load('spans.npy'), numpy.loadtxt('spans1.csv', delimiter=',', skiprows=1)
assert spans.shape == (len(csv),) and len(spans.dtype.names) == csv.shape[1]
for i, name in enumerate(spans.dtype.names):
    assert numpy.array_equal(spans[name].astype(float), csv[:, i], equal_nan=True), name
rays = numpy.loadtxt('many.csv', delimiter=',')
numpy.save('many.npy', rays)
numpy.save('fortran.npy', numpy.asfortranarray(rays))
numpy.save('big.npy', rays.astype('>f8'))
END
    for form in many fortran big; do
        expect 0 cast cube.obj --rays $form.npy -o again.npy
        cmp -s one.npy again.npy || fail "$form.npy: other hits than from CSV"
    done
else
    echo "no NumPy here: hits.npy was not read by it"
fi
finish
