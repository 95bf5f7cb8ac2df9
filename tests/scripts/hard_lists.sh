#!/bin/sh
# The hard cases are played on what --layout, --builder, --box and --tri name, one from outside too, and
# on nothing else; options that they do not use are refused.
#   sh tests/scripts/hard_lists.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
hard='hard.0[1-9]-*'

# A layout that lies about its boxes passes nothing.
cc -std=c17 -O2 -ffp-contract=off -shared -fPIC -I. -DLIE=1 -o "$dir/liar.so" tests/peers/plugin_liar.c || bad "the liar is compiled"
expect 1 . conform "$hard" --engine cpu --layout "$dir/liar.so"
grep -q '^0 passed' "$dir/out" || bad "conform: hard cases pass on a layout that lies"
cc -std=c17 -O2 -ffp-contract=off -shared -fPIC -I. -o "$dir/mine.so" fuzz/samples/layout/mine.c || bad "mine is compiled"
expect 0 . conform "$hard" --engine cpu --layout "$dir/mine.so"
grep -q '^0 passed' "$dir/out" && bad "conform: no hard case is played on a layout from outside"

# Each list is all that is played.
only() { # field, value, option
    expect 0 . conform "$hard" --list --engine cpu "$3" "$2"
    [ -s "$dir/out" ] || bad "conform $3 $2: nothing is played"
    sed 's/^hard\.[0-9]*-[a-z0-9-]*\.//' "$dir/out" | cut -d . -f "$1" | grep -qvxF "$2" &&
        bad "conform $3 $2: others are played"
}
only 3 tiny8 --layout
only 4 sah_binned --builder
only 5 watertight --box
only 6 baldwin_webber --tri
# Without a pattern, too: a test that is not of the core is played if it is named, and not else.
expect 0 . conform --hard --list --engine cpu --layout f32 --tri baldwin_webber
[ "$(sed "s,.*[.],," "$dir/out" | sort -u)" = baldwin_webber ] || bad "conform --hard --tri baldwin_webber: others are played, or nothing"
expect 0 . conform --hard --list --engine cpu --layout f32
sed "s,.*[.],," "$dir/out" | grep -qxF baldwin_webber && bad "conform --hard: a test that is not of the core is played"
# A waiver of which a part was played, and did not fail, may be needed by what was not.
expect 0 ' 0 failed' conform --hard '*13-*' --engine cpu --layout f32 --builder rtrs --box robust --tri mt
expect 2 'no hard case matches' conform 'hard.nothing' --engine cpu --layout tiny8

# All layouts at once: a matrix of so many columns is written.
expect 0 . conform 'hard.03-*' --engine cpu --layout every --builder median --tri every --quick --markdown "$dir/wide.md"
[ "$(grep '^| 03 ' "$dir/wide.md" | tr -cd '|' | wc -c)" -gt 64 ] || bad "conform --markdown: not every layout has its columns"

# By default every layout is played but the one outside the product that is as published, and every
# builder; --list says so.
names() { "$raydiff" list "$1" | sed -n 's/^  \([a-z][a-z0-9_]*\) .*/\1/p' | sort; }
expect 0 . conform --hard --list --engine cpu
for table in layouts:5 builders:6; do
    cut -d . -f "${table#*:}" "$dir/out" | sort -u >"$dir/met"
    names "${table%:*}" >"$dir/all"
    comm -13 "$dir/met" "$dir/all"
done >"$dir/missed"
[ "$(paste -sd, "$dir/missed")" = amd64_g0,gfx12_mesa ] || bad "conform --hard: not played by default: $(tr '\n' ' ' <"$dir/missed")"
of_layouts=$(names layouts | wc -l) of_builders=$(names builders | wc -l)
grep -qx "$(wc -l <"$dir/out") trials of [0-9]* hard cases: $((of_layouts - 2)) of $of_layouts layouts, $of_builders of $of_builders builders" "$dir/err" ||
    bad "conform --hard --list does not say how much of the tables is played"

# Vertices that are not finite end no builder.
expect 0 . conform 'hard.44-*' --engine cpu --layout f32 --builder all --box robust --tri mt

# A defect that ends the traversal of a ray is expected where its driver has it, as one that makes an answer WRONG is.
"$raydiff" conform hard.53-long-loop.closest.vulkan.f32.median.rtrs.mt >"$dir/out" 2>"$dir/err"
case $? in
0) grep -q '^1 passed, 0 failed, 0 skipped$' "$dir/out" || bad 'conform: a loop that ends early is not a defect that is known' ;;
77) tail -n 1 "$dir/err" ;;
*) bad "conform: a loop that ends early fails: $(head -n 1 "$dir/out")" ;;
esac

# --quick leaves out no trial of which a defect is known to show.
lists='--engine cpu --layout f32,rtrs_rf,rtrs_direct --builder median --tri mt,mt_rtrs'
expect 0 . conform 'hard.63-*' $lists --verbose
sed -n 's/^KNOWN  *\(hard[^:]*\):.*/\1/p' "$dir/out" | sort >"$dir/known"
[ "$(wc -l <"$dir/known")" -ge 2 ] || bad 'no trial of hard case 63 shows a known defect'
expect 0 . conform 'hard.63-*' $lists --quick --list
sort "$dir/out" | comm -13 - "$dir/known" | grep . && bad 'conform --quick: what shows a defect is left out'

# Verdicts are counted of the answers that are judged, and of those of trials that are excused none.
expect 0 ' rays more in trials that are waived' conform 'hard.0[0-9]-*' $lists --box robust
awk '/^[0-9]+ rays judged: / { for (i = 5; i <= NF; i += 2) sum += $i; exit !(sum > 0 && sum == $1) }' "$dir/out" ||
    bad "conform: not the verdicts of what is judged: $(grep ' rays judged: ' "$dir/out")"

# What an engine does not finish is a trial that fails, and a part of those that it was to answer.
sed 's/        struct ray \*ray = take/        if (q.rays > 0) return 0;\n&/' fuzz/samples/sample_tracer.c >"$dir/ends.c"
cc -O1 -o "$dir/ends" "$dir/ends.c" || bad 'ends.c is not compiled'
expect 3 . conform 'hard.0[1-4]-*' --engine "pipe:$dir/ends"
fails=$(grep -c '^FAILED  hard' "$dir/out")
sed -n "s|^engine pipe:$dir/ends answered \([0-9]*\) of \([0-9]*\), failed \([0-9]*\): .*|\1 \2 \3|p" "$dir/out" >"$dir/told"
awk -v fails="$fails" '{ told = $2 - $1 == $3 && $3 == fails } END { exit !(told && fails > 4) }' "$dir/told" ||
    bad "conform: of $fails trials that are not finished it is told '$(cat "$dir/told")'"

for option in '--count 5' '--brute 7' --all '--store compact'; do
    expect 2 "^raydiff conform: ${option%% *}: not used by the hard cases" conform --hard $option
done
expect 2 '^raydiff conform: --all: ' conform 'closest.cpu.*' --all

echo "hard_lists: $failed failed"
[ "$failed" -eq 0 ]
