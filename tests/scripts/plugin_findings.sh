#!/bin/sh
# Findings on layouts from outside: whoever reads a folder of them can be told the layout and its shader.
#   sh tests/scripts/plugin_findings.sh BUILD/raydiff [min|records|decode|report]      one part alone
set -u
raydiff=$(realpath "$1") part=${2-}
. tests/scripts/expect.sh
root=$(pwd)
cd "$dir" || exit 4

sample() { # NAME.so, options of the compiler, file
    name=$1
    shift
    cc -std=c17 -O1 -ffp-contract=off -shared -fPIC -I"$root" -o "$name" "$@" -lm || bad "$name does not compile"
}
sample mine.so "$root/fuzz/samples/layout/mine.c"
sample liar.so -DLIE=LIE_ULP "$root/tests/peers/plugin_liar.c"
cp "$root/fuzz/samples/layout/mine.glsl" .
plays() { [ -z "$part" ] || [ "$part" = "$1" ]; }

# --- min and report --------------------------------------------------------------------------------
expect 1 . fuzz --trials 2 --jobs 1 --corpus none --engine cpu --no-shrink --dir found --layout ./liar.so
first=$(ls -d found/cpu.*/first.trial)
sed "s/[.]liar[.]/.mine./" "$first" >sound.trial
if plays min; then
    printed=$(sed -n 's/^to shrink .*: raydiff //p' out)
    [ "$printed" = 'min found --layout ./liar.so' ] || bad "fuzz says to shrink by '$printed'"
    expect 2 "unknown layout 'liar' .one from outside: --layout FILE.so first." min found
    expect 2 "takes only FILE.so" min found --layout f32
    # What is wrong with a shader is told of it, whichever is named first.
    expect 2 '^raydiff check: --shader: no.glsl: No such file' check sphere --engine vulkan --shader no.glsl --layout ./mine.so
    expect 2 '^raydiff check: --shader: no.glsl: No such file' check sphere --engine vulkan --layout ./mine.so --shader no.glsl
    expect 2 "no finding of found is on mine" min found --layout ./liar.so,./mine.so
    expect 2 "no finding of found is on mine" min found --layout ./mine.so --layout ./liar.so
    expect 2 "liar is named twice" min found --layout ./liar.so --layout ./liar.so
    expect 2 "no finding of $first is on mine" min "$first" --layout ./liar.so,./mine.so --out small.trial
    # shellcheck disable=SC2086
    expect 0 . $printed
    grep -q '^found: 1 finding, 1 of them smaller now' out || bad "min shrank nothing"
    expect 0 . min "$first" --layout ./liar.so --out small.trial
    grep -q '^  replay   raydiff replay small.trial --layout ./liar.so$' out || bad "min does not say how to replay"
    expect 2 "unknown layout 'liar' .one from outside: --layout FILE.so first." merge --to merged found
    expect 2 "takes only FILE.so" merge --to merged found --layout f32
    expect 0 . merge --to merged found --layout ./liar.so
    grep -q '  cpu.liar.tree.bound_too_small  smallest: ' out || bad "merge: the finding is not there"
    expect 2 "unknown layout 'liar'" export "$first" --form text
    expect 0 . export "$first" --form text --layout ./liar.so
    grep -q '^# cpu.liar.tree.bound_too_small$' out || bad "export: not the finding"
    expect 1 . report --findings found --layout ./liar.so --parts check --out r.html --json r.json
    grep -q '"command": "raydiff replay found/cpu[^"]*/smallest.trial --layout ./liar.so"' r.json ||
        bad "report: how to replay: $(grep command r.json)"
    grep -q 'liar: record [0-9]*: . bounds' r.html || bad "report does not name the record"
fi

