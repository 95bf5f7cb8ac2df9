#!/bin/sh
# Plays one mutation for tests/mutation/run.sh: CC_CMD=... TOOL_SRC=... sh tests/mutation/play.sh OUT KEY FILE NUMBER
# Writes OUT/done/KEY, one line: WORD SECONDS BY: FILE, and the mutation as `mutate list` has it. WORD:
#   killed     BY is the suite that turned red, or "SUITE hangs" at 20 times its usual time and 60 s
#   survived   all suites that run the line stay green, and others for 120 s more; BY: how many ran the line
#   same       the compiler makes the same code of it
#   broken     it does not compile
# A C file is compiled, and programs get a library with it in place of the unit; of a header all units that
# include it, and unit tests that do; of GLSL all shaders that include it. What turns red must be green
# without the mutation, then and there.
set -u
. tests/heap.sh
out=$1 key=$2 file=$3 number=$4
build=$(dirname "$out")
flat=$(echo "$file" | tr / .)
dir=$out/play/$key
mkdir -p "$dir" "$out/done" "$out/healthy"
started=$(date +%s)
said=$("$build/mutate" list "$file" | sed -n "$((number + 1))p")
text=${said#* }
line=${text%% *}
tell() {
    printf '%s %d %s: %s %s\n' "$1" "$(($(date +%s) - started))" "$2" "$file" "$text" >"$dir/told"
    mv "$dir/told" "$out/done/$key"
    rm -rf "$dir"
    exit 0
}
mkdir -p "$dir/tree/$(dirname "$file")" "$dir/units"
"$build/mutate" apply "$file" "$number" >"$dir/tree/$file" || exit 4

# --- what is compiled with it ------------------------------------------------------------------------

# The units of a folder of objects that include the file or are it.
units_of() { find "$build/obj/$1" -name '*.d' -exec grep -lF " $file" {} + 2>/dev/null | sed "s|^$build/obj/||; s|\.d$||"; }
# Source, object, flags.
mutated() { sh tests/mutation/compile.sh "$dir/tree" "$@" -g0 2>>"$dir/compile.log"; }
healthy() { sh tests/mutation/compile.sh "$dir/none" "$@" -g0 2>>"$dir/compile.log"; }
compile() { mutated "$1" "$2" -w || tell broken compiler; }
# A warning stops `make check`: whether there is one with the mutation and none without it.
warns() { # unit
    mutated "$(source_of "$1.c")" "$dir/strict.o" -Werror && return 1
    healthy "$1.c" "$dir/strict.o" -Werror
}
source_of() { [ -e "$dir/tree/$1" ] && echo "$dir/tree/$1" || echo "$1"; }
# Without the mutation, made once for all of a build.
healthy_object() { # unit
    kept=$out/healthy/$(echo "$1" | tr / .).o
    [ "$kept" -nt "$build/obj/$1.o" ] || { healthy "$1.c" "$dir/healthy.o" -w && mv "$dir/healthy.o" "$kept"; } || exit 4
    echo "$kept"
}
compile_units() { # the library's and the commands'
    objects=
    for unit in $(for room in ref gpu scenes fuzz bench cmd tests/hard; do units_of $room; done); do
        object=$dir/units/$(echo "$unit" | tr / .).o
        compile "$(source_of "$unit.c")" "$object"
        cmp -s "$object" "$(healthy_object "$unit")" && continue
        objects="$objects $build/obj/$unit.o=$object"
        warns "$unit" && tell killed warnings
    done
}
compile_shaders() {
    modules=" $(cat "$build/spv/list") "
    changed=
    shaders=$dir/shaders # what a shader includes is looked for beside it first
    mkdir -p "$shaders" "$dir/raw" && sh tests/planted/shaders.sh "$dir/tree" "$shaders" || exit 4
    for module in $modules; do
        shader=$(basename "$module" .spv)
        grep -qF " $file" "$build/spv/plain/$shader.d" || continue
        case $shader in query_*) target=vulkan1.2 ;; *) target=vulkan1.1 ;; esac # as in shaders/shaders.mk
        source=$shaders/$shader.comp
        [ -e "$source" ] || source=$build/gen/$shader.comp
        ${GLSLANG:-glslangValidator} --quiet -V --target-env $target -I. "-I$shaders" -o "$dir/raw/$shader.spv" "$source" \
            >>"$dir/compile.log" 2>&1 && "$build/spirv_tool" fix "$dir/raw/$shader.spv" "$dir/$shader.spv" || tell broken glslang
        cmp -s "$dir/$shader.spv" "$module" && continue
        changed="$changed $shader"
        modules=$(echo "$modules" | sed "s# [^ ]*/$shader\.spv # $dir/$shader.spv #")
    done
    [ -n "$changed" ] || return 0
    "$build/spirv_tool" embed "$dir/shaders.c" $modules && compile "$dir/shaders.c" "$dir/units/shaders.o"
    objects=$build/obj/gen/shaders.o=$dir/units/shaders.o
}

objects= tests=
case $file in
*.c) compile_units ;;
*.h)
    compile_units
    tests=$(units_of tests | sed -n 's|.*/\(test_[a-z0-9_]*\)$|\1|p')
    ;;
*) compile_shaders ;;
esac
[ -n "$objects$tests" ] || tell same compiler
# The library with these in place of its own.
with=$build
if [ -n "$objects" ]; then
    for pair in $objects; do echo "$pair"; done |
        awk -F= 'NR == FNR { other[$1] = $2; next } { print $1 in other ? other[$1] : $1; used += $1 in other }
            END { exit used == 0 }' - "$build/objects" >"$dir/objects" &&
        $CC_CMD -shared -Wl,-soname,libraydiff.so -o "$dir/libraydiff.so" $(cat "$dir/objects" "$build/libraries") || tell broken linker
    with=$dir
