#!/bin/sh
# What tracers that are shared objects list, and the bytes that they tell, from the command line: in both ways to run
# one, lists are judged as those of other engines; bytes stand where engines' bytes stand; what is not told is '-' or
# null, and never 0: sh tests/guest/bytes.sh PATH/raydiff
set -u
. tests/guest/outsiders.sh

samples=$root/fuzz/samples/engine
strict='-Wall -Wextra -Werror -O2 -shared -fPIC'
cc -std=c11 $strict "-I$root" -o brute.so "$samples/brute_engine.c" || bad 'the template in C'
cc -std=c11 $strict "-I$root" -DBUG=1 -o brute_bug.so "$samples/brute_engine.c" || bad 'its bug'
c++ -std=c++11 $strict "-I$root" -o bvh.so "$samples/bvh_engine.cpp" || bad 'the tracer in C++'

# --- lists: triangles and double hits of both ways are the same; a bug is found; one that makes none says so
expect 0 '2 of 2 rows agree' check sphere:n=8 --query all --count 500 --repeat 1 --engine ./brute.so,inside:./brute.so \
    --json lists.json
perl -MJSON::PP -0ne '@l = map { "$_->{lists}{triangles} $_->{lists}{double_hits} $_->{hits}" } @{ decode_json($_)->{rows} };
    exit !(@l == 2 && $l[0] eq $l[1] && $l[0] =~ /^[1-9]/)' lists.json || bad 'both ways list the same'
expect 1 'WRONG +- +./brute_bug.so' check sphere:n=4 --query all --engine ./brute_bug.so --count 200 --repeat 1
expect 1 '`can` has no ALL' check sphere:n=4 --query all --engine ./bvh.so --count 50
expect 1 '`can` has no ALL' check sphere:n=4 --query all --engine inside:./bvh.so --count 50
expect 0 '2 passed, 0 failed' conform 'all.*.mt.sphere.mixed.1' --engine ./brute.so,inside:./brute.so
expect 1 '0 passed, 1 failed' conform 'all../brute_bug.so.-.-.-.mt.sphere.mixed.1'
expect 0 '1 passed, 0 failed' conform 'all.cpu.f32.median.robust.mt.sphere.mixed.1'
"$raydiff" conform '*.sphere.mixed.1' --list --engine ./brute.so | grep -q '^all' && bad 'other patterns mean no lists'
for way in '' inside:; do # of one that makes no lists the misses are counted all the same
    expect 0 'answered 1 of 1' leaks sphere:n=8 --engine "$way./bvh.so" --count 1000
    grep -q 'did not run' out && bad "leaks of $way"
done

# --- bytes: the tracer in C++ has a node of 64 bytes for each triangle; the template tells nothing
nodes=$((64 * 512))
for query in closest all; do
    "$raydiff" check sphere:n=8 --query $query --count 500 --repeat 1 --layout f32 --engine brute,cpu,./brute.so,inside:./brute.so \
        --json told.json >out 2>&1
    perl -MJSON::PP -0ne 'for (@{ decode_json($_)->{rows} }) {
            if ($_->{engine} eq "cpu") { exit 1 if grep { !defined || $_ <= 0 } @$_{qw(node_bytes scene_bytes memory_bytes)} }
            else { exit 2 if grep { defined } @$_{qw(node_bytes item_bytes scene_bytes)};
                   exit 3 if ($_->{engine} eq "brute") ne defined $_->{memory_bytes} } }' told.json ||
        bad "check --json, query $query: what is not told is null ($?)"
done
expect 0 '2 of 2 rows agree' check sphere:n=8 --count 500 --repeat 1 --engine ./bvh.so,inside:./bvh.so --json told.json
grep -cE '^agrees .* 64\.0 ' out | grep -qx 2 || bad 'B/tri of check'
perl -MJSON::PP -0ne 'for (@{ decode_json($_)->{rows} }) { exit 1 if $_->{node_bytes} != '$nodes' || $_->{memory_bytes} != '$nodes' ||
    defined $_->{item_bytes} || defined $_->{scene_bytes} }' told.json || bad 'check --json has what is told'
expect 0 'agrees +- +./brute.so +0 +[0-9]+ +- +[0-9]+ +- ' check sphere:n=8 --count 500 --repeat 1 --engine ./brute.so
expect 0 '^- +./bvh.so +- +own +closest +32\.8 +- ' check sphere:n=8 --count 500 --repeat 1 --wide --engine ./bvh.so
all=inside:./bvh.so,./bvh.so,inside:./brute.so,./brute.so
expect 0 . bench fast --scene sphere:n=8 --count 800 --rounds 1 --engine $all --csv fast.csv
grep -cE '^  (inside:)?bvh.so +64\.0 ' out | grep -qx 2 || bad 'byte/tri of bench fast'
grep -cE '^  (inside:)?brute.so +- ' out | grep -qx 2 || bad 'byte/tri of bench fast, not told'
expect 0 . bench matrix --scene sphere:n=8 --count 800 --rounds 1 --threads 1 --engine $all --csv matrix.csv
expect 0 . bench matrix --scene sphere:n=8 --count 800 --rounds 1 --threads 1 --engine $all --wide
grep -cE '^  (inside:)?bvh.so +64\.0 +- +- +64\.0 +- ' out | grep -qx 2 || bad 'bytes per triangle of bench matrix'
grep -cE '^  (inside:)?brute.so +- +- +- +- +- ' out | grep -qx 2 || bad 'bytes per triangle of bench matrix, not told'
expect 0 . bench error --scene sphere:n=8 --count 800 --rounds 1 --engine $all --csv error.csv
# columns FILE NAME COLUMN...: of each row whose engine is of that file
columns() {
    file=$1 name=$2
    shift 2
    awk -F, -v name="$name" -v columns="$*" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["engine"] ~ name { n = split(columns, c, " "); line = ""
            for (i = 1; i <= n; i++) line = line " " ($at[c[i]] == "" ? "null" : $at[c[i]])
            print substr(line, 2) }' "$file" | sort | uniq -c | sed 's/^ *//'
}
[ "$(columns fast.csv bvh.so bytes_per_triangle)" = '8 64' ] && [ "$(columns fast.csv brute.so bytes_per_triangle)" = '8 null' ] ||
    bad 'CSV of bench fast'
[ "$(columns matrix.csv bvh.so node_bytes scene_bytes held_bytes bytes_per_triangle)" = "2 $nodes null $nodes 64" ] &&
    [ "$(columns matrix.csv brute.so node_bytes scene_bytes held_bytes bytes_per_triangle)" = '2 null null null null' ] ||
    bad 'CSV of bench matrix'
columns error.csv bvh.so node_bytes item_bytes memory_bytes | grep -Eqx "[1-9][0-9]* $nodes null $nodes" &&
    columns error.csv brute.so node_bytes item_bytes memory_bytes | grep -Eqx '[1-9][0-9]* null null null' ||
    bad 'CSV of bench error'
[ "$failed" -eq 0 ] && echo 'lists and bytes of tracers from outside: as they should be'
exit "$failed"
