#!/bin/sh
# raydiff diff on a scene: what is counted, what is allowed, what is explained, and that a tracer
# with a bug is caught with a command that shows it again.
#   sh tests/scripts/diff.sh BUILD
set -u
build=$1
raydiff=$build/raydiff
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh
small="-w 48 -h 36"

says() {
    grep -qE -- "$1" "$dir/out" || bad "no line like /$1/"
}

# Bad input: one line each, before anything is drawn.
expect 2 "two engines are compared" diff rtrs --engine cpu $small
expect 2 "unknown name 'gpu'" diff rtrs --engine cpu,gpu $small
expect 2 "'5' is not X,Y" diff rtrs --pixel 5 $small
expect 2 "48,3 is not in a picture of 48 x 36" diff rtrs --pixel 48,3 $small
expect 2 "'-1' is not a whole number" diff rtrs --pixel -1,3 $small
expect 2 "--out: not used by --pixel" diff rtrs --pixel 1,3 --out "$dir/heat.png" $small
expect 2 "no-such-folder" diff rtrs --engine cpu,embree --out "$dir/no-such-folder/heat.png" $small
expect 2 "no-such-folder" diff rtrs --engine cpu,embree --json "$dir/no-such-folder/x.json" $small
expect 2 "--handler naive tests every triangle" diff rtrs --engine cpu,embree --handler naive $small
for engines in cpu,brute brute,cpu; do
    expect 2 "brute is selected by two names" diff rtrs --engine $engines --handler naive $small
done
expect 2 "paths take [0-9]+ MB for each engine, at most 2048" diff rtrs --engine cpu,embree -w 16384 -h 16384
expect 2 "one, the same for all engines" diff rtrs --engine cpu,embree --layout f32,rf16 $small
expect 2 "nothing.obj" diff "$dir/nothing.obj" $small
[ ! -e "$dir/heat.png" ] || bad "a heat map was written in spite of an error"

# Engines of other bits: every path that differs is explained, and every class is counted.
for profile in repaired rtrs; do
    expect 0 . diff rtrs --profile $profile --engine cpu,brute,embree,embree_robust $small \
        --json "$dir/$profile.json"
    [ $profile = rtrs ] || says '^  paths       0 of 1728 differ$'
    says '^  explained   ([1-9][0-9]*) of \1 pixels: same path [0-9]+, rounding [1-9]'
    says '^  faults      wrong answer 0, picture not of its rays 0, unexplained 0; err/E at most 0\.[0-9]+$'
    grep -q '"reference": "cpu"' "$dir/$profile.json" || bad "--json names the reference"
done
for key in same_bits_demanded paths_different segments triangle t asked shadowed values_different \
    largest at_a_border beyond_the_bound to_explain drift published renderer wrong unexplained tie \
    near_tie boundary border in_plane slab noise out_of_contract err_over_bound borders; do
    grep -q "\"$key\": " "$dir/repaired.json" || bad "--json has no $key"
done
# The published tree loses hits in the column of rays with direction 0 along x; they are told of.
expect 0 . diff rtrs --profile rtrs --engine cpu,embree -w 96 -h 72
says 'wrong as published [1-9]'
again=$(sed -n 's/^    explain: raydiff //p' "$dir/out" | head -n 1)
eval "expect 1 . $again"

