#!/bin/sh
# The command line as a user meets it: exit codes, one clear line per error, nothing half-written.
#   sh tests/scripts/cli.sh RAYDIFF [usage]      usage: names, options and numbers alone
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh

cat >"$dir/one.obj" <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
f 1 2 3
OBJ
small="--count 200 --repeat 1 --engine cpu"

# Help is on standard output and succeeds, everywhere.
for command in '' check conform explain bisect leaks render bench list doctor scene precompute judge gen verify report web replay export fuzz merge min diff construct build tree; do
    expect 0 . $command --help
    grep -q 'example' "$dir/out" || bad "raydiff $command --help shows no example"
done
expect 0 . --version

# Usage.
expect 2 . 
expect 2 "unknown command 'chekc' .*; did you mean check\?$" chekc
expect 2 "unknown option: '--cuont'; did you mean --count?" check soup --cuont 3
expect 2 "unknown option: '--coun'; did you mean --count?" check soup --coun 3
# What two letters or more begin is meant, the first of all that they begin.
"$raydiff" check --help | sed -n 's/^  --\([a-z-]*\).*/\1/p' >"$dir/names"
[ "$(wc -l <"$dir/names")" -gt 40 ] || bad 'check has few options'
for length in 2 3; do
    for begun in $(cut -c "-$length" "$dir/names" | sort -u); do
        grep -qx -- "$begun" "$dir/names" && continue
        "$raydiff" check soup --$begun 3 2>"$dir/err" >"$dir/out"
        told=$(sed -n "s/^raydiff check: unknown option: '--$begun'; did you mean --\([a-z-]*\)? (see raydiff check --help)\$/\1/p" "$dir/err")
        case $told in
        "$begun"*) grep -qx -- "$told" "$dir/names" || bad "check --$begun: --$told is no option" ;;
        *) bad "check --$begun: not an option that it begins, but --$told" ;;
        esac
    done
done
expect 2 "unknown name 'vulcan'.*; did you mean vulkan?" check soup --engine vulcan
expect 2 "unknown name 'sah_swep'.*; did you mean sah_sweep?" check soup --builder sah_swep
expect 2 "unknown option: '--frobnicate' .see" check soup --frobnicate
expect 2 'count: is given twice' check soup --count 3 --count 4
expect 2 "unknown command 'load' .see raydiff render --help" load
expect 2 'no scene given' check
expect 2 'unknown option' check soup --frobnicate
expect 2 '--count: its value is missing: N' check soup --count
expect 2 '^raydiff check: nothing.obj: No such file' check nothing.obj --engine cpu
[ -s "$dir/out" ] && bad 'check: an engine is blamed for a scene that is not there'
expect 2 "name it last, as 'cpu,pipe:./tracer', or quote" check soup --engine pipe:./tracer,cpu
expect 2 "name it last, as 'cpu,embree,pipe:./tracer -f 1', or quote" check soup --engine 'pipe:./tracer -f 1,cpu,embree'
expect 2 "name it last, as 'cpu,pipe:./b 2', or quote" check soup --engine 'brute,pipe:./a 1,pipe:./b 2,cpu'
expect 2 "unknown name 'f33'; layouts are: f32, rf16" check soup --layout f33
expect 2 "unknown name 'gpu'; engines are" check soup --engine gpu
expect 2 "unknown name 'sah'; builders are" check soup --builder sah
expect 2 "'all' stands alone, not in a list" check soup --layout f32,all
expect 2 'more than 32 engines times layouts' replay fuzz/corpus/rounded-inward.trial --layout every
expect 2 "'auto' is for check and render, and stands alone" check soup --layout auto,f32
expect 2 "'auto' is for check and render, and stands alone" leaks soup --layout auto
expect 2 "--bits: .*--store quantised" check soup --bits 12 $small
expect 2 'goes without --store' check soup --store compact --bvh none
expect 2 "is named twice" check soup --layout f32,f32
expect 2 '^raydiff check: soup: n is given twice' check soup:n=5,n=6
expect 2 '^raydiff check: soup: seed is given twice' check soup:n=5,seed=1,seed=2
expect 2 "'0' is not a whole number from 1" check soup --count 0
expect 2 "'0' is not a whole number from 1" check soup --leaf 0
expect 2 "'-3' is not a whole number" check soup --count -3
expect 2 "'1.5' is not a whole number" check soup --count 1.5
expect 2 "'nan' is not a finite number" check soup --eps nan
# Frames draw no rays: a seed is of a scene that is drawn by chance.
frames="bench frames --engine cpu --layout f32 --frames 1 --size 8x8 --out $dir/frames --seed 3"
expect 2 '--seed: not used here: it needs a scene or rays that are drawn by chance' $frames
expect 0 . $frames --scene soup:n=9
# Of several scenes it may be any; rays through pixels are not drawn, nor is what has a seed of its own.
fixed='--rays primary --seed 3 --engine cpu --layout f32 --count 50 --repeat 1'
for scenes in soup:n=99 'soup:n=99 cornell' 'cornell soup:n=99' 'cornell sphere:n=2 soup:n=99'; do
    expect 0 . check $scenes $fixed
    expect 0 . scene info $scenes --seed 3
done
for scenes in cornell 'cornell sphere:n=2' 'soup:n=9,seed=2 cornell'; do
    expect 2 '^raydiff check: --seed: not used here: it needs a scene or rays that are drawn by chance' check $scenes $fixed
    expect 2 '^raydiff scene: --seed: not used here: it needs a scene or rays' scene info $scenes --seed 3
done
expect 2 '--threads: not used by benchmark special' bench special --threads 2
# Lists are no longer than they can be; a word is looked for between commas alone.
expect 2 "^raydiff bench: --scene: at most 16 scenes " bench builders --scene "$(seq -s';' 17)"
expect 2 . bench builders --scene "$(seq -s';' 16)"
grep -q "^raydiff bench: 16: unknown scene '16'" "$dir/err" || bad "bench: the last of 16 scenes is not read"
for names in watertightx,watertight,cpu cpu,watertightx,watertight; do
    expect 2 "require: unknown name 'watertightx'" conform --engine cpu --require $names
done
expect 2 'require: longer than 4095 characters' conform --require "watertight,$(printf '%04096d' 0)"
expect 2 "require: unknown name '0" conform --require "watertight,$(printf '%04095d' 0)"
expect 2 "^raydiff bench: --scheduler: 'mach_rt' is named twice " bench traffic --scheduler mach_rt,mach_rt
expect 2 '^raydiff bench: --depths: at most 8 depths ' bench traffic --scene nothing.obj --depths 1,2,3,4,5,6,7,8,9
expect 2 '^raydiff bench: nothing.obj: No such file' bench traffic --scene nothing.obj --depths 1,2,3,4,5,6,7,8
expect 2 "layout: 'every' stands alone, not in a list" check soup --layout f32,every
expect 2 '^raydiff check: --wide: takes no value ' check soup --wide=1
# One dash is of one letter.
expect 2 "^raydiff check: unknown option or missing value: '-count' " check soup -count 3
expect 2 "^raydiff check: unknown option or missing value: '-z' " check soup -z
# What --same does not use: it builds in C.
for option in '--driver x' '--device 0' '--rounds 2' '--move 0.1'; do
    expect 2 "^raydiff build: ${option% *}: not used here: --same builds in C " build soup:n=40 --same 1 $option
done
expect 2 "^raydiff build: --builder: gpu_hploc builds on a device, --same in C " build soup:n=40 --same 1 --builder median,gpu_hploc
if [ "${2-}" = usage ]; then
    echo "cli, usage: $failed failed"
    [ "$failed" -eq 0 ]
    exit
fi
expect 2 "no trial matches" conform 'closest.warp.*'
expect 2 "trial: unknown layout 'f31'" conform closest.cpu.f31.median.robust.mt.soup.random.1
expect 2 "is not query.engine" conform closest.cpu
expect 2 "require vulkan: --engine leaves it out" conform --engine cpu --require vulkan
expect 0 'pairs of members met, 0 of them only in trials that were refused or skipped' \
    conform --engine cpu --layout f32 --builder median --box robust --tri mt --count 100
expect 77 . \
    conform --engine cpu,rayquery --driver no-such-driver --layout f32 --builder median --box robust \
    --tri mt --count 100
grep -q 'met, [1-9][0-9]* of them only in trials that were refused or skipped: mt with rayquery' "$dir/out" ||
    bad "conform: pairs that met only in skipped trials"
expect 2 "unknown benchmark 'x'; benchmarks are: layouts, .*, fast, matrix" bench x
expect 2 "'x.obj' is a second .a scene: --scene" bench fast x.obj
for one in fast matrix error spawn builders oracle layouts; do
    expect 2 "^raydiff bench: nothing.obj: No such file" bench $one --scene nothing.obj
