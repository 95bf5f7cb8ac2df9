#!/bin/sh
# Programs under tests/heap.sh are ended by what they do to memory, and only by that:
#   sh tests/house/heap_checked.sh FOLDER
set -u
dir=$1
. tests/heap.sh
cat >"$dir/heap.c" <<'C'
#include <stdlib.h>
int main(int count, char **argument)
{
    volatile char *block = malloc(24);
    char kind = *argument[1];
    if (count != 2 || !block)
        return 4;
    if (kind == 'b')
        block[24] = 1; /* behind */
    if (kind == 'z' && !block[0])
        return 3; /* used unset: what was here before */
    free((void *)block);
    if (kind == 't')
        free((void *)block);
    return 0;
}
C
${CC:-cc} -O0 -w -o "$dir/heap" "$dir/heap.c" || exit 4
failed=0
ends() { # kind, exit code with the variables
    env $heap "$dir/heap" "$1" >"$dir/heap.log" 2>&1
    code=$?
    [ "$code" -eq "$2" ] || { echo "$1: exit code $code, not $2"; failed=1; }
}
ends n 0
# The byte that is looked at behind a block depends on its address: one address in 256 hides what is written there.
code=0
for try in 1 2 3; do
    [ "$code" -eq 134 ] || { env $heap "$dir/heap" b >"$dir/heap.log" 2>&1; code=$?; }
done
[ "$code" -eq 134 ] || { echo "b: exit code $code, not 134"; failed=1; }
ends t 134
ends z 0
grep -q 'cannot be preloaded' "$dir/heap.log" && { echo 'libc_malloc_debug.so.0 is missing'; failed=1; }
"$dir/heap" b || { echo 'the byte behind is seen without the variables: they show nothing'; failed=1; }
[ "$failed" -eq 0 ] && echo 'heap: what is written behind a block is seen'
exit "$failed"
