#!/bin/sh
# raydiff tree as a user meets it: its exit codes, its text and its JSON, which say the same, and both what the file
# has; whose scene counts; a tree that a C program writes.
#   sh tests/trees/tree.sh PROGRAM
set -u
raydiff=$(realpath "$1")
. tests/scripts/expect.sh

v() { sed -n "s/^$1=//p" "$dir/flat"; }
# What the JSON of the last run says the text says, too, and each of its fields is in the table of fields.
told() { # exit code, FILE and options
    code=$1
    shift
    expect "$code" . tree "$@" --wide --json "$dir/j.json"
    awk -f tests/values/flat.awk "$dir/j.json" >"$dir/flat"
    sh tests/values/fields.sh tree "$dir/flat" "$dir/seen" || bad 'JSON: fields'
    [ "$(v exit)" = "$code" ] || bad 'JSON: exit'
    number() { case $(v "$1") in null) echo - ;; *) printf '%.6g' "$(v "$1")" ;; esac; }
    {
        echo "$(v file): a tree of format $(v format), "
        [ "$(v scene)" = null ] || echo "of $(v scene)"
        [ "$(v with_triangles)" = true ] || echo 'without a scene'
        echo " $(v nodes), the root leads to $(v reached): $(v inner) inner with up to $(v width) children, $(v leaves) lea"
        echo " ($(v empty_leaves) empty)"
        echo " $(v triangles) triangle"
        echo ", at most $(v largest_leaf) in one"
        [ "$(v splits)" = false ] || echo 'they may be split'
        echo " depth $(v depth), so a stack of at most $(v stack)"
        [ "$(v bytes)" = null ] || echo " bytes $(v bytes) of nodes"
        echo " SAH $(number sah), with exact boxes $(number sah_tight); overlap $(number overlap)"
        [ "$(v gap)" = null ] || echo "would do grown by $(v gap) float"
        [ "$(v splits)" = true ] || echo " of $(v boxes_judged) judged: $(v boxes_small) too small, $(v boxes_loose) larger"
        [ "$code" -eq 0 ] && echo SOUND || echo "FAULTY: $(v faults) fault"
        sed -n 's/^counts\.\([a-z]*\)=\([1-9][0-9]*\)$/\1 \2/p' "$dir/flat"
        sed -n 's/^named\.[0-9]*\.rule=//p' "$dir/flat" >"$dir/rules"
        sed -n 's/^named\.[0-9]*\.text=//p' "$dir/flat" | paste -d: "$dir/rules" - | sed 's/^\([a-z]*\):/FAULT \1: /'
    } >"$dir/lines"
    tr -s ' \n' ' ' <"$dir/out" >"$dir/line"
    while IFS= read -r text; do grep -qF -- "$text" "$dir/line" || echo "$text"; done <"$dir/lines" >"$dir/untold"
    [ ! -s "$dir/untold" ] || bad "JSON, but not in the text: $(head -n 1 "$dir/untold")"
}

input=tests/golden/input
told 0 $input/mine.tree
# Areas 2 (1 + 0.5 + 0.5), 2 and 4: the root's 1, and both leaves'.
[ "$(v sah)" = 2.5 ] && [ "$(v bytes)" = 96 ] && [ "$(v nodes)" = 3 ] && [ "$(v scene)" = null ] || bad 'numbers by hand'
told 1 $input/faulty.tree
[ "$(v scene)" = soup:n=4 ] && [ "$(v counts.nan)" = 1 ] && [ "$(v counts.cycle)" = 1 ] && [ "$(v counts.child)" = 1 ] &&
    [ "$(v counts.unreached)" = 1 ] && [ "$(v counts.triangle)" = 1 ] && [ "$(v counts.doubled)" = 1 ] &&
    [ "$(v counts.missing)" = 1 ] || bad 'faults by hand'
