#!/bin/sh
# Worlds and a tracer that is no part of raydiff (fuzz/samples/worlds.py): over the pipe, as text, as files. The
# verdicts are the same, lies are found each way as what they are and explained, and a tracer of scenes is told apart.
#   sh tests/worlds/worlds_piped.sh RAYDIFF [PART]     verdicts, lies, commands, scenes or files; most: all but lies; all without it
set -u
raydiff=$1
part=${2-all}
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
command -v python3 >/dev/null || { echo 'python3 is missing'; exit 77; }
. tests/scripts/expect.sh
honest="python3 fuzz/samples/worlds.py"
few='--count 100 --repeat 1'

# The last run printed a line like this.
shown() {
    grep -qE -- "$1" "$dir/out" || bad "no line like /$1/"
}

# The tracer with a mistake: name, a command of sed.
lie() {
    sed "$2" fuzz/samples/worlds.py >"$dir/$1.py"
    ! cmp -s fuzz/samples/worlds.py "$dir/$1.py" || bad "lie $1: no line of the sample is changed"
}

# The counts of the judged rows of JSON files are the same: prints each file whose are not those of the first.
others() {
    python3 -c '
import json, sys
counts = ["status", "rays", "hits", "counts", "wrong", "displacement"]
first, *rest = [[json.load(open(name))["rows"][0][k] for k in counts] for name in sys.argv[1:]]
print(*[name for name, row in zip(sys.argv[2:], rest) if row != first])' "$@" || echo 'one that cannot be read'
}

# A lie is found over the pipe and explained; rays that meet no edge, on which another triangle is as right.
found() { # lie, kind of WRONG, cause, world
    engine="python3 $dir/$1.py"
    expect 1 . check $4 --engine "pipe:$engine" --count 250 --repeat 1 --rays random
    shown "of 250 answers WRONG \(.*$2 [1-9]"
    expect 1 . explain $4 --engine "pipe:$engine" --count 250 --rays random
    shown "^conclusion: WRONG: [1-9][0-9]* of 250 answers, by $3\$"
}

# As text, too.
found_as_text() { # lie, kind of WRONG, world
    "$raydiff" gen $3 --count 250 --rays random | python3 "$dir/$1.py" --text | "$raydiff" verify >"$dir/out" 2>"$dir/err"
    [ $? -eq 1 ] || bad "verify: $1 is not found"
    shown "of 250 answers WRONG \(.*$2 [1-9]"
}

# An answer to an exported finding is among the right ones.
right() { # tracer
    $1 --text <"$dir/finding.txt" | python3 -c '
import re, sys
wanted = re.findall(r"# ray 0, right: (?:instance (\d+), geometry (\d+), triangle (\d+), (\S+).*, t in \[(\S+), (\S+)\]|a miss)", open(sys.argv[1]).read())
hits = [line.split() for line in sys.stdin if line[0] in "hm"]
hit = hits[0]
ok = any(w[0] == "" for w in wanted) if hit[0] == "m" else any(
    w[:3] == tuple(hit[4:7]) and w[3] in (hit[7], "either") and float(w[4]) <= float(hit[1]) <= float(w[5]) for w in wanted)
sys.exit(0 if ok and len(hits) == 1 else 1)' "$dir/finding.txt"
}

lie equal 's/if not mask & seen or/if mask != seen or/'

# --- the same verdicts each way, whatever rays may meet
verdicts() {
    for world in mixed placed-mirrored:n=1,count=4 crowd:n=5; do
        for how in '--modes all' '--modes mixed --query any' '--modes drawn'; do
            expect 0 . check $world --engine "pipe:$honest" $how $few --json "$dir/pipe.json"
            expect 0 . gen $world $how --count 100 --out "$dir/rays"
            [ "$(head -n 1 "$dir/rays")" = 'raydiff 2' ] || bad "gen $world: the first line"
            query=closest
            case $how in *any*) query=any ;; esac
            grep -qx "query $query" "$dir/rays" || bad "gen $world $how: the query is not $query"
            grep -q '^r .*0x' "$dir/rays" || bad "gen $world $how: rays are not exact"
            $honest --text <"$dir/rays" >"$dir/hits"
            "$raydiff" verify --json "$dir/text.json" <"$dir/hits" >"$dir/out" 2>"$dir/err" || bad "verify $world $how"
            expect 0 . judge $world "$dir/rays" "$dir/hits" --json "$dir/files.json"
            other=$(others "$dir/pipe.json" "$dir/text.json" "$dir/files.json")
            [ -z "$other" ] || bad "$world $how: judged otherwise than over the pipe: $other"
            "$raydiff" gen $world $how --count 100 --decimal >"$dir/decimal"
            ! grep -q 0x "$dir/decimal" || bad "gen $world --decimal: a number is hexadecimal"
            grep -qx "query $query" "$dir/decimal" || bad "gen $world $how --decimal: the query is not $query"
            $honest --text <"$dir/decimal" | cmp -s - "$dir/hits" || bad "gen $world --decimal: other numbers"
        done
    done
    shown ', set .*/rays, masks and flags given, seed 1$'
}

