#!/bin/sh
# raydiff explain of worlds: a tracer that is right, one whose trees lose instances, and what is refused. Text against JSON.
#   sh tests/worlds/explain_worlds.sh RAYDIFF
set -u
raydiff=$(realpath "$1")
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
}
# exit code, arguments
ends() {
    want=$1
    shift
    "$raydiff" explain "$@" --wide --json "$dir/json" >"$dir/out" 2>"$dir/err"
    code=$?
    [ "$code" -eq "$want" ] || { bad "explain $*: exit $code, not $want"; tail -n 3 "$dir/out" "$dir/err"; }
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" 2>/dev/null
}
# rule, arguments: one line, exit code 2
refused() {
    rule=$1
    shift
    "$raydiff" explain "$@" >"$dir/out" 2>"$dir/err"
    code=$?
    [ "$code" -eq 2 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && grep -qF -- "$rule" "$dir/err" && [ ! -s "$dir/out" ] ||
        bad "explain $*: exit $code, $(cat "$dir/err")"
}
has() { grep -qx -- "$1" "$dir/flat" || bad "JSON has no $1"; }
# The text by the JSON.
laws() {
    sh tests/values/fields.sh explain_world "$dir/flat" "$dir/seen" || bad "fields"
    awk -F= 'NR == FNR { v[$1] = substr($0, length($1) + 2); next }
        function wrong(what) { print "WRONG   " what ": " $0; bad = 1 }
        FNR == 1 { if (index($0, v["world"] ": ") != 1 || !($0 ~ v["instances"] " instance") || !($0 ~ v["triangles"] " placed")) wrong("head") }
        FNR == 2 {
            on = v["layout"] == "null" ? "" : " on " v["layout"]
            if (index($0, v["engine"] on ", query " v["query"] ": " v["rays"] " rays of set " v["set"] ", modes " v["modes"] ": " v["wrong"] " WRONG") != 1) wrong("counts")
            for (k in v) if (k ~ /^kinds\./) { sum += v[k]; if (v[k] + 0 > 0 && !index($0, substr(k, 7) " " v[k])) wrong(k) }
            if (sum != v["wrong"]) wrong("sum of kinds")
        }
        /^the first, ray / { if (!index($0, "ray " v["first.index"] ", mask 0x" sprintf("%02x", v["first.mask"]) ", flags 0x" sprintf("%03x", v["first.flags"]) ":")) wrong("first") }
        /^  of / { if (!($0 ~ "^  of +" v["wrong_compared"] " WRONG +of +" v["other_compared"] " others ")) wrong("compared"); next }
        /^ +[0-9]+ +[0-9]+ / {
            split($0, w, " ")
            for (i = 0; ("attempts." i ".cause") in v; i++)
                if (index($0, v["attempts." i ".defect"]) && (w[1] != v["attempts." i ".told_wrong"] || w[2] != v["attempts." i ".told_other"] || w[3] != v["attempts." i ".cause"])) wrong("attempt " i)
            rows++
        }
        /^ +[0-9]+ +- / { split($0, w, " "); if (w[1] != v["at_the_rim"] || w[3] != "world_box") wrong("rim") }
        { last = $0; if (/^cause /) { split($0, w, " "); cause = w[2] } }
        END {
            for (i = 0; ("attempts." i ".cause") in v; i++) if (v["wrong"] + 0 > 0 && 2 * v["attempts." i ".told_wrong"] >= v["wrong_compared"] + 0) shown++
            if (rows + 0 != shown + 0) wrong("rows")
            told = v["cause"] == "none" ? "no answer is wrong" : "WRONG: " v["wrong"] " of " v["rays"] " answers, by " v["cause"]
            if (last != ("conclusion: " told)) wrong("conclusion")
            if (v["cause"] != "none" && cause != (v["cause"] ":")) wrong("cause")
            exit bad
        }' "$dir/flat" "$dir/out" || failed=$((failed + 1))
}

ends 0 mixed --engine cpu --count 600
laws
has wrong=0
has cause=none
has first=null
has tree_fault=null
ends 0 placed-turned --engine brute --query any --modes drawn --count 300
laws
has layout=null
# Where the default layout cannot hold a world it is f32; one that is named is kept to.
ends 0 placed-far --engine cpu --count 300
laws
has layout=f32
refused 'rf16: a bound is at most 65504' placed-far --engine cpu --layout rf16
ends 1 crowd:n=20,size=0.5 --engine cpu --layout rtrs_rf_paper --box rtrs --count 2000
laws
has cause=world_box
grep -q '^tree_fault=top level, ' "$dir/flat" || bad 'no fault of the top'
grep -q '^cause  world_box: top level, whose triangles are instances: rtrs_rf_paper: ' "$dir/out" || bad 'the fault is not told'
# As many rays as are judged by check, and as many WRONG ones, at the same seed.
"$raydiff" check crowd:n=20,size=0.5 --engine cpu --layout rtrs_rf_paper --box rtrs --count 2000 --query closest --json "$dir/check" >/dev/null 2>&1
counted=$(awk -f tests/values/flat.awk "$dir/check" | sed -n 's/^rows\.0\.counts\.wrong=//p')
has "wrong=$counted"
sh tests/values/fields.sh --unseen explain_world "$dir/seen" || bad 'fields that were not seen'

refused "--ray: mixed is a world" mixed --ray '0,0,0 1,0,0'
for option in "index 3" "html $dir/x.html" "svg $dir/x.svg" "store quantised" "cause sentinel"; do
    refused "--${option%% *}: mixed is a world" mixed --${option%% *} "${option#* }"
done
[ ! -e "$dir/x.html" ] && [ ! -e "$dir/x.svg" ] || bad 'a file was written'
refused "--modes: sphere:n=2 is a scene" sphere:n=2 --modes all
"$raydiff" explain mixed --engine cpu_stackless >"$dir/out" 2>"$dir/err"
code=$?
[ "$code" -eq 77 ] && grep -qx 'raydiff explain: cpu_stackless traces scenes, not worlds' "$dir/err" || bad "an engine of scenes: exit $code"
echo "explain_worlds: $failed failed"
[ "$failed" -eq 0 ]
