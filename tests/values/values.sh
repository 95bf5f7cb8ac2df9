#!/bin/sh
# The numbers that commands print, by value: text against JSON, and what is made of other numbers (ratios,
# sums, shares) made again from those. sh tests/values/values.sh RAYDIFF
set -u
raydiff=$1
. tests/values/compare.sh

small='--count 1000 --repeat 3 --threads 1'
compare check 250 check sphere:n=8 soup:n=300 --layout f32,rf16,half4 --engine cpu,fast $small
compare check 100 check soup:n=200 --layout f32,rf16 --engine all --query any $small
# Wrong answers of each kind that members as published give.
compare check 60 check soup:n=400,size=0.5 --layout rtrs_rf,rtrs_direct --engine cpu --box rtrs --tri mt_rtrs $small
# A formula that is unknown and wrong for small triangles; lists.
sed 's/size > 0\.0f/size > 1e-4f/; s/q.rays, 1, 0, 0, 0}/q.rays, 0, 0, 0, 0}/' fuzz/samples/sample_tracer.c >"$dir/some.c"
cc -O1 -o "$dir/some" "$dir/some.c" || bad 'a tracer is not compiled'
run check soup:n=100 --engine "pipe:$dir/some" --count 200 --repeat 1 --json "$dir/json" &&
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" && sh tests/values/fields.sh check "$dir/flat" "$dir/seen" &&
    grep -q '^rows.0.displacement.p99=[1-9]' "$dir/flat" && grep -q '^rows.0.findings.0.judgement.wrong=' "$dir/flat" ||
    bad "$ran: keys, or nothing is WRONG"
sed 's/q.rays, 1, 0, 0, 0}/q.rays, 0, 0, 0, 0}/' fuzz/samples/sample_tracer.c >"$dir/unknown.c"
cc -O1 -o "$dir/unknown" "$dir/unknown.c" || bad 'a tracer is not compiled'
compare check 40 check soup:n=100 --engine "cpu,pipe:$dir/unknown" --layout f32 --count 2000 --repeat 1
compare check 30 check soup:n=100 --engine cpu --layout f32 --query all --count 200 --repeat 1
compare leaks 200 leaks sphere:n=8 --engine cpu --layout f32,rf16 --count 4000 --threads 1
all_seen check leaks
echo "values: $failed failed"
[ "$failed" -eq 0 ]
