#!/bin/sh
# raydiff conform --worlds: names of trials, pairs of members counted from them, what options do and which are refused.
#   sh tests/worlds/conform_worlds.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
one=world.closest.cpu.f32.median.robust.woop.mirrored.bits.flip.mixed.cells.cull-back.12.1
two=world.all.cpu.rf16/f32.lbvh/median.robust.mt.sheared.drawn.none.opaque.all.drawn.40.7
less=world.any.brute.-.-.-.mt.turned.idle.drawn.not-opaque.none.opaque.3.1

# A whole name is one trial, which prints itself.
for name in $one $two $less; do
    expect 0 . conform $name --verbose --count 100
    grep -q "^PASSED  $name: 100 rays, [1-9][0-9]* hits;" "$dir/out" || bad "conform $name: does not name itself"
    [ "$(tail -n 1 "$dir/out")" = "1 passed, 0 failed, 0 skipped" ] || bad "conform $name: the conclusion is not last"
    expect 0 . conform $name --list
    [ "$(cat "$dir/out")" = $name ] || bad "conform $name --list: another name"
done
expect 2 "trial: unknown masks 'bitz'; known are: all, bits, drawn, idle; did you mean bits" conform $(echo $one | sed 's/bits/bitz/')
expect 2 "trial: unknown layout 'f31'$" conform $(echo $one | sed s/f32/f31/)
expect 2 "trial: unknown layout 'f31'$" conform $(echo $two | sed s/rf16/f31/)
expect 2 "trial: unknown builder 'lb'$" conform $(echo $two | sed s/lbvh/lb/)
expect 2 "trial: unknown number of instances '13'; known are: 1, 3, 12, 40" conform $(echo $one | sed s/12/13/)
expect 2 "trial: engine brute takes '-', not 'f32'$" conform $(echo $one | sed s/cpu/brute/)
expect 2 "trial: seed 'x' is not a number$" conform ${one%.1}.x
expect 2 "is not world.query.engine" conform world.closest.cpu
expect 2 "no trial of worlds matches 'world.warp.\*'" conform 'world.warp.*'
expect 77 . conform $(echo $one | sed s/cpu/cpu_stackless/)
for option in --all --hard --quick --summary '--store compact' '--displacement 9' '--markdown m.md'; do
    expect 2 "^raydiff conform: ${option%% *}: not used by the trials of worlds" conform --worlds $option
done
expect 2 'watertight: not used by the trials of worlds' conform --worlds --require watertight
expect 2 'require vulkan: --engine leaves it out' conform --worlds --engine cpu --require vulkan

# A pattern takes those of the array whose names it matches.
expect 0 . conform --worlds --list
cp "$dir/out" "$dir/all"
expect 0 . conform 'world.*.cpu.*.mirrored.*' --list
grep '^world\.[a-z]*\.cpu\..*\.mirrored\.' "$dir/all" | cmp -s - "$dir/out" || bad "conform: a pattern takes other trials"
[ -s "$dir/out" ] || bad "conform: no mirrored world"

# Every two members that take part meet, in trials that run but for what is refused: the bounds of rf16 end at 65504.
expect 0 . conform --worlds --engine cpu,brute --count 60 --threads 1 --brute 0 --junit "$dir/xml"
pairs=$(awk -v prefix='world\\.' -v fields=13 -v what='pairs of worlds and members' -f tests/conform/pairs.awk "$dir/xml")': rf16 with far'
case $pairs in *" 2 of them only"*) ;; *) bad "conform --worlds: two pairs cannot meet, rf16 and rf16/f32 with far; not '$pairs'" ;; esac
grep -qx "$pairs" "$dir/out" || bad "not '$pairs', but '$(grep ' pairs of worlds' "$dir/out")'"
"$raydiff" conform --worlds --list --engine cpu >"$dir/of_cpu"
[ "$(cut -d . -f 4 "$dir/of_cpu" | sort -u | tr '\n' ' ')" = 'f32 f32/rf16 rf16 rf16/f32 ' ] || bad "conform --worlds: other layouts"
for field in 2:3 6:2 7:4 8:9 9:4 10:6 11:3 12:4 13:11 14:4; do
    [ "$(cut -d . -f ${field%:*} "$dir/of_cpu" | sort -u | wc -l)" -eq ${field#*:} ] || bad "conform --worlds: field $field of names"
done
awk -F . '
    { for (a = 2; a <= 14; a++) { seen[a, $a]; for (b = a + 1; b <= 14; b++) met[a, $a, b, $b] } }
    END {
        for (one in seen) { split(one, key, SUBSEP); n[key[1]]++ }
        for (a = 2; a <= 14; a++) for (b = a + 1; b <= 14; b++) all += n[a] * n[b]
        for (pair in met) found++
        exit all != found
    }' "$dir/of_cpu" || bad "conform --worlds: two members do not meet"

# Members that are named are all that is played, those as published too: each below itself, and below
# the one after it if there are several. Shaders have one layout for both levels.
cycle() { # names, with commas between
    echo "$1" | awk -F , '{ for (i = 1; i <= NF; i++) { print $i; if (NF > 1) print $(i % NF + 1) "/" $i } }' | LC_ALL=C sort
}
for named in f32 rf16,f32 f32,rf16,half4 rtrs_rf,f32,tiny8,half4; do
    expect 0 . conform --worlds --list --engine cpu --layout "$named" --builder median --box robust --tri mt
    cut -d . -f 4 "$dir/out" | LC_ALL=C sort -u >"$dir/names"
    cycle "$named" | cmp -s - "$dir/names" || bad "conform --worlds --layout $named: other layouts: $(tr '\n' ' ' <"$dir/names")"
    expect 0 . conform --worlds --list --engine vulkan --layout "$named" --builder median --box robust --tri mt
    cut -d . -f 4 "$dir/out" | LC_ALL=C sort -u >"$dir/names"
    echo "$named" | tr , '\n' | LC_ALL=C sort | cmp -s - "$dir/names" || bad "conform --worlds --layout $named: of shaders other layouts"
done
for named in lbvh rtrs,median median,sah_binned,lbvh; do
    expect 0 . conform --worlds --list --engine cpu --layout f32 --builder "$named" --box robust --tri mt
    cut -d . -f 5 "$dir/out" | LC_ALL=C sort -u >"$dir/names"
    cycle "$named" | cmp -s - "$dir/names" || bad "conform --worlds --builder $named: other builders: $(tr '\n' ' ' <"$dir/names")"
done

# What an option needs is looked for in the engines that are named, else in all, whatever else is named.
for named in '' '--engine cpu' '--engine cpu,brute'; do
    for option in '--layout f32' '--builder median' '--box robust'; do
        expect 0 . conform --worlds --list $named $option
    done
done
for option in '--layout f32' '--builder median' '--box robust'; do
    expect 2 "^raydiff conform: ${option% *}: not used here: it needs an engine that walks trees" \
        conform --worlds --list --engine brute $option
done

echo "conform_worlds: $failed failed"
[ "$failed" -eq 0 ]
