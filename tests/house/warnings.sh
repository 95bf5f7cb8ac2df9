#!/bin/sh
# A warning stops `make check` and not `make run`, whichever comes first; without one, a check compiles
# nothing that is there already. A planted fault shows that the checks below can fail.
#   sh tests/house/warnings.sh
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
object=$dir/build/obj/ref/base/base.o
unset WERROR MAKEFLAGS MFLAGS

# Without the lists of test programs, readers and planted bugs, which cost each make most of its time.
lean='TEST_SRC= READER_NAMES= PLANTED='

# compiled MAKEFILE ARGUMENTS...: one object, from here.
compiled() {
    makefile=$1
    shift
    make -s -f "$makefile" $lean "OUT=$dir/build" "CFLAGS_EXTRA=-include $dir/first.h" "$@" "$object" >"$dir/log" 2>&1
}
warns() { echo 'static int unused(void) { return 0; }' >"$dir/first.h"; }
silent() { # newer than the object, however coarse the clock of files
    echo 'extern int declared;' >"$dir/first.h"
    touch -d '1 minute' "$dir/first.h"
}
tells() { grep -q "$1" "$dir/log"; }

# What is wrong with a Makefile, a line each.
faults() {
    rm -rf "$dir/build"
    warns
    compiled "$1" || echo "a warning stops a user's build"
    tells 'unused' || echo "a user does not see the warning"
    compiled "$1" WERROR=1 && echo "a check takes what was compiled with a warning"
    tells 'unused' || echo "a check does not say which warning"
    rm -rf "$dir/build"
    compiled "$1" WERROR=1 && echo "a check compiles with a warning"
    compiled "$1" WERROR=0 || echo "WERROR=0 does not turn it off"
    silent
    compiled "$1" || echo "what is mended does not build"
    touch -d '1 hour' "$object" # newer than all else
    before=$(stat -c %y "$object")
    compiled "$1" WERROR=1 || echo "a check fails without a warning"
    [ "$(stat -c %y "$object")" = "$before" ] || echo "a check compiles anew what is there"
}
faults Makefile >"$dir/faults"
failed=0
[ ! -s "$dir/faults" ] || { sed 's/^/FAILED  /' "$dir/faults"; failed=1; }
for target in check sanitize-check tsan-check validate-check validate-gpu-check; do
    make -n $lean "OUT=$dir/none" "$target" 2>/dev/null | grep -q 'WERROR=1' || { echo "FAILED  make $target lets warnings pass"; failed=1; }
done
for target in all lib tests run bench install; do
    make -n $lean "OUT=$dir/none" "$target" 2>/dev/null | grep -qE 'WERROR=1|-Werror' && { echo "FAILED  make $target: -Werror"; failed=1; }
done

# Planted: nothing is kept of what was warned of; everything is an error; nothing is.
planted() { # NAME SED
    sed "$2" Makefile >"$dir/Makefile.$1"
    cmp -s Makefile "$dir/Makefile.$1" && { echo "BROKEN  $1 changes nothing"; failed=1; }
    faults "$dir/Makefile.$1" >"$dir/faults"
    [ -s "$dir/faults" ] || { echo "MISSED  $1"; failed=1; }
}
planted forgets 's/^WARNED .*/WARNED :=/'
planted always 's/^WARN := /&-Werror /'
planted never 's/,-Werror)/,)/'
echo "warnings: $failed failed"
[ "$failed" -eq 0 ]
