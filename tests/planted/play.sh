#!/bin/sh
# Plays one line of `tests/planted/plant.sh --list`, for tests/planted/run.sh; a line says how it went:
#   caught | MISSED | BROKEN (does not build, or its catcher fails without the bug) | SKIP
#   CC_CMD=... LIBS=... TOOL_SRC=... sh tests/planted/play.sh BUILD LIST LINE
# Lines are words of the shell; $out is a folder with the scenes of tests/planted/scenes.sh.
#   program BUG UNIT ARGUMENTS                   raydiff ARGUMENTS must turn red
#   test    BUG UNIT TEST[:NAME]                 a program of unit tests, or those whose names match NAME
#   script  BUG UNIT SCRIPT [ARGUMENTS]          so must a script of tests/ that is told of the program
#   header  BUG TEST[:NAME]                      the bug is in a header that the test includes
#   reader  BUG UNIT ENTRY                       the seeds of a reader of files must end it
#   explain BUG UNIT CAUSE CODE ARGUMENTS        raydiff explain must name the cause and exit with the code
#   told    BUG UNIT CAUSE ARGUMENTS             so must the command that raydiff check prints
#   watched LINE                                 with the GPU's memory watched
# UNIT: the C file, the file of WGSL or a script of a page, or the shaders with commas between, that are compiled with the bug. What they include
# has it, too.
set -u
build=$1 list=$2 line=$3
out=$build/mutants/suite
limit=300 # seconds for what may hang

started=$(date +%s%N)
# How long each line took is in BUILD/mutants/suite/milliseconds.
say() {
    echo "$((($(date +%s%N) - started) / 1000000)) $line $*" >>"$out/milliseconds"
    echo "$*" >"$out/told.new.$line" && mv "$out/told.new.$line" "$out/told.$line"
}
broken() {
    say "BROKEN  $*"
    exit 0
}

# $(once FILE COMMAND...): the command's exit code, which FILE.code keeps: it is run by whoever comes
# first, and what it prints is in FILE.log.
once() {
    file=$1
    shift
    (
        flock 9
        [ -e "$file.code" ] || { "$@" >"$file.log" 2>&1; echo $? >"$file.code"; }
    ) 9>"$file.lock"
    cat "$file.code"
}

# Only the bug matters, not the speed: compiled with little optimisation, linked without symbols.
compile() { $CC_CMD -Werror=implicit-function-declaration -O1 -g0 "$@"; }
link() { # program, then what it is made of
    program=$1
    shift
    $CC_CMD -g0 -Wl,-s -o "$program" "$@" "$build/libraydiff.a" $LIBS
}

bug() { # sets name, unit and the folder of what is made with the bug in that unit
    name=$1 unit=$2
    dir=$out/$name-$(basename "$unit" .c)
    mkdir -p "$dir"
    made "$dir/plant" sh tests/planted/plant.sh "$name" "$dir/tree"
}
made() { # FILE COMMAND...: it is there, or the line is told as broken
    [ "$(once "$@")" -eq 0 ] || broken "$name does not build in $unit: $1.log"
}
with_bug() { [ -e "$dir/tree/$1" ] && echo "$dir/tree/$1" || echo "$1"; }
compile_unit() { compile -iquote "$dir/tree" -c -o "$dir/unit.o" "$(with_bug "$unit")"; }

# The shaders named with the bug in them, all others as they are.
compile_shaders() {
    tool=$build/spirv_tool
    modules=" $(cat "$build/spv/list") "
    for source in $TOOL_SRC; do
        [ -e "$dir/tree/$source" ] && tool=$dir/tool
    done
    [ "$tool" = "$build/spirv_tool" ] ||
        ${HOSTCC:-cc} -iquote "$dir/tree" -I. -std=c17 -O1 -o "$tool" $(for source in $TOOL_SRC; do with_bug "$source"; done) || return
    shaders=$dir/shaders # what a shader includes is looked for beside it first
    mkdir -p "$shaders" && sh tests/planted/shaders.sh "$dir/tree" "$shaders" || return
    for shader in $(echo "$unit" | tr , ' '); do
        source=$shaders/$shader.comp
        [ -e "$source" ] || source=$build/gen/$shader.comp
        case $shader in query_*) target=vulkan1.2 ;; *) target=vulkan1.1 ;; esac
        ${GLSLANG:-glslangValidator} --quiet -V --target-env $target -I. "-I$shaders" \
            -o "$dir/$shader.raw" "$source" && "$tool" fix "$dir/$shader.raw" "$dir/$shader.spv" || return
        cmp -s "$dir/$shader.spv" "$build/spv/$shader.spv" &&
            { echo "the bug changes nothing in $shader"; return 1; }
        modules=$(echo "$modules" | sed "s# [^ ]*/$shader\.spv # $dir/$shader.spv #")
    done
    "$build/spirv_tool" embed "$dir/shaders.c" $modules && compile -c -o "$dir/unit.o" "$dir/shaders.c"
}

