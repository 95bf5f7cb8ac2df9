#!/bin/sh
# Layouts from outside. First that of docs/my-layout.md through several commands (tests/docs/pages.pl follows the
# page itself); then plugins that lie, crash and hang, which must be refused with the record or the deed named.
#   sh tests/scripts/plugin.sh BUILD
set -u
build=$1
work=$(mktemp -d) || exit 4
trap 'rm -rf "$work"' EXIT
bad=0
breach() {
    echo "plugin: $1"
    bad=1
}
root=$(pwd)
for entry in "$root"/ref "$root"/scenes; do ln -s "$entry" "$work/"; done
mkdir "$work/build"
ln -s "$(cd "$build" && pwd)/raydiff" "$work/build/raydiff"

# The files of the page are the samples.
for file in mine.c mine.glsl; do
    awk -v mark="<!-- file: $file -->" '
        $0 == mark { here = 1 }
        here && /^```$/ { exit }
        inside { print }
        here && /^```./ { inside = 1 }' docs/my-layout.md >"$work/$file"
    cmp "$work/$file" "fuzz/samples/layout/$file" || breach "docs/my-layout.md has another $file"
done
cd "$work" || exit 4
start=$(date +%s)
while read -r line; do
    echo "--- $line"
    $line >step.log 2>&1
    code=$?
    [ "$code" -eq 0 ] || {
        breach "exit $code"
        tail -n 5 step.log
    }
    case $line in
    *" check "*)
        grep -q '^agrees  *mine  *cpu ' step.log || breach "no row of mine on cpu"
        # Two rows that differ in the name and the speed only.
        rows() { awk -v name="$1" '$2 == name && $3 == "vulkan" { for (i = 4; i <= 7; i++) printf "%s ", $i; print "" }' step.log; }
        [ "$(rows f32)" = "$(rows mine)" ] || breach "mine on vulkan is not f32"
        ;;
    *" conform "*) grep -q ' 0 failed' step.log || breach "conform: $(tail -n 1 step.log)" ;;
    *" fuzz "*) grep -q 'trials  *60 ' step.log || breach "fuzz played not 300 trials" ;;
    *" bench "*) grep -q 'mine' step.log || breach "bench does not name it" ;;
    esac
done <<'END'
cc -std=c17 -O2 -ffp-contract=off -shared -fPIC -I. -o mine.so mine.c
build/raydiff check sphere --layout f32,./mine.so --shader mine.glsl --engine cpu,vulkan --count 10000
build/raydiff conform --layout ./mine.so --engine cpu --count 100
build/raydiff fuzz --trials 60 --layout ./mine.so --shader mine.glsl --dir mine.findings
build/raydiff bench error --scene sphere:n=8 --layout f32,./mine.so --shader mine.glsl --tri mt --rounds 3 --count 1000
END
echo "tutorial: $(($(date +%s) - start)) s"

# --- four children ---------------------------------------------------------------------------------
start=$(date +%s)
cc -std=c17 -O2 -Wall -Wextra -Werror -ffp-contract=off -shared -fPIC -I"$root" -o mine4.so \
    "$root/fuzz/samples/layout/mine4.c" || breach "mine4.c does not compile"
mine4="--layout ./mine4.so --shader $root/fuzz/samples/layout/mine4.glsl"
wide() { # what the log must say, command...
    want=$1
    shift
    # shellcheck disable=SC2086
    build/raydiff "$@" $mine4 >step.log 2>&1
    code=$?
    [ "$code" -eq 0 ] && grep -qE "$want" step.log || {
        breach "mine4: $1: exit $code, or not '$want'"
        tail -n 5 step.log
    }
}
wide ' 0 of [24]000 answers WRONG' check sphere:n=8 --engine cpu,vulkan --driver stock --count 2000 --repeat 1
passes=4
if grep -q '^skipped  *mine4  *vulkan ' step.log; then
    echo "SKIP mine4 on vulkan: $(grep -m 1 '^skipped' step.log)"
    passes=2
