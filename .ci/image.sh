#!/bin/sh
# An image for containers from scratch: debootstrap's minimal system and in it the package that deb-check built,
# put together and run by buildah, as chroot and without network. No image of a registry is used.
#   sh .ci/image.sh RESULTS [RELEASE...]     (make image-check, RELEASE=trixie)
# A line a release, which replaces its line in RESULTS. The image: build/image/RELEASE.tar (podman load -i), logs there.
# Exit codes: 0 green; 1 not; 2 usage; 77 it cannot be tried here, with the reason.
set -u
LC_ALL=C.UTF-8
export LC_ALL
check=image-check
supported='bookworm trixie'
logs=build/image
. .ci/systems.sh

# A step, all of whose output goes to its log; what fails ends this.
step() { # NAME COMMAND...
    name=$1
    shift
    echo "$release: $name"
    "$@" >"$logs/$release.$name.log" 2>&1 && return
    tail -n 5 "$logs/$release.$name.log"
    echo "FAILED $release: $name: $logs/$release.$name.log"
    exit 1
}
# Everything of buildah's lies beside the system, and goes with it.
bud() { buildah --root "$root.images" --runroot "$root.run" --storage-driver vfs "$@"; }

fill() { mounted=$(bud mount "$container") && cp -ax "$root/." "$mounted" && bud umount "$container"; }
# The image as a user runs it: the command is raydiff.
try() { # WORDS
    unshare --net buildah --root "$root.images" --runroot "$root.run" --storage-driver vfs \
        run --isolation chroot "$container" -- "$@"
}

inside() {
    mount -t devpts -o newinstance,ptmxmode=0666,mode=620 devpts "$root/dev/pts" || skip 'nothing can be mounted'
    rm -rf "$root/root/raydiff.git"
    cp build/deb/"$release"/raydiff_*.deb "$root/root/raydiff.deb" || exit 1
    step update in_root 'apt-get -q update'
    step install in_root 'apt-get -q -y --no-install-recommends install /root/raydiff.deb $(dpkg-deb -f /root/raydiff.deb Recommends | tr -d ,)'
    step clean in_root 'apt-get clean && rm -rf /root/raydiff.deb /var/lib/apt/lists/* /etc/apt/apt.conf.d/*proxy* /etc/resolv.conf'
    container=$(bud from --name "raydiff-$release" scratch) || exit 1
    step fill fill
    step config bud config --entrypoint '["raydiff"]' --cmd '--help' "$container"
    step version try raydiff --version
    step check try raydiff check terrain:k=3 --engine cpu,embree
    step commit bud commit --format docker "$container" "docker-archive:$logs/$release.tar:raydiff:$release"
    echo "$(cat "$logs/$release.version.log"), $(du -sxm "$root" | cut -f1) MB, check of two engines agrees without network" >"$line"
    bud rm "$container" >/dev/null
}

if [ "${1:-}" = --inside ]; then
    release=$2 root=$3 line=$4
    inside
    exit
fi
[ $# -gt 0 ] || { echo "usage: sh .ci/image.sh RESULTS [RELEASE...]" >&2; exit 2; }
results=$1
shift
[ $# -gt 0 ] || set -- bookworm trixie
command -v buildah >/dev/null || skip 'buildah is needed'
need_systems "$@"
worst=0
for release; do
    ls build/deb/"$release"/raydiff_*.deb >/dev/null 2>&1 || skip "make deb-check RELEASE=$release makes its package first"
    in_system "$release" || { worst=1; continue; }
    echo "image $release: $(cat "$line")" >"$line.all"
    cat "$line.all"
    keep "image $release" "$line.all"
done
exit $worst
