#!/bin/sh
# Trees as files, as a user meets them: written by precompute for every builder and layout, and
# taken by --bvh in place of a builder's tree, with the same answers; refused with one line.
#   sh tests/scripts/tree_files.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh

small="--count 400 --repeat 1 --engine cpu"
scene=soup:n=60,seed=7

# Every builder's tree, read back, gives what the builder's own tree does: the same rows to the
# number, but for times, the tree's name and the command lines that have it.
rows() {
    grep -vE '"(median|min|max|builder|bvh|leaf|explain|exit)":' "$1" >"$1.rows"
}
for builder in median rtrs; do
    expect 0 . precompute --scene $scene --builder $builder --item-count 4 --out "$dir/$builder.json"
    "$raydiff" check $scene $small --builder $builder --layout all --json "$dir/built" \
        >/dev/null 2>&1
    "$raydiff" check $scene $small --bvh "$dir/$builder.json" --layout all --json "$dir/read" \
        >/dev/null 2>"$dir/err"
    rows "$dir/built"
    rows "$dir/read"
    [ "$(grep -c '"layout":' "$dir/read.rows")" -eq "$(grep -c '"layout":' "$dir/built.rows")" ] ||
        bad "check --bvh of $builder has other rows"
    # What RTRS's builder makes is only counted, where what a file holds is judged.
    if [ $builder = median ] && ! cmp -s "$dir/built.rows" "$dir/read.rows"; then
        diff "$dir/built.rows" "$dir/read.rows" | head -n 6 >"$dir/out"
        bad "check --bvh of $builder answers otherwise"
    fi
done
# RTRS's tree of its own scene, cut boxes and all: taken, said, and judged.
expect 0 . precompute --scene rtrs --item-count 2 --out "$dir/seed.json"
expect 1 . check --wide rtrs --engine cpu --count 2000 --repeat 1 --bvh "$dir/seed.json"
grep -q 'warning: .*seed.json: 2 of 51 boxes are too small for their triangles' "$dir/err" ||
    bad "RTRS's cut boxes are not warned of"
for layout in $("$raydiff" list layouts | awk '/^  /{print $1}'); do
    for builder in median rtrs; do
        expect 0 . precompute --scene $scene --builder $builder --layout "$layout" --out "$dir/packed"
        "$raydiff" check --wide $scene $small --bvh "$dir/packed" >"$dir/out" 2>"$dir/err"
        got=$?
        [ $got -le 1 ] || bad "check --bvh, $layout of $builder: exit $got"
        grep -q "^$layout .*cpu" "$dir/out" || bad "check --bvh does not play $layout alone"
        [ "$(grep -c '^[a-z].* cpu  ' "$dir/out")" -eq 1 ] || bad "check --bvh, $layout: one row"
    done
done
expect 0 . precompute --scene $scene --builder median --layout rf16 --out "$dir/tree.rdpk"

# A box that is too small loses hits: said, found, and explained from the file.
cut_box() { # of the first leaf, so that the whole tree stays well formed
    awk '{
        at = match($0, /"item_count":[1-9][0-9]*,"bounds":\{"min":\[[^]]*\],"max":\[[^]]*\]/)
        leaf = substr($0, at, RLENGTH)
        min = leaf
        sub(/.*"min":\[/, "", min)
        sub(/\].*/, "", min)
        sub(/"max":\[[^]]*\]/, "\"max\":[" min "]", leaf)
        printf "%s%s%s", substr($0, 1, at - 1), leaf, substr($0, at + RLENGTH)
    }' "$1"
}
cut_box "$dir/median.json" >"$dir/cut.json"
expect 1 . check $scene --count 4000 --repeat 1 --engine cpu --layout f32 --bvh "$dir/cut.json"
grep -q 'cut.json: 1 of .* boxes are too small' "$dir/err" || bad "check warns of one box"
command=$(sed -n 's/^  explain: raydiff //p' "$dir/out" | head -n 1)
eval "\"\$raydiff\" $command" >"$dir/out" 2>"$dir/err"
[ $? -eq 1 ] && grep -q '^cause     cut_box' "$dir/out" || bad "raydiff $command: no cut box"
# The same from a packed file, in the layout that it is in.
"$raydiff" explain --wide $scene --bvh "$dir/tree.rdpk" --rays random --index 3 >"$dir/packed.out" 2>&1
"$raydiff" explain --wide $scene --builder median --layout rf16 --rays random --index 3 >"$dir/built.out" 2>&1
for page in packed built; do
    grep -vE '^(engine|again)' "$dir/$page.out" >"$dir/$page.page"
