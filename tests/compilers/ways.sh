#!/bin/sh
# Ways in which shaders read their inputs, from the command line: texel buffers and buffer references have the bits of
# storage buffers in every layout, query and storage, in worlds, in one batch or many, and in campaigns.
#   sh tests/compilers/ways.sh BUILD/raydiff
set -u
raydiff=$1
name=ways
. tests/compilers/driver.sh
ways='--buffers storage,texel,reference'

# So many rows of other ways, each with equal bits and nothing lost.
equal() { # rows, options...
    rows=$1
    shift
    expect 0 . check "$@" --repeat 1 --brute 0
    found=$(grep -cE '^(texel|reference) .* ([0-9]+) of \2 +0 equal +[0-9]+ ' "$dir/out")
    [ "$found" -eq "$rows" ] || bad "$found rows with equal bits, not $rows"
}
equal 18 sphere:n=5 --engine vulkan $ways --count 200 \
    --layout rtrs_rf,cwbvh80,half4,amd64,amd64_f16,tiny8,bvh2_bf16_world,bvh4_u10_scene,bvh8_u8_node
equal 4 soup:n=300 --engine vulkan_brute,vulkan_stackless $ways --layout f32 --count 300
for store in indexed gathered edges baldwin_webber compact; do
    equal 2 terrain:k=3 --engine vulkan $ways --layout f32 --store $store --count 200 \
        --tri "$([ $store = baldwin_webber ] && echo baldwin_webber || echo mt)"
done
equal 2 terrain:k=3 --engine vulkan $ways --layout f32 --store quantised --count 200
equal 12 sphere:n=5 --engine vulkan,vulkan_brute $ways --layout rf16 --query closest,any,all --count 300
equal 4 crowd:n=6 mixed --engine vulkan $ways --layout f32 --count 300
equal 4 crowd:n=6 --engine vulkan $ways --layout bvh8_u8_node --count 300 --query any,all
equal 2 soup:n=40 --engine vulkan $ways --layout f32 --count 270000 --rays random # several batches

# Under a compiler, too; names; what is told.
if command -v spirv-opt >/dev/null; then
    expect 0 . check sphere:n=4 --engine vulkan --layout f32 --count 300 --repeat 1 --compiler raw,opt --buffers texel,reference
    for name in vulkan:texel vulkan:texel:opt vulkan:reference vulkan:reference:opt; do
        grep -qE "^agrees +f32 +$name " "$dir/out" || bad "no row of $name"
    done
fi
expect 0 . check sphere:n=4 --engine vulkan:texel,vulkan:reference --layout f32 --count 300 --repeat 1 --json "$dir/json"
grep -q '"compiler": "texel"' "$dir/json" || bad 'JSON: no texel'
grep -q '"compiler": "reference"' "$dir/json" || bad 'JSON: no reference'
expect 0 . conform 'closest.vulkan*.rf16.median.robust.mt.sphere.random.1' --engine vulkan --buffers texel,reference
expect 0 . conform closest.vulkan:texel.rf16.median.robust.mt.sphere.random.1
expect 0 'texel' check sphere:n=4 --engine vulkan --buffers texel --layout f32 --count 99 --repeat 1 --decorate none --compiler raw

# Campaigns put many small trials into one submission.
expect 0 . fuzz --engine vulkan --buffers texel,reference --layout f32 --trials 130 --corpus none --jobs 1 \
    --dir "$dir/found"
grep -qE '^contestant vulkan:texel.f32 answered 130 trials' "$dir/out" || bad 'fuzz: who plays'
expect 0 . fuzz --trials 132 --corpus none --jobs 1 --dir "$dir/found"
grep -qE 'vulkan:reference.f32 answered 132 trials' "$dir/out" || bad 'fuzz: a resumed campaign'
expect 0 . fuzz --worlds --engine vulkan --buffers texel,reference --layout f32 --trials 20 --corpus none --jobs 1 \
    --dir "$dir/worlds"

# They take turns, the first named most often; so they do in a campaign that goes on. Trials of a corpus are for all.
turns='--turns --buffers texel,storage,reference --layout f32 --rays 20 --triangles 2-4'
played() { # file, texel, storage, reference
    grep -oE '"(name|answered)": [^,]*' "$1" | tr -d '"' | sed 'N; s/name: //; s/\n[a-z]*://' >"$dir/played"
    printf 'vulkan:texel.f32 %s\nvulkan.f32 %s\nvulkan:reference.f32 %s\n' "$2" "$3" "$4" | cmp -s - "$dir/played" ||
        bad "turns: $(cat "$dir/played")"
}
expect 0 . fuzz --engine vulkan $turns --trials 512 --corpus none --jobs 2 --dir "$dir/turns" --json "$dir/turns.json"
played "$dir/turns.json" 384 64 64
grep -qE '^ +vulkan.f32 answered 64 trials, .*; in 448 trials of this run it was' "$dir/out" || bad 'turns: not told'
expect 0 . fuzz --trials 1100 --corpus none --jobs 1 --dir "$dir/turns" --json "$dir/turns.json"
played "$dir/turns.json" 844 128 128
expect 2 '--turns yes: the campaign in .* has none' fuzz --turns --trials 200 --dir "$dir/found"
expect 2 '--turns: not used here: no two engines differ only in --buffers' fuzz --turns --trials 9 --dir "$dir/none"
expect 2 '--turns: not used with --pairs' fuzz --turns --pairs 1 --buffers texel,storage --dir "$dir/none"

# What is not used or not known.
expect 2 "--buffers: 'images' is no way: storage, texel or reference" check sphere:n=4 --engine vulkan --buffers images
expect 2 '--buffers: not used here: it needs an engine vulkan' check sphere:n=4 --engine cpu --buffers texel
expect 2 '--buffers: vulkan:texel is named twice' check sphere:n=4 --engine vulkan --buffers texel,texel
expect 2 "--buffers: 'texel' has its own" check sphere:n=4 --engine vulkan --buffers reference --compiler texel
expect 2 '--buffers' bench fast --buffers texel
exit $((failed > 0))
