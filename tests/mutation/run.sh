#!/bin/sh
# Draws mutations of a room and plays them (tests/mutation/play.sh); what is done is not done again, so that a
# run can be ended and resumed, and a larger SAMPLE goes on where a smaller one ended:
#   CC_CMD=... sh tests/mutation/run.sh BUILD ROOM SAMPLE SEED
# ROOM: folders or files, blanks between. SAMPLE counts what is neither broken nor the same to the compiler.
# BUILD is one of config=mutation; what suites run which lines is in BUILD/../mutation-map, made by
# `make mutation-map`. Prints the survivors and the score. Exit code 2: no such room, or no map.
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
touch "$out/times" "$out/red"
cat "$out/times" "$out/red" >"$out/known"
awk 'FILENAME == ARGV[1] { known[$1]; next } !($1 in known) { print $1 }' "$out/known" "$out/suites" |
    xargs -r -P "$(env -u OMP_NUM_THREADS nproc)" -n 1 sh tests/mutation/time.sh "$out"
[ -s "$out/times" ] || { echo "mutation: no suite is green without a mutation: $out/red" >&2; exit 1; }

key=$(echo "$room $seed" | cksum | tr ' ' .)
# All mutations of the room in an order that depends on the seed alone.
for file in $files; do
    "$build/mutate" list "$file" | sed "s|^\([0-9]*\) .*|$file \1|"
done >"$out/all.$key"
perl -e 'srand shift; my @all = <STDIN>; for (my $i = @all; --$i > 0;) { my $j = int rand($i + 1); @all[$i, $j] = @all[$j, $i] } print @all' \
    "$seed" <"$out/all.$key" >"$out/order.$key"

name_of() { echo "$out/done/$(echo "$1" | tr / .).$2"; }
# Those of the first N that count.
counted() {
    head -n "$1" "$out/order.$key" | while read -r file number; do
        cat "$(name_of "$file" "$number")" 2>/dev/null
    done | grep -cE '^(killed|survived) '
}
drawn=0 total=$(wc -l <"$out/order.$key")
while [ "$drawn" -lt "$total" ]; do
    lacking=$((sample - $(counted "$drawn")))
    [ "$lacking" -gt 0 ] || break
    sed -n "$((drawn + 1)),$((drawn + lacking))p" "$out/order.$key" | while read -r file number; do
        [ -e "$(name_of "$file" "$number")" ] || echo "$file $number"
    done | xargs -r -P "$(env -u OMP_NUM_THREADS nproc)" -L 1 sh tests/mutation/play.sh "$out"
    drawn=$((drawn + lacking))
    echo "mutation: $(counted "$drawn") of $sample" >&2
done

head -n "$drawn" "$out/order.$key" | while read -r file number; do
    cat "$(name_of "$file" "$number")"
done >"$out/played.$key"
grep '^survived ' "$out/played.$key"
awk -v room="$room" -v seed="$seed" '
    { count[$1]++ }
    END {
        of = count["killed"] + count["survived"]
        printf "%s, seed %s: %d of %d killed (%.1f %%), %d survived; %d the same code, %d do not compile\n", room, seed,
            count["killed"], of, of ? 100 * count["killed"] / of : 0, count["survived"], count["same"], count["broken"]
    }' "$out/played.$key"
