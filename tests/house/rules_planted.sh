#!/bin/sh
# tests/house/rules.sh must see a breach of each of its rules, planted one at a time in a copy.
set -u
copy=$(mktemp -d) || exit 4
trap 'rm -rf "$copy"' EXIT
git ls-files -z -- .ci debian ref gpu scenes fuzz tests bench cmd shaders docs CHANGELOG.md CITATION.cff CONTRIBUTING.md README.md SECURITY.md Makefile raydiff.c | tar --null -T - -cf - | tar -xf - -C "$copy" || exit 4
cd "$copy" && git init -q . && git add -A || exit 4
sh tests/house/rules.sh >log 2>&1 || { cat log; echo "the copy breaks a rule before anything is planted"; exit 1; }
failed=0

# file, line to append.
plant() {
    cp "$1" saved
    printf '%s\n' "$2" >>"$1"
    if sh tests/house/rules.sh >log 2>&1; then
        echo "MISSED  in $1: $2"
        failed=1
    else
        echo "caught  in $1: $(echo "$2" | head -n 1)"
    fi
    cp saved "$1"
}

plant ref/base/base.c '#include "gpu/vk/vk.h"'
plant ref/base/base.c '#include "ref/files/file.h"'
plant ref/oracle/oracle.h '#include "ref/judge/judge.h"'
plant ref/files/file.c '#include "cmd/conform/cmd_trial.h"'
plant scenes/render/render.c '#  include "gpu/vk/vk.h"'
plant cmd/bench/cmd_bench.c '#include "gpu/vk/vk.h"'
plant cmd/common/cmd_use.c '#include "cmd/check/cmd_check.h"'
plant shaders/tri.glsl '#include "bench/chart/chart.h"'
plant docs/rooms.txt 'ref/attic:'
plant docs/rooms.txt 'ref/base: ref/nowhere'
plant docs/rooms.txt '    ref/plugin.h'
plant ref/match/match.c '#include "ref/layouts/layout_f32.h"'
plant ref/match/match.c '#include <embree3/rtcore.h>'
plant shaders/tri.glsl 'float f(float a) { return fma(a, a, a); }'
plant shaders/half.glsl 'uint f(vec2 a) { return packHalf2x16(a); }'
plant shaders/slab.glsl 'float f(vec3 a) { return dot(a, a); }'
plant ref/tree/bvh.c 'void f(void) { printf("x"); }'
plant gpu/vk/vk.c 'void f(void) { exit (1); }'
plant ref/base/rng.h 'float f(struct rng *rng) { return ldexpf(rng_float(rng), (int)rng_below(rng, 3)); }'
plant ref/base/half.c 'void f(int a, int b) { printf("%d page%s", a, plural(b)); }'
plant ref/base/half.c "/* $(printf '%098d' 0) */"
plant ref/explain/repair.c 'static const char *text = "a slot is not read (F7)";'
plant tests/hard/cases/hard_seed.c '.fault = "F7: six of eight slots are read"'
plant docs/causes.md "A line $(printf '%0120d' 0)"
plant docs/causes.md 'A slot is not read (F7).'
plant tests/waivers.txt 'hard.*.f32.* F7: six of eight slots are read'
plant ref/base/half.c '#if MUTANT == MUTANT_LOST_SLOT'
hunk='in ref/base/half.c: half_down
-    no such line'
plant tests/planted/ref.base.txt "
bug NEW: nothing is planted
caught test ref/base/half.c test_half"
plant tests/planted/ref.base.txt "
bug NEW: its old text is gone
$hunk
caught test ref/base/half.c test_half"
plant tests/planted/ref.base.txt "
bug NEW: many places fit
in ref/base/half.c
-}
caught test ref/base/half.c test_half"
plant tests/planted/ref.base.txt "
bug NEW: it changes nothing
in ref/base/half.c
 #include \"ref/base/half.h\"
caught test ref/base/half.c test_half"
plant tests/planted/ref.base.txt "
bug NEW: there is no catcher
in ref/base/half.c
-#include \"ref/base/half.h\"
+"
plant tests/planted/ref.base.txt "
bug LOST_SLOT: of another's name
in ref/base/half.c
-#include \"ref/base/half.h\"
+
caught test ref/base/half.c test_half"
plant fuzz/selftest.txt 'NOWHERE ref/base/half.c cpu rf16 rounding'
plant tests/support/tree_fixture.h '/* ../shared/design/house.md */'
plant tests/support/tree_fixture.h 'static const char *f = "shared/scenes/a.json";'
mkdir ref/attic && echo '#include "ref/base/base.h"' >ref/attic/new.h && git add ref/attic
plant ref/attic/new.h ''
git rm -qf ref/attic/new.h
grep -v ' deb sh ' tests/run.sh >fewer && cp fewer tests/run.sh # a suite of make seldom-check
plant ref/base/half.c ''
git checkout -q tests/run.sh
sed 's/^deep: seldom-check /deep: /' tests/checks.mk >fewer && cp fewer tests/checks.mk
plant ref/base/half.c ''
git checkout -q tests/checks.mk && rm fewer
plant docs/rooms.svg '<title>ref/base&#45;&gt;cmd/fuzz</title>'
echo >gpu/vk/half.c && git add gpu/vk/half.c
plant gpu/vk/half.c ''
git rm -qf gpu/vk/half.c
echo >NOTES.txt && git add NOTES.txt
plant NOTES.txt ''
git rm -qf NOTES.txt
plant ref/base/half.c 'enum bvh { RED };'
plant ref/base/half.c '/* Below it nobody asks. */'
plant ref/base/half.c '/* Who is ended from outside leaves none. */'
plant ref/base/half.c "/* The seed's layouts. */"
plant CONTRIBUTING.md 'See `ref/base/nowhere.h`.'
plant docs/reading.md '| `ref/nowhere.c` | |'
plant docs/reading.md '| `tests/house/rules.sh` | |'
for i in $(seq 40); do echo >"docs/$i.txt"; done
git add docs
plant docs/1.txt ''
git rm -qf docs/[0-9]*.txt
plant Makefile "$(awk 'BEGIN { for (i = 0; i < 200; i++) print "#" }')"
plant Makefile 'VERSION := 9.9.9'
plant CITATION.cff 'version: 9.9.9'
plant .ci/deps.sh "run='libnowhere-dev:nothing'"
plant bench/results/lavapipe-22.3.6/hour.txt "$(awk 'BEGIN { for (i = 0; i < 3000; i++) print "1" }')"
echo '{}' >bench/results/new.json && git add bench/results/new.json
plant bench/results/new.json ''
git rm -qf bench/results/new.json
plant ref/base/half.c "$(awk 'BEGIN { for (i = 0; i < 460; i++) print "/* */" }')"
[ "$failed" -eq 0 ] && echo "rules: every planted breach caught"
exit "$failed"
