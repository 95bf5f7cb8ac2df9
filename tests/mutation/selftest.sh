#!/bin/sh
# The mutator (tests/mutation/mutator.c): what it makes of a small source, mutation by mutation, and that
# what it makes of the tree's sources fits the source and mostly compiles. sh tests/mutation/selftest.sh BUILD
set -u
build=$1
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
}
cat >"$dir/a.c" <<'C'
#define SKIPPED(a, b) ((a) + (b)) /* no token: 1 + 1 */
static int table[3] = {1, -2};
int f(int a, float *b)
{
    int c = a < 3 ? g(a, 0) : -a;
    if (!h(a, a, b[a + 1]) && c != 4)
        c = g(c, 1); // 2 + 2
    for (int i = 0; i < c; i++)
        b[i] *= 0.5f;
    g(c, c);
    return c << 2;
}
int h(int n) { int d[4][1], e = d[n][0], k[4]; }
C
cat >"$dir/expected" <<'C'
2 constant 1 => (1 + 1)
2 constant 1 => (1 - 1)
2 constant 2 => (2 + 1)
2 constant 2 => (2 - 1)
2 sign - =>
5 arguments a, 0 => 0, a
5 border < => <=
5 compare < => >=
5 constant 0 => 1
5 constant 3 => (3 + 1)
5 constant 3 => (3 - 1)
5 sign - =>
6 arguments a, b[a + 1] => b[a + 1], a
6 arithmetic + => -
6 compare != => ==
6 constant 1 => (1 + 1)
6 constant 1 => (1 - 1)
6 constant 4 => (4 + 1)
6 constant 4 => (4 - 1)
6 index a + 1 => (a + 1) + 1
6 logic ! =>
6 logic && => ||
7 arguments c, 1 => 1, c
7 constant 1 => (1 + 1)
7 constant 1 => (1 - 1)
7 ignored g(c, 1) => (g(c, 1), 0)
7 statement c = g(c, 1) =>
8 arithmetic ++ => --
8 border < => <=
8 compare < => >=
8 constant 0 => 1
9 arithmetic *= => /=
9 constant 0.5f => (0.5f * 2)
9 index i => (i) + 1
9 statement b[i] *= 0.5f =>
10 statement g(c, c) =>
11 bits << => >>
11 constant 2 => (2 + 1)
11 constant 2 => (2 - 1)
11 return c << 2 => 0
13 constant 0 => 1
13 constant 1 => (1 - 1)
13 constant 4 => (4 - 1)
13 constant 4 => (4 - 1)
13 index 0 => (0) + 1
13 index n => (n) + 1
C
"$build/mutate" list "$dir/a.c" | sed 's/^[0-9]* //; s/ *$//' | LC_ALL=C sort -k1,1n -k2 >"$dir/got"
LC_ALL=C sort -k1,1n -k2 "$dir/expected" | cmp -s - "$dir/got" || {
    bad "other mutations of the small source:"
    LC_ALL=C sort -k1,1n -k2 "$dir/expected" | diff - "$dir/got"
}
# Each changes its own line alone, and no two are the same text.
count=$(grep -c . "$dir/got")
for number in $(seq 0 $((count - 1))); do
    "$build/mutate" apply "$dir/a.c" "$number" >"$dir/b.c" || bad "mutation $number is not applied"
    line=$("$build/mutate" list "$dir/a.c" | sed -n "$((number + 1))s/^[0-9]* \([0-9]*\) .*/\1/p")
    [ "$(diff "$dir/a.c" "$dir/b.c" | grep '^[<>]' | grep -c .)" -eq 2 ] && diff "$dir/a.c" "$dir/b.c" | grep -qx "${line}c$line" ||
        bad "mutation $number changes more than line $line"
    cksum <"$dir/b.c" >>"$dir/sums"
done
[ "$(sort -u "$dir/sums" | grep -c .)" -eq "$count" ] || bad "two mutations are the same"
for words in '' 'list' 'apply x' "apply $dir/a.c 10000" 'list /no/such/file' "list $dir/a.c x"; do
    "$build/mutate" $words >"$dir/out" 2>"$dir/err"
    [ $? -eq 2 ] && [ "$(grep -c . "$dir/err")" -eq 1 ] && [ ! -s "$dir/out" ] || bad "mutate $words: not refused in one line"
