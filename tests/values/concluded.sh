#!/bin/sh
# The last line of a command counts every row that it printed: what is WRONG, what agrees, and what failed, was
# refused or skipped, or proves nothing.
#   sh tests/values/concluded.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
samples=$(dirname "$raydiff")/samples
[ -x "$samples/refuser" ] || samples=build/samples # a planted bug's program has none of its own
misses="pipe:$samples/refuser 1000000"             # answers every ray with a miss
few='--count 500 --repeat 1 --wide'

# Expected code, the whole last line as a pattern, arguments.
ends() {
    code=$1 line=$2
    shift 2
    expect "$code" . "$@"
    tail -n 1 "$dir/out" | grep -qE -- "^$line\$" || bad "raydiff $*: the last line is not /$line/"
    [ "$(grep -c '^conclusion: ' "$dir/out")" -le 1 ] || bad "raydiff $*: two conclusions"
}

# Answers that are WRONG are no result that proves nothing.
ends 1 'conclusion: 1 of 2 rows agree, 220 of 1000 answers WRONG' check sphere:n=4 $few --layout f32 --engine "cpu,$misses"
ends 1 'conclusion: 0 of 1 rows agree, 220 of 500 answers WRONG' check sphere:n=4 $few --engine "$misses"
grep -q 'vacuous' "$dir/out" && bad 'check: what is WRONG is called vacuous'
# Of 220 four are shown; what else the row is at fault for is not among the others.
[ "$(grep -c '^WRONG missed ' "$dir/out")" -eq 4 ] && grep -qx '  \.\.\. and 216 more of this row that are WRONG' "$dir/out" ||
    bad 'check: not four of 220 answers and a count of the others'
printf 'r 0.3 0.2 -9 0 0 0 1 100\nr 0.1 0.3 -9 0 0 0 1 100\n' >"$dir/rays"
printf 'm\nm\n' >"$dir/hits"
expect 1 . judge sphere:n=2 "$dir/rays" "$dir/hits"
grep -q 'against the exact truth: 2 of 2 answers WRONG' "$dir/out" || bad 'judge: what is WRONG is not counted'
# A tracer of no formula: its own test, parts that are told apart, words that the glossary has.
sed 's/q.rays, 1, 0, /q.rays, 0, 0, /' tests/peers/refuser.c >"$dir/unknown.c"
cc -O1 -o "$dir/unknown" "$dir/unknown.c" || bad 'a tracer is not compiled'
expect 1 . check sphere:n=4 $few --engine "pipe:$dir/unknown 1000000"
grep -q '^WRONG missed closest\.pipe:.*\.-\.own ray ' "$dir/out" || bad 'check: a formula that is unknown is called one of the table'
grep -q ' missed [0-9]*; displacement p50 .* uM, [0-9]* lost in closed fans; lost beside edges ' "$dir/out" ||
    bad 'check: parts of what a row has are not told apart'
for word in uM 'closed fan' 'lost beside edges'; do
    grep -q "^| $word |" docs/glossary.md || bad "the glossary has no '$word'"