# --- lies, each found as what it is and explained
lies() {
    lie unmasked 's/if not mask & seen or/if not mask or/'
    lie uncut 's/ and not how & CULL_DISABLE:/ and False:/'
    lie mirror 's/(det \* mirror > 0)/(det > 0)/'
    lie side 's/int(front)/int(not front)/'
    lie unfiltered 's/if not opaque and not passes/if False and not passes/'
    lie short 's/int(front), custom\]/int(front), custom \& 0xFFFF]/'
    lie number 's/int(front), custom\]/int(front), numbers[0]]/'
    lie untranslated 's/ + m\[4 \* k + 3\]//'
    found equal missed mask mixed
    found unmasked masked mask mixed
    found uncut culled cull mixed
    found mirror facing cull placed-mirrored:n=4,count=3
    found side facing cull mixed
    found unfiltered opacity opacity mixed
    found short instance instance_index mixed
    found number instance instance_index mixed
    found untranslated missed transform mixed
    found_as_text unmasked masked mixed
    found_as_text mirror facing placed-mirrored:n=4,count=3
    found_as_text number instance mixed
}

# --- commands that make their own worlds
commands() {
    expect 0 . fuzz --worlds --trials 8 --engine "pipe:$honest" --corpus none --dir "$dir/clean"
    shown '^findings   0 distinct, '
    expect 1 . fuzz --worlds --trials 8 --engine "pipe:python3 $dir/equal.py" --corpus none --dir "$dir/dirty"
    shown '^findings   [1-9] distinct, '
    trial=$(ls "$dir"/dirty/*missed*/smallest.trial | head -n 1)
    expect 1 . replay "$trial" --brief --engine "pipe:python3 $dir/equal.py"
    shown 'STILL FAILS$'
    expect 0 . replay "$trial" --brief --engine "pipe:$honest"
    expect 0 . leaks crowd:n=20 --engine "pipe:$honest" --count 1000
    expect 0 . conform --worlds --engine "pipe:$honest" --count 20
    shown '^[1-9][0-9]* passed, 0 failed, 0 skipped$'
    name=$("$raydiff" conform --worlds --engine "pipe:$honest" --list | head -n 1)
    expect 0 . conform "$name" --engine "pipe:$honest" --list
    [ "$(cat "$dir/out")" = "$name" ] || bad 'conform: an engine whose command has a dot'

    # --- export: the honest answer is in the interval that stands in the comment, the lie is not
    expect 2 'is a trial of a world: --form text writes' export "$trial"
    expect 2 'is a trial of a world: --form text writes' export "$trial" --form amber
    expect 2 'export: .*--engine: is a trial of a world' export "$trial" --form text --engine embree
    expect 0 . export "$trial" --form text --to "$dir/finding.txt"
    right "$honest" || bad 'export: the right answer is not among those written'
    right "python3 $dir/equal.py" && bad 'export: the WRONG answer is among those written'
}

