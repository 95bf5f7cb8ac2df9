#!/bin/sh
# Minimal systems in folders, for scripts of .ci, which source this: debootstrap, a bare clone of what is
# committed, processes, mounts and terminals of their own (unshare), so that nothing of it is left, however
# it ends. Packages come from the machine's own Debian source, through its proxies.
#   check=NAME supported='RELEASE...' logs=FOLDER      set before, and results=FILE before keep
# A script calls need_systems once, then in_system for each release, which runs `sh $0 --inside RELEASE ROOT
# LINE` in the system: what that writes into the file LINE is the result of its last run, which keep() takes.
# shellcheck disable=SC2154 # set by who sources this

skip() {
    echo "SKIP $check: $1"
    exit 77
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
proxied=$(proxies)

# $1 is run by a shell in the new system.
in_root() {
    # shellcheck disable=SC2086 # words without blanks
    chroot "$root" env -i HOME=/root TERM=dumb DEBIAN_FRONTEND=noninteractive \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin $proxied sh -c "$1" </dev/null
}

# $(version PACKAGE...): of the first that is installed, without what Debian adds.
version() {
    for package; do
        in_root "dpkg-query -W -f '\${Version}\n' $package" 2>/dev/null && return
    done | sed 's/^[0-9]*://; s/[-+~].*//' | head -n 1
}

# Debian 12.9, Ubuntu 24.04.
system_name() {
    case $release in
    noble) in_root '. /etc/os-release && echo "$NAME $VERSION_ID"' ;;
    *) echo "Debian $(in_root 'cat /etc/debian_version')" ;;
    esac
}

# The first steps inside, with root and release set: terminals, memory, PACKAGES, and the clone.
enter_system() { # PACKAGE...
    mount -t devpts -o newinstance,ptmxmode=0666,mode=620 devpts "$root/dev/pts" &&
        mount -t tmpfs tmpfs "$root/dev/shm" || skip "nothing can be mounted"
    in_root "apt-get -q update && apt-get -q -y install $*" >"$logs/$release.apt.log" 2>&1 || {
        tail -n 3 "$logs/$release.apt.log"
        echo "FAILED $release: $* cannot be installed: $logs/$release.apt.log"
        return 1
    }
    in_root 'cd /root && git clone -q raydiff.git raydiff'
}

# Where RELEASE comes from: mirror, that of security, components; options and script of debootstrap. Debian's
# is the machine's own source. Ubuntu's is Ubuntu, whose keys the machine must have.
place_of() { # RELEASE
    mirror=$archive guarded=$security components=main options='' script=''
    case $1 in
    noble)
        mirror=http://archive.ubuntu.com/ubuntu guarded=http://security.ubuntu.com/ubuntu
        components='main universe'
        options="--components=main,universe --keyring=$ubuntu_keys"
        script=${SCRIPTS:-/usr/share/debootstrap/scripts}/$1
        [ -e "$script" ] || script=${script%/*}/gutsy # what all later ones are
        ;;
    esac
}
ubuntu_keys=${UBUNTU_KEYS:-/usr/share/keyrings/ubuntu-archive-keyring.gpg}

# A minimal system; 1: there is none of this release.
make_system() { # RELEASE FOLDER
    echo "$1: debootstrap"
    mkdir -p "$2"
    place_of "$1"
    # shellcheck disable=SC2086
    env $proxied debootstrap --variant=minbase $options "$1" "$2" "$mirror" $script >"$logs/$1.debootstrap.log" 2>&1 || {
        tail -n 3 "$logs/$1.debootstrap.log"
        return 1
    }
    rm -f "$2"/etc/apt/sources.list.d/*.sources
    {
        echo "deb $mirror $1 $components"
        echo "deb $mirror $1-updates $components"
        [ -z "$guarded" ] || echo "deb $guarded $1-security $components"
    } >"$2/etc/apt/sources.list"
    cp /etc/resolv.conf "$2/etc/resolv.conf" 2>/dev/null
    git clone -q --bare . "$2/root/raydiff.git"
}

# The line of NAME in the results, or one more.
keep() { # NAME FILE
    { grep -v "^$1:" "$results" 2>/dev/null; cat "$2"; } | sort >"$results.new" && mv "$results.new" "$results"
}

# Ends the script where no system can be made; a folder for them, which is removed at the end.
need_systems() { # RELEASE...
    for release; do
        case " $supported " in
        *" $release "*) ;;
        *) echo "$check: '$release' is not one of: $supported" >&2; exit 2 ;;
        esac
    done
    [ "$(id -u)" -eq 0 ] || skip "only root may make a system in a folder"
    for tool in debootstrap unshare chroot git; do
        command -v $tool >/dev/null || skip "$tool is needed"
    done
    unshare --mount --pid --fork true 2>/dev/null || skip "unshare may not make namespaces here"
    # This machine's release, or any other of Debian's.
    sources=$(sh .ci/apt_sources.sh)
    archive=$(echo "$sources" | awk '$2 ~ /^(bullseye|bookworm|trixie|forky|sid|stable|testing)$/ {print $1; exit}')
    security=$(echo "$sources" | awk '$2 ~ /-security$/ {print $1; exit}')
    [ -n "$archive" ] || skip "apt has no Debian source on this machine"
    case " $* " in
    *' noble '*) [ -e "$ubuntu_keys" ] || skip "noble needs $ubuntu_keys (Debian: ubuntu-archive-keyring)" ;;
    esac
    rm -rf "$logs"
    mkdir -p "$logs"
    [ -z "$(git status --porcelain --untracked-files=no)" ] || echo "$check: what is not committed is not played"
    work=$(mktemp -d "${FRESH_DIR:-/var/tmp}/raydiff-fresh-XXXXXX") || exit 2
    trap 'rm -rf --one-file-system "$work"' EXIT
    trap 'exit 130' INT TERM HUP
}

# One release, in namespaces of its own. Returns 0 if it wrote its line, which is then in $line.
in_system() { # RELEASE
    root=$work/$1 line=$work/$1.line
    if ! make_system "$1" "$root"; then
        echo "FAILED $1: debootstrap: $logs/$1.debootstrap.log"
        return 1
    fi
    unshare --mount --propagation private --pid --fork --kill-child "--mount-proc=$root/proc" \
        sh "$0" --inside "$1" "$root" "$line"
    code=$?
    rm -rf --one-file-system "$root"
    [ "$code" -ne 77 ] || exit 77
    [ "$code" -eq 0 ] && [ -s "$line" ]
}
