#!/bin/sh
# The README's two commands as the README says them, in a minimal Debian of each release that is supported:
# debootstrap, git and make, a clean clone of what is committed, nothing else.
#   sh .ci/fresh.sh RESULTS [RELEASE...]     (make fresh-check, RELEASE=trixie)
# Packages come from the machine's own Debian source, through its proxies. What runs has processes, mounts
# and terminals of its own (unshare), so that nothing of it is left, however it ends. A line a release:
# versions, seconds, suites; if all is green it replaces the release's line in RESULTS. Logs: build/fresh.
# Exit codes: 0 green; 1 a command fails or what it needs cannot be installed; 2 usage; 4 the README has no
# such commands; 77 it cannot be tried here, with the reason.
set -u
LC_ALL=C.UTF-8
export LC_ALL
here=$(dirname "$0")
supported='bookworm trixie'
logs=build/fresh

skip() {
    echo "SKIP fresh-check: $1"
    exit 77
}

# Commands of the code block under "Two commands", without their comments.
commands() {
    sed -n '/^## Two commands/,/^## [^T]/{/^```sh/,/^```$/p}' README.md | sed '/^```/d; s/ *#.*//; /^$/d'
}

# The machine's proxies as words NAME=VALUE, of the environment or of apt.
proxies() {
    env | grep -iE '^(https?|ftp|no|all)_proxy=[^ ]*$'
    for scheme in http https; do
        [ -n "$(env | grep -i "^${scheme}_proxy=")" ] && continue
        apt-config dump 2>/dev/null | sed -n "s/^Acquire::$scheme::[Pp]roxy \"\(..*\)\";$/${scheme}_proxy=\1/p" |
            grep -v '=DIRECT$'
    done
}

# $1 is run by a shell in the new system.
in_root() {
    # shellcheck disable=SC2046 # words without blanks
    chroot "$root" env -i HOME=/root TERM=dumb DEBIAN_FRONTEND=noninteractive \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin $(proxies) sh -c "$1" </dev/null
}

# $(version PACKAGE...): of the first that is installed, without what Debian adds.
version() {
    for package; do
        in_root "dpkg-query -W -f '\${Version}\n' $package" 2>/dev/null && return
    done | sed 's/^[0-9]*://; s/[-+~].*//' | head -n 1
}

# Runs a command of the README and shows how it goes; sets code and seconds.
play() { # LOG COMMAND
    echo "$release: $2"
    started=$(date +%s)
    {
        in_root "cd /root/raydiff && $2" 2>&1
        echo $? >"$root/root/code"
    } | tee "$1" | sed -u "s/^/$release: /"
    code=$(cat "$root/root/code")
    seconds=$(($(date +%s) - started))
}

# One release, in namespaces of its own: the system is there, with git and make and the clone.
inside() {
    release=$1 root=$2 line=$3 told=''
    mount -t devpts -o newinstance,ptmxmode=0666,mode=620 devpts "$root/dev/pts" &&
        mount -t tmpfs tmpfs "$root/dev/shm" || skip "nothing can be mounted"
    in_root 'apt-get -q update && apt-get -q -y install git make' >"$logs/$release.apt.log" 2>&1 || {
        tail -n 3 "$logs/$release.apt.log"
        echo "FAILED $release: git and make cannot be installed: $logs/$release.apt.log"
        return 1
    }
    in_root 'cd /root && git clone -q raydiff.git raydiff' || return 1
    number=0
    commands >"$root/root/commands"
    while read -r command <&3; do
        number=$((number + 1))
        play "$logs/$release.$number.log" "$command"
        told="$told${told:+, }$command $seconds s"
        [ "$code" -eq 0 ] || {
            echo "FAILED $release: $command: exit code $code after $seconds s: $logs/$release.$number.log"
            cp -r "$root/root/raydiff/build/check" "$logs/$release.$number.check" 2>/dev/null
            return 1
        }
    done 3<"$root/root/commands"
    suites=$(grep -hE '^[0-9]+ passed' "$logs/$release".*.log | tail -n 1)
    echo "$release: Debian $(in_root 'cat /etc/debian_version'), gcc $(in_root 'gcc -dumpfullversion')," \
        "Embree $(version libembree-dev), glslang $(version glslang-tools)," \
        "Mesa $(version mesa-vulkan-drivers): $told${suites:+: $suites}" >"$line"
}

