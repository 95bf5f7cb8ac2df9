#!/bin/sh
# raydiff bisect: each planted pass, hidden among real ones, is found by conform and traced to itself, to the function
# and to the instruction; passes that only show together are found together; a driver that crashes or hangs on the
# modules between costs these; translators are named.
#   sh tests/compilers/bisect.sh BUILD/raydiff
set -u
raydiff=$1
name=bisect passes='drop reassociate contract fuse swap mark act odd invalid'
. tests/compilers/passes.sh
scene='sphere:n=8 --seed 1'

# Output of a run has such lines; spaces that break lines are one.
has() { # what, pattern...
    what=$1
    shift
    tr -s ' \n' ' ' <"$dir/out" >"$dir/line"
    for pattern; do
        grep -qE -- "$pattern" "$dir/line" || bad "$what: nothing like /$pattern/"
    done
}

# What the JSON of the last run says the text says, too; each of its fields is in the table of fields and in the schema.
v() { sed -n "s/^$1=//p" "$dir/flat"; }
told() { # exit code
    perl tests/docs/schema.pl docs/schemas/bisect.json "$dir/j.json" || bad 'JSON: not as its schema'
    awk -f tests/values/flat.awk "$dir/j.json" >"$dir/flat"
    sh tests/values/fields.sh bisect "$dir/flat" "$dir/seen" || bad 'JSON: fields'
    [ "$(v exit)" = "$1" ] || bad 'JSON: exit'
    tr -s ' \n' ' ' <"$dir/out" >"$dir/line"
    {
        echo "$(v compiler) against $(v good): $(v subject), $(v rays) ray"
        echo " engine $(v engine)$([ "$(v layout)" = null ] || echo ", layout $(v layout)") symptom "
        [ "$(v symptom)" = null ] || echo "symptom $(v symptom.name): $(v symptom.count) of $(v symptom.of) "
        [ -z "$(v symptom.first_ray)" ] || case $(v symptom.name) in
            precise) echo ", $(v symptom.open) of open rounding" ;;
            *) echo ", to ray $(v symptom.first_ray) first" ;;
        esac
        [ "$(v tool)" = null ] || echo " tool $(v tool) "
        [ "$(v passes)" = null ] || {
            case $(v passes.proof) in
            shortest) proof='no shorter list shows it' ;;
            minimal) proof='none of them can be left out' ;;
            *) proof='a smaller one may do: --tries was reached' ;;
            esac
            echo ": $(v passes.found.count) of $(v passes.all.count), $proof ($(v passes.tried) tried)"
            echo " passes $(sed -n 's/^passes\.found\.[0-9]*=//p' "$dir/flat" | paste -sd+ | sed 's/+/ + /g'): "
        }
        [ -z "$(v change.what)" ] || {
            echo " shader $(v shader)$([ -z "$(v change.function)" ] || echo ", function $(v change.function)") "
            echo " change $(v change.what) "
            echo " $(v change.found) of $(v change.edits) $([ "$(v change.decorations)" = true ] && echo 'lost decoration' || echo edit)"
            [ "$(v change.least)" = true ] && echo ', none can be left out (' || echo ', fewer may do: --tries was reached ('
            echo " ($(v change.tried) tried)"
            sed -n 's/^change\.lines\.[0-9]*\.text=/ /p' "$dir/flat"
        }
        [ "$(v crashed)$(v hung)" = 00 ] || echo "modules $(v crashed) of those tried crashed the engine, $(v hung) hung"
    } | while IFS= read -r text; do grep -qF -- "$text" "$dir/line" || echo "$text"; done >"$dir/untold"
    [ ! -s "$dir/untold" ] || bad "JSON, but not in the text: $(head -n 1 "$dir/untold")"
}