done
expect 2 "^raydiff bench: soup: n=-1 must be" bench fast --scene soup:n=-1
expect 2 "--scene: not used by benchmark fuzz" bench fuzz --scene sphere:n=4
expect 2 "soup:n=0: no triangles" bench builders --scene soup:n=0 --rounds 1
expect 2 "soup:n=0: no triangles" bench oracle --scene soup:n=0 --rounds 1 --count 64
expect 0 "shadow *fast" bench fast --scene sphere:n=4 --rounds 1 --count 500
expect 2 "no triangles" bench fast --scene soup:n=0 --rounds 1 --count 500
expect 0 "worth using, nothing lost: fast .*(fastest)" bench matrix --wide --scene sphere:n=4 --rounds 1 --count 500 --threads 1 \
    --csv "$dir/m.csv" --json "$dir/m.json" --svg "$dir/m.svg"
[ "$(grep -c '^matrix,sphere:n=4,' "$dir/m.csv")" -ge 10 ] || bad "bench matrix --csv has a row per contestant"
[ "$(grep -c '"prim_beyond_l2"' "$dir/m.json")" -ge 10 ] || bad "bench matrix --json has a row per contestant"
[ "$(grep -c 'bytes per triangle' "$dir/m.svg")" -eq 1 ] || bad "bench matrix --svg has no panel"
expect 0 "^  cpu rf16  *[0-9.]* " bench matrix --wide --scene sphere:n=4 --rounds 1 --count 64 --engine cpu --layout rf16 --threads 1
expect 0 "^  cpu f32 compact  *[0-9.]* " bench matrix --wide --scene sphere:n=4 --rounds 1 --count 64 --store indexed,compact --threads 1
expect 2 '--store: not used by benchmark oracle' bench oracle --store compact
expect 2 "tests every triangle" bench matrix --scene sphere:n=4 --engine brute
expect 77 "no device .*'no-such-driver'" bench matrix --scene sphere:n=4 --engine vulkan --driver no-such-driver
expect 77 "no device .*'no-such-driver'" bench matrix --wide --scene sphere:n=4 --rounds 1 --count 64 --threads 1 --engine rayquery,cpu \
    --layout f32 --driver no-such-driver
grep -q '^  cpu f32 ' "$dir/out" || bad "bench matrix measures the engines that can run"
expect 2 "more than 96 contestants: --engine, --layout and --store name fewer" bench matrix --scene sphere:n=4 --engine cpu,vulkan
expect 2 "stores triangles its own way" bench matrix --scene sphere:n=4 --engine fast --store edges
expect 2 "no triangles" bench matrix --scene soup:n=0 --rounds 1 --count 64
expect 2 "no-such" bench matrix --wide --scene sphere:n=4 --rounds 1 --count 64 --threads 1 --engine cpu --layout f32 --svg "$dir/no-such/x.svg"
expect 0 . bench builders --scene sphere:n=4 --rounds 1 --csv -
[ "$(grep -c '^builders,sphere:n=4,' "$dir/out")" -ge 2 ] || bad "bench builders --csv has a row per builder"
# A builder that refuses a scene is told once, whatever the rounds; the others have their rows.
{ printf 'v 1e6 1e6 0\nv 1000000.25 1e6 0\nv 1e6 1000000.25 0\n'; for i in 1 2 3 4 5; do echo 'f 1 2 3'; done; } >"$dir/far.obj"
expect 0 . bench builders --scene "$dir/far.obj" --rounds 2 --threads 1 --wide --csv "$dir/far.csv"
[ "$(grep -c '^  rtrs  *rtrs: RTRS never ends here .*; eps 0.02$' "$dir/out")" -eq 1 ] || bad "bench builders: a refusal is not told once"
sed '1d' "$dir/far.csv" | cut -d, -f3 | sort -u >"$dir/rows"
in_c() { "$raydiff" list builders | sed -n 's/^  \([a-z][a-z0-9_]*\)  .*/\1/p' | grep -v '^gpu_' | sort; }
in_c | grep -vx rtrs | cmp -s - "$dir/rows" || bad "bench builders has not the rows of all others: $(cat "$dir/rows")"
# So are builders whose builds are compared: all that build in C, if none is named.
expect 0 . build soup:n=40 --same 1 --json "$dir/same.json"
in_c >"$dir/in_c"
sed -n 's/^ *"builder": "\(.*\)",*$/\1/p' "$dir/same.json" | sort -u | cmp -s - "$dir/in_c" || bad "build --same: not every builder in C"
expect 2 "cannot both be '-'" bench oracle --csv - --json -
expect 2 "needs a file" bench error --svg -
expect 0 . bench oracle --scene sphere:n=4 --count 64 --rounds 1 --json -
head -c 2 "$dir/out" | grep -q '^{' || bad "bench --json - prints more than JSON"
tail -n 1 "$dir/out" | grep -q '^}' || bad "bench --json - prints more than JSON"
grep -q '"filter_ns"' "$dir/out" || bad "bench oracle --json - has no filter_ns"
grep -q '^oracle' "$dir/err" || bad "bench --json - hides its tables"
expect 0 . bench fuzz --engine cpu,brute --layout f32 --count 8 --rounds 1 --json -
for key in trials_per_s judged_rays_per_s harness_share cpu_f32_us brute_alone_us judge_us; do
    grep -q "\"$key\": [0-9]" "$dir/out" || bad "bench fuzz --json - has no $key"
done
expect 2 "unknown .*'x'" bench fuzz --engine x
expect 0 "^  woop  *ieee  " bench tightness --wide --scene sphere:n=4 --count 500 --csv "$dir/t.csv"
[ "$(grep -c '^tightness,sphere:n=4,' "$dir/t.csv")" -eq 20 ] || bad "bench tightness has no row per formula and rounding"
expect 2 "soup:n=0: no triangles" bench tightness --scene soup:n=0
expect 2 "--tri: not used by benchmark fuzz" bench fuzz --tri mt
expect 2 "--svg: not used by benchmark builders" bench builders --svg "$dir/x.svg"
expect 2 "unknown kind 'x'; kinds are: builders, layouts, .*, storages" list x

# Scenes.
expect 2 "nothing.obj" check "$dir/nothing.obj" $small
expect 2 'no file, and no generator' check no_such_generator $small
expect 2 "$dir" check "$dir" $small
: >"$dir/empty.obj"
expect 2 "empty.obj" check "$dir/empty.obj" $small
printf 'v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n' >"$dir/nan.obj"
expect 2 'nan.obj:3: ' check "$dir/nan.obj" $small
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n' >"$dir/range.obj"
expect 2 'range.obj:4: ' check "$dir/range.obj" $small
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n' >"$dir/past.obj"
expect 2 'past.obj:4: ' check "$dir/past.obj" $small
printf 'v 0 0 0\n' >"$dir/none.obj"
expect 2 'triangle' check "$dir/none.obj" $small
head -c 4096 /dev/urandom >"$dir/garbage.ply"
expect 2 'garbage.ply' check "$dir/garbage.ply" $small
printf 'ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n' >"$dir/liar.ply"
expect 2 'liar.ply' check "$dir/liar.ply" $small
cp "$dir/one.obj" "$dir/one.xyz"
expect 2 'one.xyz' check "$dir/one.xyz" $small

# Limits: named is an error, by default a row.
expect 0 . check --wide "$dir/one.obj" --rays primary $small
expect 2 . check --wide soup:n=100000,size=0.001 --layout rf16 $small
expect 0 . check --wide soup:n=100000,size=0.2 --brute 1e6 $small
grep -q 'refused: rf16' "$dir/out" || bad "a refused layout is a row with its reason"
expect 2 . check --wide soup:n=100 --store compact --leaf 100 --engine cpu --count 100 --repeat 1
grep -q 'nothing was played' "$dir/out" || bad "check --store compact: nothing was played, and it is not said"
expect 2 '--store: .*walks trees' check --wide soup:n=100 --store quantised --engine brute --count 100 --repeat 1
expect 2 . check --wide soup:n=100 --store indexed,compact --leaf 100 --count 100 --repeat 1 --engine cpu,brute
grep -q 'storage compact was played on no layout' "$dir/out" || bad "check: a named storage that holds nothing is no pass"
expect 0 . check --wide soup:n=100000,size=0.2 --layout auto --brute 1e6 $small
grep -q '^cwbvh80 .*cpu' "$dir/out" || bad "--layout auto takes cwbvh80 where rf16 cannot"
expect 2 . check --wide soup:n=70000,size=0.001 --layout rf16 --leaf 8 $small
grep -q 'at most 32767, .*or --layout auto' "$dir/out" || bad "rf16 names --layout auto where it refuses"

# Ten million triangles and too little memory: refused before the build, with the memory it takes. (A
# sanitized program cannot run in so little.)
if (ulimit -v 1500000 && "$raydiff" --version) >/dev/null 2>&1; then
    (ulimit -v 1500000 && "$raydiff" check sphere:n=1118 --builder sbvh --rays random --engine cpu --count 9) \
        >"$dir/out" 2>"$dir/err"
    [ $? -eq 4 ] || bad "too little memory is exit code 4"
    grep -q 'sbvh: no memory: a tree of 9999392 triangles takes at least 4.6 GB, [01].[0-9] GB are free$' "$dir/err" ||
        bad "too little memory: says $(cat "$dir/err")"
fi

