#!/bin/sh
# Debian packages of what is committed: built in a minimal system without network, clean under that release's
# lintian; then, in a system that never saw the sources' tools, installed, used, the tutorials followed with
# it, and purged without a trace.
#   sh .ci/deb.sh RESULTS [RELEASE...]       (make deb-check, RELEASE=trixie)
# A line a release, which replaces its line in RESULTS. Packages and logs: build/deb.
# Exit codes: 0 green; 1 not; 2 usage; 77 it cannot be tried here, with the reason.
set -u
LC_ALL=C.UTF-8
export LC_ALL
check=deb-check
supported='bookworm trixie'
logs=build/deb
. .ci/systems.sh

# A step in the system, all of whose output goes to its log; what fails ends this.
step() { # NAME COMMAND
    echo "$release: $1"
    in_root "$2" >"$logs/$release.$1.log" 2>&1 && return
    tail -n 20 "$logs/$release.$1.log"
    echo "FAILED $release: $1: $logs/$release.$1.log"
    exit 1
}

packages='raydiff libraydiff-dev libraydiff1 python3-raydiff raydiff-doc'

build() {
    enter_system git make dpkg-dev lintian || exit 1
    step depends 'apt-get -q -y --no-install-recommends build-dep /root/raydiff'
    started=$(date +%s)
    step build 'cd /root/raydiff && unshare --net dpkg-buildpackage -us -uc -b "-j$(nproc)"'
    seconds=$(($(date +%s) - started))
    step lintian 'lintian --allow-root --fail-on error,warning /root/raydiff_*.changes'
    cp "$root"/root/*.deb "$logs/"
    {
        echo "build without network $seconds s, lintian $(version lintian) finds no error and no warning;"
        for package in $packages; do
            stat -c "$package %s bytes," "$root/root/${package}_"*.deb
        done
    } | tr '\n' ' ' >"$line"
}

followed='docs/quickstart.md docs/my-layout.md docs/my-engine.md docs/my-shader.md docs/library.md'

# All files but those that packages of any kind write: dpkg's own, caches, logs.
files='find / -xdev \( -path /proc -o -path /root -o -path /tmp -o -path /var/lib/dpkg -o -path /var/cache
    -o -path /var/log \) -prune -o -print | sort'

use() {
    enter_system git man-db zsh pkgconf gcc libc6-dev perl python3-minimal mesa-vulkan-drivers glslang-tools || exit 1
    mkdir "$root/root/packages"
    cp $(ls "$logs"/*.deb | grep -v dbgsym) "$root/root/packages"
    step needs 'cd /root/packages &&
        for deb in *.deb; do dpkg-deb -f "$deb" Depends; dpkg-deb -f "$deb" Recommends; done | tr , "\n" | grep -vE "^ *($|(lib|python3-)?raydiff)" |
            paste -sd, >needs &&
        apt-get -q -y --no-install-recommends satisfy "$(cat needs)"'
    step before "$files >/root/before"
    step install 'dpkg -i /root/packages/*.deb'
    step program 'version=$(dpkg-query -W -f "\${Version}" raydiff) &&
        [ "$(raydiff --version)" = "raydiff $version" ] &&
        raydiff check terrain:k=3 --engine cpu,embree'
    step pages 'for page in raydiff $(raydiff help --commands | sed s/^/raydiff-/); do
        man "$page" 2>/dev/null | grep -q "$page" || { echo "no page $page"; exit 1; }; done'
    step bash 'bash -c ". /usr/share/bash-completion/completions/raydiff && complete -p raydiff"'
    step zsh 'zsh -fc "autoload -Uz compinit && compinit -u -D && [ \"\${_comps[raydiff]}\" = _raydiff ]"'
    step library 'cd /root/raydiff && sh tests/house/user_program.sh /usr/include/raydiff'
    step documents 'cd /usr/share/doc/raydiff && [ -s README.md ] && [ -s docs/numerics.md ] &&
        [ -s examples/sample_tracer.c ]'
    # The pages of who has one bug, a layout, a tracer or a shader, word for word, with what is installed.
    started=$(date +%s)
    step follow "cd /root/raydiff && SLOW=1 perl tests/docs/pages.pl /usr/bin $followed"
    seconds=$(($(date +%s) - started))
    step purge "dpkg --purge $packages"
    step after "$files >/root/after; diff /root/before /root/after"
    echo "dpkg -i, program, man pages, completions, pkg-config," \
        "$(echo $followed | wc -w) pages followed in $seconds s, purged without a trace" >"$line"
}

if [ "${1:-}" = --inside ]; then
    release=$2 root=$3 line=$4
    $PHASE
    exit
fi
[ $# -gt 0 ] || { echo "usage: sh .ci/deb.sh RESULTS [RELEASE...]" >&2; exit 2; }
results=$1
shift
[ $# -gt 0 ] || set -- bookworm trixie
need_systems "$@"
worst=0
for release; do
    PHASE=build
    export PHASE
    rm -f "$logs"/*.deb
    in_system "$release" || { worst=1; continue; }
    built=$(cat "$line")
    PHASE=use
    in_system "$release" || { worst=1; continue; }
    mkdir "$logs/$release" && mv "$logs"/*.deb "$logs/$release"
    echo "packages $release: $built$(cat "$line")" >"$line.all"
    cat "$line.all"
    keep "packages $release" "$line.all"
done
exit $worst