# The planted three: conform finds each, bisect says which pass, where and what. The first product is one of slab.glsl;
# the first sums of three are those of tri.glsl's tri_sum.
planted() { # pass, symptom, function, what
    conform=$(date +%s)
    expect 1 . conform 'closest.vulkan*.f32.median.robust.mt.sphere.random.1' --engine vulkan \
        --compiler "passes:ccp+$dir/$1+merge-return"
    grep -qE "^FAILED +closest.vulkan:passes:.*/$1" "$dir/out" || bad "conform $1"
    [ $(($(date +%s) - conform)) -le 20 ] || bad "conform $1: late"
    expect 1 . bisect $scene --compiler "passes:ccp+$dir/$1+merge-return" --json "$dir/j.json"
    told 1
    has "bisect $1" "symptom $2: " "passes [^ ]*/$1: 1 of 3, no shorter list shows it" "function $3 " "change $4" \
        'none can be left out'
}
planted drop precise slab_ray_make \
    'NoContraction of %([0-9]+) \(OpFMul\) is gone - OpDecorate %\1 NoContraction %\1 = OpFMul .* 1 of 1 edit,'
planted reassociate bits tri_sum \
    'other operands of %([0-9]+) \(OpFAdd\) - %\1 = OpFAdd .* \+ %[0-9]+ = OpFAdd .* \+ %\1 = OpFAdd .* 3 of [0-9]+ edits,'
planted contract precise tri_sum \
    'OpFAdd of %([0-9]+) became Fma - %\1 = OpFAdd .* \+ %\1 = OpExtInst %[0-9]+ %[0-9]+ Fma .* 2 of 3 edits,'

# Wrong answers, and operands in another order; any hits; a seed of its own; each symptom by name.
expect 1 . bisect $scene --compiler "passes:ccp+$dir/swap"
has swap 'symptom wrong: [1-9][0-9]* of 1000 answers are WRONG' \
    'operands of %([0-9]+) \(OpFSub\) in another order - %\1 = OpFSub (%[0-9]+) (%[0-9]+) (%[0-9]+) \+ %\1 = OpFSub \2 \4 \3'
expect 1 . bisect $scene --compiler "passes:$dir/swap" --symptom bits --query any --engine vulkan_stackless
has 'swap, any' 'symptom bits: ' 'shader stackless_f32, function '
expect 0 . bisect $scene --compiler "passes:$dir/swap+ccp" --good "passes:$dir/swap" --symptom wrong
has 'wrong under both' 'symptom none'
expect 0 . bisect $scene --compiler "passes:$dir/drop" --symptom bits
has 'drop has no bits' 'symptom none: nothing shows'
expect 0 . bisect $scene --compiler "passes:$dir/reassociate" --symptom precise
has 'reassociate loses nothing' 'symptom none'

# Decorations that come too late.
expect 1 . bisect $scene --compiler "passes:ccp+$dir/fuse+merge-return:final" --json "$dir/fault.json"
has final 'symptom precise: 0 of [0-9]+ .* 1 of open rounding' 'passes [^ ]*/fuse: 1 of 3,' \
    'of %([0-9]+) became Fma .* \+ %\1 = OpExtInst %[0-9]+ %[0-9]+ Fma'
expect 0 . bisect $scene --compiler "passes:ccp+$dir/fuse+merge-return"
has 'what is decorated is not fused' 'symptom none'
# Levels are lists, which spirv-opt tells. That of Debian 12 fuses what is not decorated, that of Debian 13 does not:
# bisect has to find what check says is there.
"$raydiff" check $scene --count 9 --repeat 1 --engine vulkan --layout f32 --compiler opt:final >"$dir/out" 2>&1
fuses=$?
expect $fuses . bisect $scene --compiler opt:final
if [ $fuses -eq 1 ]; then
    has opt:final 'symptom precise: 0 of [0-9]+ .* [1-9][0-9]* of open rounding' 'passes [a-z=0-9-]+: 1 of [0-9]+,' \
        'of %([0-9]+) became Fma .* \+ %\1 = OpExtInst %[0-9]+ %[0-9]+ Fma'
else
    has opt:final 'symptom none: nothing shows'
fi
expect 0 . bisect $scene --compiler opt --layout rf16 --json "$dir/j.json"
told 0
has opt 'symptom none: nothing shows'
expect 0 . bisect $scene --compiler opt:final --good size:final --symptom precise
has 'both of them' 'symptom none'
expect 1 . bisect $scene --compiler raw --good "passes:$dir/reassociate" --json "$dir/j.json"
told 1
has 'as built' 'symptom bits: ' 'passes none: the shader as built shows it'