done
[ -s "$dir/packed.page" ] && grep -q 'layout rf16, tree' "$dir/packed.out" ||
    bad "explain --bvh of a packed tree"
cmp -s "$dir/packed.page" "$dir/built.page" || {
    diff "$dir/packed.page" "$dir/built.page" >"$dir/out"
    bad "explain --bvh of a packed tree says otherwise"
}
expect 0 . precompute --scene platonic --builder median --out "$dir/platonic.json"
expect 0 . leaks platonic --engine cpu --tri woop --box watertight --count 1000 \
    --bvh "$dir/platonic.json"
cut_box "$dir/platonic.json" >"$dir/platonic_cut.json"
expect 1 . leaks platonic --engine cpu --tri woop --box watertight --count 1000 \
    --bvh "$dir/platonic_cut.json"
expect 0 . precompute --scene platonic --builder median --layout f32 --out "$dir/platonic.rdpk"
expect 0 . leaks platonic --engine cpu --tri woop --box watertight --count 1000 \
    --bvh "$dir/platonic.rdpk"
expect 0 . explain $scene --bvh "$dir/median.json" --rays random --count 50
grep -q 'builder' "$dir/out" && bad "explain --bvh names a builder"
expect 0 . bench layouts --wide --scene $scene --bvh "$dir/median.json" --count 2000 --rounds 1
grep -q "tree $dir/median.json" "$dir/out" || bad "bench layouts names its tree"
expect 0 . bench error --wide --engine cpu --tri mt --scene $scene --bvh "$dir/median.json" --count 200 \
    --rounds 1

# Trees that are none of this scene's, or none at all: one line each.
expect 2 'median.json: is the tree of another scene: [0-9]+ of 60' \
    check soup:n=60,seed=8 $small --bvh "$dir/median.json"
expect 2 'tree.rdpk: is the tree of another scene' check soup:n=60,seed=8 $small \
    --bvh "$dir/tree.rdpk"
# Pictures, too; sanitizers see what a command leaves behind.
expect 0 . render $scene --bvh "$dir/median.json" -w 8 -h 6 --out "$dir/tree.png"
expect 0 . diff $scene --bvh "$dir/median.json" --engine cpu,brute -w 8 -h 6
expect 2 'holds 60 triangles, the scene has 61' check soup:n=61 $small --bvh "$dir/median.json"
expect 2 'is of 60 triangles, the scene has 4' leaks platonic:which=0 --bvh "$dir/tree.rdpk"
expect 2 'the scene has 61' explain soup:n=61 --bvh "$dir/median.json"
sed 's/"snd":[1-9][0-9]*/"snd":0/' "$dir/median.json" >"$dir/cycle.json"
expect 2 'tree node 0: second child is 0' check $scene $small --bvh "$dir/cycle.json"
sed 's/\("indices":\[[0-9]*\),[0-9]*/\1,60/' "$dir/median.json" >"$dir/range.json"
expect 2 'triangle 60, but the scene has 60' check $scene $small --bvh "$dir/range.json"
sed 's/"indices":\[\([0-9]*\),[0-9]*/"indices":[\1,\1/' "$dir/median.json" >"$dir/twice.json"
expect 2 'is there twice' check $scene $small --bvh "$dir/twice.json"
head -c 300 "$dir/median.json" >"$dir/short.json"
expect 2 'short.json: line 1' check $scene $small --bvh "$dir/short.json"
: >"$dir/empty"
expect 2 'empty: is empty' check $scene $small --bvh "$dir/empty"
expect 2 'nothing: No such file' check $scene $small --bvh "$dir/nothing"
expect 2 'is a directory' check $scene $small --bvh "$dir"
expect 2 'is packed as rf16; only JSON can be packed as f32' check $scene $small --layout f32 \
    --bvh "$dir/tree.rdpk"
