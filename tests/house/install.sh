#!/bin/sh
# make install into a folder, a C program built against it with pkg-config, make uninstall.
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
prefix=$dir/opt
make -s install "PREFIX=$prefix" >"$dir/log" 2>&1 || { cat "$dir/log"; echo "make install failed"; exit 1; }
for file in bin/raydiff lib/libraydiff.a lib/pkgconfig/raydiff.pc share/man/man1/raydiff.1 \
    share/bash-completion/completions/raydiff share/zsh/site-functions/_raydiff \
    include/raydiff/ref/engine.h include/raydiff/ref/plugin.h; do
    [ -s "$prefix/$file" ] || { echo "not installed: $file"; exit 1; }
done
"$prefix/bin/raydiff" help --commands >"$dir/commands" || exit 1
while read -r command; do
    grep -q "^raydiff-$command .- " "$prefix/share/man/man1/raydiff-$command.1" || { echo "no man page of $command"; exit 1; }
    grep -q "^$command)" "$prefix/share/bash-completion/completions/raydiff" || { echo "bash completes no $command"; exit 1; }
done <"$dir/commands"
grep -q '^.SH COMMANDS' "$prefix/share/man/man1/raydiff.1" && grep -q '^.SH KNOWN FINDINGS' "$prefix/share/man/man1/raydiff.1" ||
    { echo "raydiff.1 lacks a part"; exit 1; }
grep -q '@' "$prefix/lib/pkgconfig/raydiff.pc" && { echo "raydiff.pc has unfilled fields"; exit 1; }
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
    if (engine->open(&options, &self, &why) || engine->prepare(self, &job, &why) ||
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
export PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
if ! command -v pkg-config >/dev/null 2>&1; then
    echo "SKIP pkg-config is not installed"
    exit 77
fi
gcc -std=c17 $(pkg-config --cflags raydiff) -o "$dir/user" "$dir/user.c" $(pkg-config --libs raydiff) ||
    { echo "a user's program does not build"; exit 1; }
# Seven headers and the plugin's are all; each compiles alone, so none needs one that is not there.
find "$prefix/include" -type f | sort >"$dir/headers"
[ "$(wc -l <"$dir/headers")" = 8 ] || { echo "installed headers are not eight:"; cat "$dir/headers"; exit 1; }
while read -r header; do
    gcc -std=c17 -fsyntax-only -I"$prefix/include/raydiff" -x c "$header" || { echo "$header does not stand alone"; exit 1; }
done <"$dir/headers"
"$dir/user" || { echo "a user's program fails"; exit 1; }
"$prefix/bin/raydiff" --version || exit 1
make -s uninstall "PREFIX=$prefix" >"$dir/log" 2>&1
left=$(find "$prefix" -type f)
[ -z "$left" ] || { echo "make uninstall left: $left"; exit 1; }
echo "install: built, ran, removed"