done
printf 'int f(void) { return (1; }\n' >"$dir/c.c"
"$build/mutate" list "$dir/c.c" >/dev/null 2>&1 && bad "brackets that do not match are taken"

here=$PWD mutate=$(realpath "$build/mutate")
# The order: another with another seed; a line put before changes nothing of it; what the table names is known.
order() { (cd "$dir" && perl "$here/tests/mutation/order.pl" "$mutate" "$1" "$2" a.c); }
cat >"$dir/table" <<'T'
# why
invariant same ;; test_x ;; either order
same ;; a.c ;; c = g(c, 1); // 2 + 2 ;; arguments c, 1 => 1, c
same ;; a.c ;; int c = a < 3 ? g(a, 0) : -a; ;; constant 3 => (3 - 1)
T
order "$dir/table" 1 >"$dir/first" || bad "no order"
order "$dir/table" 2 >"$dir/second"
[ "$(cut -d' ' -f1 "$dir/first" | sort -u | wc -l)" -eq "$count" ] || bad "keys of mutations are not distinct"
cmp -s "$dir/first" "$dir/second" && bad "the order does not depend on the seed"
[ "$(sort "$dir/first")" = "$(sort "$dir/second")" ] || bad "another seed, other mutations"
[ "$(awk '$4 == "same"' "$dir/first" | wc -l)" -eq 2 ] || bad "the table's two mutations are not known"
order "$dir/table" check >"$dir/told" && [ "$(cat "$dir/told")" = 'same test_x' ] || bad "a table that fits is refused"
cp "$dir/a.c" "$dir/kept.c"
sed -i '1i int first;' "$dir/a.c"
order "$dir/table" 1 | cmp -s - "$dir/first" || bad "a line put before changes the order"
cp "$dir/kept.c" "$dir/a.c"
while read -r row; do
    { cat "$dir/table"; echo "$row"; } >"$dir/wrong"
    order "$dir/wrong" check >/dev/null 2>"$dir/err" && bad "taken: $row"
    grep -q '/wrong:5: ' "$dir/err" || bad "not named: $row"
done <<'T'
same ;; a.c ;; c = g(c, 1); ;; arguments c, 1 => 1, c
same ;; a.c ;; c = g(c, 1); // 2 + 2 ;; arguments c, 1 => c, 1
same ;; a.c ;; int h(int n) { int d[4][1], e = d[n][0], k[4]; } ;; constant 4 => (4 - 1)
other ;; a.c ;; g(c, c); ;; statement g(c, c) =>
same ;; a.c ;; g(c, c);
same ;; * ;; .*nothing.* ;; .*
same ;; * ;; .* ;; constant
T
# A pattern is of the whole line and the whole mutation.
{ cat "$dir/table"; printf '%s\n' 'same ;; * ;; .*g\((.*)\).* ;; arguments \1 => .*'; } >"$dir/wide"
order "$dir/wide" check >/dev/null || bad "a pattern that fits is refused"
[ "$(order "$dir/wide" 1 | awk '$4 == "same"' | wc -l)" -eq 3 ] || bad "$(order "$dir/wide" 1 | awk '$4 == "same"' | wc -l) mutations are known by a pattern"
# A header of the mutated tree is compiled in place of the checkout's, from a header between them, too; and an
# object does not tell where its parts lie.
mkdir -p "$dir/checkout/ref" "$dir/tree/ref" "$dir/copy/ref"
echo '#define VALUE __FILE__ "1"' >"$dir/checkout/ref/inner.h"
echo '#include "ref/inner.h"' >"$dir/checkout/ref/outer.h"
printf '#include "ref/outer.h"\nconst char *value = VALUE __FILE__;\n' >"$dir/checkout/unit.c"
cp "$dir/checkout/unit.c" "$dir/copy"
compile() { (cd "$dir/checkout" && CC_CMD="${CC:-cc} -I." sh "$here/tests/mutation/compile.sh" "$1" "$2" "$3" 2>&1); }
compile "$dir/none" unit.c "$dir/plain.o" || bad "the unit does not compile"
for header in inner outer; do
    cp "$dir/checkout/ref/$header.h" "$dir/tree/ref"
    compile "$dir/tree" "$dir/copy/unit.c" "$dir/moved.o" || bad "the unit does not compile elsewhere"
    cmp -s "$dir/plain.o" "$dir/moved.o" || bad "an object tells where $header.h lies"
    sed '1s/1/2/; 1s|^#include.*|#define VALUE ""|' "$dir/checkout/ref/$header.h" >"$dir/tree/ref/$header.h"
    compile "$dir/tree" unit.c "$dir/moved.o" || bad "the unit does not compile with another $header.h"
    cmp -s "$dir/plain.o" "$dir/moved.o" && bad "a mutation of $header.h is not compiled"
    rm "$dir/tree/ref/$header.h"