fi

# --- suites ------------------------------------------------------------------------------------------

# A unit test whose own object changes with the header, or that has no library, linked anew; else as it is.
program_of() { # suite, folder of the library
    if [ -e "$out/wrapped/$1" ] && [ "$2" != "$build" ]; then
        own=
        echo " $tests " | tr '\n' ' ' | grep -q " $1 " && {
            unit=$(echo "$build"/obj/tests/*/"$1".o | sed "s|^$build/obj/||; s|\.o$||")
            own=$dir/$1.o
            compile "$unit.c" "$own"
        }
        [ -e "$dir/objects" ] || cp "$build/objects" "$dir/objects"
        sh tests/mutation/whole.sh "$build" "$1" "$dir/objects" "$dir/$1" $own || exit 4
        echo "$dir/$1"
        return
    fi
    echo " $tests " | tr '\n' ' ' | grep -q " $1 " || { sed -n "s/^$1 //p" "$out/suites"; return; }
    unit=$(echo "$build"/obj/tests/*/"$1".o | sed "s|^$build/obj/||; s|\.o$||")
    compile "$unit.c" "$dir/$1.o"
    $CC_CMD -o "$dir/$1" "$dir/$1.o" $(cat "$build/links/$1") || exit 4
    echo "$dir/$1"
}
red() { # suite, seconds that it may take, folder of the library, variables
    command=$(program_of "$1" "$3")
    logs=$dir
    (
        export LD_LIBRARY_PATH="$(realpath "$3")"
        eval "timeout -k 5 $2 env ${4:-$(heap_of "$1")} $command"
    ) >"$dir/log" 2>&1 </dev/null
    code=$?
    [ "$code" -ne 0 ] && [ "$code" -ne 77 ]
}
try() { # suite, its usual milliseconds, variables
    limit=$((60 + 20 * $2 / 1000))
    red "$1" "$limit" "$with" "${3:-}" || return
    by=$1
    { [ "$code" -eq 124 ] || [ "$code" -eq 137 ]; } && by="$1 hangs"
    [ -n "${3:-}" ] && by="$1 leaks"
    (tests= && red "$1" "$limit" "$build" "${3:-}") && return
    tell killed "$by"
}

# The suites that run the line, the quick ones first, as long as there is some left of COVERING seconds. Of a
# line that no suite is seen to run (a table, a part of a statement) they are those of the file; of a shader,
# those that make a module with it, or any module.
map= at=
case $file in
*.[ch]) [ ! -e "$out/map/$flat" ] || map=$out/map/$flat at=$line ;;
*)
    for shader in $changed; do
        [ ! -e "$out/map/spv.$shader" ] || map="$map $out/map/spv.$shader"
    done
    [ -n "$map" ] || [ ! -e "$out/map/gpu.vk.vk_pipeline.c" ] || map=$out/map/gpu.vk.vk_pipeline.c
    ;;
esac
covering() { awk -v line="$1" 'line == "" || $1 == line { for (i = 2; i <= NF; i++) print $i }' $map | sort -u; }
if [ -n "$map" ]; then
    covering "$at" >"$dir/covering"
    [ -s "$dir/covering" ] || covering "" >"$dir/covering"
fi
touch "$dir/covering"
# Of suites those that the awk condition takes, the quick ones first; and the more mutations one has killed, of this
# file above all, and of its folder, the sooner it comes.
find "$out/done" -type f -exec cat {} + 2>/dev/null |
    awk -v file="$file" 'function room(path) { sub(/[^\/]*$/, "", path); return path }
        $1 == "killed" { sub(/:$/, "", $3); by[$3] += $4 == file ? 20 : room($4) == room(file) ? 2 : 0.01 }
        END { for (suite in by) print suite, by[suite] }' >"$dir/history"
ranked() {
    awk 'FILENAME == ARGV[1] { covers[$1]; next } FILENAME == ARGV[2] { by[$1] = $2; next }
        '"$1"' { print $2 / (1 + by[$1]), $2, $1 }' "$dir/covering" "$dir/history" "$out/times" | sort -n | cut -d' ' -f2,3
}
count=0
left=$((${COVERING:-1000000} * 1000))
ranked '$1 in covers' >"$dir/order"
while read -r usual suite; do
    left=$((left - usual))
    [ "$left" -ge 0 ] || break
    try "$suite" "$usual"
    count=$((count + 1))
done <"$dir/order"
# What only a sanitizer sees (make deep): memory that is not given back.
case $text in
*" statement "*free*|*" statement "*close*|*" statement "*decref*|*" statement "*destroy*|*" statement "*release*)
    preload="LD_PRELOAD=$($CC_CMD -print-file-name=liblsan.so) LSAN_OPTIONS=exitcode=23:print_suppressions=0:suppressions=$PWD/tests/lsan.supp"
    while read -r usual suite; do
        case $suite in test_*) try "$suite" "$((5 * usual))" "$preload" ;; esac
    done <"$dir/order"
    ;;
esac
# Then others, by their time, as long as there is some of REST seconds left.
rest=$((${REST:-120} * 1000))
ranked '!($1 in covers)' >"$dir/order"
while read -r usual suite; do
    rest=$((rest - usual))
    [ "$rest" -ge 0 ] || break
    try "$suite" "$usual"
done <"$dir/order"
tell survived "$count"