# A tracer with a bug: exit code 1, and a command that shows the ray again.
ball="sphere:n=6 --camera-light-strength 1"
expect 0 . diff $ball --engine "cpu,pipe:$build/samples/tracer" $small
for bug in 1 2; do
    expect 1 . diff $ball --engine "cpu,pipe:$build/samples/tracer_bug$bug" $small --out "$dir/heat.png"
    says '^  faults      wrong answer [1-9]'
    says '^  DIFFERS$'
    head -c 4 "$dir/heat.png" | grep -q PNG || bad "--out writes a PNG"
    tail -n 1 "$dir/out" | grep -q '^conclusion: ' || bad "diff --out: the conclusion is not the last line"
    again=$(sed -n 's/^    explain: raydiff //p' "$dir/out" | head -n 1)
    look=$(sed -n 's/^  look: raydiff //p' "$dir/out")
    eval "expect 1 . $again"
    says 'WRONG'
    eval "expect 1 . $look --json $dir/pixel.json"
    says '^    FIRST     bit that differs from cpu: triangle, bit [0-9]+: 0x[0-9a-f]{8} there, 0x[0-9a-f]{8} here$'
    says ': WRONG, '
    grep -q '"first_bit": {' "$dir/pixel.json" || bad "--pixel --json names the first bit"
done

# One path on several engines.
expect 0 . diff rtrs --engine cpu,brute,embree --pixel 22,17 $small --json -
python=$(sed -n '1p' "$dir/out")
[ "$python" = '{' ] || bad "--json - prints more than JSON"
expect 0 . diff rtrs --engine cpu,brute --pixel 22,17 $small
says '^  brute: to the bit as cpu, triangle [0-9]+ at t 0x1'
says '^    light 0   (at distance|not traced)'
says '^brute: [0-9]+ segments, value [0-9]+ [0-9]+ [0-9]+, to the bit as cpu$'
expect 0 . diff rtrs --engine cpu --pixel 0,0 $small
says '^    hit       a miss$'

# The commands of a path ask what its rays asked: the nearest hit; of shadow rays of profile repaired any. JSON has each.
for profile in repaired rtrs; do
    [ $profile = repaired ] && asked=any || asked=closest
    : >"$dir/asked"
    for pixel in 22,17 20,20 26,16 24,22 5,30; do
        expect 0 . diff rtrs --profile $profile --engine cpu,embree --pixel $pixel $small --json "$dir/pixel.json"
        awk '/^    light /{of = "light"} /^    hit /{of = "hit"} /^    explain /{match($0, /--query [a-z]*/)
            print of, substr($0, RSTART + 8, RLENGTH - 8)}' "$dir/out" >>"$dir/asked"
        sed -n 's/^    explain   //p' "$dir/out" >"$dir/commands"
        while read -r command; do
            grep -qF -- "$command" "$dir/pixel.json" || bad "diff --pixel: not in JSON: $command"
        done <"$dir/commands"
    done
    [ "$(grep -c '^light ' "$dir/asked")" -gt 3 ] || bad "diff --pixel: no shadow rays"
    [ "$(sort -u "$dir/asked" | tr '\n' ';')" = "hit closest;light $asked;" ] ||
        bad "diff --pixel: $profile: commands ask: $(sort -u "$dir/asked" | tr '\n' ';')"
done

# The same bits from a driver that promises them.
"$raydiff" diff rtrs --engine cpu,vulkan $small >"$dir/out" 2>"$dir/err"
case $? in
77) echo "SKIP vulkan: $(tail -n 1 "$dir/err")" ;;
*)
    expect 0 . diff rtrs --engine cpu,vulkan --profile rtrs $small
    expect 0 . diff rtrs --engine cpu,vulkan --handler bvh-rf $small
    if grep -q 'the same bits are demanded' "$dir/out"; then
        says '^  paths       0 of 1728 differ$'
        says 'different in triangle 0, t 0, lights asked 0, shadows 0$'
    fi
    ;;
esac
# Mesa keeps 128 bytes of a driver that was unloaded unused, see tests/scripts/cli.sh.
export ASAN_OPTIONS=detect_leaks=0
expect 77 . diff rtrs --engine cpu,vulkan --driver no-such-driver $small
expect 77 . diff rtrs --engine cpu,vulkan --driver no-such-driver $small --pixel 1,1
expect 0 . diff rtrs --driver no-such-driver $small
says '^left out: vulkan: '

echo "diff: $failed failed"
[ "$failed" -eq 0 ]
