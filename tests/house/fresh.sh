#!/bin/sh
# .ci/fresh.sh without root, network and namespaces: what makes systems and enters them is played by
# scripts; the commands of the README fail one after the other.
#   sh tests/house/fresh.sh
set -u
. tests/house/systems_played.sh
# A repository with a README of its own, of which one change is not committed.
mkdir -p "$dir/repository/.ci" "$dir/notes"
cp .ci/fresh.sh .ci/systems.sh .ci/apt_sources.sh "$dir/repository/.ci"
cp README.md "$dir/repository"
git -C "$dir/repository" init -q
git -C "$dir/repository" add .
git -C "$dir/repository" -c user.name=a -c user.email=b commit -qm c
# run CODE WHAT RELEASE...
run() {
    code=$1 what=$2
    shift 2
    rm -f "$dir/notes/typed"
    (cd "$dir/repository" && PATH=$dir/bin NOTES=$dir/notes APT_ROOT=$dir/etc FRESH_DIR=$dir/work \
        sh .ci/fresh.sh "$dir/results" "$@") >"$dir/out" 2>&1
    got=$?
    [ "$got" -eq "$code" ] && echo "passed  $what" || bad "$what: exit $got, not $code"
    [ -z "$(ls "$dir/work")" ] || bad "$what: something is left"
}
says() { grep -qE -- "$1" "$dir/out" || bad "no line like /$1/"; }
typed() { [ "$(tr '\n' , <"$dir/notes/typed" 2>/dev/null)" = "$1" ] || bad "not typed: $1"; }
unset http_proxy https_proxy HTTP_PROXY HTTPS_PROXY
mkdir "$dir/work"

run 0 'both releases'
typed 'make run,make check,make run,make check,'
says '^bookworm: make check$'
line='Debian 12.9, gcc 12.2.0, Embree 3.14.2, glslang 3.14.2, Mesa 3.14.2: make run [0-9]+ s, make check [0-9]+ s: 230 passed'
says "^trixie: $line"
[ "$(grep -cE "^(bookworm|trixie): $line" "$dir/results")" -eq 2 ] || bad 'the results are two lines'
grep -q '^--variant=minbase trixie .* http://one.example/debian$' "$dir/notes/debootstrap" || bad "the machine's own mirror"
grep -qE 'example' "$dir/results" "$dir/out" && bad 'a mirror or a proxy is told'
run 0 'one of them' bookworm
typed 'make run,make check,'
[ "$(wc -l <"$dir/results")" -eq 2 ] || bad 'a line is replaced, the other kept'
cp "$dir/results" "$dir/before"

run 77 'Ubuntu without its keys' noble
says '^SKIP fresh-check: noble needs .*keyring'
UBUNTU_KEYS=$dir/keys SCRIPTS=$dir/scripts
export UBUNTU_KEYS SCRIPTS
: >"$dir/keys"
run 0 'Ubuntu' noble
grep -q "^--variant=minbase --components=main,universe --keyring=$dir/keys noble .* http://archive.ubuntu.com/ubuntu $dir/scripts/gutsy$" \
    "$dir/notes/debootstrap" || bad "Ubuntu's mirror, keys and script"
grep -q '^noble: Ubuntu 24.04, gcc 12.2.0' "$dir/results" || bad "Ubuntu's line"
cp "$dir/before" "$dir/results"

echo 'make check' >"$dir/notes/fails"
run 1 'a command that fails' bookworm
says '^FAILED bookworm: make check: exit code 1'
echo 'make run' >"$dir/notes/fails"
run 1 'the first that fails ends it' bookworm
typed 'make run,'
rm "$dir/notes/fails"
: >"$dir/notes/no-trixie"
run 1 'a release that cannot be made'
typed 'make run,make check,'
says '^FAILED trixie: debootstrap'
rm "$dir/notes/no-trixie"
cut -d: -f1 "$dir/before" >"$dir/names"
cut -d: -f1 "$dir/results" | cmp -s - "$dir/names" || bad 'what fails is not among the results'

# Planted: whatever ends a command counts as green; a line is kept of what failed.
cp "$dir/repository/.ci/fresh.sh" "$dir/sound"
echo 'make check' >"$dir/notes/fails"
planted() { # SED
    sed "$1" "$dir/sound" >"$dir/repository/.ci/fresh.sh"
    cmp -s "$dir/sound" "$dir/repository/.ci/fresh.sh" && bad "planted: /$1/ changes nothing"
    rm -f "$dir/results"
    (run 1 planted bookworm) | grep -q '^FAILED' || [ -e "$dir/results" ] || bad "planted: /$1/ is not seen"
}
planted 's/echo $? >"$root/echo 0 >"$root/'
planted 's/^    worst=1$/    worst=0/; s/^        worst=1$/        worst=0/'
cp "$dir/sound" "$dir/repository/.ci/fresh.sh"
rm "$dir/notes/fails"

run 2 'a release that is not supported' potato
says "'potato' is not one of: bookworm trixie noble"
echo 'echo 1000' | tool id
run 77 'without root'
says '^SKIP fresh-check: only root'
echo 'echo 0' | tool id
mv "$dir/bin/debootstrap" "$dir/debootstrap"
run 77 'without debootstrap'
mv "$dir/debootstrap" "$dir/bin"
echo 'exit 1' | tool mount
run 77 'where nothing can be mounted' bookworm
echo 'exit 0' | tool mount
echo 'exit 0' | tool true
: >"$dir/etc/sources.list"
run 77 'without a source of packages'
sed -i '/^make check  /d' "$dir/repository/README.md"
run 4 'a README without the commands'
echo "fresh: $failed failed"
[ "$failed" -eq 0 ]
