#!/bin/sh
# Keeps docs/numerics.md, true: every row of its tables names files
# that have its constant with that value, and every power of two, or of ten below 1, in the code of
# ref/ and shaders/ (commands left out) stands in a row with its file. Prints every breach; exit 1
# if there is one.
#   sh tests/house/constants.sh [PAGE]
set -u
page=${1:-docs/numerics.md}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
: >"$work/breaches"

# Code without comments and strings.
bare() {
    awk -v empty=1 -f tests/house/code.awk "$1"
}

# "file literal" of every row: the first column's names, the second's values and the third's files
# are in backticks. A name is defined as one of the values in each file that it is in.
awk '/^\| [^-]/' "$page" >"$work/rows"
[ -s "$work/rows" ] || { echo "$page: no table of constants"; exit 1; }
in_ticks() { echo "$1" | grep -o '`[^`]*`' | tr -d '`'; }
while IFS='|' read -r _ names values files _; do
    in_ticks "$files" >"$work/files"
    in_ticks "$values" >"$work/values"
    [ -s "$work/files" ] || continue # a heading
    for name in $(in_ticks "$names"); do
        cat $(cat "$work/files") 2>/dev/null | grep -E "#define $name[ (]" |
            grep -qFf "$work/values" || echo "$page: $name is not as the page says" >>"$work/breaches"
    done
    while read -r file; do
        [ -r "$file" ] || { echo "$page: no file $file" >>"$work/breaches"; continue; }
        while read -r value; do
            echo "$file $value"
        done <"$work/values"
    done <"$work/files"
done <"$work/rows" >"$work/said"

literal='0x[0-9a-fA-F.]+p[-+]?[0-9]+|[0-9]+(\.[0-9]+)?e-[0-9]+'
for file in $(git ls-files 'ref/*.[ch]' 'ref/*/*.[ch]' 'shaders/*.glsl' 'shaders/*.comp'); do
    case $file in ref/outside/* | ref/base/decimal.c) continue ;; esac
    bare "$file" >"$work/bare"
    grep -oE "(^|[^0-9A-Za-z_.])($literal)" "$work/bare" | grep -oE "$literal" | sort -u |
        while read -r found; do
            # 0x1p-2 is not in a row that says 0x1p-20
            grep -F "$file " "$work/said" | cut -d' ' -f2- | grep -oE "$literal" |
                grep -qxF -e "$found" ||
                echo "$file: $found is on no row of $page"
        done
    grep -F "$file " "$work/said" | cut -d' ' -f2- | sort -u | while read -r said; do
        grep -qF -e "$said" "$work/bare" || echo "$file $said" # perhaps another file of the row
    done
done >"$work/found"
grep -F ' is on no row of ' "$work/found" >>"$work/breaches"
# A value must be in each of its row's files.
grep -vF ' is on no row of ' "$work/found" | while read -r file said; do
    echo "$page: $said is not in $file"
done >>"$work/breaches"
cat "$work/breaches"
[ -s "$work/breaches" ] && exit 1
echo "constants: $(wc -l <"$work/rows") rows, all true"