# Two passes that only show together are a pair; a world; brute force.
for fault in 's/"tried"/"tries"/' 's/"least": *true/"least": 1/' 's/"sign": "-"/"sign": "x"/' 's/"exit": *1/"exit": "1"/'; do
    sed "$fault" "$dir/fault.json" >"$dir/planted.json"
    cmp -s "$dir/fault.json" "$dir/planted.json" && bad "schema: nothing planted by $fault"
    perl tests/docs/schema.pl docs/schemas/bisect.json "$dir/planted.json" >/dev/null && bad "schema: not noticed: $fault"
done
expect 1 . bisect $scene --compiler "passes:ccp+$dir/mark+merge-return+$dir/act+if-conversion"
has 'a pair' 'passes [^ ]*/mark \+ [^ ]*/act: 2 of 5, no shorter list shows it' 'NoContraction of .* is gone'
expect 1 . bisect $scene --compiler "passes:$dir/mark+$dir/act+ccp+$dir/drop"
has 'a pair before one that does alone' 'passes [^ ]*/drop: 1 of 4, no shorter list shows it'
expect 0 . bisect $scene --compiler "passes:$dir/act+$dir/mark"
has 'a pair, the other way round' 'symptom none'
expect 1 . bisect crowd:n=6 --compiler "passes:ccp+$dir/reassociate" --count 400
has 'a world' 'shader world_f32, function '
expect 1 . bisect soup:n=30 --engine vulkan_brute --compiler "passes:ccp+$dir/contract" --json "$dir/j.json"
told 1
has brute 'engine vulkan_brute symptom' 'shader trace_brute, function tri_sum'

# A search that ended before its end proves nothing.
expect 1 . bisect $scene --compiler "passes:ccp+$dir/drop+merge-return+if-conversion" --count 100 --tries 1 --json "$dir/j.json"
told 1
has 'a search of one try' '2 of 4, a smaller one may do: --tries was reached '

# A name of conform, and a finding of fuzz, which does not say where a program was.
expect 1 . bisect "closest.vulkan:passes:$dir/drop.f32.median.robust.mt.sphere.random.1"
has 'a whole name' "passes [^ ]*/drop: 1 of 1"
expect 1 . bisect "closest.vulkan:passes:$dir/fuse:final.rf16.median.robust.mt.sphere.random.1" --count 100
has 'a whole name' 'shader trace_rf16, function '
"$raydiff" fuzz --compiler "passes:$dir/reassociate" --engine vulkan --layout f32 --trials 40 --corpus none \
    --dir "$dir/found" --jobs 1 >/dev/null 2>&1
finding=$(ls -d "$dir"/found/vulkan=passes* 2>/dev/null | head -n 1)/smallest.trial
expect 1 . bisect "$finding" --compiler "passes:ccp+$dir/reassociate"
has 'a finding' 'symptom bits: ' 'passes [^ ]*/reassociate: 1 of 2' 'function tri_sum'
expect 1 . bisect "$finding" --engine "vulkan:passes:$dir/reassociate"
has 'its engine' 'passes [^ ]*/reassociate: 1 of 1'
# Its own tree, too: a leaf of all 14 triangles, which the layout cannot hold.
sed 's/^builder .*/builder median leaf 64 eps 0.02/' fuzz/corpus/eighth-slot.trial >"$dir/leaf.trial"
expect 2 'rf16: a leaf holds at most 8 items, this tree has one of 14' bisect "$dir/leaf.trial" --engine vulkan --layout rf16 \
    --compiler passes:ccp
expect 2 "'texel:opt': a way to read memory has no passes" bisect sphere:n=4 --compiler texel:opt
expect 2 'name it with --compiler' bisect "$finding"
sed 's/^expect vulkan:passes[^ ]*/expect vulkan:opt:final.f32.bits.shader/' "$finding" >"$dir/own.trial"
expect $fuses . bisect "$dir/own.trial"
has 'a finding that knows its compiler' '^opt:final against raw: ' "symptom $([ $fuses -eq 1 ] && echo precise || echo none)"

