#!/bin/sh
# Runs the suites of a build, as many at a time as there are processors, and sums up:
#   sh tests/run.sh BUILD [sanitize|tsan|validate|watch]
# A line per suite; the log of a failing one is printed. Ends with "N passed, N failed, N skipped",
# counted in suites; what a suite skipped is listed with its reason.
set -u
build=$1
mode=${2:-plain}
logs=$build/check
mkdir -p "$logs"
rm -f "$logs"/*.word
: >"$logs/queue"
: >"$logs/alone"

# name, command...: a suite, which passes with 0 and is skipped with 77. It runs beside others.
queue=$logs/queue
suite() {
    for word in "$@"; do
        printf "'%s' " "$word"
    done >>"$queue"
    echo >>"$queue"
}
# So, too, but when nothing else runs: it measures times, or takes every processor itself.
alone() {
    queue=$logs/alone
    suite "$@"
    queue=$logs/queue
}
# file, how many at a time
play() {
    xargs -r -d '\n' -P "$2" -n 1 sh tests/run_suite.sh "$logs" <"$1"
}

# ThreadSanitizer sees OpenMP's synchronisation only through Archer; without it every loop would be
# reported, so its absence is an error. A planted race shows that it looks.
if [ "$mode" = tsan ]; then
    archer=$(clang -print-resource-dir)/../../libarcher.so
    [ -r "$archer" ] || { echo "libarcher.so is missing (libomp-dev)" >&2; exit 2; }
    export OMP_TOOL_LIBRARIES="$archer"
    export TSAN_OPTIONS="ignore_noninstrumented_modules=1 suppressions=$(pwd)/tests/tsan.supp"
    suite tsan_sees_a_race sh tests/race.sh "$logs"
fi
# Leaks inside drivers are not ours; ours are.
[ "$mode" = sanitize ] && export LSAN_OPTIONS="suppressions=$(pwd)/tests/lsan.supp"

# What takes long begins first.
case $mode in
plain)
    suite conform_hard "$build/raydiff" conform --hard --quick --junit "$logs/hard.xml"
    suite rules_planted sh tests/rules_planted.sh
    suite agree sh tests/agree.sh "$build" quick "$logs/agree"
    suite conform "$build/raydiff" conform --junit "$logs/conform.xml"
    suite rules sh tests/rules.sh
    suite constants sh tests/constants.sh
    suite constants_planted sh tests/constants_planted.sh
    suite honest_planted sh tests/honest_planted.sh
    suite leaks sh tests/leaks.sh "$build" "$logs/leaks" 10000 f32,rf16
    suite corpus "$build/raydiff" replay --brief --as-expected fuzz/corpus/*.trial
    suite fire sh tests/fire.sh "$build"
    suite cli sh tests/cli.sh "$build/raydiff"
    suite shipped sh tests/shipped.sh "$build/raydiff"
    suite hard_lists sh tests/hard_lists.sh "$build/raydiff"
    suite options sh tests/options.sh "$build/raydiff"
    suite named sh tests/named.sh "$build/raydiff"
    suite losers sh tests/losers.sh "$build/raydiff"
    suite named_others sh tests/named_others.sh "$build/raydiff"
    suite watertight sh tests/watertight.sh "$build/raydiff"
    alone bench sh tests/bench.sh "$build/raydiff"
    suite diff sh tests/diff.sh "$build"
    alone window sh tests/window.sh "$build"
    suite construct sh tests/construct.sh "$build/raydiff"
    suite render sh tests/render.sh "$build/raydiff"
    suite tree_files sh tests/tree_files.sh "$build/raydiff"
    alone frames sh tests/frames.sh "$build"
    suite show sh tests/show.sh "$build/raydiff"
    suite five_commands sh tests/five_commands.sh "$build/raydiff"
    suite ci_outputs sh tests/ci_outputs.sh "$build/raydiff"
    suite report sh tests/report.sh "$build/raydiff"
    suite report_browser sh tests/report_browser.sh "$build/raydiff" quick
    alone fuzz sh tests/fuzz.sh "$build"
    suite folders sh tests/folders.sh "$build/raydiff"
    suite standard_files sh tests/standard_files.sh "$build/raydiff"
    alone signals sh tests/signals.sh "$build/raydiff"
    alone ended sh tests/ended.sh "$build/raydiff"
    alone peers sh tests/peers.sh "$build/raydiff"
    suite faults sh tests/faults.sh "$build/raydiff"
    suite fetch sh tests/fetch.sh
    suite drivers sh tests/drivers.sh
    suite warnings sh tests/warnings.sh
    suite libs sh tests/libs.sh
    suite fresh sh tests/fresh.sh
    suite runner sh tests/runner.sh
    suite other sh tests/other.sh
    alone mutants make -s mutants
    suite mutants_none sh tests/mutants_none.sh "$build"
    alone selftest make -s selftest-quick
    suite install sh tests/install.sh
    suite tutorial sh tests/tutorial.sh "$build"
    suite plugin sh tests/plugin.sh "$build"
    suite plugin_findings sh tests/plugin_findings.sh "$build/raydiff"
    ;;
sanitize)
    suite corpus "$build/raydiff" replay --brief --as-expected fuzz/corpus/*.trial
    suite fire sh tests/fire.sh "$build"
    suite conform "$build/raydiff" conform --count 200
    suite conform_hard "$build/raydiff" conform 'hard.*.cpu.*.median.watertight.*'
    suite cli sh tests/cli.sh "$build/raydiff"
    suite watertight sh tests/watertight.sh "$build/raydiff"
    suite diff sh tests/diff.sh "$build"
    suite frames sh tests/frames.sh "$build"
    suite window sh tests/window.sh "$build"
    suite five_commands sh tests/five_commands.sh "$build/raydiff"
    suite ci_outputs sh tests/ci_outputs.sh "$build/raydiff"
    suite report sh tests/report.sh "$build/raydiff"
    suite fuzz sh tests/fuzz.sh "$build"
    suite folders sh tests/folders.sh "$build/raydiff"
    ;;
validate)
    suite conform "$build/raydiff" conform --engine vulkan,vulkan_brute --count 128
    suite conform_hard "$build/raydiff" conform 'hard.*.vulkan.*.median.watertight.*'
    ;;
watch)
    suite conform "$build/raydiff" conform '*.vulkan.*.terrain.*' --count 64
    suite rayquery "$build/raydiff" check sphere --engine rayquery --driver mesa25 --count 2000 --repeat 1
    ;;
tsan)
    suite conform_cpu "$build/raydiff" conform "*.cpu.*.median.robust.*" --count 100
    suite conform_embree "$build/raydiff" conform "*.embree*" --count 100
    ;;
esac

for test in "$build"/tests/test_*; do
    case $test in *.d) continue ;; esac
    name=$(basename "$test")
    if [ "$mode" = tsan ]; then
        # Threads of drivers and of Embree are not ours to judge: CPU suites only.
        case $name in test_abi | test_bad_input | test_half_gpu | test_vulkan* | test_spirv) continue ;; esac
    fi
    if [ "$mode" = watch ]; then # what runs shaders
        case $name in test_abi | test_half_gpu | test_vulkan*) ;; *) continue ;; esac
    fi
    case $name in
    test_pipe | test_guardian | test_fuzz_shrink_apart) alone "$name" "$test" ;;
    *) suite "$name" "$test" ;;
    esac
done

# Beside each other they share processors: who waits for another thread sleeps.
jobs=$(env -u OMP_NUM_THREADS nproc 2>/dev/null || echo 2)
OMP_WAIT_POLICY=${OMP_WAIT_POLICY-passive} play "$logs/queue" "$jobs"
play "$logs/alone" 1

count() { cat "$logs"/*.word 2>/dev/null | grep -c "^$1$"; }
failed=$(count FAILED)
untold=$(($(cat "$logs/queue" "$logs/alone" | wc -l) - $(cat "$logs"/*.word | wc -l)))
[ "$untold" -eq 0 ] || echo "FAILED   $untold suites were not played to their end"
echo "logs: $logs"
echo "$(count passed) passed, $((failed + untold)) failed, $(count skipped) skipped"
[ "$failed" -eq 0 ] && [ "$untold" -eq 0 ]