# --- which record, slot and bound ------------------------------------------------------------------
told() { # where
    grep -qE 'liar: record [0-9]+: [xyz] bounds \[.*\] do not contain \[.*\] below' "$1" || bad "$2 does not name the record and the bound"
}
if plays records; then
    expect 1 . replay "$first" --layout ./liar.so --engine cpu
    told out replay
    expect 1 . fuzz --trials 2 --jobs 1 --corpus none --engine cpu --no-shrink --dir again --layout ./liar.so
    told again/findings.jsonl 'the log of fuzz'
    expect 1 . explain --wide "$first" --layout ./liar.so --json t.json
    told out explain
    told t.json 'explain --json'
    grep -q '^cause     bound_too_small: ' out || bad "explain names no cause"
    grep -q '"cause": "bound_too_small"' t.json || bad "explain --json names no cause"
    expect 1 . $(sed -n 's/^again     raydiff //p' out) --wide
    told out 'explain again'
    expect 1 . explain "$first" --layout ./liar.so --engine fast
    expect 2 'it is about a tree, and engine embree takes none' explain "$first" --layout ./liar.so --engine embree
    expect 0 . explain sound.trial --layout ./mine.so
    grep -q 'its bytes are the tree that was built' out || bad "explain: mine is no tree"

    # The slot of a wide layout, and the other rules, by the words of findings.
    named() { # lie, cause, record or slot that is named, file
        sample liar.so -DLIE="LIE_$1" "$root/tests/peers/$4"
        rm -rf lies
        expect 1 . fuzz --trials 3 --jobs 1 --corpus none --engine cpu --no-shrink --dir lies --layout ./liar.so
        [ -f lies/cpu.*.tree."$2"/first.trial ] || bad "fuzz calls $1 $(ls lies)"
        expect 1 . explain --wide lies/*.tree."$2"/first.trial --layout ./liar.so
        grep -qE "^verdict   WRONG: liar4?: .*$3" out || bad "explain does not say $3 of $1"
    }
    named CHILD child_reference 'record [0-9]+: child [01] is reference' plugin_liar.c
    named TWICE triangle_twice 'item slot [0-9]+ names triangle [0-9]+ a second time' plugin_liar.c
    named LEAF record_malformed 'record [0-9]+: a leaf without items' plugin_liar.c
    named LEAF_ULP bound_too_small 'record [0-9]+, slot [0-9]+: x bounds' plugin_liar_wide.c
    sample liar.so -DLIE=LIE_ULP "$root/tests/peers/plugin_liar.c"
fi

# --- what C and GLSL decode ------------------------------------------------------------------------
sample mine4.so "$root/fuzz/samples/layout/mine4.c"
cp "$root/fuzz/samples/layout/mine4.glsl" .
decoded() { # code, what is said, layout, shader
    expect "$1" . explain --wide sphere:n=8 --rays mixed --count 50 --index 0 --layout "./$3.so" --shader "$4" --json d.json
    grep -qE "^decode    $2" out || bad "explain --shader $4 does not say '$2'"
    grep -q "\"exit\": $1,\$" d.json || bad "explain --shader $4: the JSON tells another exit code"
}
# So, too, where all answers are right and there is no page.
decoded_alone() { # code, layout, shader
    expect "$1" . explain sphere:n=8 --count 50 --layout "./$2.so" --shader "$3" --json none.json
    grep -q ': no answer of cpu is wrong$' out || bad "explain --shader $3: an answer is wrong"
    grep -q "\"exit\": $1,\$" none.json || bad "explain --shader $3, no answer wrong: the JSON tells another exit code"
}
lie() { # file, what of it, what instead, then as decoded
    sed "s/$2/$3/" "$1" >bad.glsl
    cmp -s "$1" bad.glsl && bad "'$2' is not in $1"
    decoded 1 "DIFFERS: $4" "${1%.glsl}" bad.glsl
}
if plays decode; then
    "$raydiff" explain sphere:n=8 --count 50 --layout ./mine.so --shader mine.glsl >out 2>err
    if [ $? -eq 77 ] && grep '^decode    C and GLSL are not compared: ' out; then
        echo "SKIP what C and GLSL decode"
    else
        decoded 0 'C and GLSL decode the same of 335 records, 679 slots' mine mine.glsl
        decoded 0 'C and GLSL decode the same of 85 records, 684 slots' mine4 mine4.glsl
        box='vec3 lo = uintBitsToFloat(low.xyz)'
        lie mine.glsl "$box" "if (ref == 334u) high.y = low.w; $box" \
            'record 334: z hi: C decodes 0x1.4779eep-1 \(0.639602125\), GLSL 0x1.a20bd8p-1 \(0.816496611\)'
        grep -q '^          1 of 335 records ' out || bad "explain does not count the records that differ"
        grep -q '"first": "record 334: z hi: ' d.json || bad "explain --json has no decode"
        decoded_alone 1 mine bad.glsl
        decoded_alone 0 mine mine.glsl
        lie mine.glsl 'at < job.item_count' 'both(at < job.item_count, at != 511u)' 'record 334: item slot 3: C decodes 151, GLSL none'
        lie mine.glsl 'leaf(n.b, n.a \& ~NODE_LEAF)' 'leaf(n.b, n.b == 508u ? 3u : 4u)' 'record [0-9]*: items: C decodes [0-9]+, GLSL [0-9]+'
        lie mine.glsl 'return n.b;' 'return n.a == 0u ? n.b : n.b + 1u;' 'record 1: second child: C decodes 85, GLSL 86'
        lie mine.glsl 'return n.a + 1u;' 'return n.a + uint(n.a != 0u);' 'record 0: first child: C decodes 1, GLSL 0'
        lie mine4.glsl "$box" "if (w.record == 84u) high.y = at == 674u ? 0u : high.y; $box" \
            'record 84, slot 1: z hi: C decodes .*, GLSL 0x0p\+0'
        lie mine4.glsl 'pick(inner, high.z, NODE_LEAF' 'pick(inner, high.z == 20u ? 21u : high.z, NODE_LEAF' \
            'record 4: child of slot 3: C decodes record 20, GLSL another \(21\)'
        lie mine4.glsl 'NODE_LEAF | high.w' 'NODE_LEAF | (at == 674u ? high.w - 1u : high.w)' 'record 84, slot 1: items: C decodes 2, GLSL 1'
        # Of a finding, too: of one about a tree that is sound with this layout.
        sed "s/$box/high.y = low.w; $box/" mine.glsl >bad.glsl
        expect 1 . explain --wide sound.trial --layout ./mine.so --shader bad.glsl
        grep -q '^decode    DIFFERS: record 0: z hi: ' out || bad "explain of a finding compares nothing"
    fi
fi

# Each part of a report gets the layout and its shader, in the order in which they belong together.
if plays report; then
    expect 0 . report sphere:n=4 --quick --count 100 --parts check,bench,pictures --engine cpu,vulkan \
        --layout f32,./mine.so --shader mine.glsl --out r.html --json r.json
    for part in 'check ' 'bench error '; do
        grep -q "\"raydiff $part.* --layout f32,./mine.so --shader mine.glsl " r.json || bad "report: $part: $(grep "$part" r.json)"
    done
    expect 0 . report sphere:n=4 --quick --parts pictures --engine vulkan --shader mine.glsl --layout ./mine.so --out r.html --json r.json
    grep -q 'raydiff render sphere:n=4 --engine vulkan .* --layout ./mine.so --shader mine.glsl ' r.json ||
        bad "report: pictures: $(grep render r.json)"
    grep -q 'raydiff render sphere:n=4 --show boxes --layout ./mine.so -w' r.json || bad "report: no looks"
    expect 2 "needs a --layout FILE.so" report sphere:n=4 --parts check --shader mine.glsl --out r.html
    expect 2 "needs a --layout FILE.so" check sphere:n=4 --layout ./mine.so --shader mine.glsl --shader other.glsl
fi

[ "$failed" -eq 0 ] && echo "plugin_findings: each is brought its layout"
[ "$failed" -eq 0 ]
