#!/bin/sh
# .ci/other.sh with systems that are played by scripts, and what runs in them with compilers, an emulator and
# suites that are: what fails is told, and keeps no line.
#   sh tests/house/other.sh
set -u
. tests/house/systems_played.sh
mkdir -p "$dir/repository/.ci" "$dir/repository/tests/house" "$dir/notes" "$dir/work"
cp .ci/other.sh .ci/systems.sh .ci/apt_sources.sh "$dir/repository/.ci"
cp tests/house/arm.sh tests/house/compilers.sh "$dir/repository/tests/house"
commit() { git -C "$dir/repository" -c user.name=a -c user.email=b commit -qam c; }
git -C "$dir/repository" init -q
git -C "$dir/repository" add .
commit
# run CODE WHAT COMMAND...
run() {
    code=$1 what=$2
    shift 2
    rm -f "$dir/notes/typed"
    (cd "$dir/repository" && PATH=$dir/bin NOTES=$dir/notes APT_ROOT=$dir/etc FRESH_DIR=$dir/work "$@") >"$dir/out" 2>&1
    got=$?
    [ "$got" -eq "$code" ] && echo "passed  $what" || bad "$what: exit $got, not $code"
    [ -z "$(ls "$dir/work")" ] || bad "$what: something is left"
}
says() { grep -qE -- "$1" "$dir/out" || bad "no line like /$1/"; }
unset http_proxy https_proxy HTTP_PROXY HTTPS_PROXY WERROR MAKEFLAGS

# --- systems
for name in cut printf; do ln -s "$(command -v $name)" "$dir/bin/$name"; done
run 0 'aarch64' sh .ci/other.sh "$dir/results" aarch64
grep -qx 'sh tests/house/arm.sh build/aarch64' "$dir/notes/typed" || bad 'what is typed'
grep -qx 'aarch64: Debian 12.9: 230 passed, 0 failed, 1 skipped' "$dir/results" || bad 'its line'
grep -q 'dpkg --add-architecture' "$dir/notes/typed" && bad 'packages are no business of the clone'
run 0 'compilers' sh .ci/other.sh "$dir/results" warnings
[ "$(cut -d: -f1 "$dir/results" | tr '\n' ,)" = 'aarch64,warnings bookworm,warnings trixie,' ] || bad 'three lines'
cp "$dir/results" "$dir/before"
sed -n 1p "$dir/notes/typed" >"$dir/notes/fails"
run 1 'a release whose compilers warn' sh .ci/other.sh "$dir/results" warnings
says '^FAILED warnings bookworm: exit code 1'
[ "$(wc -l <"$dir/notes/typed")" -eq 2 ] || bad 'the other release is played all the same'
cmp -s "$dir/before" "$dir/results" || bad 'what fails changes no line'
rm "$dir/notes/fails"
run 2 'nothing of that name' sh .ci/other.sh "$dir/results" sparc
echo 'echo 1000' | tool id
run 77 'without root' sh .ci/other.sh "$dir/results" aarch64
says '^SKIP aarch64-check: only root'
# Planted: whatever a command ends with is green.
echo 'echo 0' | tool id
echo 'sh tests/house/arm.sh build/aarch64' >"$dir/notes/fails"
sed 's/echo $? >"$root/echo 0 >"$root/' .ci/other.sh >"$dir/repository/.ci/other.sh"
(run 1 planted sh .ci/other.sh "$dir/results" aarch64) | grep -q '^FAILED' || bad 'planted: a failure that is green is not seen'
rm "$dir/notes/fails"

# --- compilers: gcc 14 has a name with a number, clang 19 has not
for name in nproc find uniq timeout make ls; do ln -s "$(command -v $name)" "$dir/bin/$name"; done
compiler() { # COMMAND VERSION
    tool "$1" <<END
case \$1 in
-dumpversion) echo $2 ;;
-dumpfullversion) echo $2.1 ;;
--version) echo "$1 (played) $2.0.1" ;;
*) [ ! -e "\$NOTES/warns" ] || echo "x.c:3: warning: planted" >&2
   [ ! -e "\$NOTES/stops" ] || exit 1
   : >"\$1" ;;
esac
END
}
compiler gcc-14 14
compiler clang 19
cat >"$dir/repository/Makefile" <<'END'
all:
	@mkdir -p $(OUT) && $(CC) $(OUT)/x.o
tests: ;
END
run 0 'two compilers without a warning' sh tests/house/compilers.sh out gcc-14 clang-19
says '^gcc 14.0.1 no warning in 1 objects, [0-9]+ s; clang 19.0.1 no warning in 1 objects'
run 77 'a compiler that is not there' sh tests/house/compilers.sh out gcc-14 gcc-12
says '^gcc-12: not here$'
: >"$dir/notes/warns"
run 1 'a warning' sh tests/house/compilers.sh out gcc-14
says '^FAILED gcc-14 14.0.1: 1 warnings'
mv "$dir/notes/warns" "$dir/notes/stops"
run 1 'a compiler that stops' sh tests/house/compilers.sh out clang-19
rm "$dir/notes/stops"
run 2 'no compiler' sh tests/house/compilers.sh out
run 2 'a compiler without a version' sh tests/house/compilers.sh out gcc

# --- aarch64: a suite is a script
compiler aarch64-linux-gnu-gcc 14
echo 'exit 0' | tool pkg-config
echo '[ "$1" = --version ] && echo "qemu-aarch64 version 10.0.7 (played)" || exec sh "$@"' | tool qemu-aarch64
mkdir "$dir/repository/tests/room"
for name in one two vulkan_three; do : >"$dir/repository/tests/room/test_$name.c"; done
cat >"$dir/repository/Makefile" <<'END'
$(OUT)/raydiff: ; @mkdir -p $(OUT)
$(OUT)/samples/%: ; @:
$(OUT)/tests/%: tests/room/%.c
	@mkdir -p $(OUT)/tests
	@cp $< $@
END
suite() { cat >"$dir/repository/tests/room/test_$1.c"; }
echo "echo '[  PASSED  ] 3 test(s).'" | suite one
echo "echo '[  PASSED  ] 0 test(s).'; echo '[  SKIPPED ] a_test'" | suite two
echo 'exit 1' | suite vulkan_three
run 0 'suites' sh tests/house/arm.sh out
says '^gcc 14.1, qemu 10.0.7: build without a warning [0-9]+ s, suites [0-9]+ s: 1 passed, 0 failed, 1 skipped, 1 left out$'
says '^left out, Vulkan: vulkan_three$'
says '^skipped  two .*1 inside skipped'
echo 'echo because; exit 1' | suite one
run 1 'a suite that fails' sh tests/house/arm.sh out
says '^FAILED   one'
says '^because$'
echo 'while :; do :; done' | suite one
ARM_LIMIT=1 run 1 'a suite that hangs' sh tests/house/arm.sh out one
run 2 'a suite that there is not' sh tests/house/arm.sh out four
rm "$dir/bin/qemu-aarch64"
run 77 'without an emulator' sh tests/house/arm.sh out
says '^SKIP arm-check: dpkg --add-architecture arm64'
echo "other: $failed failed"
[ "$failed" -eq 0 ]