told 1 $input/faulty.tree --faults 1
[ "$(sed -n 's/^named.count=//p' "$dir/flat")" -eq 8 ] || bad 'one fault of each rule'
told 1 $input/faulty.tree --faults 0
[ "$(v faults)" -gt 8 ] && [ "$(sed -n 's/^named.count=//p' "$dir/flat")" -eq 0 ] || bad 'no fault is named'
sed '/^scene/d; s/nan/-9/; s/ 0 9$//; s/ 7$//; /^leaf -9.*9$/d' $input/faulty.tree >"$dir/none.tree"
told 1 "$dir/none.tree"
[ "$(v with_triangles)" = false ] && [ "$(v overlap)" = null ] || bad 'without a scene'
sed 's/^bytes.*/splits/' $input/mine.tree >"$dir/splits.tree"
told 0 "$dir/splits.tree"
sed 's/^leaf 0 0 0 1 1 0.5 1/leaf 0.5 0 0 1 1 0.5 1/' "$dir/splits.tree" >"$dir/cut.tree"
told 1 "$dir/cut.tree"
has 'a gap that no float closes' 'they would do grown by no 65536 floats$'
has 'a part that no leaf has' '^FAULT uncovered: node 0: .* triangle 1$'
sed 's/^leaf 0 0 0 1 1 0.5 1/leaf 0 0 0 1 0x1.fffff8p-1 0.5 1/' "$dir/splits.tree" >"$dir/cut.tree"
told 1 "$dir/cut.tree"
[ "$(v gap)" = 4 ] || bad 'a gap of four floats'
sed 's/^leaf 0 0 0 1 1 0.5 1/leaf 0 0 0x1p-149 1 1 0.5 1/' $input/mine.tree >"$dir/small.tree"
told 1 "$dir/small.tree"
has 'one float too small' '^FAULT small: node 2: .*least z is 0x1p-149, and triangle 1 has 0x0p\+0: 1 step, 1\.4'
[ "$(v named.0.steps)" = 1 ] && [ "$(v named.0.bound)" = 0x1p-149 ] && [ "$(v named.0.side)" = 'least z' ] || bad 'JSON: a step'
# What a driver serialised: tests/driver_trees/driver_trees.sh has more.
sed 's/l1 -1 0 0 3 2 1/l1 -1 0 0 2.5 2 1/; s/1 0 0 0  0 1 0 0$/0.5 0 0 0  0 1 0 0/' tests/driver_trees/two.lvp.txt |
    perl tests/driver_trees/encode.pl >"$dir/two.as"
expect 1 . tree "$dir/two.as" soup:n=1 --json "$dir/j.json"
awk -f tests/values/flat.awk "$dir/j.json" >"$dir/flat"
sh tests/values/fields.sh tree "$dir/flat" "$dir/seen" || bad 'JSON: fields of a driver'
sh tests/values/fields.sh --unseen tree "$dir/seen" >"$dir/unseen" || bad "fields: $(head -n 1 "$dir/unseen")"
"$raydiff" tree $input/mine.tree --json - 2>"$dir/err" | perl -MJSON::PP -0ne 'exit(decode_json($_)->{exit} != 0)' || bad '--json -'

# The scene: of the command line, of the file beside it or a generator, or of the file itself.
mkdir -p "$dir/below"
"$raydiff" scene convert soup:n=4 "$dir/below/s.obj" 2>/dev/null
sed 's/soup:n=4/s.obj/; s/^leaf 0 0 0 0 0 0 1 2 7/leaf -9 -9 -9 9 9 9 2 3/; s/nan/-9/; s/ 3 0 9$//; /^node -9 -9 -9 9 9 9$/d; /9$/d' $input/faulty.tree >"$dir/below/b.tree"
told 0 "$dir/below/b.tree"
expect 0 . tree "$dir/below/b.tree" soup:n=4
expect 1 . tree "$dir/below/b.tree" soup:n=0
expect 1 . tree "$dir/below/b.tree" soup:n=5
sed 's/s.obj/..\/s.obj/' "$dir/below/b.tree" >"$dir/up.tree"
expect 2 'is no file in the folder of this one' tree "$dir/up.tree"
expect 2 'has triangles of its own, so soup is not used' tree $input/mine.tree soup
expect 2 'No such file' tree "$dir/below/b.tree" "$dir/none.obj"

cp $input/mine.tree "$dir/$(printf '\351').tree"
expect 2 'not UTF-8' tree "$dir/$(printf '\351').tree" --json "$dir/j.json"
# So does any command, before anything is played.
byte=$(printf '\351')
cannot_tell() { # option, words
    option=$1
    shift
    expect 2 "not UTF-8 cannot be written by --$option" "$@" --"$option" "$dir/j"
    [ ! -e "$dir/j" ] && [ ! -e "$dir/$byte" ] || bad "$1: written, with a name that is not UTF-8"
}
cannot_tell json check "$byte.obj"
cannot_tell jsonl fuzz --trials 1 --engine cpu --corpus none --dir "$dir/$byte"
cannot_tell junit conform "$byte*"
expect 0 'agree' check soup:n=9 --engine cpu --layout f32 --count 50 --json "$dir/$byte.json"
expect 2 'no file given' tree
expect 2 "unexpected argument 'c'" tree a b c
expect 2 'No such file' tree "$dir/nothing"
expect 2 'no tree of a known format' tree $input/tiny.obj
expect 2 "'rtx' is not raydiff, tinybvh, bvh2, lavapipe, radv or guessed" tree $input/mine.tree --format rtx
expect 2 'too few|tinybvh' tree $input/mine.tree --format tinybvh
expect 2 'are no file of bvh v2' tree $input/mine.tree --format bvh2
expect 0 . tree $input/mine.tree --format raydiff
head -n 9 $input/mine.tree >"$dir/cut.tree"
expect 2 'is cut short' tree "$dir/cut.tree"
expect 2 'cannot write' tree $input/mine.tree --json "$dir/no/such.json"
echo "tree: $failed failed"
exit $((failed > 0))
