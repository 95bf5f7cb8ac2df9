#!/bin/sh
# tests/house/constants.sh must see a page that says another value, forgets a constant or names a file
# that does not have it.
set -u
altered=$(mktemp) || exit 4
trap 'rm -f "$altered"' EXIT
failed=0

# sed script that breaks a copy of the page.
plant() {
    sed "$1" docs/numerics.md >"$altered"
    if cmp -s docs/numerics.md "$altered"; then
        echo "NOTHING planted: $1"
        failed=1
    elif sh tests/house/constants.sh "$altered" >/dev/null; then
        echo "MISSED  $1"
        failed=1
    else
        echo "caught  $1"
    fi
}

plant 's/(72 \* 0x1p-53)/(71 * 0x1p-53)/'
plant '/`TREE_PAD`/d'
plant '/`SLAB_NEAR`/s/slab.h/tri.h/'
[ "$failed" -eq 0 ] && echo "constants: every planted error caught"
exit "$failed"
