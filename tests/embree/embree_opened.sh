#!/bin/sh
# Embree's library is opened by what uses an engine of it, and by nothing else. Where it cannot be opened, or lacks
# any function that is called, its engines are absent with the reason, as in a build without it.
#   sh tests/embree/embree_opened.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
: >"$dir/out" >"$dir/err"

# The dynamic loader's own record, of each process that a command starts: exit code, how often each opens Embree.
opens() { # CODE TIMES ARGUMENTS
    code=$1 times=$2
    shift 2
    rm -f "$dir"/loaded.*
    LD_DEBUG=files LD_DEBUG_OUTPUT=$dir/loaded expect "$code" . "$@"
    [ -n "$(ls "$dir"/loaded.* 2>/dev/null)" ] || bad "raydiff $*: the loader says nothing"
    for process in "$dir"/loaded.*; do
        [ "$(grep -c 'calling init: .*/libembree[34]' "$process")" -le "$times" ] ||
            bad "raydiff $*: a process opens Embree more than $times times"
    done
    cat "$dir"/loaded.* | grep -c 'calling init: .*/libembree[34]' >"$dir/opened"
    [ "$times" -eq 0 ] || [ "$(cat "$dir/opened")" -ge 1 ] || bad "raydiff $*: Embree is not opened"
}
tree='sphere:n=4 --count 200'
opens 0 0 --version
opens 0 0 help check
opens 0 0 check $tree --repeat 1 --engine cpu,cpu_stackless,fast,fast_small,brute,kd
opens 0 0 leaks sphere:n=4 --engine cpu,fast --layout f32 --count 1000
opens 0 0 replay fuzz/corpus/sentinel.trial --engine cpu --layout f32
opens 0 0 fuzz --engine cpu --seed 3 --trials 20 --jobs 2 --corpus none --dir "$dir/plain"
opens 0 0 conform 'closest.cpu.f32.median.robust.mt.soup.mixed.1'
opens 0 0 render sphere:n=2 -w 8 -h 8 --out "$dir/x.png"
opens 0 0 explain sphere:n=2 --ray '0,0,-3 0,0,1'

"$raydiff" doctor >"$dir/out" 2>"$dir/err"
if grep -q 'built without Embree' "$dir/out"; then
    echo "embree_opened: $failed failed; built without Embree"
    [ "$failed" -eq 0 ]
    exit
fi
opens 0 1 check $tree --repeat 1 --engine cpu,embree,embree_robust
opens 0 1 check $tree --repeat 1 --engine embree:sse2,embree:sse2:8

# Without the library: code, how the reason is told, arguments.
cc -shared -fPIC -o "$dir/shim.so" tests/embree/shim.c -ldl || bad 'shim.c is not compiled'
absent='Embree: no library: [^ ]*/libembree[34]\.so\.[34]: cannot open shared object file'
without() { # CODE LINE ARGUMENTS
    code=$1 line=$2
    shift 2
    EMBREE_ABSENT=1 LD_PRELOAD=$dir/shim.so expect "$code" . "$@"
    grep -qE -- "$line" "$dir/out" "$dir/err" || bad "raydiff $*: no line like /$line/"
}
without 77 "^ *why: $absent" doctor
[ "$(grep -cE "^ *why: $absent" "$dir/out")" -eq 2 ] || bad 'doctor: not both engines are absent'
for engine in embree embree_robust cpu,embree_robust,embree; do
    without 77 "^engine embree.* answered 0 of 1, cannot run here 1: $absent" check $tree --repeat 1 --engine "$engine"
done
for mode in embree:sse2:8 embree:all embree:refit,embree:dynamic; do
    without 77 "$absent" check $tree --repeat 1 --engine "cpu,$mode"
done
without 77 "^raydiff check: --engine: $absent" check $tree --repeat 1 --engine embree:avx2
without 77 "^raydiff render: $absent" render sphere:n=2 -w 8 -h 8 --engine embree --out "$dir/x.png"
without 77 "^raydiff diff: fewer than two of the engines can run here: $absent" diff sphere:n=2 -w 8 -h 8 --engine cpu,embree
without 77 "^raydiff fuzz: $absent" fuzz --engine cpu,embree --trials 5 --jobs 1 --corpus none --dir "$dir/without"
without 77 'embree .*skipped: '"$absent" replay fuzz/corpus/sentinel.trial --engine embree
without 77 ' 0 failed, [1-9][0-9]* skipped' conform 'closest.embree.-.-.-.mt.soup.mixed.1'
# What was not named goes on without it, and that is told.
without 0 "^  embree skipped: Embree: no library: " check $tree --repeat 1 --layout f32
without 0 "^left out: $absent" diff sphere:n=2 -w 8 -h 8
# Nothing else minds.
without 0 '^conclusion: 1 of 1 rows agree' check $tree --repeat 1 --engine cpu --layout f32

# Each function that is called is looked for, and each that is looked for is called.
functions=$(sed -n 's/^    X(\([A-Za-z0-9]*\)).*/\1/p' ref/engines/embree_library.h)
[ "$(echo $functions | wc -w)" -gt 30 ] || bad 'the list of functions is not read'
called=$(cat ref/engines/*.c | grep -ohE '\brtc\.[A-Z][A-Za-z0-9]*' | sort -u)
for function in $functions; do
    echo "$called" | grep -qxE "rtc\.($function|$(echo "$function" | sed 's/[0-9]*$//'))" || bad "rtc$function is not called"
    EMBREE_LACKS=rtc$function LD_PRELOAD=$dir/shim.so expect 77 . check sphere:n=1 --count 10 --repeat 1 --engine embree
    grep -qE "cannot run here 1: Embree: libembree[34]\.so\.[34] has no rtc$function\$" "$dir/out" || bad "rtc$function: not told"
done

echo "embree_opened: $failed failed"
[ "$failed" -eq 0 ]
