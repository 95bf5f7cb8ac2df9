#!/bin/sh
# What may be lost between triangles, and what must not: leaks --profile, --require watertight,
# --displacement.
#   sh tests/watertight.sh RAYDIFF
set -u
raydiff=$1
. tests/expect.sh
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
expect 2 "it is above 0" $ask --engine cpu --displacement 0
[ "$failed" -eq 0 ]
