#!/bin/sh
# The exit codes of every command, each in the situations that its help tells: all is well, something is wrong, bad
# input, an engine that fails, a driver that is not there, nothing that was run though it was wanted. Where gcc has its
# LeakSanitizer, whatever way a command ends, it has given its memory back.
#   sh tests/values/exits.sh RAYDIFF [PART...]     PART: judging, findings, files, mixed, folders, unwritable
set -u
raydiff=$1
shift
. tests/values/compare.sh
. tests/values/tracers.sh
tried=0

# Variables under which raydiff ends with 23 if it keeps memory, and lists what on standard error; not the tracers that
# it starts, which have a limit of addresses. A sanitized build looks for itself.
freed=
lsan=$(cc -print-file-name=liblsan.so)
echo '#include <stdlib.h>
__attribute__((constructor)) static void alone(void) { unsetenv("LD_PRELOAD"); }' >"$dir/alone.c"
cc -shared -fPIC -o "$dir/alone.so" "$dir/alone.c" || bad 'alone.c is not compiled'
watched="LD_PRELOAD=$lsan:$dir/alone.so LSAN_OPTIONS=exitcode=23:print_suppressions=0:suppressions=tests/lsan.supp"
echo '#include <stdlib.h>
int main(void) { return malloc(77) == NULL; }' >"$dir/keeps.c"
cc -O0 -o "$dir/keeps" "$dir/keeps.c" || bad 'keeps.c is not compiled'
if [ -e "$lsan" ] && env $watched "$raydiff" list layouts >"$dir/text" 2>&1; then
    freed=$watched
    env $freed "$dir/keeps" >"$dir/text" 2>&1
    [ $? -eq 23 ] || bad 'a program that keeps memory does not end with 23'
else
    echo 'SKIP memory that is not given back: no LeakSanitizer that can be loaded'
fi
# What the sanitizer tells of itself is no word of raydiff.
own_words() { [ ! -s "$dir/err" ] || sed -i '/^Warning: REAL(/d' "$dir/err"; }
kept() { sed -n 's/^ *#[1-9][0-9]* 0x[0-9a-f]* in //p' "$dir/err" | head -n 2 | tr '\n' ' '; }

# exit code, arguments of raydiff. 2 has its reason on standard error, or in the row of what failed or was left out.
ends() {
    wanted=$1
    shift
    tried=$((tried + 1))
    timeout 20 env $freed "$raydiff" "$@" >"$dir/text" 2>"$dir/err" </dev/null
    code=$?
    own_words
    [ "$code" -ne 23 ] || bad "raydiff $*: memory is kept: $(kept)"
    [ "$code" -eq "$wanted" ] || bad "raydiff $*: exit $code, not $wanted: $(tail -n 1 "$dir/err")"
    [ "$code" -ne 2 ] || [ -s "$dir/err" ] || grep -qE '(  failed|left out): [^ ]' "$dir/text" || bad "raydiff $*: no reason on standard error"
}
# The tracers that a part plays.
tracers_of() {
    case $1 in
    judging | findings) echo sees blind refuser ender ;;
    files) echo sees blind careless ;;
    mixed) echo blind ;;
    folders) echo sees blind ;;
    esac
}
for tracer in $(for part in ${*:-judging findings files}; do tracers_of "$part"; done | tr ' ' '\n' | sort -u); do tracer "$tracer"; done
sees="pipe:$dir/sees" blind="pipe:$dir/blind" careless="pipe:$dir/careless"
refuser="pipe:$dir/refuser" ender="pipe:$dir/ender" dies="pipe:false" missing="pipe:$dir/missing"
none='--engine vulkan --driver no-such-driver'
gone="$dir/gone"
echo 'no file of this kind' >"$dir/other.obj"
head -c 64 /dev/zero >"$dir/zeros.trial"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$dir/one.obj"

