# For suites of tracers from outside; read with `.` where the sources are, with the path of the program in $1.
# Goes to a folder of its own, so that files are named as users name theirs; $root is where the sources are, the file
# `out` has what the last command said.
raydiff=$(cd "$(dirname "${1?PATH/raydiff}")" && pwd)/raydiff
root=$(pwd)
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 4
: >out
failed=0
bad() {
    echo "FAILED: $1"
    sed 's/^/    /' out
    failed=1
}
# expect CODE TEXT ARGUMENTS...: the exit code, and a regular expression of what is printed
expect() {
    want=$1 text=$2
    shift 2
    "$raydiff" "$@" >out 2>&1
    code=$?
    [ "$code" -eq "$want" ] && grep -Eq -- "$text" out || bad "$* ends with $code, not $want and '$text'"
}