done

files=$(git ls-files 'ref/*.c' 'ref/*.h' 'gpu/*.c' 'fuzz/*.c' 'scenes/*.c' 'bench/*.c' 'cmd/*.c' 'shaders/*.glsl' 'shaders/*.comp' |
    grep -v '^fuzz/templates')
# The product's own table fits, and each invariant's suite is one of `make check`.
perl tests/mutation/order.pl "$build/mutate" tests/mutation/equivalent.txt check \
    $({ git ls-files 'ref/judge/*.c' 'ref/tree/*.c' 'shaders/w*.glsl' 'shaders/slab.glsl' 'ref/oracle/placed_filter.c'; sed -n 's/^[^#]* ;; \([a-z][^ ;]*\.[a-z]*\) ;; .*/\1/p' tests/mutation/equivalent.txt; } | sort -u) >"$dir/invariants" ||
    bad "tests/mutation/equivalent.txt"
while read -r name suite; do
    [ -x "$build/tests/$suite" ] || grep -qE "^ *(suite|waits|pairs|alone) $suite " tests/run.sh || bad "invariant $name: no suite $suite"
done <"$dir/invariants"

# Lines that nothing runs are told, with the sums of their rooms; what a signal ended has told what it ran.
mkdir -p "$dir/room/ref/a" "$dir/room/build/ran" "$dir/room/build/tests"
printf '#include <stdlib.h>\n\nint main(int argc, char **argv)\n{\n    (void)argv;\n    if (argc == 2)\n        exit(3);\n    if (argc > 2)\n        abort();\n    return 0;\n}\n' >"$dir/room/ref/a/a.c"
(
    cd "$dir/room" && git init -q . && git add ref && ln -s "$here/tests" tests &&
        cc -O1 -g -fPIC -c -o ran.o tests/mutation/ran.c &&
        cc -O1 -g -fPIC -fsanitize-coverage=trace-pc -c -o a.o ref/a/a.c && cc -o build/tests/a a.o ran.o &&
        cc -shared -o build/libraydiff.so ran.o a.o && # whose blocks have other addresses
        perl tests/mutation/blocks.pl table build/libraydiff.so >build/table
) || bad 'no program tells its lines'
uncovered() { (cd "$dir/room" && perl tests/mutation/uncovered.pl build "$@") >"$dir/out" 2>&1; }
ran() { RAN_BLOCKS="$dir/room/build/ran" "$dir/room/build/tests/a" "$@"; }
uncovered && bad 'nothing was run, and that is not told'
ran
uncovered || bad 'uncovered.pl fails'
printf '%s\n' 'ref/a/a.c: 2 of 8 lines' '7:        exit(3);' '9:        abort();' \
    '    2 of     8 lines of ref/a are run by no suite' '2 of 8 lines are run by no suite' | cmp -s - "$dir/out" ||
    { bad 'uncovered.pl'; cat "$dir/out"; }
uncovered other
grep -qx '0 of 0 lines are run by no suite' "$dir/out" || bad 'a room that is not there has lines'
ran 1
uncovered && grep -qx '1 of 8 lines are run by no suite' "$dir/out" || { bad 'what was run later is not told'; cat "$dir/out"; }
(ran 1 2) 2>/dev/null
uncovered && grep -qx '0 of 8 lines are run by no suite' "$dir/out" || { bad 'what ended by a signal is not told'; cat "$dir/out"; }

for file in $files; do
    "$build/mutate" list "$file" >>"$dir/all" || bad "$file cannot be read"
done
[ "$(grep -c . "$dir/all")" -gt 50000 ] || bad "few mutations of the tree"
echo "mutate: $(grep -c . "$dir/all") mutations of $(echo "$files" | wc -w) files, $failed failed"
[ "$failed" -eq 0 ]
