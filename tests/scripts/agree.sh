#!/bin/sh
# Everybody against everybody: sh tests/scripts/agree.sh BUILD quick|deep|full OUTPUT
# Every generated scene and three real meshes (what is not fetched is left out, with a line), all three
# queries, all triangle tests: layouts f32 and rf16 with the box tests robust and watertight; the
# published box test on scenes up to 4k triangles. `quick` has fewer rays, and lists and the published box test with
# one triangle test each: `conform` has a trial of every pair. Writes OUTPUT.txt, with the tables only if a check fails; then it fails, too.
set -u
raydiff=$1/raydiff
case $2 in
full)
    tests=mt,woop,mt_rtrs lists_of=$tests published_of=$tests
    rays=300000 lists=50000 published=10000 brute=100000 engines=cpu,vulkan,embree,embree_robust
    slow=$engines
    ;;
quick | deep)
    tests=mt,woop,mt_rtrs lists_of=woop published_of=mt_rtrs
    rays=500 lists=300 published=150 brute=300 engines=all
    [ "$2" = quick ] || { rays=3000 lists=600 published=600 brute=3000 lists_of=$tests published_of=$tests; }
    # The published box test enters so many boxes that those without a stack would take a third of
    # all the time; conform holds them to cpu's bits on it. An engine named here must be there, so
    # rayquery, which not every driver has, is left to `all` above.
    slow=cpu,vulkan,fast,brute,vulkan_brute,embree,embree_robust
    ;;
*)
    echo "usage: tests/scripts/agree.sh BUILD quick|deep|full OUTPUT" >&2
    exit 2
    ;;
esac
out=$3
mkdir -p "$(dirname "$out")"

generated=$("$raydiff" list scenes | awk 'NR > 1 {print $1}')
real=
for mesh in scenes/fetched/assimp-wuson.obj scenes/fetched/utah-teapot.obj \
    scenes/fetched/dragon-11k.ply.gz scenes/fetched/glmark2-bunny.obj; do
    if [ "$(echo $real | wc -w)" -ge 3 ]; then
        break
    elif [ -r "$mesh" ]; then
        real="$real $mesh"
    else
        echo "SKIP $mesh: not fetched (make scenes)"
    fi
done
[ -n "$generated" ] || exit 4

code=0
# name, options...: one raydiff check over scenes.
part() {
    name=$1
    shift
    "$raydiff" check --wide "$@" --repeat 1 >>"$out.tmp" 2>&1
    result=$?
    echo "$name: exit code $result"
    [ "$result" -eq 0 ] || code=1
}
: >"$out.tmp"
# The oracle decides all rays by its tree and `brute` of them by brute force too, in scenes up to 16k
# triangles; in larger ones fewer.
part robust $generated $real --engine $engines --box robust,watertight --tri $tests --query closest,any --count $rays --brute $((brute * 16384)) --brute-rays $brute
part lists $generated $real --engine $engines --box robust,watertight --tri $lists_of --query all --count $lists --brute $((lists / 10 * 16384)) --brute-rays $((lists / 10))
part published $generated --engine $slow --box rtrs --tri $published_of --query closest,any,all --count $published --brute $((published * 4096)) --brute-rays $published
tables='^(f32|rf16|-) |^layout  |times (the|its) speed|^what it means|^raydiff check: [0-9]+ s:|skipped:'
[ "$code" -ne 0 ] || { grep -vE "$tables" "$out.tmp" >"$out.txt" && mv "$out.txt" "$out.tmp"; }
mv "$out.tmp" "$out.txt"
grep -hE 'bit for bit against cpu|answers WRONG|^  right .*; allowed:' "$out.txt" | sort | uniq -c
if [ "$code" -ne 0 ]; then
    grep -hE '^WRONG|^BITS|failed|vacuous' "$out.txt" | head -n 20
fi
exit "$code"