# A tree deeper than the stack, beyond the range of compact nodes: no layout can hold it, and that is
# said, not crashed on.
awk 'BEGIN { for (i = 0; i < 100; i++) { x = 2 ^ (110 - i)
    printf "v %.9g 0 0\nv %.9g %.9g 0\nv %.9g 0 %.9g\nf %d %d %d\n", x, x, x / 8, x, x / 8, 3*i+1, 3*i+2, 3*i+3 } }' >"$dir/deep.obj"
expect 2 . check --wide "$dir/deep.obj" --builder rtrs --eps 0 --leaf 1 --layout auto $small
grep -q 'auto refused: .*deep' "$dir/out" || bad "--layout auto says why nothing fits"

# A miss everywhere proves nothing.
printf 'v 0 0 0\nv 1e-6 0 0\nv 0 1e-6 0\nv 1 1 1\nf 1 2 3\nf 1 4 4\n' >"$dir/speck.obj"
expect 1 . check --wide "$dir/speck.obj" --rays random $small
grep -q 'vacuous' "$dir/out" || bad "a vacuous row says so"

# Output files: complete or not there.
expect 0 . check --wide soup $small --json "$dir/rows.json"
for key in rows layout builder leaf engine box tri query node_bytes rays hits counts differences \
    mrays_per_s median min max status reason; do
    grep -q "\"$key\"" "$dir/rows.json" || bad "--json: no key $key"
done
expect 2 'no-such-folder' check --wide soup $small --json "$dir/no-such-folder/rows.json"
# Vertices that moved: refitted and judged, or to be built anew.
expect 0 . check --wide sphere $small --move 0.01 --json "$dir/moved.json"
grep -q 'SAH cost of the tree of median [0-9.]* before, [0-9.]* refitted' "$dir/out" || bad "--move: cost"
grep -q '^  rf16: refitted in ' "$dir/out" || bad "--move: time"
grep -q sah_after "$dir/moved.json" || bad "--move: JSON"
# As random motion is, the tree is worse than before; the ratio is of what was built and packed.
awk '/"sah_before"/ { before = $2 + 0 } /"sah_after"/ { after = $2 + 0 }
    / before, .* refitted$/ { told = $(NF - 3) + 0; anew = $(NF - 1) + 0 }
    /refitted in .* built in/ { ratio = $(NF - 3) * $4; time = $10 + $14; off = 0.06 * $4 + 1
        ok += ratio - time < off && time - ratio < off; n++ }
    END { exit !(before < after && told - before < 0.06 && before - told < 0.06 && anew - after < 0.06 && after - anew < 0.06 && n > 1 && ok == n) }' \
    "$dir/moved.json" "$dir/out" || bad "--move: costs and times do not belong together"
expect 0 . check soup:n=300 --move 0.02 --layout f32,half4 --store indexed,compact --engine cpu --count 200 --repeat 1 --wide
[ "$(sed -n 's/^  \([a-z0-9/]*\): refitted in .*/\1/p' "$dir/out" | tr '\n' ' ')" = 'f32 f32/compact half4 half4/compact ' ] ||
    bad "--move: not a line for each layout and storage"
expect 2 . check --wide sphere $small --move 0.5 --layout bvh2_u8_scene
grep -q 'rebuild: bvh2_u8_scene: a box' "$dir/out" || bad "--move says what is to be built anew"
# A tree of a file was not built: what it took to build it is not told.
expect 0 . precompute --scene soup:n=40 --out "$dir/moves.json"
expect 0 . check soup:n=40 --bvh "$dir/moves.json" --move 0.1 --count 100 --repeat 1 --engine cpu --layout f32 --wide --json "$dir/moved.json"
awk -F'[:,]' '/"pack_ns"/ { pack = $2 / 40 } /"refit_ns"/ { refit = $2 / 40 } /"build_ns"/ { build = $2 }
    /: refitted in / { n++; sub(/^.*: /, ""); ok = $0 == sprintf("refitted in %.1f ns a triangle; packed in %.1f", refit, pack) }
    END { exit !(n == 1 && ok && build == 0) }' "$dir/moved.json" "$dir/out" || bad "--move of a tree that is read: $(grep refitted "$dir/out")"
expect 2 'is below 0' check --wide sphere $small --move -1
# Every allowed class and every kind of WRONG has a counter, also of 0, and docs/verdicts.md has it.
expect 0 'parity off in [0-9]* of [0-9]*$' check --wide sphere $small --query closest,any,all --json "$dir/rows.json"
for key in right tie near_tie boundary border in_plane slab noise out_of_contract; do
    grep -q "^  right [0-9]*; allowed:.* $key [0-9]\\|^  $key [0-9]*; allowed:" "$dir/out" || bad "check counts no $key"
    grep -q "\"$key\": [0-9]" "$dir/rows.json" || bad "--json counts no $key"
    grep -q "[\`*]$key[\`*]" docs/verdicts.md || bad "docs/verdicts.md does not tell of $key"
done
for key in missed phantom triangle distance barycentric not_finite not_repeatable any_disagrees \
    twice order masked culled opacity instance facing; do
    grep -q "WRONG (.*$key 0[,)]" "$dir/out" || bad "check counts no $key"
    grep -q "\"$key\": 0" "$dir/rows.json" || bad "--json counts no $key"
    grep -q "^| \`$key\` |" docs/verdicts.md || bad "docs/verdicts.md does not tell of $key"
done
for key in err_over_bound displacement lists double_hits parity_off closed; do
    grep -q "\"$key\": " "$dir/rows.json" || bad "--json has no $key"
done
expect 2 "queries are: closest, any, all" check --wide soup --query every $small
expect 0 . conform closest.cpu.f32.median.robust.mt.soup.random.1 --junit "$dir/junit.xml"
grep -q '<testcase' "$dir/junit.xml" || bad "--junit writes test cases"
expect 0 . conform closest.cpu.f32.median.robust.mt.soup.random.1 --tap
grep -q '^ok 1 - closest.cpu.f32' "$dir/out" || bad "--tap prints TAP"
printf 'closest.cpu.* never fails README.md\n' >"$dir/waivers"
expect 1 . conform closest.cpu.f32.median.robust.mt.soup.random.1 --waivers "$dir/waivers"
printf '# list\nclosest.cpu.* no link\n' >"$dir/waivers"
expect 2 'waivers:2: a waiver must end in a link' conform closest.cpu.f32.median.robust.mt.soup.random.1 --waivers "$dir/waivers"

# Storages.
expect 0 . conform closest.cpu.f32:compact.median.robust.woop.sphere.edges.7 --verbose
grep -q '^PASSED  closest.cpu.f32:compact.median.robust.woop.sphere.edges.7:' "$dir/out" || bad "conform: a name with a storage names itself"
expect 0 . conform 'closest.cpu.f32:*.median.robust.mt.soup.mixed.1' --list
grep -q '^closest.cpu.f32:edges\.' "$dir/out" || bad "conform: a pattern that names storages has them"
expect 0 . conform 'closest.cpu.f32*.median.robust.mt.soup.mixed.1' --list
grep -q : "$dir/out" && bad "conform: storages are played only where they are named"

# Hard cases.
hard=hard.03-border.closest.cpu.f32.median.robust.mt
expect 2 '--store: not used by the hard cases' conform --hard --store compact
expect 2 "no hard case matches 'hard.99-\*'" conform 'hard.99-*'
expect 0 . conform --hard --list
grep -q "^$hard\$" "$dir/out" || bad "conform --hard --list names every trial"
all=$(wc -l <"$dir/out")
expect 0 . conform --quick --list
[ "$(wc -l <"$dir/out")" -lt "$all" ] || bad "--quick leaves trials out"
grep -q "^$hard\$" "$dir/out" || bad "--quick keeps repaired members"
expect 0 . conform 'hard.79-*.closest.cpu.rf16_nearest.*' --verbose
grep -q '^KNOWN .*rounded_inward' "$dir/out" || bad "a known defect is shown for its cause"
expect 0 . conform $hard --summary --markdown "$dir/hard.md" --html "$dir/hard.html" --junit "$dir/hard.xml"
grep -q '^03  border  *\. *$' "$dir/out" || bad "--summary prints the matrix"
grep -q '^| 03 border | passed |$' "$dir/hard.md" || bad "--markdown writes the matrix"
grep -q '<td class="passed"' "$dir/hard.html" || bad "--html writes the matrix"
grep -q "name=\"$hard\"" "$dir/hard.xml" || bad "--junit writes hard cases"
expect 2 'no-such-folder' conform $hard --markdown "$dir/no-such-folder/hard.md"
printf '%s known README.md\n' "$hard" >"$dir/waivers"
expect 1 . conform $hard --waivers "$dir/waivers"
grep -q 'excused no failing trial' "$dir/out" || bad "a waiver that excuses nothing fails"

# Heat maps of several engines are named by them, before the ending of the file, not of its folder; that of one is not.
mkdir "$dir/a.b"
for out in x x.y.png; do
    expect 0 . diff cornell --engine cpu,embree,embree_robust -w 16 -h 12 --out "$dir/a.b/$out"
    expect 0 . diff cornell --engine cpu,embree -w 16 -h 12 --out "$dir/a.b/one-$out"