expect 0 . precompute --scene $scene --builder median --layout rtrs_rf --out "$dir/seed.rdpk"
expect 2 . explain $scene --bvh "$dir/seed.rdpk" # after a warning
grep -q 'cannot be decoded to a tree for JSON: ' "$dir/err" || bad "RTRS's triangles decode"
expect 2 'is packed as rf16; only JSON' explain $scene --bvh "$dir/tree.rdpk" --layout f32
expect 2 'on a tree as JSON' bench layouts --scene $scene --bvh "$dir/tree.rdpk"
expect 2 'goes without --builder' check $scene --bvh "$dir/median.json" --builder median
expect 2 'goes without --leaf' leaks $scene --bvh "$dir/median.json" --leaf 2
expect 2 'goes without --eps' explain $scene --bvh "$dir/median.json" --eps 1
expect 2 'to one scene, not to 2' check $scene soup --bvh "$dir/median.json"
expect 2 'engine brute takes no tree' explain $scene --bvh "$dir/median.json" --engine brute
expect 2 "a trial's name says" explain closest.cpu.rf16.median.robust.mt.soup.random.1 \
    --bvh "$dir/median.json"
expect 2 'name it with --scene' bench layouts --bvh "$dir/median.json"
expect 2 'not used by benchmark oracle' bench oracle --scene $scene --bvh "$dir/median.json"

# Damage that a reader survives is counted: a leaf that leaves two triangles out, one that names the first of the next
# leaf, too, and a leaf whose box is empty. Of its records of 8 words the fourth is the first item or child, the last
# the number of items.
expect 0 . precompute --scene $scene --builder median --layout f32 --out "$dir/f32.rdpk"
expect 0 . precompute --scene $scene --verify "$dir/f32.rdpk"
records=$(od -An -tu4 -j28 -N4 "$dir/f32.rdpk" | tr -d ' ')
grep -q ": layout f32, $records records, 0 boxes too small, 0 triangles in no leaf, 0 in several\$" "$dir/out" ||
    bad "precompute --verify: a sound tree has faults"
damaged() { # perl on @word; @leaf has where leaves begin there, in the order of their items
    perl -e 'local $/; binmode STDIN; binmode STDOUT; my @word = unpack "V*", <STDIN>;
        my @leaf = sort { $word[$a + 3] <=> $word[$b + 3] } grep { $word[$_ + 7] } map { 12 + 8 * $_ } 0 .. $word[7] - 1;
        '"$1"'; print pack "V*", @word' <"$dir/f32.rdpk" >"$dir/damaged.rdpk"
    verify_tells "$scene" "$dir/damaged.rdpk"
}
# What is wrong with a tree is told in one line that names its file.
verify_tells() { # scene, file
    expect 1 . precompute --scene "$1" --verify "$2"
    one_line && grep -qF "raydiff precompute: $2: " "$dir/err" || bad "precompute --verify $2: not one line of what is wrong in it"
}
for layout in '' '--layout f32'; do
    # shellcheck disable=SC2086 # words of a command
    expect 0 . precompute --scene soup:n=20 --builder median $layout --out "$dir/other.tree"
    verify_tells soup:n=20,seed=2 "$dir/other.tree"
done
damaged '$word[$leaf[2] + 7] -= 2'
grep -q ', 0 boxes too small, 2 triangles in no leaf, 0 in several$' "$dir/out" || bad "precompute --verify: 2 left out"
damaged '$word[$leaf[2] + 7] -= 2; $word[$leaf[7] + 7]++'
grep -qE ', [0-9]+ boxe?s? too small, 2 triangles in no leaf, 1 in several$' "$dir/out" ||
    bad "precompute --verify: 2 left out and 1 twice"
damaged '$word[$leaf[4] + $_] = 0x42C80000 for 0 .. 2'
grep -q ', 1 box too small, 0 triangles in no leaf, 0 in several$' "$dir/out" || bad "precompute --verify: 1 small box"

# precompute itself.
expect 2 'no file, and no generator' precompute --scene nowhere --out "$dir/x"
expect 2 'nothing.obj: No such file' precompute --scene "$dir/nothing.obj" --out "$dir/x"
expect 2 'is a directory' precompute --scene soup --out "$dir"
mkdir "$dir/locked" && chmod a-w "$dir/locked"
if [ -w "$dir/locked" ]; then
    echo "SKIP a folder that cannot be written: this user can write everywhere"
else
    expect 2 'locked' precompute --scene soup --out "$dir/locked/x"
    [ -z "$(ls "$dir/locked")" ] || bad "precompute leaves something in a locked folder"
fi
[ ! -e "$dir/x" ] || bad "a refused precompute writes nothing"

echo "tree_files: $failed failed"
[ "$failed" -eq 0 ]
