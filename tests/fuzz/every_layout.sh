#!/bin/sh
# The campaign of make check: every layout that claims to be right, by turns as many as a campaign can have, on
# the same trials. None is left out, each answers what it does not refuse, and nothing is found.
#   sh tests/fuzz/every_layout.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh
trials=96 turn=26 # 32 contestants at most
faithful='^(rtrs_direct|rtrs_rf|rtrs_rf_paper|amd64_g0|gfx12_mesa)$'

expect 0 . list layouts
awk 'NR > 1 { print $1 }' "$dir/out" | grep -vE "$faithful" >"$dir/names"
count=$(wc -l <"$dir/names")
[ "$count" -eq "$(($(awk 'END { print NR - 1 }' "$dir/out") - 5))" ] && [ "$count" -ge 52 ] || bad "$count layouts"

# Of every contestant: name, answered, refused for its layout, with a right hit, and refused otherwise.
contestants() {
    awk -f tests/values/flat.awk "$dir/json" | awk -F '[.=]' '$1 == "contestants" {
        value = $0
        sub(/^[^=]*=/, "", value)
        at[$2, $3] = value
        if ($2 == "count") count = value + 0
    }
    END {
        for (i = 0; i < count; i++)
            print at[i, "name"], at[i, "answered"], at[i, "refused_in_this_run"], at[i, "with_a_right_hit"], at[i, "refused"]
    }'
}
for first in $(seq 1 $turn "$count"); do
    layouts=$(sed -n "$first,$((first + turn - 1))p" "$dir/names" | paste -sd, -)
    expect 0 . fuzz --engine cpu --layout "$layouts" --rays 40 --trials $trials --jobs 2 --corpus none \
        --dir "$dir/$first" --json "$dir/json"
    contestants >>"$dir/met"
done
sed 's/^/cpu./' "$dir/names" | sort >"$dir/want"
sort "$dir/met" | awk '{ print $1 }' | diff "$dir/want" - >"$dir/out" 2>"$dir/err" || bad "a layout was not played, or twice"
# Half floats hold no bound beyond 65504, which some trials have; single ones and frames hold every trial.
# What a trial's rays hit does not depend on the layout; some trials have no hit.
awk -v trials=$trials '
    { small = $1 ~ /\.rf16|half4|_f16_world$|amd64_(f16|g1)$/ }
    $3 == 0 { right[$4] = $2 }
    $2 + $3 != trials || $5 != 0 || $4 + 8 < $2 || $4 > $2 || ($3 > 0) != small || $3 > trials / 8 { print; bad = 1 }
    END {
        for (hits in right) {
            kinds++
            bad = bad || hits + 0 >= right[hits]
        }
        exit bad || NR < 52 || kinds != 1
    }' "$dir/met" >"$dir/out" 2>"$dir/err" || bad "what a layout answered and refused"
echo "every_layout: $failed failed"
[ "$failed" -eq 0 ]
