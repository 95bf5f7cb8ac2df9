#!/bin/sh
# What the shared library shows is its header, and tests/library/abi.txt has that as it was agreed on: whatever
# would break a compiled program fails here.
#   sh tests/library/abi.sh BUILD
#   sh tests/library/abi.sh --list >tests/library/abi.txt      after RAYDIFF_ABI has grown, if a program must be
#                                                              compiled again; not for a function that is added
# Also: the header compiles as C11 and C++11 without a warning, beside those of plugins; the library has no state,
# needs no library beyond OpenMP's, prints nothing and ends no program; abidiff, where it is installed, finds the
# types of the object to be those of the list.
set -u
header=ref/library/raydiff.h
agreed=tests/library/abi.txt
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
bad=0
breach() {
    echo "$1"
    bad=1
}
cc=${CC:-gcc}

# Declarations without comments, one a line.
declarations() {
    sed '/^#include </d' "$1" | $cc -E -P -x c - | sed 's/__attribute__((visibility("default"))) *//' | tr -s ' \n' '  ' |
        awk '{
            for (i = 1; i <= length($0); i++) {
                c = substr($0, i, 1)
                line = line c
                depth += (c == "{") - (c == "}")
                if (c == ";" && depth == 0) { sub(/^ */, "", line); print line; line = "" }
            }
        }'
}
# The sizes of structs, as assertions; of a processor with 64 bits.
sizes() {
    {
        printf '#include "%s"\n#include <stdio.h>\nint main(void)\n{\n' "$header"
        declarations "$header" | sed -n 's/^struct \([a-z_]*\) {.*/    printf("_Static_assert(sizeof(struct \1) == %zu, \\"\1\\");\\n", sizeof(struct \1));/p'
        printf '    return 0;\n}\n'
    } >"$dir/sizes.c"
    $cc -I. -o "$dir/sizes" "$dir/sizes.c" && "$dir/sizes"
}
list() {
    echo "/* Made by tests/library/abi.sh --list. */"
    echo "#include <stdbool.h>"
    echo "#include <stddef.h>"
    echo "#include <stdint.h>"
    sed -n '/^#define RAYDIFF_ABI /p; /^#define RAYDIFF_NOTHING /s| */\*.*||p; /^#define RAYDIFF_REASON_BYTES /p' "$header"
    declarations "$header"
    sizes
}
if [ "$1" = --list ]; then
    list
    exit
fi
build=$1
library=$build/shared/libraydiff.so.$(sed -n 's/^#define RAYDIFF_ABI //p' "$header")
[ -s "$library" ] || { echo "$library is missing: make lib"; exit 1; }

list >"$dir/now"
diff "$agreed" "$dir/now" || breach "the header is not $agreed: see the head of this script"
functions() { sed -n 's/^[a-z].*[ *]\(raydiff_[a-z_]*\)(.*);$/\1/p' "$1" | grep -vx raydiff_fails | sort; }
[ "$(functions "$agreed" | wc -l)" -ge 15 ] || breach "$agreed has no functions"
nm -D --defined-only "$library" | sed -n 's/.* T \([^@]*\).*/\1/p' | sort >"$dir/shown"
functions "$agreed" | diff - "$dir/shown" || breach "the library does not show the functions of its header"
[ "$(nm -D --defined-only "$library" | grep -vc ' T ')" -eq 1 ] || breach "the library shows more than functions and its version"

soname=$(readelf -d "$library" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')
[ "$soname" = "$(basename "$library")" ] || breach "its soname is '$soname'"
readelf -d "$library" | sed -n 's/.*NEEDED.*\[\([^.]*\).*/\1/p' | grep -vxE 'libc|libm|libgomp|libomp|ld-linux.*|libgcc_s|libpthread' &&
    breach "it needs a library that a user need not have"
nm -D --undefined-only "$library" | sed 's/.* U //; s/@.*//' |
    grep -xE '(f|v|vf|d)?printf(_chk)?|f?put(s|c|char)|perror|fwrite|write|exit|_exit|quick_exit|abort|__assert_fail|raise|kill' &&
    breach "it prints, or ends its user's program"
# What can be written: locks, what the compiler adds, and the table that layouts from outside would be added to.
objdump -t "$library" | awk '$4 == ".data" || $4 == ".bss" || $3 == ".data" || $3 == ".bss" {print $NF}' |
    grep -vxE '\.gomp_critical_user_.*|completed\..*|__(dso_handle|TMC_END__|cpu_model|cpu_features2)|all|\.data|\.bss' &&
    breach "it has state of its own"

# As users compile it.
printf '#include <raydiff.h>\n#include "ref/plugin.h"\n#include "ref/raydiff_engine.h"\n#include <raydiff.h>\nint main(void) { return raydiff_version() == 0; }\n' >"$dir/user.c"
cp "$dir/user.c" "$dir/user.cc"
strict='-Wall -Wextra -Wpedantic -Wconversion -Wundef -Werror'
for compiler in gcc clang; do
    command -v $compiler >/dev/null || continue
    $compiler -std=c11 $strict -Wstrict-prototypes -Wshadow -Iref/library -I. -c -o "$dir/user.o" "$dir/user.c" || breach "$compiler: not C11"
done
for compiler in g++ clang++; do
    command -v $compiler >/dev/null || continue
    $compiler -std=c++11 $strict -Iref/library -I. -c -o "$dir/user.o" "$dir/user.cc" || breach "$compiler: not C++11"
    $compiler -o "$dir/user" "$dir/user.o" "$library" -Wl,-rpath,"$(realpath "$build/shared")" && "$dir/user" ||
        breach "$compiler: a program does not link"
done

# A library of empty functions with the types of the list, against the real one; a member that is another is seen.
empty() { # NAME
    mkdir -p "$dir/$1.d" && cp "$dir/$1.txt" "$dir/$1.d/raydiff.h"
    {
        echo '#include "raydiff.h"'
        sed -n '/^typedef/!s/^\([a-z].*(.*)\);$/\1 { __builtin_unreachable(); }/p' "$dir/$1.txt"
    } >"$dir/$1.d/empty.c"
    $cc -g -w -shared -fPIC -Wl,-soname,"$soname" -Wl,--version-script=ref/library/raydiff.map \
        -o "$dir/$1.so" "$dir/$1.d/empty.c"
}
if command -v abidiff >/dev/null; then
    cp "$agreed" "$dir/same.txt"
    sed '/_Static_assert/d; s/uint32_t expected;/uint64_t expected;/' "$agreed" >"$dir/other.txt"
    compare() { abidiff --no-show-locs --headers-dir1 "$dir/$1.d" --headers-dir2 ref/library "$dir/$1.so" "$library" >"$dir/$1.log" 2>&1; }
    empty same && empty other || breach "no library of the list's types"
    compare same || { breach "abidiff: the types are not those of the list"; tail -n 30 "$dir/same.log"; }
    compare other && breach "abidiff does not see a member of another type"
else
    echo "SKIP abidiff is not installed (Debian: abigail-tools)"
fi
[ "$bad" -eq 0 ] && echo "abi: $(wc -l <"$dir/shown") functions, as agreed"
exit "$bad"