done
[ "$(ls "$dir/a.b" | LC_ALL=C sort | tr '\n' ' ')" = \
    'one-x one-x.y.png x-embree x-embree_robust x.y-embree.png x.y-embree_robust.png ' ] || bad "diff --out: $(ls "$dir/a.b")"
for one in x x.y.png; do
    of=$(echo "$one" | sed 's/^[^.]*\(\.y\)*/&-embree/')
    cmp -s "$dir/a.b/one-$one" "$dir/a.b/$of" || bad "diff --out: $of is not the map of embree alone"
done
expect 2 "^raydiff diff: 'soup' and --path rtrs: one scene" diff soup --path rtrs
# Explanations: one ray, a set, a trial's name.
expect 2 'no scene given' explain
expect 2 'one scene at a time' explain soup grid
expect 2 "ray: 5 numbers" explain soup --ray '0,0,0 1,1'
expect 2 "does not begin with a float32 number" explain soup --ray '0,0,0 1,1,x'
expect 2 "is beyond its eighth number" explain soup --ray '0,0,0 1,1,1 0,1 2'
expect 2 "goes without --rays" explain soup --ray '0,0,0 1,1,1' --index 3
expect 2 "20 is no ray here: 0 to 19" explain soup --rays random --count 20 --index 20
# Its default layout is one that holds the scene; a named one stays.
expect 0 . explain sphere:n=100 --count 100
grep -q 'no answer of cpu is wrong' "$dir/out" || bad "explain: no default layout for a large scene"
expect 2 'rf16: a child record index is at most 32767' explain sphere:n=100 --count 100 --layout rf16
expect 2 "unknown cause 'bad luck'" explain soup --cause 'bad luck'
expect 2 '--html: not used by --query all' explain soup --query all --html x.html
expect 2 "'closest,any' is not one name" explain soup --query closest,any
expect 2 "trial: unknown storage 'tape'" explain closest.cpu.f32:tape.median.robust.mt.soup.random.1
expect 2 "trial: unknown layout 'f31'" explain closest.cpu.f31.median.robust.mt.soup.random.1
expect 0 'conclusion: no list is wrong' explain all.cpu.f32.median.robust.mt.soup.vertices.1
expect 0 'conclusion: the list is right' explain soup --query all --index 3 --count 10
expect 2 "a leaf holds at most 8 items" explain soup --layout rf16 --leaf 9
expect 0 . explain "$dir/one.obj" --ray '0x1p-2,0.25,-1 0,0,1'
grep -q '^verdict   right' "$dir/out" || bad "explain: an answer that is right is not called so"
expect 0 . explain soup --rays random --count 2000
grep -q 'no answer of cpu is wrong' "$dir/out" || bad "explain says that nothing is wrong"
expect 1 . explain soup:n=300 --rays vertices --count 5000 --layout rtrs_rf_paper \
    --json "$dir/page.json"
grep -q '^cause     sentinel' "$dir/out" || bad "explain names the cause"
for key in cause truth answer judgement way words float16_steps float32_steps exact_enter tried \
    command bits; do
    grep -q "\"$key\"" "$dir/page.json" || bad "explain --json: no key $key"
done
again=$(sed -n 's/^again *raydiff //p' "$dir/out")
eval "expect 1 . $again"
grep -q '^cause     sentinel' "$dir/out" || bad "explain's own command line gives the same cause"
expect 0 . explain soup --store compact --layout f32 --ray '0,0,-1 0,0,1' --json "$dir/page.json"
grep -q 'layout f32:compact, .*' "$dir/out" || bad "explain says which storage"
grep -q '"store": "compact"' "$dir/page.json" || bad "explain --json says which storage"
grep -q '^again .* --store compact ' "$dir/out" || bad "explain's own command line names the storage"
expect 77 'edges holds no vertices: test woop' explain soup --store edges --layout f32 --tri woop --ray '0,0,-1 0,0,1'
expect 2 'storage quantised: .* lie on no grid' explain soup --store quantised --layout f32 --ray '0,0,-1 0,0,1'
expect 2 'goes without --store' explain soup --store compact --bvh none --ray '0,0,-1 0,0,1'
expect 1 . explain needles:n=300 --builder sbvh --rays random --count 3000 --layout rtrs_rf
grep -q '^cause     index_shifted' "$dir/out" || bad "explain names the cause in a split tree"
expect 0 'missed 0' check --wide needles:n=300 --builder sbvh --split-budget 2 --split-alpha 0 --query all \
    --layout f32,rf16,bvh8_u8_node --engine cpu --count 2000 --repeat 1
expect 2 'not a number from 0 to 64' precompute --scene needles --builder sbvh --split-budget 65 \
    --out "$dir/x"
expect 0 'missed 0' check --wide needles:n=300 --builder ploc --presplit 2 --query all \
    --layout f32,rf16,bvh8_u8_node --engine cpu --count 2000 --repeat 1
expect 2 'not a number from 0 to 64' precompute --scene needles --builder ploc --presplit 65 --out "$dir/x"
for builder in rtrs sbvh lbvh30 lbvh63 hploc; do
    expect 2 '^raydiff check: --presplit: not used here: it needs builder median sah_binned ' \
        check needles:n=9 --builder $builder --presplit 1
done
expect 1 . explain needles:n=300 --builder ploc --presplit 1 --rays random --count 3000 --layout rtrs_rf
grep -q '^cause     index_shifted' "$dir/out" || bad "explain names the cause in a tree of parts"
grep -q '^again .* --presplit 1 ' "$dir/out" || bad "explain's own command line names the parts"
inward=fuzz/corpus/rounded-inward.trial
expect 1 . explain $inward
grep -q '^cause     rounded_inward' "$dir/out" || bad "explain names the cause of a finding"
again=$(sed -n 's/^again     raydiff //p' "$dir/out")
cp "$dir/out" "$dir/page"
expect 1 . $again
cmp -s "$dir/page" "$dir/out" || bad "explain's own command shows the same page again"
expect 0 . explain $inward --layout rf16
grep -q '1 ray: no answer of cpu is wrong' "$dir/out" || bad "explain says of a file that nothing is wrong"
expect 0 . explain $inward --engine embree --index 0
expect 2 "^raydiff explain: --leaf: $inward brings its own" explain $inward --leaf 2
expect 2 "^raydiff explain: --rays: $inward brings its own" explain $inward --rays mixed
expect 2 "--index: 1 is no ray here: 0 to 0" explain $inward --index 1
expect 2 "none.trial" explain "$dir/none.trial"
# An engine that is not here is named, and another one can be; none was a SIGSEGV.
sed 's/^expect cpu[.]/expect gone./' $inward >"$dir/gone.trial"
expect 2 "^raydiff explain: .*gone.trial: engine 'gone' is not available: name one with --engine" explain "$dir/gone.trial"
expect 1 . explain "$dir/gone.trial" --engine cpu
grep -q '^cause     rounded_inward' "$dir/out" || bad "explain with another engine names the cause of a finding"
# A cause that says that it did not show again is not looked for.
sed 's/^expect .*/expect cpu.rtrs_rf_paper.missed.not_repeatable/' fuzz/corpus/sentinel.trial >"$dir/once.trial"
expect 1 . explain "$dir/once.trial" --wide
grep -q '^cause     sentinel' "$dir/out" || bad "explain names the cause of what was not repeatable"
grep -q '^engine  *cpu, layout rtrs_rf_paper, .*, query any$' "$dir/out" || bad "explain asks what the file asks"
expect 1 . explain closest.cpu.rtrs_rf_paper.median.robust.mt.soup.vertices.1 --count 5000
expect 2 'no-such-folder' explain "$dir/one.obj" --ray '0,0,-1 0,0,1' --json "$dir/no-such-folder/x"

# Any tracer: as a child process, over text in a shell's pipe, from files.
samples=$(dirname "$raydiff")/samples
peer="--count 2000 --repeat 1"
[ -x "$samples/tracer" ] || bad "no sample tracer: make tests builds it"
if [ -x "$samples/tracer" ]; then
    expect 0 . check --wide sphere --engine "pipe:$samples/tracer" $peer --json "$dir/peer.json"
    grep -q "^-  *pipe:.*tracer .* 0 *0 " "$dir/out" || bad "a peer is a row"
    grep -q '"engine": "pipe:' "$dir/peer.json" || bad "a peer is in the JSON"
    for bug in 1 2; do
        expect 1 . check --wide sphere --engine "pipe:$samples/tracer_bug$bug" $peer
        again=$(sed -n 's/^  explain: raydiff //p' "$dir/out" | head -n 1)
        eval "expect 1 . $again"
        grep -q '^verdict   WRONG' "$dir/out" || bad "a peer's WRONG ray can be explained"
    done
    expect 0 . check --wide sphere --engine "cpu,pipe:$samples/tracer,pipe:exec '$samples/tracer' a,b" $peer
    [ "$(grep -c '^-  *pipe:' "$dir/out")" -eq 2 ] || bad "two peers beside cpu, one with a comma"
    expect 0 . conform "closest.pipe:$samples/tracer.-.-.-.mt.soup.vertices.1"
    expect 0 . conform 'closest.*.vertices.1' --engine "pipe:$samples/tracer"
    expect 1 . conform 'closest.*.vertices.1' --engine "pipe:$samples/tracer_bug1"
    expect 0 . conform 'hard.28-*' --engine "pipe:$samples/tracer"
    expect 0 . leaks sphere:n=4 --count 1000 --engine "pipe:$samples/tracer"
