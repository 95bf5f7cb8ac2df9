#!/bin/sh
# Other processors and compilers, each in a minimal Debian that has them, on a clean clone:
#   sh .ci/other.sh RESULTS aarch64      suites compiled for aarch64, under qemu-user (make arm-check)
#   sh .ci/other.sh RESULTS warnings     gcc 12, clang 14, gcc 14 and clang 19 warn of nothing (make warnings-check)
#   sh .ci/other.sh RESULTS trimesh      trimesh's own tracer is judged from Python (make trimesh-check)
# What is green replaces its line in RESULTS. Logs: build/other. Exit codes: 0 green; 1 not; 2 usage; 77 it
# cannot be tried here, with the reason.
set -u
LC_ALL=C.UTF-8
export LC_ALL
check=other-check
supported='bookworm trixie'
logs=build/other
. .ci/systems.sh

# A row of the table: LINE'S NAME, RELEASE, packages, command.
plays() {
    case $1 in
    aarch64)
        echo "aarch64|trixie|git make $(sh tests/house/arm.sh --packages)|sh tests/house/arm.sh build/aarch64"
        ;;
    warnings)
        tried='sh .ci/deps.sh check && sh tests/house/compilers.sh build/compilers'
        echo "warnings bookworm|bookworm|git make gcc clang-14 libomp-14-dev|$tried gcc-12 clang-14"
        echo "warnings trixie|trixie|git make gcc clang-19 libomp-19-dev|$tried gcc-14 clang-19"
        ;;
    trimesh) # Debian 12 has none
        tried='sh .ci/deps.sh check && make -s -j2 all lib'
        echo "trimesh|trixie|git make python3-trimesh python3-rtree python3-scipy|$tried &&" \
            "sh tests/library/python.sh build --trimesh"
        ;;
    esac
}

# Tells the kernel how programs for aarch64 are emulated, for the processes of these name spaces alone (kernels
# before 6.7 cannot), and goes on in the system.
emulated() { # COMMAND
    magic='\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00'
    mask='\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff'
    mount -t binfmt_misc none "$root/mnt" 2>/dev/null &&
        printf '%s' ":raydiff-aarch64:M::$magic:$mask:$root/usr/bin/qemu-aarch64:F" >"$root/mnt/register"
    in_root "$1"
}

# One row; its last line of output is the result.
inside() {
    release=$1 root=$2 line=$3
    IFS='|' read -r name _ packages command <<END
$(plays "$what" | grep "^[^|]*|$release|")
END
    case $packages in *:arm64*) in_root 'dpkg --add-architecture arm64' ;; esac
    enter_system "$packages" || return 1
    {
        case $command in
        *arm.sh*) unshare --user --map-root-user --mount sh "$0" --emulated "$root" "cd /root/raydiff && $command" 2>&1 ;;
        *) in_root "cd /root/raydiff && $command" 2>&1 ;;
        esac
        echo $? >"$root/root/code"
    } | tee "$logs/$release.log"
    code=$(cat "$root/root/code")
    [ "$code" -eq 0 ] || {
        echo "FAILED $name: exit code $code: $logs/$release.log"
        return 1
    }
    echo "$name: $(system_name): $(tail -n 1 "$logs/$release.log")" >"$line"
}

what=${WHAT:-}
if [ "${1:-}" = --inside ]; then
    shift
    inside "$@"
    exit
fi
if [ "${1:-}" = --emulated ]; then
    root=$2
    emulated "$3"
    exit
fi
results=${1:-} what=${2:-}
[ $# -eq 2 ] && [ -n "$(plays "$what")" ] || { echo "usage: sh .ci/other.sh RESULTS aarch64|warnings|trimesh" >&2; exit 2; }
check=$what-check WHAT=$what
export WHAT
releases=$(plays "$what" | cut -d'|' -f2)
# shellcheck disable=SC2086
need_systems $releases
worst=0
for release in $releases; do
    if in_system "$release"; then
        cat "$line"
        keep "$(plays "$what" | grep "|$release|" | cut -d'|' -f1)" "$line"
    else
        worst=1
    fi
done
exit $worst