else
    grep -q ' 0 of 2000 answers differ' step.log || breach "mine4 on vulkan is not mine4 on cpu"
fi
wide "^$passes passed, 0 failed" conform '*.mine4.median.robust.mt.sphere.mixed.1' \
    --engine cpu,vulkan --driver stock --count 100
wide '^ .* leaf  *entered' explain sphere:n=8 --rays mixed --count 200 --index 5
echo "four children: $(($(date +%s) - start)) s"

# --- lies ------------------------------------------------------------------------------------------
source=plugin_liar.c
lie() { # name, exit code, what must be said
    cc -std=c17 -O1 -ffp-contract=off -shared -fPIC -I"$root" -DLIE="LIE_$1" -o liar.so \
        "$root/tests/peers/$source" -lm || breach "$1 does not compile"
    build/raydiff check sphere:n=8 --engine cpu --count 50 --repeat 1 --peer-time 1 --peer-memory 64 \
        --layout ./liar.so >lie.log 2>&1
    code=$?
    [ "$code" -eq "$2" ] || breach "$1: exit $code, not $2"
    grep -qE "$3" lie.log || breach "$1: says $(tail -n 1 lie.log)"
}
lie HONEST 0 '^agrees  *liar  *cpu'
lie ULP 2 'liar: record 334: x bounds .* do not contain'
lie CHILD 2 'liar: record 0: child 1 is reference 340 of 335'
lie LOST 2 'liar: triangle 151 is in no leaf'
lie SIZE 2 'given 335 records and 512 items, and returned 1340 and 512'
lie CRASH 3 'liar: crashed while packing: killed by signal'
lie START 3 'crashed while being opened: '
lie EXIT 3 'liar: crashed while packing: ended itself with code'
lie HANG 3 'liar: hung while packing: no end after 1000 ms'

# What is no file, and what hangs before anything can be asked of it; a limit named behind it is too late.
opens() { # code, words, path
    timeout 30 build/raydiff check sphere:n=8 --engine cpu --layout "$3" --peer-time 1 >lie.log 2>&1
    code=$?
    [ "$code" -eq "$1" ] && grep -q "$2" lie.log || breach "$3: exit $code: $(tail -n 1 lie.log)"
}
mkfifo fifo.so
mkdir folder.so
ln -s /dev/zero device.so
for file in fifo folder device; do opens 2 'is no regular file' ./$file.so; done
printf '#include <unistd.h>\n__attribute__((constructor)) static void f(void) { for (;;) pause(); }\n' >stuck.c
cc -shared -fPIC -o stuck.so stuck.c
opens 3 'hung while being opened: no end after 10000 ms' ./stuck.so
cat >second.c <<'END' # hangs when it is opened for the second time
#include <fcntl.h>
#include <unistd.h>
#include "ref/plugin.h"
const struct raydiff_plugin *raydiff_plugin(void);
const struct raydiff_plugin *(*volatile use)(void) = raydiff_plugin;
__attribute__((constructor)) static void f(void)
{
    if (open("opened", O_CREAT | O_EXCL | O_WRONLY, 0600) < 0)
        for (;;)
            pause();
}
END
cat second.c "$root/tests/peers/plugin_liar.c" >both.c
cc -std=gnu17 -O1 -ffp-contract=off -shared -fPIC -I"$root" -DLIE=LIE_HONEST -o second.so both.c -lm ||
    breach "second.c does not compile"
timeout 30 build/raydiff check sphere:n=8 --engine cpu --peer-time 1 --layout ./second.so >lie.log 2>&1
code=$?
[ "$code" -eq 3 ] && grep -q 'hung while being opened again' lie.log || breach "second.so: exit $code: $(tail -n 1 lie.log)"

source=plugin_liar_wide.c
lie HOLE 0 '^agrees  *liar4  *cpu'
lie ULP 2 'liar4: record 4: x bounds .* do not contain'
lie LEAF_ULP 2 'liar4: record 84, slot 1: x bounds .* do not contain'
lie CHILD 2 'liar4: record 0: child 0 is reference 425 of 425'
lie SLOT 2 'liar4: record 0: child 0 is record 1, slot 1'
source=plugin_liar.c

