#!/bin/sh
# .ci/deb.sh without root, network and namespaces: systems are played by scripts, and so is what runs in them.
# Each step that fails ends a release, is told, and keeps no line.
#   sh tests/house/deb.sh
set -u
. tests/house/systems_played.sh
for name in ls stat; do ln -s "$(command -v $name)" "$dir/bin/$name"; done
mkdir -p "$dir/repository/.ci" "$dir/notes" "$dir/work"
cp .ci/deb.sh .ci/systems.sh .ci/apt_sources.sh "$dir/repository/.ci"
git -C "$dir/repository" init -q
git -C "$dir/repository" add .
git -C "$dir/repository" -c user.name=a -c user.email=b commit -qm c
# chroot ROOT env -i VARIABLES sh -c COMMAND: notes the command, in a line; it fails if a word of notes/fails is in it.
tool chroot <<'END'
for last; do :; done
case $last in
*'git clone'*) git clone -q "$1/root/raydiff.git" "$1/root/raydiff"; exit ;;
*dpkg-query\ -W\ -f*' lintian'*) echo '2.116.3'; exit ;;
esac
echo "$last" | tr '\n' ' ' >>"$NOTES/typed"
echo >>"$NOTES/typed"
case $last in
*dpkg-buildpackage*)
    for name in raydiff libraydiff-dev libraydiff1 python3-raydiff raydiff-doc raydiff-dbgsym; do
        echo "$name" >"$1/root/${name}_0.2.0_amd64.deb"
    done ;;
*'dpkg -i '*) ls "$1/root/packages" >"$NOTES/installed" ;;
esac
[ ! -e "$NOTES/fails" ] || case $last in *"$(cat "$NOTES/fails")"*) exit 1 ;; esac
END
# run CODE WHAT RELEASE...
run() {
    code=$1 what=$2
    shift 2
    rm -f "$dir/notes/typed" "$dir/notes/installed"
    (cd "$dir/repository" && PATH=$dir/bin NOTES=$dir/notes APT_ROOT=$dir/etc FRESH_DIR=$dir/work \
        sh .ci/deb.sh "$dir/results" "$@") >"$dir/out" 2>&1
    got=$?
    [ "$got" -eq "$code" ] && echo "passed  $what" || bad "$what: exit $got, not $code"
    [ -z "$(ls "$dir/work")" ] || bad "$what: something is left"
}
says() { grep -qE -- "$1" "$dir/out" || bad "no line like /$1/"; }
unset http_proxy https_proxy HTTP_PROXY HTTPS_PROXY

run 0 'both releases'
sizes='raydiff 8 bytes, libraydiff-dev 15 bytes, libraydiff1 12 bytes, python3-raydiff 16 bytes, raydiff-doc 12 bytes,'
line="build without network [0-9]+ s, lintian 2.116.3 finds no error and no warning; $sizes *dpkg -i, program, .* without a trace"
[ "$(grep -cE "^packages (bookworm|trixie): $line\$" "$dir/results")" -eq 2 ] || bad 'the results are two lines'
[ "$(wc -l <"$dir/results")" -eq 2 ] || bad 'nothing else is kept'
# The build has no network, the packages of debug symbols stay behind, and what was built lies where it is told.
isolated() { [ "$(grep -c 'unshare --net dpkg-buildpackage' "$dir/notes/typed")" -eq 2 ]; }
five() {
    [ "$(sed 's/_0.2.0_amd64.deb//' "$dir/notes/installed" | LC_ALL=C sort | tr '\n' ' ')" = \
        'libraydiff-dev libraydiff1 python3-raydiff raydiff raydiff-doc ' ]
}
isolated || bad 'the build has a network'
five || bad 'other packages are installed'
for release in bookworm trixie; do
    [ "$(ls "$dir/repository/build/deb/$release" | grep -c 'deb$')" -eq 6 ] || bad "the packages of $release are not kept"
done
grep -n . "$dir/notes/typed" | sed -n '/:dpkg -i \/root/{s/:.*//;p;}' >"$dir/installs"
grep -n . "$dir/notes/typed" | sed -n '/:dpkg --purge /{s/:.*//;p;}' >"$dir/purges"
[ "$(paste -d' ' "$dir/installs" "$dir/purges" | awk '$1 < $2' | wc -l)" -eq 2 ] || bad 'purged before it is installed'
cp "$dir/results" "$dir/before"

# Every step, failing.
steps() {
    for step in build-dep dpkg-buildpackage '--fail-on error,warning' 'apt-get -q -y --no-install-recommends satisfy' \
        '/root/before' 'dpkg -i ' 'raydiff check ' 'man "$page"' 'complete -p raydiff' compinit user_program.sh \
        examples/sample_tracer.c --purge 'diff /root/before'; do
        echo "$step" >"$dir/notes/fails"
        run "$1" "$step fails" bookworm
        [ "$1" -eq 0 ] || says '^FAILED bookworm: '
        cmp -s "$dir/before" "$dir/results" || bad "$step: what fails changes a line"
    done
    rm "$dir/notes/fails"
}
steps 1
: >"$dir/notes/no-trixie"
run 1 'a release that cannot be made'
says '^FAILED trixie: debootstrap'
says '^packages bookworm: build'
rm "$dir/notes/no-trixie"

# Planted: a step that fails goes on; a network; symbols are installed as well; the exit code is lost.
cp "$dir/repository/.ci/deb.sh" "$dir/sound"
planted() { # SED CHECK
    sed "$1" "$dir/sound" >"$dir/repository/.ci/deb.sh"
    cmp -s "$dir/sound" "$dir/repository/.ci/deb.sh" && bad "planted: /$1/ changes nothing"
    "$2" && bad "planted: /$1/ is not seen"
}
fails_unseen() {
    echo --fail-on >"$dir/notes/fails"
    (run 1 planted bookworm) | grep -q '^FAILED' && return 1
    return 0
}
planted 's/^    exit 1$/    :/' fails_unseen
planted 's/worst=1; continue/continue/' fails_unseen
rm "$dir/notes/fails"
still_isolated() { (run 0 planted) >"$dir/said"; isolated; }
still_five() { (run 0 planted) >"$dir/said"; five; }
planted 's/unshare --net //' still_isolated
planted 's/grep -v dbgsym/cat/' still_five
cp "$dir/sound" "$dir/repository/.ci/deb.sh"

run 2 'a release that is not supported' potato
says "'potato' is not one of: bookworm trixie"
(cd "$dir/repository" && PATH=$dir/bin sh .ci/deb.sh) >"$dir/out" 2>&1
[ $? -eq 2 ] || bad 'without results: usage'
echo 'echo 1000' | tool id
run 77 'without root'
says '^SKIP deb-check: only root'
echo "deb: $failed failed"
[ "$failed" -eq 0 ]