fi
expect 77 . check --wide sphere --engine 'pipe:no-such-tracer' $peer
grep -q 'exit code 127' "$dir/out" || bad "a command that is not found is skipped, with the reason"
expect 3 . check --wide sphere --engine 'pipe:echo Hello, World, and all who sail in her' $peer
grep -q "begins with 'Hell', not with 'RDRA'" "$dir/out" || bad "a peer's nonsense is named"
expect 3 . check --wide sphere --engine 'pipe:sleep 100' --peer-time 1 $peer
grep -q 'late: ' "$dir/out" || bad "a peer that hangs is late"
expect 2 "'pipe:' is not pipe:COMMAND" check --wide sphere --engine pipe:
expect 2 "'0' is not a whole number from 1" check --wide sphere --peer-time 0
expect 2 "is not answer:FORMULA" explain soup --engine answer:x
expect 2 'no scene given' gen
expect 2 'not all' gen soup --query all
expect 2 'no-such-folder' gen soup --out "$dir/no-such-folder/x"
expect 0 . gen sphere:n=4 --count 60 --decimal --out "$dir/rays"
awk -f fuzz/samples/tracer.awk "$dir/rays" >"$dir/hits"
"$raydiff" verify <"$dir/hits" >"$dir/out" 2>"$dir/err" || bad "gen | awk | verify: the awk sample is right"
"$raydiff" gen sphere:n=4 --count 60 | awk -f fuzz/samples/tracer.awk >"$dir/exact"
"$raydiff" verify <"$dir/exact" >"$dir/out" 2>"$dir/err" || bad "the awk sample reads hexadecimal floats in any awk"
"$raydiff" verify <"$dir/hits" >"$dir/out" 2>"$dir/err"
grep -q 'set mixed, seed 1' "$dir/out" || bad "verify says what it judged"
expect 0 . judge sphere:n=4 "$dir/rays" "$dir/hits" --json "$dir/judged.json"
grep -q '"engine": "answer:unknown:ieee:0"' "$dir/judged.json" || bad "judge --json has the row"
awk '$1 == "h" && !n++ { $5 = ($5 + 60) % 128 } { print }' "$dir/hits" >"$dir/bad"
expect 1 . judge sphere:n=4 "$dir/rays" "$dir/bad"
again=$(sed -n 's/^  explain: raydiff //p' "$dir/out" | head -n 1)
eval "expect 1 . $again"
grep -q '^verdict   WRONG' "$dir/out" || bad "judge's explain command says why"
"$raydiff" verify <"$dir/bad" >"$dir/out" 2>"$dir/err"
[ $? -eq 1 ] || bad "verify: a wrong answer exits with 1"
expect 2 'SCENE, RAYS and HITS are needed' judge sphere "$dir/rays"
expect 2 "cannot both be '-'" judge sphere - -
expect 2 'hits: has h or m lines' judge sphere:n=4 "$dir/hits" "$dir/hits"
expect 2 'rays: has v, t or r lines' judge sphere:n=4 "$dir/rays" "$dir/rays"
grep -v '^r ' "$dir/rays" >"$dir/rayless"
expect 2 'rayless: has no ray' judge sphere:n=4 "$dir/rayless" "$dir/hits"
# No ray is drawn for a line `from` with an unknown set, or with a count that no request has.
for from in 's/ 60 mixed / 60 none_such /' 's/ 60 mixed / 0 mixed /' 's/ 60 mixed / 1073741825 mixed /'; do
    sed "/^from /$from" "$dir/hits" | "$raydiff" verify >"$dir/out" 2>"$dir/err"
    [ $? -eq 2 ] && grep -q "'from' names no ray set of any count" "$dir/err" || bad "verify: from, $from"
done
sed '/^from /s/ 60 mixed / 1073741824 mixed /' "$dir/hits" | "$raydiff" verify >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] && grep -q 'ends after 60 of 1073741824 answers' "$dir/err" || bad 'verify: from, more answers than there are'
expect 2 'for another scene than sphere:n=5' judge sphere:n=5 "$dir/rays" "$dir/hits"
head -n 11 "$dir/hits" >"$dir/bad"
expect 2 'bad:11: ends after 10 of 60 answers' judge sphere:n=4 "$dir/rays" "$dir/bad"
echo m | cat "$dir/hits" - >"$dir/bad"
expect 2 'bad:62: an answer to ray 60, but there are only 60 rays' judge sphere:n=4 "$dir/rays" "$dir/bad"
sed '5s/.*/h 1 0 0 128/' "$dir/hits" >"$dir/bad"
expect 2 'bad:5: triangle 128 is none of 128' judge sphere:n=4 "$dir/rays" "$dir/bad"
echo 'refused no spheres' >"$dir/bad"
expect 3 'bad: the tracer refused: no spheres' judge sphere:n=4 "$dir/rays" "$dir/bad"
grep -v '^from' "$dir/hits" | "$raydiff" verify >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] && grep -q "has no 'from' line" "$dir/err" || bad "verify needs the 'from' line"
sed 's/^from ./from f/' "$dir/hits" | sed 's/^from ff/from f0/' | "$raydiff" verify >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] && grep -q "for another scene or other rays" "$dir/err" || bad "verify knows a stale answer"
"$raydiff" verify </dev/null >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] && grep -q "standard input: is empty" "$dir/err" || bad "verify: no answer at all"

# RTRS's tree file: complete, byte for byte, or not there.
expect 2 '--out is missing' precompute --scene "$dir/one.obj"
expect 2 '--scene is missing' precompute --out "$dir/one.bvh.json"
expect 2 "'0' is not a whole number from 1" precompute --scene soup --out "$dir/x" --item-count 0
expect 2 'no-such-folder' precompute --scene soup --out "$dir/no-such-folder/x"
for i in 1 2 3 4 5; do echo 'f 1 2 3'; done | cat "$dir/one.obj" - >"$dir/copies.obj"
expect 2 'RTRS never ends here .fault F19, docs/rtrs-faults.md.' precompute --scene "$dir/copies.obj" --eps 0 --out "$dir/x"
[ ! -e "$dir/x" ] || bad "a refused precompute writes nothing"
expect 0 . precompute --scene "$dir/one.obj" --out "$dir/one.bvh.json" --item-count 4 --eps 0.02
printf '%s' '{"uniforms":[{"fst":0,"snd":0,"item_idx":0,"item_count":1,"bounds":{"min":[0.0,0.0,0.0],' \
    '"max":[1.0,1.0,0.0]}}],"indices":[0]}' | cmp -s - "$dir/one.bvh.json" ||
    bad "precompute writes RTRS's bytes"
expect 0 . precompute --scene "$dir/copies.obj" --builder median --out "$dir/x"

# Trees of others: packed or JSON, checked, whole or not at all.
sed 's/^v 1/v 70000/' "$dir/one.obj" >"$dir/far.obj"
expect 0 . precompute --scene soup:n=40 --out "$dir/tree.rdpk" --builder median --layout rf16
expect 0 . precompute --scene soup:n=40 --verify "$dir/tree.rdpk"
grep -q 'layout rf16, .* 0 boxes too small, 0 triangles in no leaf' "$dir/out" || bad "verify counts faults"
expect 2 'is of 40 triangles, the scene has 41' precompute --scene soup:n=41 --verify "$dir/tree.rdpk"
head -c 100 "$dir/tree.rdpk" >"$dir/cut.rdpk"
expect 2 'cut.rdpk: .* bytes, not 100' precompute --scene soup:n=40 --verify "$dir/cut.rdpk"
expect 0 . precompute --scene soup:n=40 --out "$dir/tree.json" --builder median
expect 0 . precompute --scene soup:n=40 --verify "$dir/tree.json"
sed 's/"max":\[[^]]*\]/"max":[0,0,0]/' "$dir/tree.json" >"$dir/small.json"
expect 1 . precompute --scene soup:n=40 --verify "$dir/small.json"
expect 2 '--out: not used by --verify' precompute --scene soup --verify "$dir/x" --out "$dir/y"
expect 2 'at most 65504' precompute --scene "$dir/far.obj" --layout rf16 --builder median --out "$dir/y"
[ ! -e "$dir/y" ] || bad "a layout that refuses leaves nothing"

# verify makes no more rays than there are answers.
sed 's/^\(from [^ ]* [^ ]*\) [0-9]*/\1 1000000000/' "$dir/hits" | "$raydiff" verify >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] && grep -q 'ends after .* of 1000000000 answers' "$dir/err" || bad "verify trusts no count"

