#!/bin/sh
# The README's two commands as the README says them, in a minimal Debian of each release that is supported:
# debootstrap, git and make, a clean clone of what is committed, nothing else. Ubuntu 24.04 is RELEASE=noble.
#   sh .ci/fresh.sh RESULTS [RELEASE...]     (make fresh-check, RELEASE=trixie)
# A line a release: versions, seconds, suites; if all is green it replaces the release's line in RESULTS.
# Logs: build/fresh.
# Exit codes: 0 green; 1 a command fails or what it needs cannot be installed; 2 usage; 4 the README has no
# such commands; 77 it cannot be tried here, with the reason.
set -u
LC_ALL=C.UTF-8
export LC_ALL
check=fresh-check
supported='bookworm trixie noble'
logs=build/fresh
. .ci/systems.sh

# Commands of the code block under "Two commands", without their comments.
commands() {
    sed -n '/^## Two commands/,/^## [^T]/{/^```sh/,/^```$/p}' README.md | sed '/^```/d; s/ *#.*//; /^$/d'
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

# One release: the system is there, with git and make and the clone.
inside() {
    release=$1 root=$2 line=$3 told=''
    enter_system git make || return 1
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
    echo "$release: $(system_name), gcc $(in_root 'gcc -dumpfullversion')," \
        "Embree $(version libembree-dev), glslang $(version glslang-tools)," \
        "Mesa $(version mesa-vulkan-drivers): $told${suites:+: $suites}" >"$line"
}

if [ "${1:-}" = --inside ]; then
    shift
    inside "$@"
    exit
fi
[ $# -gt 0 ] || { echo "usage: sh .ci/fresh.sh RESULTS [RELEASE...]" >&2; exit 2; }
results=$1
shift
[ $# -gt 0 ] || set -- bookworm trixie # Ubuntu's has a source and keys of its own
[ "$(commands | wc -l)" -eq 2 ] || { echo "fresh-check: README.md has no code block of two commands" >&2; exit 4; }
need_systems "$@"
worst=0
for release; do
    if in_system "$release"; then
        cat "$line"
        keep "$release" "$line"
    else
        worst=1
    fi
done
exit $worst