# exit code, file of answers
verified() {
    tried=$((tried + 1))
    env $freed "$raydiff" verify <"$dir/$2" >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -ne 23 ] || bad "raydiff verify <$2: memory is kept: $(kept)"
    [ "$code" -eq "$1" ] || bad "raydiff verify <$2: exit $code, not $1"
}
judging() {
    few='--count 100'
    name=closest.cpu.f32.median.robust.mt.soup.random.1
    ends 0 check soup:n=50 --engine cpu,brute --layout f32 --repeat 1 $few
    ends 0 check soup:n=50 --engine "$sees" --repeat 1 $few
    ends 0 check soup:n=50 --driver no-such-driver --layout f32 --repeat 1 $few # an engine that was not named
    ends 1 check soup:n=50 --engine "$blind" --repeat 1 $few
    ends 1 check soup:n=50 --engine "$refuser" --repeat 1 $few # vacuous
    ends 2 check "$gone.obj" $few
    ends 2 check "$dir/other.obj" $few
    ends 2 check soup:n=50 --json "$gone/file" --engine cpu --layout f32 --repeat 1 $few
    ends 3 check soup:n=50 --engine "$ender" --repeat 1 $few
    ends 3 check soup:n=50 --engine "$dies" --repeat 1 $few
    ends 3 check soup:n=50 --engine "cpu,$dies,$blind" --repeat 1 $few
    ends 77 check soup:n=50 $none $few
    ends 77 check soup:n=50 --engine "$missing" $few
    ends 0 leaks sphere:n=4 --engine cpu --layout f32 --tri woop --box watertight --count 1000
    ends 0 leaks sphere:n=4 --driver no-such-driver --layout f32 --tri woop --count 1000
    ends 1 leaks sphere:n=4 --engine cpu --layout f32 --tri woop --box watertight --count 999 # too few rays
    ends 1 leaks sphere:n=4 --engine "$refuser" --count 1000
    ends 2 leaks "$dir/one.obj" --engine cpu $few
    ends 3 leaks sphere:n=4 --engine "$dies" --count 1000
    ends 77 leaks sphere:n=4 $none --count 1000
    ends 0 conform $name $few
    ends 1 conform --engine "$blind" 'closest.*.soup.random.1' $few
    ends 1 conform --engine "$refuser" 'closest.*.soup.random.1' $few
    ends 2 conform 'closest.warp.*'
    ends 3 conform --engine "$dies" 'closest.*.soup.random.1' $few
    ends 77 conform closest.vulkan.f32.median.robust.mt.soup.random.1 --driver no-such-driver
    ends 1 conform closest.vulkan.f32.median.robust.mt.soup.random.1 --driver no-such-driver --require vulkan
    ends 0 conform 'hard.01*.closest.cpu.f32.median.robust.mt'
    ends 1 conform --hard --engine "$blind" 'hard.01*.closest.*'
    ends 2 conform 'hard.99*'
    ends 3 conform --hard --engine "$dies" 'hard.01*.closest.*'
    ends 77 conform 'hard.01*.closest.vulkan.f32.median.robust.mt' --driver no-such-driver
    # Answers from files.
    "$raydiff" gen sphere:n=4 --count 20 >"$dir/asked"
    awk -f fuzz/samples/tracer.awk "$dir/asked" >"$dir/answers"
    sed 's/^h .*/m/' "$dir/answers" >"$dir/misses"
    { grep '^from' "$dir/answers"; echo 'refused too many'; } >"$dir/refused"
    ends 0 gen sphere:n=4 --count 20
    ends 2 gen "$gone.obj"
    verified 0 answers
    verified 1 misses
    verified 2 other.obj
    verified 3 refused
    for command in check leaks conform gen verify judge; do ends 2 $command --frobnicate; done
}