# --- tracers of scenes
scenes() {
    cc -O1 -o "$dir/scenes" fuzz/samples/sample_tracer.c || exit 4
    line='traces scenes, not worlds: its flags have no 8'
    expect 77 . check mixed --engine "pipe:$dir/scenes" $few
    shown "^engine pipe:.*/scenes answered 0 of 1, cannot run here 1: pipe:.*/scenes $line\$"
    expect 77 . check mixed --engine "cpu,pipe:$dir/scenes" --layout f32 $few
    shown '^agrees '
    expect 77 "explain: pipe:.*/scenes $line" explain mixed --engine "pipe:$dir/scenes"
    expect 77 "fuzz: pipe:.*/scenes $line" fuzz --worlds --trials 4 --engine "pipe:$dir/scenes" --corpus none --dir "$dir/none"
    expect 77 . leaks mixed --engine "pipe:$dir/scenes" --count 1000
    expect 77 . conform --worlds --engine "pipe:$dir/scenes" --count 20
    shown ', 99 skipped$'
    "$raydiff" gen mixed --count 9 --decimal >"$dir/rays"
    awk -f fuzz/samples/tracer.awk "$dir/rays" | "$raydiff" verify >"$dir/out" 2>"$dir/err"
    [ $? -eq 3 ] && grep -q 'verify: standard input: the tracer refused: this tracer takes scenes alone$' "$dir/err" || bad 'verify: awk'
    grep -v '"raydiff"' fuzz/samples/tracer.awk >"$dir/deaf.awk" # does not look at the version
    awk -f "$dir/deaf.awk" "$dir/rays" | "$raydiff" verify >"$dir/out" 2>"$dir/err"
    [ $? -eq 2 ] && grep -q "standard input:1: 'from' is of a world, but the first line is not 'raydiff 2'" "$dir/err" ||
        bad 'verify: a tracer that does not look at the version'
    awk -f "$dir/deaf.awk" "$dir/rays" | sed 1d >"$dir/old"
    expect 2 "old:1: an answer of version 1, to rays in a world: its first line is 'raydiff 2'" judge mixed "$dir/rays" "$dir/old"
    "$raydiff" gen sphere:n=2 --count 9 | $honest --text | "$raydiff" verify >"$dir/out" 2>"$dir/err"
    [ $? -eq 3 ] || bad 'verify: a tracer of worlds and a scene'
    expect 1 . check sphere:n=2 --engine "pipe:$honest" $few
    shown 'refused: this tracer takes worlds alone'
}

# --- what is wrong with files
files() {
    "$raydiff" gen mixed --count 9 --decimal >"$dir/rays"
    $honest --text <"$dir/rays" >"$dir/hits"
    expect 0 . judge mixed "$dir/rays" "$dir/hits"
    expect 2 "rays: its rays are of version 2, but sphere:n=2 is a scene: 'raydiff 1' is the first line" judge sphere:n=2 "$dir/rays" "$dir/hits"
    "$raydiff" gen sphere:n=2 --count 9 >"$dir/scene"
    expect 2 "scene: its rays are of version 1, but mixed is a world: 'raydiff 2' is the first line" judge mixed "$dir/scene" "$dir/hits"
    expect 2 'rays: has v and t lines for another world than crowd' judge crowd "$dir/rays" "$dir/hits"
    grep '^[r]' "$dir/rays" >"$dir/alone" # without the world
    expect 0 . judge mixed "$dir/alone" "$dir/hits"
    sed '3s/.*/h 1 0 0 99 0 0 front/' "$dir/hits" >"$dir/far"
    expect 2 'far:3: an answer to ray 0 that names instance 99 of 32' judge mixed "$dir/rays" "$dir/far"
    sed '$d' "$dir/hits" >"$dir/less"
    expect 2 'less:10: ends after 8 of 9 answers' judge mixed "$dir/rays" "$dir/less"
    expect 2 'rays: has v, t or r lines: is it a request' judge mixed "$dir/rays" "$dir/rays"
    expect 2 'gen: --modes: sphere is a scene; only worlds have masks and flags' gen sphere --modes all
    sed 's/modes=mixed/modes=many/' "$dir/hits" | "$raydiff" verify >"$dir/out" 2>"$dir/err"
    [ $? -eq 2 ] && grep -q "'from' has no modes that there are" "$dir/err" || bad 'verify: modes'
    sed 's/modes=mixed/modes=drawn/' "$dir/hits" | "$raydiff" verify >"$dir/out" 2>"$dir/err"
    [ $? -eq 2 ] && grep -q "'from' is for another scene or other rays" "$dir/err" || bad 'verify: other modes'
    echo '{"raydiff_world": 1, "meshes": [], "instances": []}' >"$dir/none.json"
    expect 2 'none.json: vacuous' gen "$dir/none.json"
    printf 'raydiff 2\nr 0 0 0 0 1 0 0 9 255 0\n' >"$dir/one"
    printf 'raydiff 2\nm\n' >"$dir/miss"
    expect 2 'none.json: vacuous' judge "$dir/none.json" "$dir/one" "$dir/miss"
}

case $part in
all) for name in verdicts lies commands scenes files; do $name; done ;;
most) for name in verdicts commands scenes files; do $name; done ;;
verdicts | lies | commands | scenes | files) $part ;;
*) echo "$part: no part of this suite" && exit 2 ;;
esac
echo "worlds_piped: $failed failed"
[ "$failed" -eq 0 ]
