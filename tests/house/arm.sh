#!/bin/sh
# The program and all suites of unit tests compiled for aarch64; the suites run under qemu-user, since numbers
# must be the same on another processor. A line a suite; then those left out, and why; last the sum.
#   sh tests/house/arm.sh FOLDER [SUITE...]    (in a system of its own: make arm-check)
#   sh tests/house/arm.sh --packages           Debian's names of what it needs
# Exit codes: 0 all pass; 1 a warning, or a suite fails; 2 usage; 77 what it needs is not here.
set -u
compiler=aarch64-linux-gnu-gcc
libraries='libc6-dev libgomp1 libjansson-dev libpng-dev zlib1g-dev libvulkan-dev libembree-dev libcmocka-dev libgmp-dev'
packages="gcc libc6-dev gcc-aarch64-linux-gnu qemu-user pkg-config glslang-tools $(printf '%s:arm64 ' $libraries)"
if [ "${1:-}" = --packages ]; then
    echo $packages
    exit
fi
[ $# -gt 0 ] || { echo "usage: sh tests/house/arm.sh FOLDER [SUITE...]" >&2; exit 2; }
folder=$1
shift
# A suite that takes longer hangs: none of those that run here takes a third of it.
limit=${ARM_LIMIT:-900}

# Why SUITE does not run here, if so.
left_out() {
    case $1 in
    vulkan* | half_gpu | grid_gpu) echo Vulkan ;;
    pipe | fuzz_campaign_deaths | memory) echo 'qemu-user passes no limit of memory on' ;;
    adversaries | fuzz_campaign) echo 'over 3 minutes' ;;
    esac
    # Those that start programs of theirs, which the kernel must know how to emulate.
    [ -n "$known" ] || ! grep -qE 'tests/[a-z]*/(peers|spawned|campaigns|built)\.h|--peer|system\(|spawn|dlopen\(' "$(ls tests/*/"test_$1.c")" ||
        echo 'the kernel starts no programs for aarch64'
}
qemu=$(command -v qemu-aarch64 || command -v qemu-aarch64-static)
export PKG_CONFIG_LIBDIR="${ARM_PKG_CONFIG:-/usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig}"
if [ -z "$qemu" ] || ! command -v $compiler >/dev/null ||
    ! pkg-config --exists jansson libpng zlib vulkan cmocka gmp; then
    echo "SKIP arm-check: dpkg --add-architecture arm64; apt-get install" $packages
    exit 77
fi

made=$(ls tests/*/test_*.c | sed 's|.*/test_\(.*\)\.c|\1|')
for suite; do
    echo "$made" | grep -qx -- "$suite" || { echo "arm-check: there is no suite '$suite'" >&2; exit 2; }
done
[ $# -gt 0 ] || set -- $made
start=$(date +%s)
make -s -j"$(nproc)" "OUT=$folder" CC=$compiler WERROR=1 "$folder/raydiff" \
    $(printf "$folder/samples/%s " tracer tracer_bug1 tracer_bug2 refuser) $(echo "$made" | sed "s|^|$folder/tests/test_|") || {
    echo "FAILED aarch64: it does not build without a warning"
    exit 1
}
built=$(($(date +%s) - start))
known=$("$folder/raydiff" --version 2>/dev/null)

[ -n "$known" ] || emulator=$qemu
passed=0 failed=0 skipped=0 left=0 reasons=''
start=$(date +%s)
for suite; do
    why=$(left_out "$suite")
    if [ -n "$why" ]; then
        left=$((left + 1)) reasons="$reasons$why:$suite
"
        continue
    fi
    begun=$(date +%s)
    timeout -k 5 "$limit" ${emulator:-} "$folder/tests/test_$suite" >"$folder/$suite.log" 2>&1
    code=$?
    # A suite whose tests were all skipped shows nothing.
    [ "$code" -ne 0 ] || ! grep -q '^\[  PASSED  \] 0 test' "$folder/$suite.log" || code=77
    case $code in
    0) passed=$((passed + 1)) word=passed ;;
    77) skipped=$((skipped + 1)) word=skipped ;;
    *) failed=$((failed + 1)) word=FAILED ;;
    esac
    inner=$(grep -c '^\[  SKIPPED \] [a-z_0-9]*$' "$folder/$suite.log")
    printf '%-8s %-24s %3d s%s\n' $word "$suite" $(($(date +%s) - begun)) \
        "$([ "$inner" -eq 0 ] || echo "  ($inner inside skipped)")"
    case $word in
    FAILED)
        echo "--- exit code $code; last lines of $folder/$suite.log"
        tail -n 20 "$folder/$suite.log"
        echo "---"
        ;;
    *) grep -h '^SKIP' "$folder/$suite.log" | sort | uniq -c | sed 's/^ */    /' | head -n 3 ;;
    esac
done
printf '%s' "$reasons" | cut -d: -f1 | sort -u | while read -r why; do
    echo "left out, $why:" $(printf '%s' "$reasons" | sed -n "s/^$why://p")
done
echo "gcc $($compiler -dumpfullversion), $("$qemu" --version | sed -n 's/.*version \([0-9.]*[0-9]\).*/qemu \1/p'):" \
    "build without a warning $built s, suites $(($(date +%s) - start)) s:" \
    "$passed passed, $failed failed, $skipped skipped, $left left out"
[ "$failed" -eq 0 ]