# Benchmarks: small ones, complete files.
expect 0 . bench error --wide --scene 'sphere:n=3;soup:n=9,size=0.4' --count 300 --rounds 1 --engine cpu --rays vertices \
    --layout f32,rf16 --tri mt,woop --svg "$dir/e.svg" --csv "$dir/e.csv" --json "$dir/e.json"
grep -q '^cpu  *f32  *watertight  *woop' "$dir/out" || bad "bench error has a row per engine, layout and test"
[ "$(grep -c '^error,' "$dir/e.csv")" -eq 8 ] || bad "bench error --csv has a row per contestant"
grep -q '^error,"soup:n=9,size=0.4",9,vertices,' "$dir/e.csv" || bad "a CSV text with a comma is quoted"
[ "$(grep -c '"edge_leaks"' "$dir/e.json")" -eq 8 ] || bad "bench error --json has a row per contestant"
if command -v xmllint >/dev/null; then
    xmllint --noout "$dir/e.svg" 2>"$dir/err" || bad "bench error --svg is not well-formed"
fi
[ "$(grep -c '<circle' "$dir/e.svg")" -gt 8 ] || bad "bench error --svg shows no points"
expect 0 . bench spawn --wide --scene sphere:n=3 --count 300 --engine cpu --csv "$dir/s.csv" --json "$dir/s.json"
grep -q '^bary  *least' "$dir/out" || bad "bench spawn has a row per point and rule"
[ "$(grep -c '^spawn,sphere:n=3,' "$dir/s.csv")" -eq 252 ] || bad "bench spawn --csv has 6 places, 14 rows, 3 judges"
expect 1 . bench spawn --scene "$dir/speck.obj" --count 20 --engine cpu
grep -q 'vacuous' "$dir/out" || bad "bench spawn says that a scene without hits proves nothing"
expect 2 'no-such-folder' bench error --scene sphere:n=3 --count 10 --rounds 1 --engine cpu --svg "$dir/no-such-folder/x.svg"
expect 2 . bench error --scene soup:n=100000,size=0.001 --layout rf16 --engine cpu --count 10 --rounds 1

# A command that is interrupted leaves nothing half-written.
timeout -s INT 2 "$raydiff" conform --junit "$dir/ended.xml" >"$dir/out" 2>"$dir/err"
[ $? -ne 0 ] || bad "conform was not interrupted"
timeout -s TERM 2 "$raydiff" bench builders --scene sphere:n=100 --rounds 99 --csv "$dir/ended.csv" >"$dir/out" 2>"$dir/err"
[ -z "$(find "$dir" -name 'ended*')" ] || bad "a command that is interrupted leaves files"

# A full disk behind the standard output is said, whatever the verdict.
if [ -w /dev/full ]; then
    for command in list 'check soup '"$small" 'check --help' --help 'scene list'; do
        # shellcheck disable=SC2086 # words of a command
        "$raydiff" $command >/dev/full 2>"$dir/err"
        [ $? -eq 2 ] || bad "raydiff $command >/dev/full is exit code 2"
        grep -q 'cannot write to .*standard output' "$dir/err" || bad "raydiff $command >/dev/full says nothing"
    done
fi

# Leaks: closed meshes only, rows that promise fail, others are counted.
few="--count 1000 --layout f32 --engine cpu"
expect 2 'no scene given' leaks
expect 2 "unknown name 'opengl'; profiles are: vulkan, dxr" leaks sphere --profile opengl
expect 2 'no closed mesh: triangle 0, edge of vertices 0 .* the mesh is open there' leaks "$dir/one.obj" $few
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 4 2\nf 1 4 3\nf 2 3 4\n' >"$dir/turned.obj"
expect 2 'a triangle is turned round' leaks "$dir/turned.obj" $few
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n' >"$dir/flat.obj"
expect 2 'flat.obj: no point inside' leaks "$dir/flat.obj" $few
expect 0 . leaks --wide sphere:n=4 $few --tri mt,woop --json "$dir/leaks.json"
grep -q 'mt .* counted$' "$dir/out" || bad "leaks: a row that promises nothing is counted"
grep -q 'watertight *woop .* kept$' "$dir/out" || bad "leaks: woop keeps its word"
for key in profile scenes aimed_exactly promises broken total aims vertex beside misses double_hits even \
    lost phantoms repeated bit_differences findings; do
    grep -q "\"$key\"" "$dir/leaks.json" || bad "leaks --json: no key $key"
done
expect 1 . leaks --wide sphere:n=4 $few --tri woop --box watertight --profile dxr
grep -q 'BROKEN: .* hit twice' "$dir/out" || bad "leaks: woop breaks the DXR rule, and it is said"
expect 0 . leaks --wide sphere --count 1000 --engine cpu --layout rtrs_rf,f32 --tri woop --box watertight
grep -q '^rtrs_rf .* counted$' "$dir/out" || bad "leaks: a member as published promises nothing"
grep -q '^f32 .* kept$' "$dir/out" || bad "leaks: what stands beside it does"
expect 1 . leaks --wide sphere:n=4 --count 999 --layout f32 --engine cpu
grep -q 'vacuous: 999 rays' "$dir/out" || bad "leaks: too few rays are vacuous"
expect 2 . leaks --wide sphere:n=4 $few --layout rf16 --leaf 9
expect 0 . leaks --wide sphere:n=4 $few --tri woop --box watertight --store indexed,compact --json "$dir/leaks.json"
grep -q '^f32:compact .* kept$' "$dir/out" || bad "leaks: a storage keeps its word"
grep -q '"store": "compact"' "$dir/leaks.json" || bad "leaks --json says which storage"
expect 2 'goes without --store' leaks sphere:n=4 --store compact --bvh none
expect 2 . leaks --wide sphere:n=4 $few --store quantised
grep -q 'refused: storage quantised: ' "$dir/out" || bad "leaks: a storage that holds nothing of the scene is not a pass"
expect 2 'no-such-folder' leaks sphere:n=4 $few --json "$dir/no-such-folder/x"

[ -z "$(ls "$dir" | grep -i tmp)" ] || bad "a temporary file was left behind"

# Scenes: what they are, and from one format to another.
expect 2 'info, convert or list' scene
expect 2 "unknown action 'inform'" scene inform
expect 2 'no scene given' scene info
expect 2 "unknown option: '--jsonn'; did you mean --json?" scene info soup --jsonn
expect 2 'one scene and one file are needed' scene convert soup
expect 2 "unknown scene 'suop'" scene info suop
expect 2 "soup: 'm' is no parameter; known are n, size, offset, seed" scene info soup:m=3
expect 2 'soup: n=-1 must be a number from 0' scene info soup:n=-1
expect 0 . scene list
grep -q 'terrain' "$dir/out" || bad "scene list names the generators"
expect 0 . scene info "$dir/one.obj" soup:n=7,seed=3 --json
for key in triangles vertices least most longest_side largest_coordinate zero_area duplicates lights \
    materials camera; do
    grep -q "\"$key\"" "$dir/out" || bad "scene info --json: no key $key"
done
grep -q '"triangles": 7' "$dir/out" || bad "scene info --json counts triangles"
expect 2 'past.obj:4: ' scene info "$dir/one.obj" "$dir/past.obj"
grep -q 'triangles  *1$' "$dir/out" || bad "a bad scene does not hide the good one before it"
expect 0 . scene convert soup:n=50 "$dir/a.ply"
expect 0 . scene convert "$dir/a.ply" "$dir/b.json"
expect 0 . scene convert "$dir/b.json" "$dir/c.obj"
grep -q 'not kept' "$dir/out" || bad "convert says what the format cannot hold"
expect 0 . scene convert "$dir/c.obj" "$dir/d.ply"
cmp -s "$dir/a.ply" "$dir/d.ply" || bad "a scene keeps every bit through all formats"
expect 2 'unknown ending' scene convert soup "$dir/x.off"
expect 2 'cannot write' scene convert soup "$dir/no-such-folder/x.ply"
[ -z "$(ls "$dir" | grep -i tmp)" ] || bad "a temporary file was left behind"

# Findings played again.
corpus=fuzz/corpus
expect 2 'no file given' replay
expect 2 'nothing.trial: No such file' replay "$dir/nothing.trial"
expect 2 "unknown name 'rf17'" replay $corpus/sentinel.trial --layout rf17
head -c 400 $corpus/rounded-inward.trial >"$dir/cut.trial"
expect 2 'cut.trial:[0-9]+: ' replay "$dir/cut.trial" $corpus/sentinel.trial
expect 1 . replay $corpus/rounded-inward.trial
for line in ': STILL FAILS$' '<- expected$' '^  then     raydiff' '^  now      raydiff' '^cause     rounded_inward' \
    '^again     raydiff replay .*rounded-inward.trial --engine cpu --layout rtrs_rf_paper$'; do
    grep -q -- "$line" "$dir/out" || bad "replay prints no line like /$line/"
