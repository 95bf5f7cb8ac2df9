#!/bin/sh
# .ci/image.sh without root, network, namespaces and buildah: scripts play them. Each step that fails ends a
# release, is told, and keeps no line.
#   sh tests/house/image.sh
set -u
. tests/house/systems_played.sh
for name in ls cut; do ln -s "$(command -v $name)" "$dir/bin/$name"; done
echo 'printf "454\t%s\n" "$2"' | tool du
mkdir -p "$dir/repository/.ci" "$dir/notes" "$dir/work"
cp .ci/image.sh .ci/systems.sh .ci/apt_sources.sh "$dir/repository/.ci"
git -C "$dir/repository" init -q
git -C "$dir/repository" add .
git -C "$dir/repository" -c user.name=a -c user.email=b commit -qm c
package() { mkdir -p "$dir/repository/build/deb/$1" && echo "$1" >"$dir/repository/build/deb/$1/raydiff_0.2.0_amd64.deb"; }
# What is typed in the system, and what buildah is told, in the order of time.
{
    echo 'fails() { [ ! -e "$NOTES/fails" ] || case $1 in *"$(cat "$NOTES/fails")"*) exit 1 ;; esac; }'
    echo 'for last; do :; done; echo "$last" >>"$NOTES/typed"; fails "$last"'
} | tool chroot
cat <<'END' | tool buildah
fails() { [ ! -e "$NOTES/fails" ] || case $1 in *"$(cat "$NOTES/fails")"*) exit 1 ;; esac; }
[ "$1 $3 $5 $6" = '--root --runroot --storage-driver vfs' ] || exit 9
mounted=$2.mounted
shift 6
echo "buildah $*" >>"$NOTES/typed"
fails "buildah $*"
case $1 in
from) echo "$3" ;;
mount) mkdir -p "$mounted" && echo "$mounted" ;;
run) [ "$NETWORK" = none ] || exit 8
    [ -d "$mounted/etc" ] && [ "$6" = raydiff ] && echo 'raydiff 0.2.0' ;;
esac
END
tool unshare <<'END'
NETWORK=any
while case ${1:-} in --propagation) shift ;; --net) NETWORK=none ;; --*) ;; *) false ;; esac do shift; done
export NETWORK
exec "$@"
END
# run CODE WHAT RELEASE...
run() {
    code=$1 what=$2
    shift 2
    rm -f "$dir/notes/typed"
    (cd "$dir/repository" && PATH=$dir/bin NOTES=$dir/notes APT_ROOT=$dir/etc FRESH_DIR=$dir/work \
        sh .ci/image.sh "$dir/results" "$@") >"$dir/out" 2>&1
    got=$?
    [ "$got" -eq "$code" ] && echo "passed  $what" || bad "$what: exit $got, not $code"
    [ -z "$(ls "$dir/work")" ] || bad "$what: something is left"
}
says() { grep -qE -- "$1" "$dir/out" || bad "no line like /$1/"; }
unset http_proxy https_proxy HTTP_PROXY HTTPS_PROXY

run 77 'without a package' bookworm
says '^SKIP image-check: make deb-check RELEASE=bookworm makes its package first'
package bookworm
package trixie
run 0 'both releases'
for release in bookworm trixie; do
    grep -qx "image $release: raydiff 0.2.0, 454 MB, check of two engines agrees without network" "$dir/results" || bad "the line of $release"
done
run 0 'one of them' bookworm
[ "$(wc -l <"$dir/results")" -eq 2 ] || bad 'a line is replaced, the other kept'
# From nothing, the package in it, tried before it is committed, with raydiff as its command.
order=$(grep -nE 'install /root/raydiff.deb|^buildah (from|config|run|commit)' "$dir/notes/typed" |
    sed 's/^[0-9]*:\(buildah [a-z]*\).*/\1/; s/^[0-9]*:apt.*/install/' | tr '\n' ,)
[ "$order" = 'install,buildah from,buildah config,buildah run,buildah run,buildah commit,' ] || bad "the order: $order"
grep -q '^buildah from --name raydiff-bookworm scratch$' "$dir/notes/typed" || bad 'it begins with nothing'
grep -qxF 'buildah config --entrypoint ["raydiff"] --cmd --help raydiff-bookworm' "$dir/notes/typed" || bad 'its command'
grep -q '^buildah run --isolation chroot raydiff-bookworm -- raydiff check terrain:k=3 --engine cpu,embree$' "$dir/notes/typed" ||
    bad 'it is tried'
cp "$dir/results" "$dir/before"

for step in 'apt-get -q update' 'install /root/raydiff.deb' 'apt-get clean' 'buildah from' 'buildah mount' 'buildah config' \
    'raydiff --version' 'raydiff check' 'buildah commit'; do
    echo "$step" >"$dir/notes/fails"
    run 1 "$step fails" bookworm
    cmp -s "$dir/before" "$dir/results" || bad "$step: what fails changes a line"
done
# Planted: what fails goes on; the image is tried with a network.
cp "$dir/repository/.ci/image.sh" "$dir/sound"
planted() { # SED
    sed "$1" "$dir/sound" >"$dir/repository/.ci/image.sh"
    cmp -s "$dir/sound" "$dir/repository/.ci/image.sh" && bad "planted: /$1/ changes nothing"
    (run "$2" planted bookworm) | grep -q '^FAILED' || bad "planted: /$1/ is not seen"
}
echo 'raydiff check' >"$dir/notes/fails"
planted '/^step()/,/^}/s/exit 1/:/' 1
planted 's/worst=1; continue/continue/' 1
rm "$dir/notes/fails"
planted 's/unshare --net buildah/buildah/' 0
cp "$dir/sound" "$dir/repository/.ci/image.sh"

run 2 'a release that is not supported' potato
mv "$dir/bin/buildah" "$dir/buildah"
run 77 'without buildah' bookworm
says '^SKIP image-check: buildah is needed'
mv "$dir/buildah" "$dir/bin"
echo 'echo 1000' | tool id
run 77 'without root' bookworm
says '^SKIP image-check: only root'
echo "image: $failed failed"
[ "$failed" -eq 0 ]