# --brief is of the whole page the first line, those of engines that came to no answer, and what each answered.
briefly() { # engines
    "$raydiff" replay fuzz/corpus/rounded-outward.trial --engine "$1" --time 2 >"$dir/whole" 2>"$dir/err"
    "$raydiff" replay fuzz/corpus/rounded-outward.trial --engine "$1" --time 2 --brief >"$dir/text" 2>"$dir/err"
    { sed -n 1p "$dir/whole"; grep -E '^  [^ ].* (crashed|hung|failed): |^engine [^ ].* answered ' "$dir/whole"; } >"$dir/parts"
    grep -qE ' (crashed|hung): ' "$dir/parts" && cmp -s "$dir/parts" "$dir/text" ||
        bad "replay --brief --engine $1: not the lines of the whole page"
}
# A file tells of one end; a tracer that ends in that way still fails, one that ends in another way is told as such.
endings() {
    sed '1i #include <unistd.h>
        s/^        struct ray \*ray = /        if (q.rays > 0) for (;;) pause();&/' fuzz/samples/sample_tracer.c >"$dir/hanger.c"
    sed 's/^        struct ray \*ray = /        if (q.rays > 0) abort();&/' fuzz/samples/sample_tracer.c >"$dir/aborts.c"
    sed 's/"RDRA", 1, 0/"RDRX", 1, 0/' fuzz/samples/sample_tracer.c >"$dir/babbler.c"
    for tracer in hanger aborts babbler; do cc -O1 -o "$dir/$tracer" "$dir/$tracer.c" || bad "$tracer is not compiled"; done
    for kind in crash hang protocol missed clean; do
        cause=unexplained
        [ $kind != missed ] || cause=scale
        expect=pipe:x.-.$kind.$cause
        [ $kind != clean ] || expect=clean
        sed "s/^expect .*/expect $expect/" fuzz/corpus/rounded-outward.trial >"$dir/$kind.trial"
        for tracer in sees blind ender aborts hanger babbler; do
            still=0 as=1
            case $kind,$tracer in
            clean,sees) still=0 as=0 ;;
            clean,blind) still=1 as=1 ;;
            crash,ender | crash,aborts | hang,hanger | protocol,babbler | missed,blind) still=1 as=0 ;;
            # What is not read as an answer and what dies are told apart where a file tells of neither.
            crash,babbler | protocol,ender | protocol,aborts | protocol,hanger) continue ;;
            *,ender | *,aborts | *,hanger | *,babbler) still=3 as=3 ;;
            esac
            ends $still replay "$dir/$kind.trial" --engine "pipe:$dir/$tracer" --time 2
            ends $as replay "$dir/$kind.trial" --engine "pipe:$dir/$tracer" --time 2 --as-expected
        done
    done
}
findings() {
    endings
    few='--rays 40 --jobs 1 --corpus none'
    f=$dir/found
    trial=fuzz/corpus/wrong-item.trial
    ends 0 fuzz --trials 64 --engine cpu,brute --layout f32 --dir "$dir/clean" $few
    ends 1 fuzz --trials 64 --engine cpu --layout rtrs_rf --faithful --until 1 --no-shrink --dir "$f" $few
    ends 1 fuzz --trials 64 --engine "$blind" --dir "$dir/blind.found" --until 1 --no-shrink $few
    ends 1 fuzz --trials 64 --engine "$refuser" --dir "$dir/refused.found" $few # vacuous
    ends 1 fuzz --trials 64 --engine "$refuser" --dir "$dir/refused.found" $few # and nothing is left to play
    ends 1 fuzz --trials 64 --engine cpu --pairs 1000 --layout f32 --dir "$dir/pairs" $few # pairs met too seldom
    ends 2 fuzz --trials 64 --engine cpu --dir "$dir/one.obj" $few
    ends 2 fuzz --trials 64 --engine cpu --seed 2 --dir "$f" # another campaign
    ends 3 fuzz --trials 64 --engine "$dies" --dir "$dir/no" $few
    ends 77 fuzz --trials 64 --engine "$missing" --dir "$dir/no" $few
    ends 77 fuzz --trials 64 $none --dir "$dir/no" $few
    printf '%s until - a word docs/fuzzing.md\n' 'cpu.rtrs_rf.*.*' >"$dir/known"
    "$raydiff" fuzz --dir "$f" --trials 65 --no-shrink --baseline "$dir/known" >"$dir/text" 2>&1
    ends 0 fuzz --dir "$f" --trials 65 --no-shrink --baseline "$dir/known"
    ends 2 fuzz --dir "$f" --trials 65 --baseline "$gone"
    ends 0 merge --to "$dir/merged" "$f"
    ends 2 merge --to "$dir/merged2" "$gone"
    ends 0 min "$f"
    for one in $(ls "$f" | grep '\.missed\.'); do # one of several shows no more, wherever it stands: its ray meets nothing
        rm -rf "$dir/less"
        cp -r "$f" "$dir/less"
        for of in "$dir/less/$one"/*.trial; do
            printf '%s\n' 'raydiff trial 1' "expect $one" 'builder median leaf 4 eps 0.02' 'box robust' 'tri mt' 'query closest' \
                'vertices 3' '0 0 0' '1 0 0' '0 1 0' 'triangles 1' '0 1 2' 'rays 1' '7 7 7 0 0 1 0 9' end >"$of"
        done
        ends 1 min "$dir/less"
    done
    sed 's/^expect cpu\.[^.]*/expect cpu.f32/' "$trial" >"$dir/cured.trial"
    ends 1 min "$dir/cured.trial" --out "$dir/cured.out" # shows no more
    ends 2 min "$gone"
    ends 2 min "$dir/zeros.trial"
    sed 's/^expect cpu\.[^.]*/expect vulkan.f32/' "$trial" >"$dir/gpu.trial"
    ends 77 min "$dir/gpu.trial" --driver no-such-driver --out "$dir/gpu.out"
    ends 1 replay "$trial"
    ends 0 replay "$trial" --as-expected
    ends 0 replay "$dir/cured.trial"
    ends 1 replay "$dir/cured.trial" --as-expected # it is gone
    ends 0 replay fuzz/corpus/rounded-outward.trial --engine cpu --as-expected
    ends 1 replay fuzz/corpus/rounded-outward.trial --engine cpu --layout rtrs_rf_paper --as-expected
    ends 1 replay "$trial" "$dir/cured.trial" --as-expected # one of two
    ends 1 replay fuzz/corpus/bad-rays.trial "$trial" # one of two
    ends 1 replay "$trial" fuzz/corpus/bad-rays.trial
    ends 0 replay fuzz/corpus/bad-rays.trial --engine cpu
    # A named engine without a layout stands in for one that has lost the ray by its layout.
    ends 0 replay fuzz/corpus/rounded-inward.trial --engine embree --brief
    grep -q ': does not fail$' "$dir/text" || bad 'replay: not told that Embree finds the triangle'
    ends 1 replay fuzz/corpus/rounded-inward.trial --engine "$blind"
    grep -q ' <- expected$' "$dir/text" || bad 'replay: a miss of a tracer is not what is expected'
    ends 2 replay "$gone"
    ends 2 replay "$dir/zeros.trial"
    ends 2 replay "$trial" "$gone"
    ends 3 replay fuzz/corpus/bad-rays.trial --engine "$dies"
    ends 77 replay "$dir/gpu.trial" --driver no-such-driver
    ends 77 replay fuzz/corpus/bad-rays.trial $none
    for engine in "$dies" "cpu,fast,$dies" 'cpu,pipe:sleep 20'; do briefly "$engine"; done
    ends 0 export fuzz/corpus/bad-rays.trial --engine vulkan --to "$dir/exported"
    ends 2 export "$gone" --to "$dir/exported2"
    ends 0 explain soup:n=50 --index 0 --engine cpu --layout f32
    ends 1 explain "$trial"
    ends 1 explain cornell --rays primary --index 0 --engine "$blind"
    ends 2 explain "$gone"
    ends 2 explain soup:n=50 --index 10000000 --engine cpu --layout f32
    ends 3 explain soup:n=50 --index 0 --engine "$dies"
    ends 3 explain soup:n=50 --index 0 --engine "$ender"
    ends 77 explain soup:n=50 --index 0 $none --layout f32
    for command in fuzz merge min replay export explain bisect; do ends 2 $command --frobnicate; done
    # What was read before an option turns out to be of no use is given back.
    for subject in "min $f" "min $trial" "explain $trial" "export $trial --engine cpu --to $dir/unused" "fuzz --dir $f"; do
        for option in '--driver no-such-driver' '--peer-time 3' '--engine fast' '--layout f32'; do
            case "$subject $option" in explain*--engine* | explain*--layout*) continue ;; esac # of use
            ends 2 $subject $option
        done
    done
    ends 2 replay "$trial" --peer-time 3
    ends 2 merge "$f" --to "$dir/unused" --layout f32
    [ ! -e "$dir/unused" ] || bad 'something is written though an option is of no use'
}