# The same in the other commands: one that dies is code 3 and one line, one that lies 2.
other() { # code, command...
    want=$1
    shift
    build/raydiff "$@" --peer-time 1 --layout ./liar.so >other.log 2>&1
    code=$?
    [ "$code" -eq "$want" ] || breach "$*: exit $code, not $want: $(tail -n 1 other.log)"
    grep -q 'liar' other.log || breach "$*: does not name it"
}
fuzzed() { # kind, code of replay, what is said, cause
    rm -rf findings
    other 1 fuzz --trials 2 --jobs 1 --corpus none --engine cpu --no-shrink --dir findings
    grep -q "cpu.liar.$1.$4 " other.log || breach "fuzz: no finding of kind $1"
    grep -q 'raydiff replay .* --layout ./liar.so$' other.log || breach "fuzz: no way to replay"
    grep -qE "\"opinion\": ?\"[^\"]*$3" findings/findings.jsonl || breach "fuzz: the log does not say $3"
    other "$2" replay findings/*/first.trial --engine cpu --brief
    other "$2" replay findings/*/first.trial --engine cpu
    grep -qE "$3" other.log || breach "replay: does not say $3: $(cat other.log)"
}
lie CRASH 3 crashed
other 3 conform any.cpu.liar.median.robust.mt.sphere.mixed.1 --count 50
other 3 leaks sphere:n=8 --engine cpu --count 50
other 3 explain sphere:n=8 --engine cpu
other 3 bench error --scene sphere:n=8 --engine cpu --count 50 --rounds 1
fuzzed crash 1 'liar: crashed while packing' unexplained
lie ULP 2 record
other 2 conform any.cpu.liar.median.robust.mt.sphere.mixed.1 --count 50
other 2 leaks sphere:n=8 --engine cpu --count 50
other 2 explain sphere:n=8 --engine cpu
other 2 bench error --scene sphere:n=8 --engine cpu --count 50 --rounds 1
fuzzed tree 1 'liar: record [0-9]+: . bounds' bound_too_small

build/raydiff precompute --scene sphere --layout ./mine.so --out mine.tree >lie.log 2>&1
[ $? -eq 2 ] || breach "precompute --layout ./mine.so: not exit code 2"
grep -q 'mine is from outside, and files of packed trees hold none such' lie.log || breach "precompute: $(cat lie.log)"
[ ! -e mine.tree ] || breach "precompute writes what nothing reads"

# --- shaders ---------------------------------------------------------------------------------------
shader() { # what must be said
    build/raydiff check sphere:n=8 --count 50 --repeat 1 --layout ./mine.so --shader bad.glsl >lie.log 2>&1
    code=$?
    [ "$code" -eq 2 ] || breach "a bad shader: exit $code, not 2"
    grep -qE "$1" lie.log || breach "a bad shader: says $(tail -n 1 lie.log)"
}
build/raydiff check sphere:n=8 --count 50 --repeat 1 --engine vulkan --layout ./mine.so --shader mine.glsl >lie.log 2>&1
if grep -q 'built without glslang' lie.log; then
    echo "SKIP shaders of layouts from outside: raydiff was built without glslang"
else
    printf '#include "slab.glsl"\n\nfoo;\n' >bad.glsl
    shader ' bad.glsl:3: '
    printf '#include "nothing.glsl"\n' >bad.glsl
    shader ' bad.glsl:1: cannot include "nothing.glsl"'
    sed 's/vec3 lo =/float q = dot(vec3(1.0), vec3(ref)); vec3 lo = q */' mine.glsl >bad.glsl
    shader ' bad.glsl: word [0-9]*: OpDot: refused'
fi
[ "$bad" -eq 0 ] && echo "plugin: followed and refused"
exit "$bad"
