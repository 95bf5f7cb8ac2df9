#!/bin/sh
# Draws mutations of a room and plays them (tests/mutation/play.sh); what is done is not done again, so that a
# run can be ended and resumed, and a larger SAMPLE goes on where a smaller one ended:
#   CC_CMD=... sh tests/mutation/run.sh BUILD ROOM SAMPLE SEED
# ROOM: folders or files, blanks between. SAMPLE counts what is neither broken nor the same to the compiler.
# BUILD is one of config=mutation; what suites run which lines is in BUILD/../mutation-map, made by
# `make mutation-map`. What tests/mutation/equivalent.txt has is not played. Prints the survivors, what killed the others,
# and the score. AGAIN=1 plays survivors once more. Exit code 1: more than a tenth is said to be equivalent, or
# no suite is green; 2: no such room, or no map.
set -u
build=$1 room=$2 sample=$3 seed=$4
map=$build/../mutation-map/map
out=$build/play
export CC_CMD OMP_NUM_THREADS="${OMP_NUM_THREADS:-1}"
[ -n "$room" ] || { echo "mutation: which room? make mutation ROOM=ref/judge" >&2; exit 2; }
[ -d "$map" ] || { echo "mutation: which suites run which lines? make mutation-map" >&2; exit 2; }
files=$(git ls-files -- $room | grep -E '\.(c|h|glsl|comp)$')
[ -n "$files" ] || { echo "mutation: '$room': no source" >&2; exit 2; }
mkdir -p "$out/done"
ln -sfn "$(realpath "$map")" "$out/map"
sh tests/mutation/suites.sh "$build" >"$out/suites"
mkdir -p "$out/wrapped"
for name in $(grep -l -e --wrap "$build"/links/* | sed 's|.*/||'); do
    sh tests/mutation/whole.sh "$build" "$name" "$build/objects" "$out/wrapped/$name" || exit 4
    sed -i "s|^$name .*|$name $out/wrapped/$name|" "$out/suites"
done

# How long each suite takes, measured once; one that is red without a mutation is left out, and named in
# $out/red.
: >"$out/red"
touch "$out/times"
cat "$out/times" "$out/red" >"$out/known"
awk 'FILENAME == ARGV[1] { known[$1]; next } !($1 in known) { print $1 }' "$out/known" "$out/suites" |
    xargs -r -P "$(env -u OMP_NUM_THREADS nproc)" -n 1 sh tests/mutation/time.sh "$out"
[ -s "$out/times" ] || { echo "mutation: no suite is green without a mutation: $out/red" >&2; exit 1; }

# All mutations of the room in an order that depends on the seed alone.
key=$(echo "$room $seed" | cksum | tr ' ' .)
perl tests/mutation/order.pl "$build/mutate" tests/mutation/equivalent.txt "$seed" $files >"$out/order.$key" || exit 1

# Results of the first N, and of those that are known to be equivalent: WORD SECONDS BY: MUTATION.
results() {
    head -n "$1" "$out/order.$key" | while read -r id file number invariant; do
        if [ "$invariant" != - ]; then
            echo "equivalent 0 $invariant: $file $("$build/mutate" list "$file" | sed -n "$((number + 1))s/^[0-9]* //p")"
        else
            cat "$out/done/$id" 2>/dev/null
        fi
    done
}
counted() { results "$1" | grep -cE '^(killed|survived) '; }
drawn=0 total=$(wc -l <"$out/order.$key")
while [ "$drawn" -lt "$total" ]; do
    lacking=$((sample - $(counted "$drawn")))
    [ "$lacking" -gt 0 ] || break
    sed -n "$((drawn + 1)),$((drawn + lacking))p" "$out/order.$key" | while read -r id file number invariant; do
        [ "$invariant" = - ] || continue
        [ -n "${AGAIN:-}" ] && grep -q '^survived ' "$out/done/$id" 2>/dev/null && rm "$out/done/$id"
        [ -e "$out/done/$id" ] || echo "$id $file $number"
    done | xargs -r -P "$(env -u OMP_NUM_THREADS nproc)" -L 1 sh tests/mutation/play.sh "$out"
    drawn=$((drawn + lacking))
    [ "$drawn" -le "$total" ] || drawn=$total
    echo "mutation: $(counted "$drawn") of $sample" >&2
done

results "$drawn" >"$out/played.$key"
grep '^survived ' "$out/played.$key"
awk '$1 == "killed" { sub(/:$/, "", $3); count[$3]++ } END { for (by in count) print count[by], by }' "$out/played.$key" |
    sort -k1,1nr -k2 | awk '{ printf "%s%s %s", (NR > 1 ? ", " : "killed by "), $2, $1 } END { if (NR) print "" }'
awk -v room="$room" -v seed="$seed" '
    { count[$1]++ }
    END {
        of = count["killed"] + count["survived"]
        printf "%s, seed %s: %d of %d killed (%.1f %%), %d survived; %d equivalent, %d the same code, %d do not compile\n", room,
            seed, count["killed"], of, of ? 100 * count["killed"] / of : 0, count["survived"], count["equivalent"], count["same"],
            count["broken"]
        if (10 * count["equivalent"] > of + count["equivalent"]) {
            print "mutation: more than a tenth of " room " is said to be equivalent"
            exit 1
        }
    }' "$out/played.$key"