files() {
    few='--parts check --quick --engine cpu --layout f32 --count 100'
    printf '\377\330' >"$dir/one.json"
    ends 0 report soup:n=50 --out "$dir/r.html" $few
    ends 1 report soup:n=50 --out "$dir/r.html" --parts check --quick --count 100 --engine "$blind"
    ends 2 report soup:n=50 --out "$gone/r.html" $few
    ends 2 report "$gone.obj" --out "$dir/r.html" $few
    ends 2 report --check "$dir/one.json" --out "$dir/r.html"
    ends 3 report soup:n=50 --out "$dir/r.html" --parts check --quick --count 100 --engine "$dies"
    ends 77 report soup:n=50 --out "$dir/r.html" --parts check --quick --count 100 $none
    # What a report found is no better for a file that it cannot write behind it.
    if [ -w /dev/full ]; then
        ends 3 report soup:n=50 --out "$dir/r.html" --parts check --quick --count 100 --engine "$dies" --json /dev/full
        ends 2 report soup:n=50 --out "$dir/r.html" --parts check --quick --count 100 --engine "$blind" --json /dev/full
        ends 2 report soup:n=50 --out "$dir/r.html" $few --json /dev/full
    fi
    ends 0 doctor
    ends 77 doctor --driver no-such-driver
    ends 2 doctor --json "$gone/file"
    ends 0 list layouts
    ends 2 list nothing
    ends 0 scene info soup:n=10
    ends 2 scene info "$gone.obj"
    ends 2 scene info "$dir/other.obj"
    size='--width 16 --height 16'
    ends 0 render sphere:n=4 --engine cpu --out "$dir/a.png" $size
    ends 0 render sphere:n=4 --engine cpu --out "$dir/b.png" $size
    ends 0 render soup:n=4 --engine cpu --out "$dir/c.png" $size
    ends 1 render sphere:n=4 --show class --engine "$blind" --out "$dir/d.png" $size
    ends 2 render "$gone.obj" --out "$dir/d.png" $size
    ends 2 render sphere:n=4 --engine cpu --out "$gone/d.png" $size
    ends 3 render sphere:n=4 --engine "$dies" --out "$dir/d.png" $size
    ends 77 render sphere:n=4 $none --out "$dir/d.png" $size
    ends 0 diff "$dir/a.png" "$dir/b.png"
    ends 1 diff "$dir/a.png" "$dir/c.png"
    ends 2 diff "$dir/a.png" "$gone.png"
    ends 2 diff "$dir/a.png" "$dir/one.obj"
    ends 0 diff sphere:n=4 --engine cpu,fast $size
    ends 1 diff sphere:n=4 --engine "cpu,$blind" $size
    ends 3 diff sphere:n=4 --engine "cpu,$dies" $size
    ends 77 diff sphere:n=4 --engine cpu,vulkan --driver no-such-driver $size
    # Two names of one engine are refused, also behind another that runs.
    for engines in brute,cpu cpu,brute vulkan,brute,cpu vulkan,cpu,brute; do
        "$raydiff" diff sphere:n=4 --engine $engines --handler naive $size >"$dir/text" 2>"$dir/err"
        case $?,$engines in
        2,*) grep -q 'brute is selected by two names' "$dir/err" || bad "diff of $engines: not refused as two names" ;;
        77,vulkan*) echo "SKIP two names behind engine vulkan: $(tail -n 1 "$dir/err")" ;;
        *) bad "diff of $engines, which are two names of one engine" ;;
        esac
    done
    ends 0 bench builders --scene sphere:n=4 --rounds 1
    ends 1 bench error --scene sphere:n=4 --engine "$blind" --count 50 --rounds 1
    ends 0 bench matrix --scene sphere:n=4 --engine "$sees" --count 50 --rounds 1
    ends 1 bench matrix --scene sphere:n=4 --engine "$blind" --count 50 --rounds 1
    ends 1 bench matrix --scene sphere:n=4 --engine "$careless" --count 50 --rounds 1
    # A named layout or storage that does not hold the scene is told, and counts beside others that do.
    printf 'v 0 0 0\nv 1e6 0 0\nv 1e6 1e6 0\nv 0 1e6 0\nf 1 2 3\nf 1 3 4\n' >"$dir/far.obj"
    for of in error 'matrix --engine cpu' 'traffic --scheduler depth_first'; do
        for named in '--layout f32,rf16' '--layout rf16'; do
            [ "$of" != error ] || named="$named --engine cpu --tri mt --box robust"
            ends 2 bench $of --scene "$dir/far.obj" $named --count 50
        done
        [ "$of" = error ] || ends 2 bench $of --scene sphere:n=4 --store quantised,indexed --count 50
    done
    ends 0 bench matrix --scene "$dir/far.obj" --engine cpu --store indexed,compact --count 50 --rounds 1 --threads 1
    ends 2 bench traffic --scheduler depth_first --scene sphere:n=4 --layout f32,rf16 --store indexed,compact --count 50
    ends 0 bench traffic --scheduler depth_first --scene sphere:n=4 --layout f32,rf16 --count 50
    ends 2 bench traffic --scheduler depth_first --scene sphere:n=4 --store baldwin_webber --count 50 # the test needs vertices
    ends 2 bench nothing
    ends 2 bench builders --scene "$gone.obj"
    ends 3 bench error --scene sphere:n=4 --engine "$dies" --count 50 --rounds 1
    ends 77 bench matrix --scene sphere:n=4 --rounds 1 $none
    for named in "$missing" "cpu,$missing"; do ends 77 bench fast --scene sphere:n=4 --engine "$named" --count 50 --rounds 1; done
    # A scene that cannot be read ends what several are given to, wherever it stands among them.
    for of in "$gone.obj sphere:n=4" "sphere:n=4 $gone.obj" "sphere:n=3 $gone.obj sphere:n=4"; do
        list=$(echo "$of" | tr ' ' ';')
        ends 2 scene info $of
        ends 2 scene info $of --json
        ends 2 leaks $of --engine cpu --layout f32 --tri woop --box watertight --count 1000
        ends 2 bench builders --scene "$list" --rounds 1
        ends 2 bench traffic --scene "$list" --scheduler depth_first --layout f32 --count 50
        ends 2 bench tightness --scene "$list" --count 50
        for benchmark in oracle 'spawn --engine cpu --layout f32 --tri mt' fast 'worlds --instances 3' 'layouts --layout f32 --engine cpu' \
            "frames --engine cpu --layout f32 --frames 1 --size 8x8 --out $dir/frames"; do
            rounds='--count 50 --rounds 1'
            case $benchmark in frames*) rounds= ;; esac
            ends 2 bench $benchmark --scene "$list" $rounds
        done
    done
    printf 'camera\n' >"$dir/broken.json"
    ends 2 construct "$dir/one.obj" --out "$gone/x.json"
    ends 0 precompute --scene soup:n=20 --builder median --out "$dir/tree.json"
    ends 0 precompute --scene soup:n=20 --verify "$dir/tree.json"
    ends 1 precompute --scene soup:n=20,seed=2 --verify "$dir/tree.json" # too small boxes
    ends 2 precompute --scene soup:n=9 --verify "$dir/tree.json"
    ends 2 precompute --scene soup:n=20 --verify "$dir/broken.json"
    ends 0 tree tests/golden/input/mine.tree
    ends 1 tree tests/golden/input/faulty.tree
    ends 2 tree "$dir/broken.json"
    for command in report doctor list scene render diff bench construct precompute tree; do ends 2 $command --frobnicate; done
}