# A driver that cannot bear modules between; the search ends where it was told to.
if echo '#include <vulkan/vk_layer.h>' | ${CC:-cc} -E - >/dev/null 2>&1; then
    ${CC:-cc} -D_GNU_SOURCE -shared -fPIC -O1 -I. -o "$dir/libodd.so" tests/compilers/odd_layer.c || bad odd_layer.c
    cat >"$dir/odd.json" <<END
{"file_format_version": "1.1.0", "layer": {"name": "VK_LAYER_RAYDIFF_odd", "type": "GLOBAL",
 "library_path": "$dir/libodd.so", "api_version": "1.3.0", "implementation_version": "1", "description": "odd"}}
END
    export VK_LAYER_PATH="$dir" VK_INSTANCE_LAYERS=VK_LAYER_RAYDIFF_odd
    expect 1 . bisect $scene --compiler "passes:ccp+$dir/odd" --count 100 --json "$dir/j.json"
    told 1
    has 'a driver that crashes' 'change other operands of .* \+ OpName %[0-9]+ "odd" ' '4 of [0-9]+ edits, none can be left out' \
        'modules [1-9][0-9]* of those tried crashed the engine, 0 hung'
    ODD=hang
    export ODD
    expect 1 . bisect $scene --compiler "passes:$dir/odd" --count 100 --tries 2 --time 1 --json "$dir/j.json"
    told 1
    has 'a driver that hangs' 'fewer may do: --tries was reached' 'modules 0 of those tried crashed the engine, [12] hung'
    unset ODD VK_LAYER_PATH VK_INSTANCE_LAYERS
else
    echo "SKIP a driver that crashes: vulkan/vk_layer.h is needed"
fi

# Translators: another spirv-cross that loses a word, and two front ends behind it.
if command -v spirv-cross >/dev/null && command -v glslangValidator >/dev/null && command -v glslc >/dev/null; then
    mkdir "$dir/fake"
    cat >"$dir/fake/spirv-cross" <<END
#!/bin/sh
'$(command -v spirv-cross)' "\$@" | awk '!done && /precise/ && /\*/ { sub(/precise /, ""); done = 1 } { print }'
END
    cat >"$dir/fake/glslc" <<END
#!/bin/sh
awk '!done && /precise/ && /\*/ { sub(/precise /, ""); done = 1 } { print }' | '$(command -v glslc)' "\$@"
END
    chmod +x "$dir/fake"/*
    path=$PATH
    PATH=$dir/fake:$path
    expect 1 . bisect $scene --compiler cross --json "$dir/j.json"
    told 1
    has cross 'tool spirv-cross: glslc behind it shows it, too' 'function slab_ray_make change %([0-9]+) \(OpFMul\) is without NoContraction - OpDecorate %\1 NoContraction'
    rm "$dir/fake/spirv-cross"
    expect 1 . bisect $scene --compiler shaderc
    has shaderc 'tool glslc: glslangValidator behind the same spirv-cross does not show it' 'is without NoContraction'
    PATH=$path
    expect 0 . bisect $scene --compiler cross
else
    echo "SKIP translators: spirv-cross, glslangValidator and glslc are needed"
fi

# What cannot be.
expect 3 'spirv-val ended with exit code 1' bisect $scene --compiler "passes:$dir/invalid"
expect 2 'no compiler' bisect $scene
expect 2 'the same compiler, opt' bisect $scene --compiler opt --good opt
expect 2 'has no shaders to compile' bisect $scene --engine cpu --compiler opt
expect 2 '--compiler: the engine has one, opt' bisect $scene --engine vulkan:opt --compiler size
expect 2 "'fast' is no compiler" bisect $scene --compiler fast
expect 2 "Unknown flag '--no-such-pass'" bisect $scene --compiler passes:no-such-pass
expect 2 '--query: closest or any can be bisected' bisect $scene --compiler opt --query all
expect 2 "--layout: the trial's name says it" bisect closest.vulkan:opt.f32.median.robust.mt.sphere.random.1 --layout rf16
expect 2 '--count: the file says it' bisect "$finding" --compiler opt --count 9
expect 2 'one scene at a time' bisect sphere soup --compiler opt
expect 2 'no scene given' bisect --compiler opt
expect 77 'no-such-driver' bisect $scene --compiler opt --driver no-such-driver
sh tests/values/fields.sh --unseen bisect "$dir/seen" >"$dir/unseen" || bad "fields: $(head -n 1 "$dir/unseen")"
exit $((failed > 0))
