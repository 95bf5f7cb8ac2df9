#!/bin/sh
# make install into a folder, a C program built against it with pkg-config, make uninstall.
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
prefix=$dir/opt
make -s install "PREFIX=$prefix" >"$dir/log" 2>&1 || { cat "$dir/log"; echo "make install failed"; exit 1; }
for file in bin/raydiff lib/libraydiff.a lib/pkgconfig/raydiff.pc share/man/man1/raydiff.1 \
    share/bash-completion/completions/raydiff share/zsh/site-functions/_raydiff \
    include/raydiff/ref/engine.h include/raydiff/scenes/scenes.h; do
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
#include "scenes/scenes.h"

#include <stdio.h>

/* One ray down on a flat grid, by engine cpu on layout rf16. */
int main(void)
{
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct reason why;
    struct build_options build = {.leaf = 4, .eps = 0.02f};
    if (scene_open("grid:n=4,height=0", 1, &scene, &why) ||
        builder_find("median")->build(&scene, &build, &bvh, &why) ||
        packed_make(layout_find("rf16"), &bvh, &scene, &packed, &why))
        return puts(why.text), 1;
    const struct engine *engine = engine_find("cpu");
    struct engine_options options = {.device = -1};
    struct job job = {&scene, &packed, box_test_find("robust"), tri_test_find("woop"), QUERY_CLOSEST};
    struct box box = scene_bounds(&scene);
    struct ray ray = {{0.5f * (box.lo[0] + box.hi[0]) + 0.25f, 0.5f * (box.lo[1] + box.hi[1]) + 0.125f,
                       box.hi[2] + 3.0f}, 0.0f, {0.0f, 0.0f, -1.0f}, 100.0f};
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
    return hit.prim == ABI_NO_PRIM || hit.t != 3.0f;
}
C
export PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
if ! command -v pkg-config >/dev/null 2>&1; then
    echo "SKIP pkg-config is not installed"
    exit 77
fi
gcc -std=c17 $(pkg-config --cflags raydiff) -o "$dir/user" "$dir/user.c" $(pkg-config --libs raydiff) ||
    { echo "a user's program does not build"; exit 1; }
"$dir/user" || { echo "a user's program fails"; exit 1; }
"$prefix/bin/raydiff" --version || exit 1
make -s uninstall "PREFIX=$prefix" >"$dir/log" 2>&1
left=$(find "$prefix" -type f)
[ -z "$left" ] || { echo "make uninstall left: $left"; exit 1; }
echo "install: built, ran, removed"