# The worst of what happened ends a command, in any order of scenes and engines: 3 before 2, 1, 77 and 0.
worst() {
    code=0
    for happened in $*; do
        case $code.$happened in
        *.cpu | *.shows) ;;
        0.missing) code=77 ;;
        0.blind | 77.blind | 0.cured | 77.cured) code=1 ;;
        [01].gone | 77.gone) code=2 ;;
        *.dies) code=3 ;;
        esac
    done
    echo "$code"
}
mixed() {
    small="--count 100 --layout f32"
    for who in 'cpu' 'cpu blind' 'cpu missing' 'cpu dies' 'cpu blind missing' 'cpu missing blind' 'cpu blind dies' 'cpu dies blind' \
        'cpu missing dies' 'cpu dies missing' 'cpu blind missing dies' 'cpu dies missing blind' 'cpu missing dies blind'; do
        engines=cpu
        for one in ${who#cpu}; do eval "engines=\$engines,\$$one"; done
        for of in sphere:n=4 "sphere:n=4 $gone.obj" "$gone.obj sphere:n=4"; do
            unread=
            [ "$of" = sphere:n=4 ] || unread=gone
            want=$(worst $who $unread)
            ends "$want" check $of --engine "$engines" --repeat 1 $small
            ends "$want" bench error --scene "$(echo "$of" | tr ' ' ';')" --engine "$engines" --rounds 1 $small --tri mt --box robust
            ends "$want" bench matrix --scene "$(echo "$of" | tr ' ' ';')" --engine "$engines" --rounds 1 $small
            [ -n "$unread" ] || [ "$who" = cpu ] || ends "$want" diff $of --engine "$engines" --width 16 --height 16
            # A report is of scenes that can be read, or it is not written.
            [ -n "$unread" ] || ends "$want" report $of --engine "$engines" --parts check --quick $small --out "$dir/r.html"
        done
        ends "$(worst $who)" conform 'closest.*.sphere.random.1' --engine "$engines" --builder median --box robust --tri mt $small
        ends "$(worst $who)" conform 'hard.01*.closest.*' --engine "$engines" --builder median --box robust --tri mt --layout f32
    done
    # What a report found counts although its numbers cannot be written.
    [ ! -w /dev/full ] || for who in 'cpu' 'cpu blind' 'cpu missing' 'cpu dies' 'cpu blind dies'; do
        engines=cpu
        for one in ${who#cpu}; do eval "engines=\$engines,\$$one"; done
        ends "$(worst $who gone)" report sphere:n=4 --engine "$engines" --parts check --quick $small --out "$dir/r.html" --json /dev/full
    done
    # A named layout that refuses is told where the rows stand.
    "$raydiff" check sphere:n=100 --engine "cpu,$blind" --layout rf16,f32 --repeat 1 --count 100 >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -eq 2 ] && grep -q '^refused rf16 ' "$dir/text" || bad "a layout that refuses beside what is WRONG: exit $code"
}

# What becomes of a tracer before its findings are shrunk: it shows them, it is cured, missing or dies, or no command of
# it is given.
becomes() { # tracer, what
    cp "$dir/blind" "$dir/$1"
    case $2 in
    cured) cp "$dir/sees" "$dir/$1" ;;
    missing) rm "$dir/$1" ;;
    dies) printf '#!/bin/sh\nexit 9\n' >"$dir/$1" ;;
    esac
    [ "$2" = gone ] || named="$named,pipe:$dir/$1"
}
# The worst of all findings of a folder ends its shrinking, in whatever order they stand there; the JSON has the code
# of each.
folders() {
    for tracer in one two three; do cp "$dir/blind" "$dir/$tracer"; done
    all="pipe:$dir/one,pipe:$dir/two,pipe:$dir/three"
    "$raydiff" fuzz --trials 64 --engine "$all" --until 1 --no-shrink --dir "$dir/pipes" --rays 40 --jobs 1 --corpus none \
        >"$dir/text" 2>&1
    each="$(grep -o '^{"signature":"pipe:[a-z]*[^"]*"' "$dir/pipes/findings.jsonl" | awk '!seen[$0]++' | sed 's/.*pipe://; s/[.].*//')"
    [ "$(echo "$each" | sort -u | wc -l)" -eq 3 ] && [ "$(echo "$each" | tail -n 1)" != "$(echo "$each" | head -n 1)" ] ||
        bad "findings of three tracers, one after the other: $(echo $each)"
    for first in shows cured gone dies missing; do
        for second in shows cured gone dies missing; do
            for third in shows cured gone dies missing; do
                [ "$first" != "$second" ] && [ "$first" != "$third" ] && [ "$second" != "$third" ] || continue
                rm -rf "$dir/shrunk" && cp -r "$dir/pipes" "$dir/shrunk"
                named=
                becomes one "$first" && becomes two "$second" && becomes three "$third"
                codes=$(for tracer in $each; do
                    case $tracer in one) worst "$first" ;; two) worst "$second" ;; three) worst "$third" ;; esac
                done)
                ends "$(worst "$first" "$second" "$third")" min "$dir/shrunk" --asks 3 --engine "${named#,}" --json "$dir/json"
                told=$(awk -f tests/values/flat.awk "$dir/json" | sed -n 's/^findings.*[.]exit=//p')
                [ "$told" = "$codes" ] || bad "min of $first, $second and $third: its JSON has $(echo $told), not $(echo $codes)"
                grep -qx " *\"exit\": $code,*" "$dir/json" || bad "min of $first, $second and $third: its JSON has another code"
            done
        done
    done
}

