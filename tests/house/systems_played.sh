#!/bin/sh
# What .ci/systems.sh needs, played by scripts, without root, network and namespaces; tests of what makes
# systems source this. $dir is a folder of theirs, made here; $dir/notes has what was done. A chroot runs
# git clone alone; anything else that is typed in the clone goes to $dir/notes/typed, and ends with 1 if it
# is a line of $dir/notes/fails.
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $1"
    sed 's/^/        /' "$dir/out"
    failed=$((failed + 1))
}
for tool in sh cat cp sed awk grep sort tail head wc tee date env mkdir mktemp mv rm dirname git tr; do
    mkdir -p "$dir/bin"
    ln -s "$(command -v $tool)" "$dir/bin/$tool"
done
tool() { rm -f "$dir/bin/$1"; { echo '#!/bin/sh'; cat; } >"$dir/bin/$1"; chmod +x "$dir/bin/$1"; }
echo 'echo 0' | tool id
echo 'exit 0' | tool mount
echo 'exit 0' | tool true
echo 'echo "Acquire::http::Proxy \"http://secret.example:3128\";"' | tool apt-config
# Its options, then the command.
tool unshare <<'END'
while case ${1:-} in --propagation) shift ;; --*) ;; *) false ;; esac do shift; done
exec "$@"
END
tool debootstrap <<'END'
echo "$*" >>"$NOTES/debootstrap"
while case $1 in --*) ;; *) false ;; esac do shift; done
[ "$1" != trixie ] || [ ! -e "$NOTES/no-trixie" ] || exit 1
mkdir -p "$2/etc/apt" "$2/root" "$2/dev/pts" "$2/dev/shm"
END
# chroot ROOT env -i VARIABLES sh -c COMMAND; what is typed in the clone is noted, with its exit code.
tool chroot <<'END'
for last; do :; done
env | grep -q "^http_proxy=" && exit 9
echo "$*" | grep -q ' http_proxy=http://secret.example:3128 ' || exit 8
case $last in
*'cd /root/raydiff && '*)
    command=${last#*&& }
    [ -d "$1/root/raydiff/.git" ] || exit 7
    echo "$command" >>"$NOTES/typed"
    echo "230 passed, 0 failed, 1 skipped"
    [ ! -e "$NOTES/fails" ] || ! grep -qxF -- "$command" "$NOTES/fails" ;;
*'git clone'*) git clone -q "$1/root/raydiff.git" "$1/root/raydiff" ;;
*dpkg-query*) echo '4:3.14.2+dfsg-1' ;;
*os-release*) echo 'Ubuntu 24.04' ;;
*debian_version*) echo 12.9 ;;
*dumpfullversion*) echo 12.2.0 ;;
esac
END
mkdir "$dir/etc"
printf 'deb http://one.example/debian bookworm main\ndeb http://two.example/security bookworm-security main\n' \
    >"$dir/etc/sources.list"

