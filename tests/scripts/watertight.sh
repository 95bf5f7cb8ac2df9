#!/bin/sh
# What may be lost between triangles, and what must not: leaks --profile, --require watertight,
# --displacement.
#   sh tests/scripts/watertight.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh
few='--count 4000 --engine cpu --layout f32 --box robust'

# DXR forbids what Vulkan advises against, whatever a tracer promises.
expect 0 . leaks sphere:n=8 $few --tri mt
expect 1 . leaks sphere:n=8 $few --tri mt --profile dxr
grep -q 'BROKEN.*missed\|missed' "$dir/out" || bad "leaks --profile dxr names what was missed"

tracer="pipe:$(dirname "$raydiff")/samples/tracer"
ask="check sphere:n=4 --count 3000 --repeat 1 --rays edges"
expect 0 . $ask --engine cpu --layout f32 --tri mt
expect 1 . $ask --engine cpu --layout f32 --tri mt --require watertight
expect 0 . $ask --engine cpu --layout f32 --tri woop --box watertight --require watertight
expect 1 . $ask --engine "$tracer" --require watertight
expect 2 "'closed' is not watertight" $ask --require closed
expect 2 "of closest and any hits" $ask --engine cpu --query all --require watertight
expect 2 "--displacement: not used here: it needs an engine whose formula is not known" $ask --engine cpu --displacement 8
expect 2 "is not above 0" $ask --engine cpu --displacement 0

# conform judges with the same demands.
trial=closest.cpu.f32.median.robust
played() { # its last line
    grep -q "^$1, 0 skipped" "$dir/out" || bad "conform: no line '$1'"
}
expect 0 . conform $trial.mt.sphere.edges.1
played '1 passed, 0 failed'
for require in watertight cpu,watertight watertight,cpu; do
    expect 1 . conform $trial.mt.sphere.edges.1 --require $require
    played '0 passed, 1 failed'
    grep -q '^FAILED.*lost in closed fans [1-9]' "$dir/out" || bad "conform says what a fan lost"
done
expect 0 . conform closest.cpu.f32.median.watertight.woop.sphere.edges.1 --require watertight,cpu
of="closest.$tracer.-.-.-.mt.sphere.edges.1"
expect 0 . conform "$of" --engine "$tracer"
expect 1 . conform "$of" --engine "$tracer" --require watertight
expect 2 "no engine here has an unknown formula" conform "$of" --engine "$tracer" --displacement 8
expect 2 "unknown name 'closed'" conform $trial.mt.sphere.edges.1 --require watertight,closed
expect 2 "not used here: it needs an engine whose formula is not known" conform $trial.mt.sphere.edges.1 --displacement 8
expect 2 "not used here: it needs an engine whose formula is not known" conform 'closest.cpu.*' --displacement 8
expect 2 "require watertight: not used by the hard cases" conform 'hard.01-*' --engine cpu --require watertight
expect 2 "displacement: not used by the hard cases" conform 'hard.01-*' --displacement 8
[ "$failed" -eq 0 ]
