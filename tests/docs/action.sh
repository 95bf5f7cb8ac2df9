#!/bin/sh
# Plays the run steps of the GitHub Action as its runner would: each in a shell that ends at the first error, with the
# step's variables, in a folder of the user.
#   sh tests/docs/action.sh
set -u
root=$(pwd)
action=$root/.github/actions/raydiff
work=$(mktemp -d) || exit 4
trap 'rm -rf "$work"' EXIT
failed=0
# arguments or "": steps N.sh, N.env and N.name; what is in ${{ }} is put in.
steps() {
    rm -f "$work"/*.sh "$work"/*.env "$work"/*.name
    default=$(sed -n 's/^    default: //p' "$action/action.yml")
    awk -v out="$work" -v path="$action" -v arguments="${1:-$default}" '
        /^    - name: / { n++; sub(/^    - name: /, ""); print > (out "/" n ".name"); part = ""; next }
        /^      env:$/ { part = "env"; next }
        /^      run: \|$/ { part = "run"; next }
        /^      [a-z]+:/ { part = ""; next }
        {
            gsub(/\$\{\{ github\.action_path \}\}/, path)
            gsub(/\$\{\{ inputs\.arguments \}\}/, arguments)
            if ($0 ~ /\$\{\{/) { print "unknown: " $0; exit 1 }
        }
        part == "env" { sub(/^ */, ""); name = $0; sub(/: .*/, "", name); sub(/^[A-Z]+: /, ""); print name "=\047" $0 "\047; export " name > (out "/" n ".env") }
        part == "run" { sub(/^        /, ""); print > (out "/" n ".sh") }
        END { print n > (out "/count") }' "$action/action.yml"
}
play() { # exit code, arguments
    want=$1
    shift
    steps "$*" || { failed=1; return; }
    rm -rf "$work/user"
    mkdir "$work/user"
    [ "$(cat "$work/count")" -eq 3 ] || { echo "FAILED  $(cat "$work/count") steps"; failed=1; }
    for i in 1 2 3; do
        (cd "$work/user" && . "$work/$i.env" && sh -e "$work/$i.sh") >"$work/log" 2>&1
        code=$?
        [ "$code" -eq 0 ] || break
    done
    [ "$code" -eq "$want" ] || { echo "FAILED  step $i ($(cat "$work/$i.name")): exit $code, not $want"; tail -n 5 "$work/log"; failed=1; }
}
play 0 fuzz --trials 64 --engine cpu --corpus none --dir findings --junit raydiff.xml
[ -s "$work/user/raydiff.xml" ] && [ -s "$work/user/findings.tar.gz" ] || { echo 'FAILED  no results'; failed=1; }
play 1 fuzz --trials 64 --engine cpu --layout rtrs_rf_paper --corpus none --no-shrink --dir findings --junit raydiff.xml
tar tzf "$work/user/findings.tar.gz" | grep -q 'first\.trial$' || { echo 'FAILED  no findings are kept'; failed=1; }
play 2 chekc
steps '' && grep -q "ARGUMENTS='fuzz --time 60 " "$work/3.env" || { echo 'FAILED  no default'; failed=1; }
[ "$failed" -eq 0 ] && echo 'action: played'
exit "$failed"
