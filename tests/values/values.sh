#!/bin/sh
# The numbers that commands print, by value: text against JSON, and what is made of other numbers (ratios,
# sums, shares) made again from those. sh tests/values/values.sh RAYDIFF
set -u
raydiff=$1
. tests/values/compare.sh

# As it fits 80 columns, and with all columns and counters. Lines of a finding, of a command and those that end with
# a reason are not broken.
both() { # least, command, its arguments
    least_of=$1
    shift
    compare "$1" "$least_of" "$@" --wide
    run "$@" --json "$dir/json" || return
    grep -vE '^(WRONG|BITS|MISS|DOUBLE|(engine|layout) .* answered .*, cannot run here [0-9]+: |  explain:|  \.\.\. and)|^[^ ].*: ([0-9]+ instances?, )?[0-9]+ triangles,' "$dir/text" | grep -E '.{81}' && bad "$ran: a line is longer than 80 columns"
    # Broken lines made whole.
    awk '/^    / { sub(/^ */, " "); line = line $0; next } NR > 1 { print line } { line = $0 } END { print line }' "$dir/text" >"$dir/whole"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    awk -v fits=1 -v least="$((least_of / 2))" -f tests/values/lib.awk -f "tests/values/$1.awk" "$dir/flat" "$dir/whole" || bad "$ran"
}

small='--count 1000 --repeat 3 --threads 1'
both 250 check sphere:n=8 soup:n=300 --layout f32,rf16,half4 --engine cpu,fast $small
both 100 check soup:n=200 --layout f32,rf16 --engine all --query any $small
# A layout so slow that it is told from f32 on any machine.
sed 's/"mine"/"slow"/; s/    const uint32_t \*word = packed->word + (size_t)WORDS \* ref;/&\n    for (volatile int i = 0; i < 30000; i++) continue;/' \
    fuzz/samples/layout/mine.c >"$dir/slow.c"
cc -std=c17 -O2 -ffp-contract=off -shared -fPIC -I. -o "$dir/slow.so" "$dir/slow.c" || bad 'a layout is not compiled'
# Repeats of f32 that the machine itself delays can reach the slow ones; then it is measured again.
named=
for _ in 1 2 3 4 5; do
    both 60 check sphere:n=4 --layout "f32,$dir/slow.so" --engine cpu --count 300 --repeat 3 --threads 1
    grep -q "; slow on cpu has 0\.[0-3][0-9] times f32's speed\$" "$dir/whole" && named=yes && break
done
[ "$named" ] || bad "$ran: a layout that is far slower is not named"
# Wrong answers of each kind that members as published give.
both 60 check soup:n=400,size=0.5 --layout rtrs_rf,rtrs_direct --engine cpu --box rtrs --tri mt_rtrs $small
# A formula that is unknown and wrong for small triangles; lists.
sed 's/size > 0\.0f/size > 1e-4f/; s/q.rays, 1, 0, /q.rays, 0, 0, /' fuzz/samples/sample_tracer.c >"$dir/some.c"
cc -O1 -o "$dir/some" "$dir/some.c" || bad 'a tracer is not compiled'
run check soup:n=100 --engine "pipe:$dir/some" --count 200 --repeat 1 --json "$dir/json" &&
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" && sh tests/values/fields.sh check "$dir/flat" "$dir/seen" &&
    grep -q '^rows.0.displacement.p99=[1-9]' "$dir/flat" && grep -q '^rows.0.findings.0.judgement.wrong=' "$dir/flat" ||
    bad "$ran: keys, or nothing is WRONG"
both 40 check soup:n=100 --engine "cpu,pipe:$dir/some" --layout f32 --count 200 --repeat 1
both 40 check sphere:n=4 --engine cpu --layout f32 --tri mt,woop --count 100 --repeat 1
both 60 check sphere:n=4 --engine cpu --layout f32 --box robust,watertight --query any,closest --count 100 --repeat 1
sed 's/q.rays, 1, 0, /q.rays, 0, 0, /' fuzz/samples/sample_tracer.c >"$dir/unknown.c"
cc -O1 -o "$dir/unknown" "$dir/unknown.c" || bad 'a tracer is not compiled'
both 40 check soup:n=100 --engine "cpu,pipe:$dir/unknown" --layout f32 --count 2000 --repeat 1
both 40 check soup:n=100 --engine "cpu,pipe:$dir/unknown" --layout f32 --count 500 --repeat 1 --displacement 64
grep -q '; allowed are 64 uM, not 32' "$dir/whole" || bad "$ran: another bound than the usual one is not told"
both 30 check soup:n=100 --engine cpu --layout f32 --query all --count 200 --repeat 1
# Shaders compiled anew: bits that must be equal, and bits that are free.
both 150 check sphere:n=4 soup:n=100 --engine cpu,vulkan,vulkan_brute --compiler raw,opt,size:none --layout f32,rf16 --count 400 \
    --repeat 1 --threads 1
both 60 check sphere:n=4 --engine vulkan --compiler raw,opt:final --layout f32 --query any,closest --count 400 --repeat 1
# Modes of Embree beside its own choice.
if "$raydiff" check sphere:n=1 --engine embree:sse2 --count 10 >"$dir/text" 2>&1 || [ $? != 77 ]; then
    both 100 check sphere:n=4 soup:n=100 --engine embree,embree:sse2:4,embree:sse2:robust,embree:high:compact --query closest,any --count 400 \
        --repeat 1 --threads 1
    grep -q '^  bits of modes beside embree: [1-9]' "$dir/whole" || bad "$ran: no bits differ"
fi
# Worlds; engines that trace none are told, not played.
both 100 check crowd:n=12 sphere:n=4 mixed:count=20 --layout f32,rf16 --engine cpu,brute $small
both 60 check mixed:count=20 --layout f32 --engine cpu,brute --query closest,any,all --count 200 --repeat 1
run check placed-mirrored:count=3 --layout f32 --count 200 --repeat 1 --json "$dir/json" && awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" &&
    grep -q '^scenes.0.scenes_only=.*stackless' "$dir/flat" && ! grep -q '^rows.*engine=.*stackless' "$dir/flat" || bad "$ran: engines of scenes"
both 200 leaks sphere:n=8 --engine cpu,fast --layout f32,rf16 --count 4000 --threads 1
# Several scenes and worlds in one call: what is told of each, rays that are lost or hit twice, and the conclusion.
run scene convert sphere:n=4 "$dir/x.obj"
for form in --wide --color=never; do
    run leaks room sphere:n=4 wall:n=2 placed-turned --seed 7 --count 1000 --engine cpu,brute,cpu_stackless --layout f32,rf16 --tri mt,woop \
        --box watertight --profile dxr $form --json "$dir/json" || continue
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    awk '/^    [^ ]/ { sub(/^ */, " "); line = line $0; next } NR > 1 { print line } { line = $0 } END { print line }' "$dir/text" >"$dir/whole"
    awk -v least=500 -v seed=7 -f tests/values/lib.awk -f tests/values/floats.awk -f tests/values/scenes/obj.awk -f tests/values/leaks_told.awk "$dir/flat" \
        "$dir/x.obj" "$dir/whole" || bad "$ran"
done
all_seen check leaks
echo "values: $failed failed"
[ "$failed" -eq 0 ]
