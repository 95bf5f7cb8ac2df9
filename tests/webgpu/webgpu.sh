#!/bin/sh
# Engine webgpu, from the command line. Without Node, too: why it is skipped, and what becomes of a process that ends,
# hangs, crashes or talks nonsense. Where Node and Dawn are (make webgpu), on each driver of make drivers: six layouts,
# both queries, all tests, judged by WGSL's bounds; RTRS's published faults; an installed program.
#   sh tests/webgpu/webgpu.sh BUILD/raydiff [faults|published]   only what needs no Node, or only RTRS's layouts and bits
set -u
raydiff=$1 part=${2-all}
. tests/scripts/expect.sh
here=$(pwd)
dawn=${RAYDIFF_WEBGPU:-$here/build/webgpu}
drivers=${RAYDIFF_DRIVERS:-$here/build/drivers}
unset RAYDIFF_WEBGPU RAYDIFF_DRIVERS

soup='soup:n=9 --count 9 --repeat 1'

# --- what is missing is told, with the remedy -------------------------------------------------------------------------
faults() {
mkdir -p "$dir/none" "$dir/fake/node_modules/webgpu" "$dir/bin"
: >"$dir/fake/node_modules/webgpu/index.js"
cp tests/webgpu/fake_node.pl "$dir/bin/node"
chmod +x "$dir/bin/node"
PATH=$dir/none expect 77 . check $soup --engine webgpu --layout f32
has 'no Node' '^skipped f32 +webgpu webgpu: node is not in PATH \(Debian'
export RAYDIFF_WEBGPU="$dir/none"
PATH=$dir/bin:$path
expect 77 . check $soup --engine webgpu --layout f32
has 'no Dawn' '^skipped f32 +webgpu webgpu: Dawn is not in '
export RAYDIFF_WEBGPU="$dir/fake"
expect 77 . check $soup --engine webgpu --layout f32 --driver "$dir/none.json"
has 'no driver' '^skipped f32 +webgpu vulkan: driver file '

# --- a process that is not well ---------------------------------------------------------------------------------------
late=1
fails() { # way, exit code, what the row says
    FAKE_NODE=$1 expect "$2" . check $soup --engine webgpu --layout f32 --peer-time "$late" --json "$dir/fake.json"
    grep -qE -- "\"reason\": \".*$3" "$dir/fake.json" || bad "a process that $1: no reason like /$3/"
    case $2 in 3) status=failed ;; *) status=skipped ;; esac # what it refuses it cannot do, and does not fail
    grep -q "\"status\": \"$status\"" "$dir/fake.json" || bad "a process that $1: the row is not $status"
}
fails ends 3 'ended with exit code 9 '
fails crashes 3 'ended by signal 11 '
fails aborts 3 'ended by signal 6 before the answer to ray 0'
fails hangs 3 'late: not done within 1 s'
fails magic 3 "begins with 'RDRX'"
fails counts 3 'is about 10 rays, not 9'
fails short 3 'after the answer to ray 7'
fails long 3 "longer than 9 rays|wrote more bytes|begins with 'xRDR'"
fails refuses 77 'webgpu: no device for me; it said: a line of the driver'
fails 'refuses a tree' 1 'webgpu: too large'
FAKE_WORDS='0 0 0 4294967295 3' fails 'has no end' 3 'ray 0 was not finished'
FAKE_WORDS='0 0 0 9 1' fails 'names none' 3 'ray 0 names triangle 9 of 9'
FAKE_WORDS='0 0 0 4294967295 0' fails 'does not run' 3 'ray 0 was not finished'
# The ray is told by its number among all, whichever of the requests of 65,536 it is in.
soup='soup:n=9 --count 140000 --repeat 1' late=60
for ray in 1 65535 65536 65537 131072 139999; do
    FAKE_AT=$ray FAKE_WORDS='0 0 0 4294967295 3' fails "does not finish ray $ray" 3 "ray $ray was not finished"
    FAKE_AT=$ray FAKE_WORDS='0 0 0 9 1' fails "names none for ray $ray" 3 "ray $ray names triangle 9 of 9"
done
soup='soup:n=9 --count 9 --repeat 1'

