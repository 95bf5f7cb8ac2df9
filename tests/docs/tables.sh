#!/bin/sh
# Tables of measurements in the documents are what is recorded (tests/docs/tables.pl), and a changed digit in any of their
# rows is noticed: sh tests/docs/tables.sh
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0 changed=0
perl tests/docs/tables.pl || failed=1
cp docs/results.md docs/errors.md docs/paper.md "$dir"
for page in results errors paper; do
    # Rows with a fraction; that of frames of two lines is not recorded.
    for row in $(grep -nE '^\| .*[0-9]\.[0-9]' "docs/$page.md" | grep -v 'another look' | cut -d: -f1); do
        perl -pe 's/(\d)(?=\D*$)/($1 + 5) % 10/e if $. == '"$row" "docs/$page.md" >"$dir/$page.md"
        cmp -s "docs/$page.md" "$dir/$page.md" && { echo "FAILED  docs/$page.md:$row: no digit"; failed=1; }
        perl tests/docs/tables.pl "$dir" >/dev/null && { echo "FAILED  docs/$page.md:$row: a changed digit is not noticed"; failed=1; }
        changed=$((changed + 1))
    done
    cp "docs/$page.md" "$dir"
done
echo "tables: $changed rows changed by a digit"
[ "$failed" -eq 0 ] && [ "$changed" -ge 90 ]
