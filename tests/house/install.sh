#!/bin/sh
# make install into a folder, a C program built against it with pkg-config, make uninstall.
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
prefix=$dir/opt
make -s install "PREFIX=$prefix" >"$dir/log" 2>&1 || { cat "$dir/log"; echo "make install failed"; exit 1; }
for file in bin/raydiff lib/libraydiff.a lib/pkgconfig/raydiff.pc share/man/man1/raydiff.1 \
    share/bash-completion/completions/raydiff share/zsh/site-functions/_raydiff \
    include/raydiff/ref/engine.h include/raydiff/ref/plugin.h include/raydiff/ref/raydiff_engine.h \
    include/raydiff/raydiff.h lib/libraydiff.so \
    lib/libraydiff.so.1 lib/pkgconfig/libraydiff.pc share/raydiff/python/raydiff.py; do
    [ -s "$prefix/$file" ] || { echo "not installed: $file"; exit 1; }
done
"$prefix/bin/raydiff" help --commands >"$dir/commands" || exit 1
while read -r command; do
    grep -q "^raydiff-$command .- " "$prefix/share/man/man1/raydiff-$command.1" || { echo "no man page of $command"; exit 1; }
    grep -q "^$command)" "$prefix/share/bash-completion/completions/raydiff" || { echo "bash completes no $command"; exit 1; }
done <"$dir/commands"
grep -q '^.SH COMMANDS' "$prefix/share/man/man1/raydiff.1" && grep -q '^.SH KNOWN FINDINGS' "$prefix/share/man/man1/raydiff.1" ||
    { echo "raydiff.1 lacks a part"; exit 1; }
grep '@' "$prefix"/lib/pkgconfig/*.pc && { echo "unfilled fields"; exit 1; }
PKG_CONFIG_PATH="$prefix/lib/pkgconfig" sh tests/house/user_program.sh "$prefix/include/raydiff" || exit
"$prefix/bin/raydiff" --version || exit 1
make -s uninstall "PREFIX=$prefix" >"$dir/log" 2>&1
left=$(find "$prefix" ! -type d)
[ -z "$left" ] || { echo "make uninstall left: $left"; exit 1; }
echo "install: built, ran, removed"