# It answers, and what it answers is judged: it misses everything.
FAKE_NODE=noisy expect 1 . check sphere:n=4 --count 200 --repeat 1 --engine webgpu --layout f32
has 'misses everything' '^WRONG   f32 +webgpu +[1-9]' '^ +missed +[0-9]+|missed [0-9]+'
# What the device holds: the tree, and nine floats for each triangle.
for scene in sphere:n=4 soup:n=37; do
    for layout in f32 rf16 cwbvh80; do
        FAKE_NODE=noisy expect 1 . check $scene --count 50 --repeat 1 --engine webgpu --layout $layout --json "$dir/held.json"
        awk -f tests/values/flat.awk "$dir/held.json" | awk -F= '
            { v[$1] = $2 }
            END {
                exit !(v["scenes.0.triangles"] > 0 && v["rows.0.memory_bytes"] == \
                    v["rows.0.node_bytes"] + v["rows.0.item_bytes"] + 36 * v["scenes.0.triangles"])
            }' || bad "$scene, $layout: not the bytes of the tree and of the triangles"
    done
done
# Each row's program is given once, whatever was given before, and no two are the same.
FAKE_GIVEN=$dir/given FAKE_NODE=noisy expect 1 . check sphere:n=4 soup:n=37 --count 50 --repeat 1 --engine webgpu \
    --layout f32,rf16 --tri mt,woop --query closest,any
[ "$(grep -cE '^(WRONG|agrees|vacuous) .* webgpu ' "$dir/out")" -eq 16 ] || bad 'not 16 rows of webgpu'
[ "$(wc -l <"$dir/given")" -eq 16 ] && [ "$(sort -u "$dir/given" | wc -l)" -eq 16 ] ||
    bad "not 16 programs are given, but $(sort "$dir/given" | uniq -c | awk '{ print $1 }' | paste -sd+)"
# What Node is told of the driver: a card, any device, or one of that name; a file by the loader's variables alone.
: >"$dir/some.json"
told() { # option, what is told
    FAKE_TOLD=$dir/told FAKE_NODE=refuses VK_DRIVER_FILES='' VK_ICD_FILENAMES='' \
        expect 77 . check $soup --engine webgpu --layout f32 ${1:+--driver "$1"}
    [ "$(cat "$dir/told")" = "$2" ] || bad "--driver '$1': node is told $(cat "$dir/told"), not $2"
}
told '' 'any of -'
told hardware 'hardware of -'
told lava 'any adapter=lava of -'
told 'a part' 'any adapter=a part of -'
told "$dir/some.json" "any of $dir/some.json"
FAKE_NODE=refuses expect 0 . doctor # the other way it waits for a card, for a minute
grep -A2 '^webgpu  *SKIPPED' "$dir/out" | grep -q 'no device for me; it said: a line of the driver' || bad 'doctor: no reason'
expect 0 . list engines
has list '^  webgpu +WGSL'
PATH=$path
unset RAYDIFF_WEBGPU
}

path=$PATH
[ "$part" = published ] || faults
[ "$part" != faults ] || exit "$((failed > 0))"

# --- Dawn -------------------------------------------------------------------------------------------------------------
skip() { echo "SKIP webgpu: $1"; [ "$failed" -eq 0 ] && exit 77; exit 1; }
command -v node >/dev/null || skip 'node is needed (Debian: nodejs)'
export RAYDIFF_WEBGPU="$dawn" RAYDIFF_DRIVERS="$drivers"
[ -s "$dawn/node_modules/webgpu/index.js" ] || skip 'Dawn is needed: make webgpu'
[ -s "$drivers/swiftshader/icd.json" ] || skip 'SwiftShader is needed: make drivers'
layouts='f32,rf16,cwbvh80'
published='rtrs_direct,rtrs_rf,rtrs_rf_paper'

