#!/bin/sh
# bench/hardware.sh plays every step whatever the others find, and ends as the worst of them; programs are stubs.
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
cat >"$dir/raydiff" <<'STUB'
#!/bin/sh
echo "played $1 $2"
case $* in
*"$FAILS"*) exit "$WITH" ;;
esac
STUB
chmod +x "$dir/raydiff"
run() { # exit code, what fails, with which code, arguments
    want=$1 FAILS=$2 WITH=$3
    shift 3
    export FAILS WITH
    rm -rf "$dir/out"
    sh bench/hardware.sh "$dir/raydiff" "$@" >"$dir/log" 2>&1
    code=$?
    [ "$code" -eq "$want" ] || { echo "FAILED  exit $code, not $want: $FAILS with $WITH"; failed=1; }
}
steps() { [ "$(grep -c ' exit ' "$dir/out/summary.txt")" -eq 8 ] || { echo "FAILED  not all steps: $FAILS"; failed=1; }; }
run 0 nothing 0 "$dir/out"
steps
grep -q 'engines    vulkan,vulkan_brute,vulkan_stackless,rayquery$' "$dir/log" || { echo 'FAILED  ray queries are not played'; failed=1; }
for what in doctor conform '--hard' leaks fuzz 'bench layouts' 'bench matrix'; do
    run 1 "$what" 1 "$dir/out"
    steps
    run 3 "$what" 139 "$dir/out"
    steps
    grep -q ' exit 139 ' "$dir/out/summary.txt" || { echo "FAILED  no code of $what"; failed=1; }
done
run 0 '--engine rayquery' 77 "$dir/out"
grep -q 'engines    vulkan,vulkan_brute,vulkan_stackless$' "$dir/log" || { echo 'FAILED  ray queries that cannot run are played'; failed=1; }
run 77 '--engine vulkan' 77 "$dir/out"
run 2 nothing 0
run 2 nothing 0 "$dir/out" any soon
run 3 nothing 0 "$dir/out" any 0
mkdir -p "$dir/full" && touch "$dir/full/file"
run 2 nothing 0 "$dir/full"
[ "$failed" -eq 0 ] && echo 'hardware: every step counts'
exit "$failed"