# All WGSL and the program that runs it, some with the bug.
compile_wgsl() {
    sh gpu/webgpu/embed.sh $(for file in shaders/wgsl/*.wgsl gpu/webgpu/*.js; do with_bug "$file"; done) \
        >"$dir/wgsl_sources.c" && compile -c -o "$dir/unit.o" "$dir/wgsl_sources.c"
}

# The script of a page, as the Makefile makes it part of the program.
compile_script() {
    shipped=$(basename "$unit" .js)_shipped
    { echo "extern const char ${shipped}[];"; echo "const char ${shipped}[] ="
      sed -e 's/[\\"?]/\\&/g' -e 's/^/    "/' -e 's/$/\\n"/' "$(with_bug "$unit")"; echo ';'; } >"$dir/script.c" &&
        compile -c -o "$dir/unit.o" "$dir/script.c"
}

make_unit() {
    case $unit in
    cmd/*.js) made "$dir/unit" compile_script ;;
    *.wgsl | *.js) made "$dir/unit" compile_wgsl ;;
    *.c) made "$dir/unit" compile_unit ;;
    *) made "$dir/unit" compile_shaders ;;
    esac
}
# ld.gold links the program in half the time.
gold=$(command -v ld.gold >/dev/null && echo -fuse-ld=gold)
link_program() { # the commands are no part of the library; the unit may be one of them
    own=$(basename "$unit" .c).o
    link "$dir/raydiff" $gold "$build"/obj/raydiff.o $(ls "$build"/obj/cmd/*/*.o | grep -v "/$own\$") "$dir/unit.o"
}
make_program() {
    bug "$1" "$2"
    make_unit
    made "$dir/raydiff" link_program
}

# Exit code of a command without the bug; the same command is run once.
healthy_log() { echo "$out/healthy/$(echo "${RAYDIFF_VALIDATE-} $*" | cksum | tr ' ' -)"; }
healthy() { once "$(healthy_log "$@")" timeout "$limit" "$@"; }

judge() { # where, code of the healthy run, code of the mutant's, log of the healthy run
    if [ "$2" -eq 77 ] || { [ "$3" = 0 ] && grep -q '^SKIP' "$4"; }; then
        say "SKIP    $name (in $1): $(grep -h '^SKIP' "$4" | head -n 1)"
    elif [ "$2" -ne 0 ]; then
        broken "$name (in $1): its catcher fails without the bug, exit $2, $4"
    elif [ "$3" = 1 ] || [ "$3" = 3 ]; then
        say "caught  $name (in $1)"
    else
        say "MISSED  $name (in $1): exit $3"
    fi
}

# Bug, unit, then the arguments of raydiff that must turn red.
program() {
    make_program "$1" "$2"
    shift 2
    code=$(healthy "$build/raydiff" "$@")
    timeout "$limit" "$dir/raydiff" "$@" >"$dir/$line.log" 2>&1
    judge "$unit" "$code" $? "$(healthy_log "$build/raydiff" "$@").log"
}

# Bug, unit, script of tests/ that must turn red when it is given the program, then what it plays of itself.
script() {
    make_program "$1" "$2"
    by=$(ls tests/*/"$3")
    shift 3
    code=$(healthy sh "$by" "$build/raydiff" "$@")
    timeout "$limit" sh "$by" "$dir/raydiff" "$@" >"$dir/$line.log" 2>&1
    judge "$unit, by ${by##*/}${1:+ $*}" "$code" $? "$(healthy_log sh "$by" "$build/raydiff" "$@").log"
}