# Arguments of raydiff with TO in place of a file that cannot be written: exit code 2, one line on standard error that
# names it, and nothing that was not there before.
unwritten() {
    case $* in
    *TO.*) targets="$gone/file $dir/one.obj/file" ;; # an ending or several files
    *TO*) targets="$gone/file $dir/one.obj/file $dir/taken $full" ;;
    esac
    for target in $targets; do
        told=$(echo "$*" | sed "s|TO|$target|")
        find "$dir" | sort >"$lists/before"
        # shellcheck disable=SC2086 # words of a command
        $as timeout 20 env $freed "$program" $told >"$lists/text" 2>"$dir/err" </dev/null
        code=$?
        own_words
        find "$dir" | sort >"$lists/after"
        tried=$((tried + 1))
        [ "$code" -eq 2 ] || bad "raydiff $told: exit $code, not 2"
        [ "$(wc -l <"$dir/err")" -eq 1 ] && grep -qF "$target" "$dir/err" || bad "raydiff $told: not one line that names the file"
        cmp -s "$lists/before" "$lists/after" || bad "raydiff $told: $(diff "$lists/before" "$lists/after" | head -n 2)"
        # Nothing is played before that is known, but of a full disk; merge tells what it reads.
        case $1:$target in
        merge:* | *:"$full") ;;
        *) [ ! -s "$lists/text" ] || bad "raydiff $told: is played first: $(head -n 1 "$lists/text")" ;;
        esac
    done
}
unwritable() {
    lists=$(mktemp -d) || exit 4
    trap 'rm -rf "$dir" "$lists"' EXIT
    full=/dev/full as= program=$raydiff
    [ -w /dev/full ] || full=
    found=$dir/campaign trial=fuzz/corpus/wrong-item.trial
    "$raydiff" fuzz --trials 64 --engine cpu --layout rtrs_rf --faithful --no-shrink --dir "$found" --rays 40 --jobs 1 \
        --corpus none >"$dir/text" 2>&1
    mkdir "$dir/taken"
    : >"$dir/taken/file"
    : >"$dir/err"
    name=closest.cpu.f32.median.robust.mt.soup.random.1
    one='sphere:n=4 --engine cpu --layout f32 --count 50'
    unwritten check soup:n=50 --engine cpu --layout f32 --repeat 1 --count 100 --json TO
    unwritten leaks sphere:n=4 --engine cpu --layout f32 --tri woop --box watertight --count 1000 --json TO
    unwritten conform $name --count 100 --junit TO
    for out in markdown html junit; do unwritten conform hard.01-axis.closest.cpu.f32.median.robust.mt --$out TO; done
    for out in json csv svg; do unwritten bench matrix --scene $one --rounds 1 --threads 1 --$out TO; done
    unwritten bench frames --scene sphere:n=4 --frames 2 --size 16x16 --engine cpu --layout f32 --out TO.x
    for out in json junit tap jsonl; do unwritten fuzz --trials 64 --dir "$found" --corpus none --no-shrink --$out TO; done
    unwritten fuzz --trials 2 --engine cpu --layout f32 --corpus none --jobs 1 --rays 40 --dir TO.x
    unwritten merge "$found" --to TO
    unwritten min $trial --out TO
    unwritten min $trial --out "$lists/small.trial" --json TO
    unwritten replay fuzz/corpus/bad-rays.trial --engine cpu --json TO
    unwritten export fuzz/corpus/bad-rays.trial --engine vulkan --to TO
    for out in json html svg; do unwritten explain soup:n=50 --index 0 --engine cpu --layout f32 --$out TO; done
    unwritten report soup:n=50 --parts check --quick --engine cpu --layout f32 --count 100 --out TO
    unwritten report soup:n=50 --parts check --quick --engine cpu --layout f32 --count 100 --out "$lists/r.html" --json TO
    unwritten doctor --json TO
    for end in obj ply json; do unwritten scene convert sphere:n=4 TO.$end; done
    picture='sphere:n=4 --camera-light-strength 1 --width 16 --height 16'
    unwritten render $picture --engine cpu --out TO
    unwritten render $picture --engine cpu --out "$lists/r.png" --json TO
    unwritten render $picture --engine cpu --out "$lists/r.png" --paths TO.csv
    unwritten render sphere:n=4 --width 16 --height 16 --engine cpu --out "$lists/r.png" --show t --csv TO
    unwritten diff $picture --engine cpu,fast --out TO
    unwritten diff $picture --engine cpu,fast --json TO
    unwritten precompute --scene soup:n=20 --builder median --out TO
    unwritten tree tests/golden/input/mine.tree --json TO
    unwritten gen sphere:n=4 --count 20 --out TO
    unopened
    locked
}
# It is known before an engine or a device is opened: where none is here, too, that is what is told.
unopened() {
    none='--driver no-such-driver' there=$dir/no-such-folder/x
    small='sphere:n=2 --width 8 --height 8 --engine vulkan'
    while read -r command; do
        tried=$((tried + 1))
        # shellcheck disable=SC2086 # words of a command
        timeout 20 "$raydiff" $command $none >"$dir/text" 2>"$dir/err" </dev/null
        code=$?
        [ "$code" -eq 2 ] && grep -qF "$there" "$dir/err" || bad "raydiff $command $none: exit $code: $(tail -n 1 "$dir/err")"
    done <<END
check sphere:n=2 --engine vulkan --json $there
leaks sphere:n=3 --engine vulkan --layout f32 --json $there
conform closest.vulkan.f32.* --junit $there
explain sphere:n=3 --index 0 --engine vulkan --layout f32 --json $there
fuzz --trials 2 --engine vulkan --corpus none --dir $dir/unopened --json $there
replay fuzz/corpus/bad-rays.trial --engine vulkan --json $there
build sphere:n=2 --json $there
tree sphere:n=2 --from rayquery --json $there
tree sphere:n=2 --from rayquery --save $there
report sphere:n=2 --engine vulkan --parts check --out $there
diff $small,cpu --out $there
diff $small,cpu --json $there
render $small --out $there
render $small --out $dir/u.png --json $there
render $small --out $dir/u.png --paths $there.csv
render $small --out $dir/u.png --show t --csv $there
render $small --benchmark --benchmark-out $there
bench frames --scene sphere:n=2 --engine vulkan --layout f32 --frames 1 --size 8x8 --out $there
bench error --scene sphere:n=2 --engine vulkan --count 10 --rounds 1 --csv $there
bench error --scene sphere:n=2 --engine vulkan --count 10 --rounds 1 --svg $there
bench matrix --scene sphere:n=2 --engine vulkan --count 10 --rounds 1 --json $there
END
}
# A folder of findings that may only be read: to whom it is, who is not root.
locked() {
    cp -r "$found" "$dir/locked"
    find "$dir/locked" -type f -exec cksum {} + | sort >"$lists/sums"
    chmod -R a-w "$dir/locked" && chmod 755 "$dir"
    if [ "$(id -u)" -eq 0 ]; then
        as='setpriv --reuid 65534 --regid 65534 --clear-groups' program=$lists/raydiff
        cp "$raydiff" "$program" && chmod 755 "$lists"
        $as true 2>"$dir/err" || { echo "SKIP a folder that may only be read: no setpriv here"; return; }
    fi
    for command in "min $dir/locked" "fuzz --dir $dir/locked --trials 100 --no-shrink" "merge $found --to $dir/locked/all" \
        "check soup:n=20 --engine cpu --layout f32 --count 100 --repeat 1 --json $dir/locked/x.json" \
        "min $dir/locked/$(ls "$dir/locked" | sed -n 1p)/smallest.trial"; do
        tried=$((tried + 1))
        # shellcheck disable=SC2086 # words of a command
        $as timeout 20 "$program" $command >"$lists/text" 2>"$dir/err" </dev/null
        code=$?
        [ "$code" -eq 2 ] || bad "raydiff $command: exit $code, not 2"
        [ "$(wc -l <"$dir/err")" -eq 1 ] && grep -qF "$dir/locked" "$dir/err" || bad "raydiff $command: not one line that names it"
    done
    find "$dir/locked" -type f -exec cksum {} + | sort | cmp -s - "$lists/sums" || bad 'a folder that may only be read has changed'
    chmod -R u+w "$dir/locked"
}

for part in ${*:-judging findings files mixed folders unwritable}; do "$part"; done
echo "exits: $tried runs, $failed failed"
[ "$failed" -eq 0 ]