done
expect 0 . replay $corpus/rounded-inward.trial --brief --as-expected
[ "$(wc -l <"$dir/out")" -eq 1 ] || bad "replay --brief prints a line per file"
expect 0 . replay $corpus/rounded-inward.trial --layout rf16 --json "$dir/replay.json"
grep -q ': does not fail$' "$dir/out" || bad "replay says that a repaired layout does not fail"
for key in files expect fails exit then now played engine layout status reason findings; do
    grep -q "\"$key\": " "$dir/replay.json" || bad "replay --json: no key $key"
done
expect 0 . replay $corpus/rounded-outward.trial --engine cpu
expect 1 . replay $corpus/rounded-outward.trial --layout rtrs_rf_paper --engine cpu
grep -q ': FAILS$' "$dir/out" || bad "replay says that a clean file fails"
expect 1 . replay $corpus/rounded-outward.trial --layout rtrs_rf_paper --as-expected --brief
# Its cause shows on the second ray only; the first is lost for another one.
awk '/^vertices/ { print; print "-100 -10 0\n-101 -10 0\n-100 -11 0"; skip = 3; next }
    skip > 0 { skip--; next }
    /^rays/ { print "rays 2\n-100.25 -10.25 9 0 0 -1 0 inf"; next }
    { print }' $corpus/rounded-inward.trial >"$dir/behind.trial"
expect 1 . replay "$dir/behind.trial" --engine cpu
grep -q 'missed rounded_inward, ray 1 .*<- expected$' "$dir/out" || bad "replay finds a cause behind another"
sed 's/^expect .*/expect cpu.rtrs_rf_paper.missed.sentinel/' "$dir/behind.trial" >"$dir/before.trial"
expect 1 . replay "$dir/before.trial" --engine cpu
grep -q 'missed sentinel, ray 0 .*<- expected$' "$dir/out" || bad "replay finds the first cause"
sed 's/^expect .*/expect cpu.f32.missed.stack/' $corpus/sentinel.trial >"$dir/other.trial"
expect 0 . replay "$dir/other.trial" --engine cpu
expect 1 . replay "$dir/other.trial" --engine cpu --as-expected
sed 's/^expect .*/expect pipe:true.-.protocol.unexplained/' $corpus/sentinel.trial >"$dir/peer.trial"
expect 2 "name its command: --engine 'pipe:COMMAND'" replay "$dir/peer.trial"
expect 1 . replay "$dir/peer.trial" --engine pipe:true
grep -q 'crashed: pipe:true: it ended with exit code 0.*, as expected$' "$dir/out" || bad "replay says what a peer did"
expect 3 . replay $corpus/rounded-outward.trial --engine cpu,pipe:false
expect 2 'no-such-folder' replay $corpus/rounded-outward.trial --engine cpu --json "$dir/no-such-folder/x"

# Findings for people without raydiff.
expect 2 'no file given' export
expect 2 'one file at a time' export $corpus/sentinel.trial $corpus/wrong-item.trial
expect 2 'nothing.trial: No such file' export "$dir/nothing.trial"
expect 2 "'basic' is not c, amber or text" export $corpus/sentinel.trial --form basic
expect 2 "unknown name 'rf17'" export $corpus/sentinel.trial --layout rf17
expect 2 "'cpu' is raydiff's own C.*--engine vulkan" export $corpus/sentinel.trial
expect 2 "tracer of its own: --form text" export "$dir/peer.trial"
expect 2 "not engine embree: --form c" export $corpus/sentinel.trial --engine embree --form amber
expect 2 'there is no ray 1: the file has 1' export $corpus/sentinel.trial --engine vulkan --ray 1
expect 2 'no-such-folder' export $corpus/sentinel.trial --engine vulkan --to "$dir/no-such-folder/x"
expect 0 . export $corpus/sentinel.trial --engine vulkan --to "$dir/finding.c"
[ "$(wc -l <"$dir/out")" -eq 1 ] || bad "export --to prints more than what it wrote"
grep -q 'cc finding.c -lvulkan -o finding' "$dir/finding.c" || bad "export says how to compile the file that it wrote"
grep -qx "wrote $dir/finding.c, but C on the same bytes is wrong, too: no driver is at fault" "$dir/out" ||
    bad "export says that C fails there, too"
expect 0 . export $corpus/sentinel.trial --engine vulkan --layout rf16 --to "$dir/other.c"
grep -qx "wrote $dir/other.c, but the expected failure did not occur here: every answer was right" "$dir/out" ||
    bad "export: it is not told that nothing failed"
expect 0 . export $corpus/sentinel.trial --engine vulkan --layout rf16 --to -
echo "raydiff export: $corpus/sentinel.trial: the expected failure did not occur here: every answer was right" | cmp -s - "$dir/err" ||
    bad "export --to -: it is not told that nothing failed"
expect 0 . export $corpus/eighth-slot.trial --engine vulkan --to "$dir/other.c"
grep -qx "wrote $dir/other.c" "$dir/out" || bad "export: a finding on which C is right has a remark"
# The help's example shows a wrong answer, wherever a device can run it.
shown=$("$raydiff" export --help | sed -n 's/^example: raydiff \(.*\) --to x\.c$/\1/p')
expect 0 . ${shown:-no-example} --to "$dir/shown.c"
cc -o "$dir/shown" "$dir/shown.c" -lvulkan || bad "export: the help's example is not compiled"
"$dir/shown" >"$dir/out" 2>&1
code=$?
[ "$code" -eq 2 ] || { [ "$code" -eq 1 ] && grep -q '^1 of 1 rays WRONG: the bug shows$' "$dir/out"; } || bad "export: the help's example shows nothing wrong"
expect 0 . export $corpus/rounded-outward.trial --form text
"$raydiff" gen sphere:n=4 --count 1 | grep -c '^from ' | grep -qx 1 || bad "gen says where a scene comes from"
grep -q '^from ' "$dir/out" && bad "export --form text claims to come from a generator"
awk -f fuzz/samples/tracer.awk "$dir/out" | grep -q '^h ' || bad "a text tracer reads export --form text"

# Findings made smaller.
expect 2 'no file or folder given' min
expect 2 'one at a time' min $corpus/sentinel.trial $corpus/wrong-item.trial
expect 2 'nothing.trial: No such file' min "$dir/nothing.trial"
expect 2 "it expects 'clean'" min $corpus/rounded-outward.trial
expect 2 "name its command: --engine 'pipe:COMMAND'" min "$dir/peer.trial"
expect 2 'is no folder of findings' min "$dir"
expect 2 'are for a file' min "$dir" --force
expect 2 'no-such-folder' min $corpus/sentinel.trial --out "$dir/no-such-folder/x"
expect 1 . min "$dir/other.trial"
grep -q 'does not show here; nothing was written' "$dir/out" || bad "min says that nothing shows"
[ ! -e "$dir/other.min.trial" ] || bad "min writes what does not show"
cp $corpus/rounded-inward.trial "$dir/big.trial"
expect 0 . min "$dir/big.trial"
for line in '^  before   2 triangles, 1 ray, 6 vertices' '^  after    2 triangles, 1 ray, 3 vertices' \
    '^  cause    rounded_inward: ' "^  replay   raydiff replay $dir/big.min.trial$"; do
    grep -q -- "$line" "$dir/out" || bad "min prints no line like /$line/"
done
expect 0 . replay "$dir/big.min.trial" --engine cpu --as-expected
expect 2 'is there already: --force or --out' min "$dir/big.trial"
expect 0 . min "$dir/big.trial" --force
expect 0 . min "$dir/big.min.trial"
grep -q 'wrote    nothing: it is the smallest' "$dir/out" || bad "min makes its own result smaller"
expect 0 . min "$dir/big.min.trial" --out "$dir/same.trial" --json "$dir/min.json"
cmp -s "$dir/big.min.trial" "$dir/same.trial" || bad "min --out writes another trial"
for key in signature result end before after bytes asks tried accepted rounds written exit; do
    grep -q "\"$key\": " "$dir/min.json" || bad "min --json: no key $key"
done
expect 1 . fuzz --trials 40 --rays 100 --jobs 1 --corpus none --faithful --engine cpu --layout rtrs_rf,rtrs_direct \
    --no-shrink --dir "$dir/findings"
expect 0 . min "$dir/findings"
grep -Eq ' [1-9][0-9]* of them smaller now$' "$dir/out" || bad "min of a folder makes nothing smaller"
for file in "$dir"/findings/*missed*/smallest.trial; do
    [ "$(wc -c <"$file")" -le 4096 ] || bad "$file is larger than 4 kB"
    expect 0 . replay "$file" --engine cpu --brief --as-expected
done
expect 0 . min "$dir/findings"
grep -q ' 0 of them smaller now$' "$dir/out" || bad "min of a folder makes its own results smaller"
bug=$(dirname "$raydiff")/samples/tracer_bug1
if [ -x "$bug" ]; then
    expect 1 . fuzz --trials 20 --rays 100 --jobs 1 --corpus none --engine "pipe:$bug" --no-shrink --dir "$dir/peer"
    expect 0 . min "$dir/peer" --engine "pipe:$bug"
    grep -Eq 'pipe:tracer_bug1.* [1-4], 1 .* smaller' "$dir/out" || bad "min of a peer's bug leaves it as large as it was"
