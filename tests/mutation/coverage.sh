#!/bin/sh
# Which suites run which lines: sh tests/mutation/coverage.sh BUILD OUT [SUITE]
# BUILD is one of config=coverage, with BUILD/table (make coverage). OUT/map/FILE (with dots in place of slashes) gets a
# line "LINE SUITE..." for each that is run; what a suite ran is kept in OUT/lines/SUITE and not asked again. SUITE: that one alone.
# Of a shader module, OUT/map/spv.NAME gets line 0 with the suites that make it (tests/mutation/modules.c).
set -u
build=$1 out=$2
mkdir -p "$out/lines" "$out/map"

if [ $# -eq 2 ]; then
    sh tests/mutation/suites.sh "$build" >"$out/suites"
    while read -r name _; do
        [ -e "$out/lines/$name" ] || echo "$name"
    done <"$out/suites" | xargs -r -P "$(nproc)" -n 1 sh "$0" "$build" "$out"
    rm -f "$out/map"/*
    (cd "$out/lines" && awk '{ print $1, $2, FILENAME }' *) | sort -k1,1 -k2,2n -k3,3 |
        awk -v out="$out/map" '
            $1 != file || $2 != line {
                if (file != "") print row >name
                if ($1 != file) {
                    if (file != "") close(name)
                    name = $1
                    gsub("/", ".", name)
                    name = out "/" name
                }
                file = $1
                line = $2
                row = line
            }
            { row = row " " $3 }
            END { print row >name }'
    echo "$(ls "$out/map" | wc -l) files are run by $(ls "$out/lines" | wc -l) suites"
    for module in $(cat "$build/spv/list"); do
        module=$(basename "$module" .spv)
        [ -e "$out/map/spv.$module" ] || echo "shader module $module is made by none"
    done
    exit 0
fi

dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
command=$(sed -n "s/^$3 //p" "$out/suites")
logs=$dir
mkdir "$dir/modules" "$dir/ran"
(
    export RAYDIFF_WHOLE_MODULES=1 # as they are in the build
    export RAN_BLOCKS="$dir/ran" RAYDIFF_MODULES="$dir/modules" LD_PRELOAD="$(realpath "$build/modules.so")"
    eval "timeout -k 5 1800 $command"
) >"$dir/log" 2>&1 </dev/null
code=$?
[ "$code" -eq 0 ] || { echo "$3: exit $code without a mutation" >&2; tail -n 3 "$dir/log" >&2; }
for data in "$dir"/ran/*; do
    name=$(basename "$data")
    table=$build/table
    if [ "$name" != libraydiff.so ]; then # a test that is linked with all objects
        table=$dir/table
        perl tests/mutation/blocks.pl table "$build/tests/$name" >"$table" 2>>"$dir/log" || continue
    fi
    perl tests/mutation/blocks.pl ran "$table" "$data"
done >"$dir/seen"
cksum $(cat "$build/spv/list") >"$dir/known"
find "$dir/modules" -type f -exec cksum {} + | awk '
    { content = $1 " " $2 }
    NR == FNR { sub(/.*\//, "", $3); sub(/\.spv$/, "", $3); name[content] = $3; next }
    content in name { print "spv/" name[content], 0 }' "$dir/known" - >>"$dir/seen"
sort -u "$dir/seen" >"$dir/lines"
mv "$dir/lines" "$out/lines/$3"