for driver in swiftshader mesa25; do
    [ -s "$drivers/$driver/icd.json" ] || continue
    scenes='sphere:n=8 soup:n=60 cornell'
    [ "$part" = all ] || scenes=cornell
    for scene in $scenes; do
        expect 0 . check $scene --count 1500 --repeat 1 --engine webgpu --layout $layouts --driver $driver \
            --query closest,any --json "$dir/$driver.json"
        [ "$(grep -cE '^agrees ' "$dir/out")" -eq 6 ] || bad "$driver, $scene: not six rows that agree"
        [ "$(grep -c '"other_bits": ' "$dir/$driver.json")" -eq 6 ] || bad 'JSON: not six counts of other bits'
    done
    # On these drivers Tint leaves every operation as it is written: bits are cpu's.
    [ "$(grep -c '"other_bits": 0,' "$dir/$driver.json")" -eq 6 ] || bad "$driver: other bits than cpu's"
    # RTRS's faults are the layout's and the shader's, whoever runs it: what cpu loses is lost.
    expect 0 . check sphere:n=8 --count 1500 --repeat 1 --engine cpu,webgpu --layout $published --driver $driver
    has 'as published' '^counted rtrs_direct +webgpu +[1-9][0-9]* ' '^counted rtrs_rf +webgpu +[1-9][0-9]* '
    for layout in rtrs_direct rtrs_rf rtrs_rf_paper; do
        [ "$(awk -v l=$layout '$2 == l && $3 ~ /^(cpu|webgpu)$/ {print $7}' "$dir/out" | sort -u | wc -l)" -eq 1 ] ||
            bad "$layout: cpu and webgpu do not hit the same"
    done
done
[ "$part" != published ] || exit "$((failed > 0))"
for tri in mt woop mt_rtrs pluecker baldwin_webber; do
    for box in robust watertight; do
        expect 0 . check sphere:n=8 --count 1000 --repeat 1 --engine webgpu --layout f32,cwbvh80 --driver swiftshader \
            --tri $tri --box $box
        [ "$(grep -cE '^agrees .* webgpu +0 +[0-9]+ +0 ' "$dir/out")" -eq 2 ] || bad "$tri, $box: not two rows with cpu's bits"
    done
done
expect 0 . check sphere:n=8 --count 1000 --repeat 1 --engine webgpu --layout f32 --driver swiftshader --box rtrs
has 'box rtrs' '^counted f32 +webgpu +0 '

# Rays along the axes, ends of ranges, far scenes, large and small ones.
for rays in axis ranges edges vertices; do
    expect 0 . check stack --rays $rays --count 1000 --repeat 1 --engine webgpu --layout $layouts --driver swiftshader
done
expect 0 . conform --engine webgpu --driver swiftshader 'closest.webgpu.rf16.median.robust.mt.sphere.*'
expect 0 . fuzz --trials 40 --engine webgpu --driver swiftshader --corpus none --dir "$dir/found"

# Bounds beyond the largest half are infinite, and no box ends before what it holds.
expect 0 . check sphere:n=6,radius=8e4 --count 500 --repeat 1 --engine cpu,webgpu --layout rtrs_rf_paper --driver swiftshader
[ "$(awk '$3 ~ /^(cpu|webgpu)$/ {print $7}' "$dir/out" | sort -u | wc -l)" -eq 1 ] || bad 'infinite halves: other hits than cpu'

# Other layouts, storages and lists are skipped with the reason; a driver that Dawn does not take is named.
expect 1 . check $soup --engine webgpu --layout tiny8 --driver swiftshader
has 'no WGSL' '^skipped tiny8 +webgpu webgpu: layout tiny8 has no WGSL'
expect 1 . check $soup --engine webgpu --layout f32 --store edges --driver swiftshader
expect 1 . check $soup --engine webgpu --layout f32 --query all --driver swiftshader

# The card, and a program elsewhere.
expect 0 . doctor --driver swiftshader
has doctor '^webgpu +runs' 'between fences: as in C but for subnormals' 'without a fence: as written' "WGSL's bounds"
mkdir "$dir/installed"
cp "$raydiff" "$dir/installed/raydiff"
raydiff=$dir/installed/raydiff
(cd "$dir" && "$raydiff" check $soup --engine webgpu --layout f32 --driver swiftshader) >"$dir/out" 2>&1 ||
    bad 'a program elsewhere does not find Dawn by RAYDIFF_WEBGPU'
has 'installed' '^agrees +f32 +webgpu '
[ "$failed" -eq 0 ]
