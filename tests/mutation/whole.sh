#!/bin/sh
# Links a unit test whose allocations are made to fail (--wrap) with all objects in place of the library, which it
# would not reach:   CC_CMD=... sh tests/mutation/whole.sh BUILD NAME OBJECTS PROGRAM [OBJECT]
# OBJECTS lists the library's; OBJECT is in place of the test's own.
set -u
build=$1 name=$2 objects=$3 program=$4
own=${5:-$(echo "$build"/obj/tests/*/"$name".o)}
exec $CC_CMD -o "$program" "$own" $(sed "s|[^ ]*/libraydiff\.a|$(tr '\n' ' ' <"$objects")|" "$build/links/$name") \
    $(cat "$build/libraries")
