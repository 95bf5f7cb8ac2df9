#!/bin/sh
# All that a graphics card is asked for on the day that there is one, in one folder and under ten minutes:
#   sh bench/hardware.sh RAYDIFF FOLDER [DRIVER [SECONDS]]
# DRIVER as raydiff takes it [hardware]; SECONDS that all of it may take [560]. FOLDER must be new or empty; it gets a
# log of each step, what the step writes, and summary.txt: step, exit code, seconds, last line.
# Exit codes: 0 all steps agree; 1 a step found a mismatch; 2 usage; 3 a step crashed, hung or ran out of time; 77 there
# is no such device. Steps run to the end whatever the others found.
set -u
[ $# -ge 2 ] && [ $# -le 4 ] || { echo "usage: sh bench/hardware.sh RAYDIFF FOLDER [DRIVER [SECONDS]]" >&2; exit 2; }
raydiff=$1 out=$2 driver=${3:-hardware} most=${4:-560}
case $most in '' | *[!0-9]*) echo "hardware: '$most' is no number of seconds" >&2; exit 2 ;; esac
mkdir -p "$out" || exit 2
[ -z "$(ls -A "$out")" ] || { echo "hardware: $out is not empty" >&2; exit 2; }
begin=$(date +%s)
worst=0
# 3 is worse than 1, and 1 than 0.
worse() { [ "$1" -le "$worst" ] || worst=$1; }

# name, hundredths of the time, command
step() {
    name=$1 share=$2
    shift 2
    left=$((most - ($(date +%s) - begin)))
    limit=$((most * share / 100))
    [ "$limit" -lt "$left" ] || limit=$left
    if [ "$limit" -lt 1 ]; then
        echo "no time is left" >"$out/$name.log"
        code=124 took=0
    else
        started=$(date +%s)
        timeout -k 5 "$limit" "$@" >"$out/$name.log" 2>&1
        code=$?
        took=$(($(date +%s) - started))
    fi
    case $code in
    0 | 77) ;;
    1) worse 1 ;;
    *) worse 3 ;;
    esac
    printf '%-10s exit %-3d %4d s  %s\n' "$name" "$code" "$took" "$(grep . "$out/$name.log" | tail -n 1 | cut -c1-100)" |
        tee -a "$out/summary.txt"
}

if ! "$raydiff" check sphere:n=4 --engine vulkan --layout f32 --driver "$driver" --count 100 --repeat 1 >"$out/device.log" 2>&1; then
    grep -m 1 -E 'skipped|failed|no device' "$out/device.log" | tee "$out/summary.txt"
    echo "hardware: no device matches driver '$driver'"
    exit 77
fi
vulkan=vulkan,vulkan_brute,vulkan_stackless
"$raydiff" check sphere:n=4 --engine rayquery --driver "$driver" --count 100 --repeat 1 >"$out/rayquery.log" 2>&1 && vulkan=$vulkan,rayquery
echo "engines    $vulkan" | tee -a "$out/summary.txt"

step doctor 5 "$raydiff" doctor --driver "$driver" --json "$out/doctor.json"
step check 12 "$raydiff" check sphere terrain:k=5 soup:n=2000 --engine "cpu,$vulkan" --layout 'f32,rf16,half4,cwbvh80,tiny8,bvh8_*' --driver "$driver" --count 20000 \
    --wide --json "$out/check.json"
step conform 20 "$raydiff" conform --engine "cpu,$vulkan" --driver "$driver" --count 200 --junit "$out/conform.xml"
step hard 15 "$raydiff" conform --hard --quick --engine "cpu,$vulkan" --driver "$driver" --junit "$out/hard.xml"
step leaks 8 "$raydiff" leaks sphere:n=40 --engine "cpu,$vulkan" --layout f32,rf16,cwbvh80 --tri mt,woop --box watertight \
    --driver "$driver" --count 100000 --json "$out/leaks.json"
step fuzz 16 "$raydiff" fuzz --time $((most * 14 / 100)) --engine "$vulkan" --driver "$driver" --dir "$out/findings" --json "$out/fuzz.json"
step layouts 12 "$raydiff" bench layouts --driver "$driver" --rounds 5 --csv "$out/layouts.csv"
step matrix 20 "$raydiff" bench matrix --engine vulkan --driver "$driver" --rounds 5 --csv "$out/matrix.csv"
echo "took       $(($(date +%s) - begin)) s" | tee -a "$out/summary.txt"
exit "$worst"
