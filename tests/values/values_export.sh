#!/bin/sh
# What an exported trial says of the exact answer, against `raydiff explain` of the same ray: the triangle, whether others
# are hit at the same t, t as a fraction and in decimals, its class; and a miss. sh tests/values/values_export.sh RAYDIFF
set -u
raydiff=$1
. tests/values/compare.sh
seen=0

# trial, what its text must be like
told() {
    "$raydiff" export "$1" --engine vulkan --form text --to "$dir/exported" >"$dir/out" 2>"$dir/err"
    code=$?
    [ "$code" -eq 77 ] && grep -q 'vulkan: .*no device' "$dir/err" && { echo 'SKIP no Vulkan device'; exit 77; }
    [ "$code" -le 1 ] || { bad "export $1: exit $code: $(cat "$dir/err")"; return; }
    rm -f "$dir/json"
    "$raydiff" explain "$1" --index 0 --engine vulkan --json "$dir/json" >"$dir/out" 2>"$dir/err"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    sed -n '/^# Exactly /,/^# [A-Z][a-z]* *  /{ s/^# *//; p; }' "$dir/exported" | awk 'NR > 1 && /^(Answered|In C|Cause) / { exit } { printf "%s ", $0 }' |
        sed 's/  */ /g; s/ $/\n/' >"$dir/said"
    [ -s "$dir/flat" ] && [ "$(wc -l <"$dir/said")" -eq 1 ] || { bad "export $1: it does not say what is exactly right"; return; }
    awk -v form="$2" '
        FNR == NR { at = index($0, "="); v[substr($0, 1, at - 1)] = substr($0, at + 1); next }
        {
            if ($0 !~ form) { print "not like \"" form "\": " $0; exit 1 }
            if (v["truth.prim"] == "null") exit $0 != "Exactly ray 0 hits nothing."
            head = "Exactly ray 0 hits triangle " v["truth.prim"] (v["truth.ties"] > 1 ? " and others at the same t" : "") " first, at t "
            tail = " (" v["truth.class"] ")."
            t = substr($0, length(head) + 1, length($0) - length(head) - length(tail))
            if ($0 != head t tail) { print "said: " $0 "\nmeant: " head "..." tail; exit 1 }
            n = split(t, word, /[ ,]+/)
            if (split(word[2], part, "/") < 2) part[2] = 1
            if (word[1] != "=") { print "no t: " t; exit 1 }
            # Doubles of the fraction or number, and of what is printed beside it, are within the interval widened by their rounding.
            far = (v["truth.t_hi"] - v["truth.t_lo"]) + 1e-12 * v["truth.t_hi"]
            if (part[1] / part[2] < v["truth.t_lo"] - far || part[1] / part[2] > v["truth.t_hi"] + far) { print "t = " t; exit 1 }
            if (word[n - 1] == "about" && (word[n] < v["truth.t_lo"] - far || word[n] > v["truth.t_hi"] + far)) { print "about: " t; exit 1 }
        }' "$dir/flat" "$dir/said" || bad "export $1"
    seen=$((seen + 1))
}

trial=fuzz/corpus/strict-comparison.trial
told "$trial" 'hits triangle 0 first, at t = [0-9]+/[0-9]+'
sed 's/^triangles 1/triangles 2/; s/^0 1 2$/0 1 2\n2 1 0/' "$trial" >"$dir/twice.trial"
told "$dir/twice.trial" 'and others at the same t first, at t = [0-9]+/[0-9]+'
sed 's/^0x1p+15 \(.*\)-0x1p+14        -0x1p+14 /0x1p+15 \10x1p+14        0x1p+14 /' "$trial" >"$dir/away.trial"
told "$dir/away.trial" 'hits nothing'
for trial in fuzz/corpus/rounded-inward.trial fuzz/corpus/half-overflow.trial fuzz/corpus/determinant-threshold.trial; do
    told "$trial" '^Exactly ray 0 hits '
done
# A ray that is not the only one, or not the first, has the file's number in the program; Embree is not given the second.
sed '/^rays 1$/ { s/1/4/; n; p; h; s/^0x1p+15/0x1p+90/; p; g; p; }' fuzz/corpus/strict-comparison.trial >"$dir/four.trial"
numbers() { # numbers that are told, arguments
    told=$1
    shift
    "$raydiff" export "$dir/four.trial" --form c --to "$dir/program" "$@" >"$dir/out" 2>"$dir/err"
    said=$(sed -n 's|^ */\* ray \([0-9]*\) of the finding \*/$|\1|p' "$dir/program"/*.c "$dir/program" 2>/dev/null | tr '\n' ' ')
    [ "$said" = "$told" ] || bad "export $*: rays '$said', not '$told': $(cat "$dir/err")"
    rm -rf "$dir/program"
}
numbers '' --engine embree --ray 0
numbers '3 ' --engine embree --ray 3
numbers '2 3 ' --engine embree
echo "values_export: $seen trials, $failed failed"
[ "$failed" -eq 0 ]
