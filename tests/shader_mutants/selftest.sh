#!/bin/sh
# The mutants of shaders: a few are played, one that must be killed and one that must survive; results are resumed; what
# a layer swaps is seen by an unchanged test; scores are counted. sh tests/shader_mutants/selftest.sh BUILD
set -u
build=$1
raydiff=$build/raydiff
. tests/scripts/expect.sh
command -v spirv-val >/dev/null || { echo "SKIP no spirv-val"; exit 77; }
shader=trace_rf16
: >"$dir/err"

"$build/shader_mutants" play "$dir" $shader 8 1 2 quick >"$dir/out" 2>"$dir/err"
code=$?
[ $code -eq 77 ] && { tail -n 1 "$dir/err"; exit 77; }
[ $code -le 1 ] || bad "play: exit code $code: $(cat "$dir/err")"
[ "$(grep -cE '^[a-z_0-9]+\.[a-z]+\.[0-9]+,[a-z]+,(killed|survived),' "$dir/$shader.csv")" -eq 8 ] || bad "8 mutants have a line each"
[ "$(grep -vc ',invalid,' "$dir/$shader.csv")" -eq 8 ] || bad "no other ends"
[ "$(cut -d, -f2 "$dir/$shader.csv" | sort -u | wc -l)" -eq 8 ] || bad "8 mutants are of 8 kinds"
cp "$dir/$shader.csv" "$dir/before"
"$build/shader_mutants" play "$dir" $shader 8 1 2 quick >"$dir/again" 2>/dev/null
cmp -s "$dir/before" "$dir/$shader.csv" && cmp -s "$dir/out" "$dir/again" || bad "what was played is not played again"

# Invocations beyond the rays work, and the others do not; a stack that is never full is asked whether it is over full.
said=$("$build/shader_mutants" one $shader main.branch.0 2>/dev/null)
case "$? $said" in "0 the condition of OpBranchConditional is negated: killed "*) ;; *) bad "must be killed: $said" ;; esac
said=$("$build/shader_mutants" one $shader stack_push.comparison.0 2>/dev/null)
case "$? $said" in "1 OpUGreaterThanEqual became OpUGreaterThan: survived "*) ;; *) bad "must survive: $said" ;; esac
said=$("$build/shader_mutants" one $shader tri_sum.decoration.0 2>/dev/null)
case "$? $said" in *": killed test_spirv") ;; *) bad "a decoration must be missed: $said" ;; esac

# An unchanged test behind the layer.
if [ -x "$build/tests/test_vulkan_shaders" ] && echo '#include <vulkan/vk_layer.h>' | ${CC:-cc} -E - >/dev/null 2>&1; then
    printf '%s\n' 'main.branch.0,branch,survived,,1,0.1,"the condition of OpBranchConditional is negated"' \
        'stack_push.comparison.0,comparison,survived,,1,0.1,"OpUGreaterThanEqual became OpUGreaterThan"' >"$dir/own.csv"
    cp "$dir/own.csv" "$dir/$shader.csv"
    sh tests/shader_mutants/own_tests.sh "$build" "$dir" $shader test_vulkan_shaders >"$dir/log" 2>&1
    grep -q '^main.branch.0,branch,killed,test_vulkan_shaders,' "$dir/$shader.csv" || bad "the test behind the layer: $(cat "$dir/log")"
    grep -q '^stack_push.comparison.0,comparison,survived,,' "$dir/$shader.csv" || bad "the test kills what it cannot see"
else
    echo "SKIP the layer: vulkan/vk_layer.h and test_vulkan_shaders are needed"
fi

# Scores: the last line of a mutant counts; a proof is of a name with its text, and must not be of one that is killed.
cat >"$dir/s.csv" <<'END'
f.branch.0,branch,killed,closest.x,1,0.1,"a"
f.branch.1,branch,survived,,1,0.1,"b"
f.branch.2,branch,survived,,1,0.1,"c"
f.store.0,store,invalid,,1,0.1,"d"
f.branch.2,branch,killed,hard.1 hangs,1,0.1,"c"
END
echo '* f.branch.1 "b" why' >"$dir/proven"
said=$(perl tests/shader_mutants/score.pl "$dir/proven" "$dir/s.csv") || bad "all but the proven are killed: $said"
echo "$said" | grep -qE '^s +2 +1 100\.0 100$' || bad "score: $said"
echo "$said" | grep -q '^killed by conform 1, hard cases hangs 1$' || bad "killed by: $said"
echo '* f.branch.1 "x" why' >"$dir/proven"
said=$(perl tests/shader_mutants/score.pl "$dir/proven" "$dir/s.csv") && bad "a proof of another text"
echo "$said" | grep -q '^survived: s f.branch.1: b$' || bad "survivors are named: $said"
echo '* f.branch.? "*" why' >"$dir/proven"
perl tests/shader_mutants/score.pl "$dir/proven" "$dir/s.csv" >/dev/null 2>"$dir/err" && bad "a proof of what is killed"
grep -q 's f.branch.0 (a) stands among the equivalent, and closest.x kills it' "$dir/err" || bad "which one: $(cat "$dir/err")"

[ $failed -eq 0 ] && echo "shader mutants: selftest passed"
exit $((failed > 0))
