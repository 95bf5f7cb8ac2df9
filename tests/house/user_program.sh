#!/bin/sh
# C programs that are built against the installed libraries, as pkg-config says, and run; headers that stand alone.
#   sh tests/house/user_program.sh INCLUDE/raydiff       exit code 77: pkg-config is not installed
set -u
include=$1
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
cat >"$dir/user.c" <<'C'
#include "ref/engine.h"

#include <stdio.h>
#include <string.h>

static const float vertex[] = {0, 0, 1, 4, 0, 1, 0, 4, 1, 4, 4, 1};
static const uint32_t triangle[] = {0, 1, 2, 3, 2, 1};

/* One ray down on two triangles at z = 1, by engine cpu on layout rf16. */
int main(void)
{
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct reason why;
    struct build_options build = {.leaf = 4, .eps = 0.02f};
    if (scene_make(4, 2, &scene))
        return 1;
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, triangle, sizeof triangle);
    if (scene_check(&scene, &why) || builder_find("median")->build(&scene, &build, &bvh, &why) ||
        packed_make(layout_find("rf16"), &bvh, &scene, &packed, &why))
        return puts(why.text), 1;
    const struct engine *engine = engine_find("cpu");
    struct engine_options options = {.device = -1};
    struct job job = {&scene, &packed, box_test_find("robust"), tri_test_find("woop"), QUERY_CLOSEST};
    struct ray ray = {{3.0f, 3.5f, 4.0f}, 0.0f, {0.0f, 0.0f, -1.0f}, 100.0f};
    struct hit hit;
    struct trace_report report;
    void *self;
    if (engine_open(engine, &options, &self, &why) || engine->prepare(self, &job, &why) ||
        engine->trace(self, &ray, 1, &hit, &report, &why))
        return puts(why.text), 1;
    printf("prim %u t %g\n", hit.prim, (double)hit.t);
    engine->close(self);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
    return hit.prim != 1 || hit.t != 3.0f;
}
C
if ! command -v pkg-config >/dev/null 2>&1; then
    echo "SKIP pkg-config is not installed"
    exit 77
fi
gcc -std=c17 $(pkg-config --cflags raydiff) -o "$dir/user" "$dir/user.c" $(pkg-config --libs raydiff) ||
    { echo "a user's program does not build"; exit 1; }
# The public header with the shared library and with the static one.
cat >"$dir/public.c" <<'C'
#include <raydiff.h>

#include <stdio.h>

int main(void)
{
    static const float vertex[] = {0, 0, 1, 4, 0, 1, 0, 4, 1}, ray[] = {1, 1, 4, 0, 0, 0, -2, 100};
    static const uint32_t triangle[] = {0, 1, 2};
    const struct raydiff_answer answer = {2.0f, 0.25f, 0.25f, 0}; /* t is 1.5 */
    struct raydiff_oracle *oracle;
    struct raydiff_judged judged;
    struct raydiff_why why;
    char text[RAYDIFF_REASON_BYTES];
    if (raydiff_oracle_make(vertex, 3, triangle, 1, &oracle, &why) ||
        raydiff_judge(oracle, NULL, ray, &answer, 1, 0, &judged, NULL, &why) ||
        raydiff_reason(oracle, NULL, ray, &answer, text, &why))
        return puts(why.line), 1;
    raydiff_oracle_free(oracle);
    puts(text);
    return judged.verdict != RAYDIFF_VERDICT_WRONG || judged.fault != RAYDIFF_FAULT_DISTANCE;
}
C
for how in libraydiff raydiff; do
    gcc -std=c11 $(pkg-config --cflags $how) -o "$dir/$how" "$dir/public.c" $(pkg-config --libs $how) ||
        { echo "a user of raydiff.h does not build with pkg-config $how"; exit 1; }
    LD_LIBRARY_PATH=$(pkg-config --variable=libdir $how) "$dir/$how" || { echo "a user of raydiff.h fails: $how"; exit 1; }
    LD_LIBRARY_PATH=$(pkg-config --variable=libdir $how) ldd "$dir/$how" | grep -c 'libraydiff\.so\.[0-9]' >>"$dir/shared"
done
[ "$(tr '\n' ' ' <"$dir/shared")" = '1 0 ' ] || { echo "libraydiff is shared, raydiff is static: $(cat "$dir/shared")"; exit 1; }
# The public header, seven of the parts, the plugin's and the engine's are all; each compiles alone, so none needs one that is not there.
find "$include" -type f | sort >"$dir/headers"
[ "$(wc -l <"$dir/headers")" = 11 ] || { echo "installed headers are not eleven:"; cat "$dir/headers"; exit 1; }
while read -r header; do
    gcc -std=c17 -fsyntax-only -I"$include" -x c "$header" || { echo "$header does not stand alone"; exit 1; }
done <"$dir/headers"
"$dir/user" || { echo "a user's program fails"; exit 1; }