# A minimal system with the machine's package source; 1: there is none of this release.
make_system() { # RELEASE FOLDER
    echo "$1: debootstrap"
    mkdir -p "$2"
    # shellcheck disable=SC2046
    env $(proxies) debootstrap --variant=minbase "$1" "$2" "$archive" >"$logs/$1.debootstrap.log" 2>&1 || {
        tail -n 3 "$logs/$1.debootstrap.log"
        return 1
    }
    {
        echo "deb $archive $1 main"
        echo "deb $archive $1-updates main"
        [ -z "$security" ] || echo "deb $security $1-security main"
    } >"$2/etc/apt/sources.list"
    cp /etc/resolv.conf "$2/etc/resolv.conf" 2>/dev/null
    git clone -q --bare . "$2/root/raydiff.git"
}

# The line of RELEASE in RESULTS, or one more.
keep() { # RELEASE LINE
    { grep -v "^$1:" "$results" 2>/dev/null; cat "$2"; } | sort >"$results.new" && mv "$results.new" "$results"
}

if [ "${1:-}" = --inside ]; then
    shift
    inside "$@"
    exit
fi
[ $# -gt 0 ] || { echo "usage: sh .ci/fresh.sh RESULTS [RELEASE...]" >&2; exit 2; }
results=$1
shift
[ $# -gt 0 ] || eval "set -- $supported"
for release; do
    case " $supported " in
    *" $release "*) ;;
    *) echo "fresh-check: '$release' is not one of: $supported" >&2; exit 2 ;;
    esac
done
[ "$(commands | wc -l)" -eq 2 ] || { echo "fresh-check: README.md has no code block of two commands" >&2; exit 4; }
[ "$(id -u)" -eq 0 ] || skip "only root may make a system in a folder"
for tool in debootstrap unshare chroot git; do
    command -v $tool >/dev/null || skip "$tool is needed"
done
unshare --mount --pid --fork true 2>/dev/null || skip "unshare may not make namespaces here"
# This machine's release, or any other of Debian's.
sources=$(sh "$here/apt_sources.sh")
archive=$(echo "$sources" | awk '$2 ~ /^(bullseye|bookworm|trixie|forky|sid|stable|testing)$/ {print $1; exit}')
security=$(echo "$sources" | awk '$2 ~ /-security$/ {print $1; exit}')
[ -n "$archive" ] || skip "apt has no Debian source on this machine"
mkdir -p "$logs"
rm -rf "${logs:?}"/*
[ -z "$(git status --porcelain --untracked-files=no)" ] || echo "fresh-check: what is not committed is not played"

work=$(mktemp -d "${FRESH_DIR:-/var/tmp}/raydiff-fresh-XXXXXX") || exit 2
trap 'rm -rf --one-file-system "$work"' EXIT
trap 'exit 130' INT TERM HUP
worst=0
for release; do
    root=$work/$release line=$work/$release.line
    if ! make_system "$release" "$root"; then
        echo "FAILED $release: debootstrap: $logs/$release.debootstrap.log"
        worst=1
        continue
    fi
    unshare --mount --propagation private --pid --fork --kill-child "--mount-proc=$root/proc" \
        sh "$0" --inside "$release" "$root" "$line"
    code=$?
    [ "$code" -ne 77 ] || exit 77
    if [ "$code" -eq 0 ] && [ -s "$line" ]; then
        cat "$line"
        keep "$release" "$line"
    else
        worst=1
    fi
    rm -rf --one-file-system "$root"
done
exit $worst