done
expect 1 . judge sphere:n=2 "$dir/rays" "$dir/hits"
grep -q '^tree: ' "$dir/out" && bad 'judge: a tree that no engine walks'
grep -q '^WRONG  *-  *answer:.* -$' "$dir/out" || bad 'judge: the speed of a file'
# The seed is the scene's, and the line that is printed explains the same answer.
"$raydiff" gen soup:n=30 --seed 5 --count 40 >"$dir/rays5"
{ echo 'formula unknown ieee' && yes m | head -n 40; } >"$dir/hits5"
expect 1 . judge soup:n=30 --seed 5 "$dir/rays5" "$dir/hits5"
grep -q '^soup:n=30: 30 triangles, .*, seed 5$' "$dir/out" || bad 'judge: the seed is not told'
lost=$(sed -nE 's/^WRONG missed .* expected: prim=([0-9]*) .*/\1/p' "$dir/out")
printed=$(sed -n 's/^ *explain: raydiff //p' "$dir/out")
eval "expect 1 . ${printed:-no line}"
grep -q "^verdict   WRONG: missed, triangle $lost was to be found" "$dir/out" || bad "judge: its line explains something else than triangle $lost"
# What is vacuous is told once.
expect 1 . check soup:n=0 $few --layout f32 --engine cpu
grep -q '^  cpu: vacuous: 0 hits of 500 rays prove nothing$' "$dir/out" || bad 'check: why a row is vacuous'
ends 1 'conclusion: 0 of 1 rows agree, 1 vacuous' check soup:n=0 $few --layout f32 --engine cpu
# Rows that did not run are counted, too.
ends 3 'conclusion: 0 of 1 rows agree, 1 failed' check sphere:n=2 $few --engine 'pipe:sleep 100' --peer-time 1
ends 77 'conclusion: 0 of 1 rows agree, 1 skipped' check sphere:n=2 $few --engine rayquery --driver no-such-driver
ends 2 'conclusion: 1 of 2 rows agree, 1 refused, 0 of 500 answers WRONG' \
    check sphere:n=300 $few --brute 0 --layout rf16,tiny8 --engine cpu
ends 0 'conclusion: 1 of 1 rows agree, 1 as published counted, 0 of 500 answers WRONG' \
    check rtrs $few --layout f32,rtrs_rf --engine cpu

# Of one run each it is not known which layout is faster (that ranges are far enough apart is told by check.awk).
ends 0 'conclusion: 2 of 2 rows agree, 0 of 1000 answers WRONG; speeds cannot be told apart' \
    check sphere:n=8 $few --layout f32,rf16 --engine cpu
grep -q "rf16 on cpu: .* times its speed, within noise\$" "$dir/out" || bad 'check: a speed of one run is told'

# What is told of a scene, and of named engines, does not depend on one that cannot be read before or behind it.
for scenes in "$dir/nothing.obj sphere:n=4" "sphere:n=4 $dir/nothing.obj"; do
    ends 2 'conclusion: 1 of 1 rows agree, 0 of 500 answers WRONG' check $scenes $few --layout rf16 --engine cpu
    grep -qx 'engine cpu answered 1 of 1' "$dir/out" || bad "check $scenes: it is not told what engine cpu answered"
done

# No row twice: an engine with tests of its own is one row, whatever tests are named.
expect 0 . leaks sphere:n=4 --engine cpu,fast,embree,brute,"pipe:$samples/tracer" --layout f32 --count 2000
sed -n '/^verdict/,/^what it means/p' "$dir/out" | sort | uniq -d | grep -q . && bad 'leaks: a row twice'
expect 0 . leaks sphere:n=4 --engine fast --layout f32 --count 2000
grep -q '  1 of 1 rows promise' "$dir/out" || bad 'leaks: engine fast is one row'
expect 0 . check sphere:n=4 --engine cpu,fast,embree,brute,"pipe:$samples/tracer" --layout f32 --tri mt,woop --box robust,watertight \
    --count 200 --repeat 1 --json "$dir/json"