fi

# The self-test of the fuzzer, where nothing is built, and with a program that finds nothing.
expect 2 "rayquery:fast_build:low_memory:allow_upd...: findings hold engines' names of up to 94 characters, this has 115" fuzz \
    --engine cpu,rayquery:fast_build:low_memory:allow_update:allow_compaction:clone:split4:turned:u16:stride24:offset:nan:degenerate \
    --dir "$dir/pairs"
[ ! -e "$dir/pairs" ] || bad "fuzz makes a folder for engines whose names findings do not hold"
expect 2 "--pairs: draws members at random, so not with" fuzz --pairs 3 --shard 1/2 --dir "$dir/pairs"
expect 1 . fuzz --pairs 65 --trials 64 --engine embree --corpus none --dir "$dir/own-pair"
grep -q "^short  *1 pair met in fewer than 65 trials" "$dir/out" || bad "fuzz --pairs: an engine of its own tree is not counted"
expect 1 . fuzz --pairs 1000 --trials 64 --engine cpu,fast --layout f32,bvh8_u8_node --dir "$dir/pairs" --json "$dir/pairs.json"
awk 'FILENAME ~ /txt$/ { met++; if (least == "" || $3 < least) least = $3; next }
    /^ *"(possible|impossible|met|least|median|below)": / { gsub(/[":,]/, ""); json[$1] = $2 }
    /^pairs / { can = $2; told = $7 }
    /^short / { short = $2 }
    END { exit !(met > 9 && json["met"] == met && told == met && can == json["possible"] && can >= met &&
        (can > met ? json["least"] == 0 : json["least"] == least) && short == can && json["below"] == can) }' \
    "$dir/pairs/pairs.txt" "$dir/pairs.json" "$dir/out" || bad "fuzz --pairs: file, JSON and text tell of other pairs"
grep -q '^short  *[0-9]* pairs met in fewer than 1000 trials' "$dir/out" ||
    bad "raydiff fuzz --pairs: it does not say that the time was short"
expect 2 "no planted bugs in .*/none: type .make selftest" fuzz --self-test --programs "$dir/none"
mkdir -p "$dir/planted/LOST_SLOT.trace"
echo 'LOST_SLOT ref/trace/trace.c cpu f32 slots' >"$dir/planted/selftest.txt"
expect 2 "LOST_SLOT.trace is not built" fuzz --self-test --programs "$dir/planted"
expect 2 "no bug is 'NONE'" fuzz --self-test --programs "$dir/planted" --only NONE
printf '#!/bin/sh\necho sick\nexit 4\n' >"$dir/planted/LOST_SLOT.trace/raydiff"
chmod +x "$dir/planted/LOST_SLOT.trace/raydiff"
expect 1 . fuzz --self-test --control 16 --programs "$dir/planted" --json "$dir/self.json"
[ "$(tail -n 1 "$dir/out")" = "found 0 of 1" ] || bad "fuzz --self-test: the last line is not its sum"
grep -q '"passed": false' "$dir/self.json" || bad "fuzz --self-test --json: passed"
# One without a bug that finds something fails it, even where every bug is found.
mkdir -p "$dir/unclean/LOST_SLOT.trace"
echo 'LOST_SLOT ref/trace/trace.c cpu rtrs_rf slots' >"$dir/unclean/selftest.txt"
case $raydiff in /*) ;; *) raydiff=$PWD/$raydiff ;; esac
printf '#!/bin/sh\nexec "%s" "$@"\n' "$raydiff" >"$dir/unclean/LOST_SLOT.trace/raydiff"
chmod +x "$dir/unclean/LOST_SLOT.trace/raydiff"
expect 1 . fuzz --self-test --control 256 --programs "$dir/unclean" --json "$dir/self.json"
grep -q '^without a bug 0 of 1 clean$' "$dir/out" || bad "fuzz --self-test: a control that finds something is clean"
[ "$(tail -n 1 "$dir/out")" = "found 1 of 1" ] || bad "fuzz --self-test: a bug that is found is not"
grep -q '"passed": false' "$dir/self.json" || bad "fuzz --self-test --json: passed, and the control is not clean"
expect 0 . fuzz --self-test --shaders

# Two pictures.
picture() { echo "$2" | base64 -d >"$dir/$1.png"; }
picture rgb iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAE0lEQVR42mP4z8DAAMIM/zk5OQEaKgMZWsSx5QAAAABJRU5ErkJggg==
picture other iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFUlEQVR42mP4z8DA8A+IGf5zcnMCABolAxotJONlAAAAAElFTkSuQmCC
picture gray iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR42mNoAAAAggCB2kUIOwAAAABJRU5ErkJggg==
head -c 50 "$dir/rgb.png" >"$dir/cut.png"
expect 0 . diff "$dir/rgb.png" "$dir/rgb.png"
grep -q 'different  *0 of 4 ' "$dir/out" || bad "diff: a picture differs from itself"
expect 1 . diff --out "$dir/heat.png" "$dir/rgb.png" "$dir/other.png" --json "$dir/diff.json"
grep -q 'within  *x 1 to 1, y 0 to 1' "$dir/out" || bad "diff: does not say where"
grep -q '"different": 2' "$dir/diff.json" || bad "diff --json: does not say how many"
expect 0 . diff "$dir/rgb.png" "$dir/other.png" --max 2
expect 1 . diff "$dir/rgb.png" "$dir/other.png" --max 1
expect 2 'sides must be equal' diff "$dir/rgb.png" "$dir/gray.png"
expect 2 'cut.png: damaged PNG file: cut short' diff "$dir/rgb.png" "$dir/cut.png"
expect 2 'none.png: No such file' diff "$dir/none.png" "$dir/rgb.png"
expect 2 'two PNG files are compared, not 1' diff "$dir/rgb.png"
expect 2 "'256' is not a whole number from 0" diff "$dir/rgb.png" "$dir/rgb.png" --max 256
expect 2 'cannot write: No such file' diff "$dir/rgb.png" "$dir/other.png" --out "$dir/none/heat.png"
expect 1 . diff "$dir/rgb.png" "$dir/other.png" --json -
head -c 1 "$dir/out" | grep -q '^{' || bad "diff --json - prints more than JSON"

# '-' is the standard output of every --json, and no other file.
stands_alone() {
    head -c 1 "$dir/out" | grep -q '^{' || bad "$1 --json - prints more than JSON"
    tail -n 1 "$dir/out" | grep -q '^}' || bad "$1 --json - prints more than JSON"
    [ "$(grep -c . "$dir/err")" -gt 1 ] || bad "$1 --json - hides its report"
}
for arguments in "check soup $small" "leaks sphere:n=4 $few" "judge sphere:n=4 $dir/rays $dir/hits" \
    "replay $corpus/rounded-outward.trial --engine cpu" "min $dir/big.min.trial"; do
    expect 0 . $arguments --json -
    stands_alone "raydiff $arguments"
done
expect 0 . explain "$dir/one.obj" --ray '0.25,0.25,-1 0,0,1' --json -
stands_alone explain
expect 77 . doctor --driver no-such-driver --json -
stands_alone doctor
expect 1 . fuzz --self-test --control 16 --programs "$dir/planted" --json -
stands_alone "fuzz --self-test"
for arguments in 'bench error --svg' 'conform --junit' 'conform --markdown' 'fuzz --tap' \
    'gen soup --out' 'precompute --scene soup --out'; do
    expect 2 "needs a file, not '-'" $arguments -
done
[ ! -e ./- ] || bad "a file named - was written"

# RTRS's numbers (Figure 8 of its paper), on its scene.
expect 0 . check --wide rtrs --builder rtrs --eps 0.02 --leaf 2 --layout rtrs_direct $small --json "$dir/f8.json"
grep -q '"node_bytes": 2448' "$dir/f8.json" || bad "rtrs_direct at leaf 2 needs 2,448 bytes"
expect 0 . check --wide rtrs --builder rtrs --eps 0.02 --leaf 4 --layout rtrs_rf $small --json "$dir/f8.json"
grep -q '"node_bytes": 656' "$dir/f8.json" || bad "rtrs_rf at leaf 4 needs 656 bytes"

# An engine that cannot run: skipped by default, 77 when named. Mesa's driver loses 128 bytes when it
# is unloaded without a device having been made, and is gone when a sanitizer asks whose they were.
export ASAN_OPTIONS=detect_leaks=0
expect 77 . check --wide soup --count 200 --repeat 1 --engine vulkan --driver no-such-driver
expect 77 . leaks sphere:n=4 --count 1000 --engine vulkan --driver no-such-driver
expect 77 . explain soup --engine vulkan --driver no-such-driver
expect 77 "fewer than two .* can run here: .*no-such-driver" diff sphere:n=2 -w 16 -h 16 --engine cpu,vulkan --driver no-such-driver
expect 77 . replay fuzz/corpus/sentinel.trial --engine vulkan --driver no-such-driver
expect 0 . check --wide soup --count 200 --repeat 1 --driver no-such-driver

echo "cli: $failed failed"
[ "$failed" -eq 0 ]
