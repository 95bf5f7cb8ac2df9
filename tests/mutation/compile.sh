#!/bin/sh
# Compiles a C source, with headers of TREE in place of the checkout's:
#   CC_CMD=... sh tests/mutation/compile.sh TREE SOURCE OBJECT [FLAG...]
# The object is the same wherever source and headers lie. The source is compiled from a folder of its own, since
# a quoted include is looked for beside the source, and beside standard input means the current folder, before
# TREE. Returns the compiler's exit code.
set -u
tree=$1 source=$2 object=$3
shift 3
alone=$(mktemp -d) || exit 4
trap 'rm -rf "$alone"' EXIT
cp "$source" "$alone/unit.c" || exit 4
$CC_CMD -iquote "$tree" -fmacro-prefix-map="$alone/=" -fmacro-prefix-map="$tree/=" -fmacro-prefix-map=./= "$@" -c \
    -o "$object" "$alone/unit.c"