perl -MJSON::PP -0ne 'my %seen; $seen{join " ", map { $_ // "-" } @$_{qw(engine layout box tri query builder store)}}++ for @{decode_json($_)->{rows}};
    my %count; for (keys %seen) { print "twice: $_\n" if $seen{$_} > 1; $count{(split)[0] =~ s/:.*//r}++ }
    print "$count{cpu} $count{fast} $count{embree} $count{brute} $count{pipe}\n"' "$dir/json" >"$dir/out2"
[ "$(cat "$dir/out2")" = '4 1 1 2 1' ] || bad "check: a row twice: $(cat "$dir/out2")"

# What is allowed and what is required of answers from a file: t is off by some units; hits at vertices are lost.
"$raydiff" gen sphere:n=4 --rays primary --decimal --count 200 >"$dir/some.rays" && awk -f fuzz/samples/tracer.awk "$dir/some.rays" >"$dir/some.hits"
awk '$1 == "h" { $2 = sprintf("%.9g", $2 * 1.00001) } { print }' "$dir/some.hits" >"$dir/off"
ends 1 'conclusion: 0 of 1 rows agree, [1-9][0-9]* of 200 answers WRONG' judge sphere:n=4 "$dir/some.rays" "$dir/off"
ends 0 'conclusion: 1 of 1 rows agree, 0 of 200 answers WRONG' judge sphere:n=4 "$dir/some.rays" "$dir/off" --displacement 1000
"$raydiff" scene convert sphere:n=4 "$dir/sphere.obj" >"$dir/out"
awk '$1 == "v" { printf "r %.9g %.9g %.9g 0 %.9g %.9g %.9g 10\n", 3 * $2, 3 * $3, 3 * $4, -$2, -$3, -$4 }' "$dir/sphere.obj" >"$dir/corners"
{ grep '^r' "$dir/some.rays"; cat "$dir/corners"; } >"$dir/both"
{ cat "$dir/some.hits"; sed 's/.*/m/' "$dir/corners"; } >"$dir/lost"
ends 0 'conclusion: 1 of 1 rows agree, 0 of 266 answers WRONG' judge sphere:n=4 "$dir/both" "$dir/lost"
ends 1 'conclusion: 0 of 1 rows agree, 0 of 266 answers WRONG' judge sphere:n=4 "$dir/both" "$dir/lost" --require watertight

# Bits in JSON are those of the numbers in the line of the finding.
expect 1 . check sphere:n=4 --engine "pipe:$samples/tracer_bug1" --count 200 --repeat 1 --json "$dir/json"
perl -MJSON::PP -0ne '
    BEGIN { @ARGV = @ARGV[0, 1]; open my $in, "<", $ARGV[1]; local $/; $text = <$in>; pop @ARGV }
    sub number { my ($hex) = @_; $hex =~ /^(-?)0x([01])(?:\.([0-9a-f]+))?p([-+]\d+)$/ or return "$hex?";
        my ($sign, $one, $rest, $power) = ($1, $2, $3 // "", $4); my $x = hex("$one$rest") * 2 ** ($power - 4 * length $rest);
        sprintf "0x%08x", unpack "L", pack "f", $sign ? -$x : $x }
    my %line; $line{$1} = [map { number($_) } $2, $3, $4] while $text =~ /^WRONG .* ray (\d+) .* t=(\S+) u=(\S+) v=(\S+)  expected/mg;
    for (@{decode_json($_)->{rows}[0]{findings}}) {
        my $is = $line{$_->{ray}} or next; $seen++;
        print "ray $_->{ray}: @$is\n" if "@$is" ne join " ", @{$_->{got}}{qw(t_bits u_bits v_bits)} }
    print "no line\n" if $seen < 3' "$dir/json" "$dir/out" >"$dir/out2"
[ -s "$dir/out2" ] && bad "check: bits of findings: $(cat "$dir/out2")"

# Each command that judges ends with a conclusion.
ends 0 'conclusion: 1 of 1 comparison with cpu as it should be' diff sphere:n=4 --engine cpu,brute -w 16 -h 12 --out "$dir/heat.png"
dxr='leaks sphere:n=4 --engine cpu --layout f32 --tri woop --box watertight --count 2000'
ends 0 'conclusion: 3 rows: [12] kept, 0 broken, [12] counted' leaks sphere:n=4 --engine cpu,embree --layout f32 --tri woop --count 2000
ends 1 'conclusion: 1 row: 0 kept, 1 broken, 0 counted' $dxr --profile dxr
ends 1 'conclusion: 0 of 1 rows agree, 2 of 2 answers WRONG' judge sphere:n=2 "$dir/rays" "$dir/hits"
"$raydiff" gen sphere:n=4 --count 50 --decimal | awk -f fuzz/samples/tracer.awk | "$raydiff" verify >"$dir/out" 2>"$dir/err"
tail -n 1 "$dir/out" | grep -qx 'conclusion: 1 of 1 rows agree, 0 of 50 answers WRONG' || bad 'verify: no conclusion'
ends 0 'conclusion: 1 of 1 comparison with cpu as it should be' diff rtrs --engine cpu,vulkan --width 16 --height 12
ends 0 'conclusion: [0-9]+ of [0-9]+ engines run, [1-9] of [0-9]+ Vulkan drivers are here' doctor
head -n 1 "$dir/out" | grep -qE 'compiled by (gcc|Clang|.* Clang) [0-9]' || bad 'doctor: which compiler?'
sed -n '/^brute/,/^driver/p' "$dir/out" | grep '^        ' | sort | uniq -d | grep -q . && bad 'doctor: a device is described again'
# Two names that lead to one driver have one card.
mkdir -p "$dir/drivers/mesa25" && : >"$dir/drivers/versions"
cp "$(ls /etc/vulkan/icd.d/lvp_icd*.json /usr/share/vulkan/icd.d/lvp_icd*.json 2>/dev/null | head -n 1)" "$dir/drivers/mesa25/icd.json" &&
    RAYDIFF_DRIVERS="$dir/drivers" "$raydiff" doctor >"$dir/out" 2>"$dir/err"
grep -qx 'driver mesa25 *as stock' "$dir/out" && [ "$(grep -c '^    the judge uses' "$dir/out")" -eq 1 ] ||
    bad 'doctor: a card is printed for each name of its driver'
ends 0 'bench error: [0-9]+ rows?: no answer is WRONG' \
    bench error --scene sphere:n=4 --count 60 --rounds 1 --engine cpu --layout f32 --tri mt

# So does explain: of an answer, of none that is wrong, of a tree, and of a shader that decodes otherwise than C.
rounded='rounded_inward: a stored bound lies inside the tree.s, within a float16 step'
ends 1 "conclusion: WRONG: missed, by $rounded" explain fuzz/corpus/rounded-inward.trial --wide
ends 0 'conclusion: no answer is wrong' explain sphere:n=4 --layout f32 --count 200 --wide
ends 0 'conclusion: the answer is right' explain sphere:n=4 --layout f32 --count 20 --index 0 --wide
cc -std=c17 -O2 -ffp-contract=off -shared -fPIC -I. -o "$dir/mine.so" fuzz/samples/layout/mine.c || bad 'mine is compiled'
sed 's/return leaf(n.b, n.a & ~NODE_LEAF);/return leaf(n.b, (n.a \& ~NODE_LEAF) - 1u);/' fuzz/samples/layout/mine.glsl >"$dir/bug.glsl"
mine="explain sphere:n=8 --layout $dir/mine.so --engine vulkan --count 2000 --wide --shader"
ends 1 'conclusion: decode DIFFERS: record 6: items: C decodes 4, GLSL 3; WRONG: missed, by shader: .*' $mine "$dir/bug.glsl"
ends 0 'conclusion: no answer is wrong; C and GLSL decode the same' $mine fuzz/samples/layout/mine.glsl

# One is told as one, on the screens of every command.
nouns='triangles|vertices|rays|rows|points|edges|pairs|hits|trials|nodes|leaves|items|instances|rounds|findings|records|frames|turns|bounces|lights|meshes|threads|workers|answers|models|materials|segments|boxes|bytes|refusals|files|parts|figures|shapes'
single() {
    code=$1
    shift
    expect "$code" . "$@"
    many=$(cat "$dir/out" "$dir/err" | sed -z 's/\n    */ /g' | perl -ne "print \"\$1\\n\" while /(?<![0-9.,])(?<!of )\\b(1 (?:[a-z]+ )?(?:$nouns)\\b)(?! ray\\b)/g")
    [ -z "$many" ] || bad "raydiff $*: $many"
}
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$dir/one.obj"
test_one='--layout f32 --engine cpu'
single 1 check soup:n=1 --rays random --count 1 $test_one
grep -q '^soup:n=1: 1 triangle, 3 vertices; 1 ray, set ' "$dir/out" && grep -q ': 1 node, 1 leaf, depth ' "$dir/out" || bad 'check: 1 triangles'
single 1 leaks sphere:n=4 $test_one --tri woop --box watertight --count 1
single 0 scene info "$dir/one.obj"
single 0 scene convert "$dir/one.obj" "$dir/one.ply"
grep -q ': 1 triangle, 3 vertices$' "$dir/out" || bad 'scene convert: 1 triangles'
single 0 scene convert "$dir/one.obj" "$dir/one.world.json"
single 0 construct --out "$dir/one.json" --model "$dir/one.obj" default --camera-pos 0 0 3 0 0 0 --camera-fixed
grep -q ': 1 model, 1 triangle, 3 vertices, 1 material, ' "$dir/err" || bad 'construct: 1 triangles'
single 0 precompute --scene "$dir/one.obj" --out "$dir/one.bvh"
grep -q ': 1 triangle, 1 node, 1 leaf of at most 1 item, depth 0, ' "$dir/err" || bad 'precompute: 1 triangles'
single 0 precompute --scene "$dir/one.obj" --verify "$dir/one.bvh"
single 0 explain "$dir/one.obj" $test_one --rays primary --count 1
single 0 diff "$dir/one.obj" --engine cpu,brute --width 16 --height 12 --bounces 1
single 0 render "$dir/one.obj" --engine cpu -w 16 -h 12 --out "$dir/one.png"
single 1 fuzz --trials 1 --rays 1 --triangles 1-1 $test_one --corpus none --jobs 1 --dir "$dir/one"
single 0 conform '*.f32.median.robust.mt.platonic.primary.1' --engine cpu --count 1
few='--count 1 --rounds 1'
single 1 bench error --scene soup:n=1 $few $test_one --tri mt
single 1 bench layouts --scene soup:n=1 --count 1 --rounds 1 --threads 1
grep -q '^vacuous f32 *cpu ' "$dir/out" && ! grep -q '^agrees .* random ' "$dir/out" && tail -n 1 "$dir/out" | grep -q ', or no ray hits anything$' ||
    bad 'bench layouts: rows that prove nothing agree'
# What is named is measured or counted; speeds are beside f32 where Embree is not.
printf 'v 0 0 0\nv 1e6 0 0\nv 0 1e6 0\nf 1 2 3\n' >"$dir/far.obj"
single 2 bench layouts --scene "$dir/far.obj" $few --engine cpu --layout f32,rf16
grep -q '^cpu  *rf16  *left out: rf16: a bound is at most 65504 ' "$dir/out" || bad 'bench layouts: why rf16 is left out'
single 1 bench layouts --scene "$dir/one.obj" $few --engine cpu --layout f32,cwbvh80,rtrs_rf
[ "$(grep -cE '^(agrees|vacuous) +(f32|cwbvh80|rtrs_rf) +cpu .* f32$' "$dir/out")" -eq 9 ] || bad 'bench layouts: nine rows beside f32'
single 2 bench layouts --scene "$dir/one.obj" $few --engine cpu --layout f32 --compiler opt
grep -q 'needs an engine vulkan' "$dir/err" || bad 'bench layouts: --compiler without an engine that has shaders'
VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent single 77 bench layouts --scene sphere:n=4 --count 300 --rounds 1 --engine vulkan,cpu --layout f32
single 1 bench spawn --scene soup:n=1 $few --engine cpu --tri mt
single 0 bench builders --scene soup:n=1 --rounds 1 --threads 1
single 0 bench oracle --scene soup:n=1 $few
single 0 bench tightness --scene soup:n=1 --count 1
single 0 bench traffic --scene cornell --count 20
single 0 bench fuzz $few $test_one
single 0 bench frames --scene "$dir/one.obj" --engine cpu --layout f32 --frames 1 --turns 1 --bounces 1 --size 16x12 --out "$dir/f"

echo "concluded: $failed failed"
[ "$failed" -eq 0 ]
