# For the suites that meet the program as a user does; read with `.`. Sets $dir, a temporary folder,
# and counts in $failed; needs $raydiff. After ten failures the rest is left out: the program itself is broken.
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0

bad() {
    echo "FAILED  $1"
    sed 's/^/        /' "$dir/out" "$dir/err" | tail -n 8
    failed=$((failed + 1))
    [ "$failed" -lt 10 ] || { echo "$failed failed, the rest is left out"; exit 1; }
}

# Standard error has one line.
one_line() {
    { IFS= read -r said && ! read -r said; } <"$dir/err"
}

# Expected code, a pattern that standard error must match (. for none), arguments.
expect() {
    code=$1 pattern=$2
    shift 2
    "$raydiff" "$@" >"$dir/out" 2>"$dir/err"
    got=$?
    if [ "$got" -ne "$code" ]; then
        bad "raydiff $*: exit $got, not $code"
    elif [ "$code" -ne 0 ] && [ "$pattern" != . ] && ! grep -qE -- "$pattern" "$dir/err"; then
        bad "raydiff $*: no line like /$pattern/"
    elif [ "$code" -eq 2 ] && [ "$pattern" != . ] && ! one_line; then
        bad "raydiff $*: an error is one line"
    else
        echo "passed  raydiff $*"
    fi
}

# What the last run printed has such lines.
has() { # what, pattern...
    what=$1
    shift
    for pattern; do
        grep -qE -- "$pattern" "$dir/out" || bad "$what: no line like /$pattern/"
    done
}