# Sets test and only: of TEST:NAME only the unit tests whose names match NAME are run.
chosen_test() {
    test=${1%%:*} only=
    case $1 in *:*) only=${1#*:} ;; esac
}
run_test() { # program
    timeout "$limit" env "LD_PRELOAD=$out/cmocka_only.so" "CMOCKA_ONLY=$only" "$1"
}
run_healthy() {
    run_test "$1" && ! grep -q 'Running 0 test' "$file.log"
}
# The test's program with the bug is in $dir.
judge_test() { # where
    log=$out/healthy/$test-$(echo "$only" | tr '*' _)
    code=$(once "$log" run_healthy "$build/tests/$test")
    run_test "$dir/$test" >"$dir/$line.log" 2>&1
    got=$?
    case $got in # CMocka returns how many failed
    0 | 124) ;;
    *) got=1 ;;
    esac
    judge "$1, by $test${only:+: $only}" "$code" "$got" "$log.log"
}

# Bug, unit or shaders, unit test that must turn red.
test_() {
    bug "$1" "$2"
    make_unit
    chosen_test "$3"
    made "$dir/$test" link "$dir/$test" "$(ls "$build"/obj/tests/*/"$test.o")" "$dir/unit.o" $(cat "$build/links/$test")
    judge_test "$unit"
}

# Bug, unit test that includes the bug's header itself.
header() {
    chosen_test "$2"
    bug "$1" "$(ls tests/*/"$test.c")"
    make_unit
    made "$dir/$test" link "$dir/$test" "$dir/unit.o" $(cat "$build/links/$test")
    judge_test "a header"
}

# Bug, unit, entry of the reader whose seeds must end it.
reader() {
    bug "$1" "$2"
    make_unit
    entry=$3
    made "$dir/$entry" link "$dir/$entry" "$build/obj/tests/readers/entry_$entry.o" "$dir/unit.o" \
        "$build"/obj/tests/readers/harness.o "$build"/obj/tests/readers/count.o "$build"/obj/tests/readers/main.o
    code=$(healthy "$build/readers/$entry" "$build/readers/seeds/$entry")
    timeout "$limit" "$dir/$entry" "$build/readers/seeds/$entry" >"$dir/$line.log" 2>&1
    got=$?
    grep -q 'does not hold' "$dir/$line.log" && [ "$got" -gt 128 ] && got=1
    judge "$unit, by the seeds of $entry" "$code" "$got" \
        "$(healthy_log "$build/readers/$entry" "$build/readers/seeds/$entry").log"
}

# Bug, unit or shaders, cause, exit code, arguments of raydiff explain, which must name the cause. The
# healthy program must find nothing wrong among the same rays.
explain() {
    make_program "$1" "$2"
    cause=$3 wanted=$4
    shift 4
    code=$(healthy "$build/raydiff" explain "$@")
    timeout "$limit" "$dir/raydiff" explain "$@" >"$dir/$line.log" 2>&1
    got=$?
    if [ "$got" -eq "$wanted" ] && grep -q "^cause  *$cause:" "$dir/$line.log"; then
        got=1
    else
        got="$got, $(grep '^cause' "$dir/$line.log")"
    fi
    judge "$unit, explained: $cause" "$code" "$got" "$(healthy_log "$build/raydiff" explain "$@").log"
}

# Bug, unit or shaders, cause, arguments of raydiff check: its first finding's command, run as printed,
# names the cause; so does the one in the JSON.
told() {
    make_program "$1" "$2"
    cause=$3
    shift 3
    code=$(healthy "$build/raydiff" check "$@")
    timeout "$limit" "$dir/raydiff" check "$@" --json "$dir/$line.json" >"$dir/$line.log" 2>&1
    told=$(sed -n 's/^  explain: raydiff //p' "$dir/$line.log" | head -n 1)
    eval "\"$dir/raydiff\" $told" >"$dir/$line.told" 2>&1
    got=$?
    if [ -z "$told" ] || ! grep -q "^cause  *$cause:" "$dir/$line.told" ||
        ! grep -qF "\"explain\": \"raydiff $told\"" "$dir/$line.json"; then
        got="2, check tells '$told', $(grep '^cause' "$dir/$line.told")"
    fi
    judge "$unit, as check tells to explain it: $cause" "$code" "$got" \
        "$(healthy_log "$build/raydiff" check "$@").log"
}

# The rest of the line, every access of a shader to memory watched.
watched() {
    export RAYDIFF_VALIDATE=gpu
    play "$@"
}

play() {
    kind=$1
    shift
    case $kind in
    test) test_ "$@" ;;
    program | script | header | reader | explain | told | watched) "$kind" "$@" ;;
    *) broken "$list:$line: what is '$kind'?" ;;
    esac
}
eval "play $(sed -n "${line}p" "$list")"
