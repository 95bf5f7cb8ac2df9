#!/bin/sh
# Runs the suites of a build, as many at a time as there are processors, and sums up:
#   sh tests/run.sh BUILD [seldom|sanitize|tsan|validate|watch]
# seldom: what finds few bugs of the product for its time: the tests of the tests' own tools and of packages, and whole
# streams of trials.
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
: >"$logs/waits"
: >"$logs/pairs"

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
# So, too, but it waits much, or makes and waits for many short processes, and does not mind what slows it down: it runs
# beside as many others as there are processors.
waits() {
    queue=$logs/waits
    suite "$@"
    queue=$logs/queue
}
# So, too, with one other of its kind beside it: it waits for most of its time, for what may not take too long.
pairs() {
    queue=$logs/pairs
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
    suite tsan_sees_a_race sh tests/house/race.sh "$logs"
fi
# Leaks inside drivers are not ours; ours are. What asks for more memory than there can be gets none, as without it.
[ "$mode" = sanitize ] && export LSAN_OPTIONS="suppressions=$(pwd)/tests/lsan.supp" \
    ASAN_OPTIONS="allocator_may_return_null=1:${ASAN_OPTIONS-}"

# Without a graphics card the drivers of cards are not loaded: each start of Vulkan would read them all.
if [ -z "${VK_DRIVER_FILES-}${VK_ICD_FILENAMES-}" ] && ! ls /dev/dri /dev/nvidia0 /dev/kfd /dev/dxg >/dev/null 2>&1; then
    for icd in /usr/share/vulkan/icd.d/lvp_icd*.json; do
        [ ! -r "$icd" ] || export VK_ICD_FILENAMES="$icd" # which tests set, too
    done
fi

# Where python3 is a script that looks for the one to start (pyenv), it takes six times as long to begin: it looks once.
python=$(command -v python3) && [ "$(head -c 2 "$python")" = '#!' ] && python=$(python3 -c 'import sys; print(sys.executable)') &&
    [ -x "$python" ] && mkdir -p "$logs/bin" && printf '#!/bin/sh\nexec "%s" "$@"\n' "$python" >"$logs/bin/python3" &&
    chmod +x "$logs/bin/python3" && export PATH="$(cd "$logs/bin" && pwd):$PATH"

# What takes long begins first.
case $mode in
plain)
    # Those without a stack, and brute force in a shader, are held to the bits of the others by `agree` and `conform`,
    # and play here in `deep`; so does the published box test in a shader, which enters nearly every box.
    suite conform_hard sh tests/conform/conform.sh "$build/raydiff" "$logs/hard.xml" 8000 --hard --quick \
        --engine cpu,fast,brute,embree,embree_robust
    waits golden env JOBS=1 sh tests/golden/golden.sh "$build/raydiff"
    suite agree sh tests/scripts/agree.sh "$build" quick "$logs/agree"
    suite conform sh tests/conform/conform.sh "$build/raydiff" "$logs/conform.xml" 400 --fewest
    suite conform_worlds sh tests/conform/conform.sh "$build/raydiff" "$logs/worlds.xml" 250 --worlds --count 200
    suite rules sh tests/house/rules.sh
    suite constants sh tests/house/constants.sh
    suite honest_planted sh tests/house/honest_planted.sh
    suite leaks sh tests/scripts/leaks.sh "$build" "$logs/leaks" 10000 f32,rf16
    suite corpus sh tests/conform/corpus.sh "$build/raydiff"
    suite readers sh tests/scripts/readers.sh "$build"
    suite cli sh tests/scripts/cli.sh "$build/raydiff"
    suite guest sh tests/guest/guest.sh "$build/raydiff"
    suite recompiled sh tests/compilers/recompiled.sh "$build/raydiff"
    suite ways sh tests/compilers/ways.sh "$build/raydiff"
    suite variants perl tests/accel/variants.pl "$build/raydiff"
    suite bisect sh tests/compilers/bisect.sh "$build/raydiff"
    suite webgpu sh tests/webgpu/webgpu.sh "$build/raydiff"
    suite fences perl tests/webgpu/fences.pl
    suite guest_shader sh tests/guest/shader.sh "$build/raydiff"
    suite values sh tests/values/values.sh "$build/raydiff"
    suite values_bench sh tests/values/values_bench.sh "$build/raydiff" layouts error spawn
    suite values_times sh tests/values/values_bench.sh "$build/raydiff" builders oracle fuzz frames fast worlds matrix tightness traffic together
    suite values_paper sh tests/values/values_paper.sh "$build/raydiff" paper
    suite values_special sh tests/values/values_paper.sh "$build/raydiff" special
    suite values_pictures sh tests/values/values_pictures.sh "$build/raydiff" render paths images engines faults published beside
    suite told sh tests/values/told.sh "$build/raydiff"
    suite values_limits sh tests/values/values_limits.sh "$build/raydiff"
    suite values_show sh tests/values/values_pictures.sh "$build/raydiff" show
    suite values_scenes sh tests/values/values_scenes.sh "$build/raydiff"
    suite values_conform sh tests/values/values_conform.sh "$build/raydiff"
    suite product sh tests/conform/product.sh "$build/raydiff"
    suite values_selftest sh tests/values/values_selftest.sh "$build/raydiff"
    suite values_findings sh tests/values/values_findings.sh "$build/raydiff"
    suite explains sh tests/values/explains.sh "$build/raydiff"
    suite known sh tests/values/known.sh "$build/raydiff"
    suite values_export sh tests/values/values_export.sh "$build/raydiff"
    suite values_reports sh tests/values/values_reports.sh "$build/raydiff"
    suite exits sh tests/values/exits.sh "$build/raydiff" judging
    waits exits_findings sh tests/values/exits.sh "$build/raydiff" findings
    suite exits_files sh tests/values/exits.sh "$build/raydiff" files
    suite exits_mixed sh tests/values/exits.sh "$build/raydiff" mixed
    suite exits_folders sh tests/values/exits.sh "$build/raydiff" folders
    suite several sh tests/values/several.sh "$build/raydiff"
    suite exits_unwritable sh tests/values/exits.sh "$build/raydiff" unwritable
    suite fields sh tests/values/fields.sh
    suite shipped sh tests/scripts/shipped.sh "$build/raydiff"
    suite hard_lists sh tests/scripts/hard_lists.sh "$build/raydiff"
    suite leaks_worlds sh tests/worlds/leaks_worlds.sh "$build/raydiff"
    suite worlds_named sh tests/worlds/conform_worlds.sh "$build/raydiff"
    waits options sh tests/scripts/options.sh "$build/raydiff"
    suite help sh tests/scripts/help.sh "$build/raydiff"
    suite named sh tests/scripts/named.sh "$build/raydiff"
    suite concluded sh tests/values/concluded.sh "$build/raydiff"
    suite losers sh tests/scripts/losers.sh "$build/raydiff"
    suite named_others sh tests/scripts/named_others.sh "$build/raydiff"
    suite embree_opened sh tests/embree/embree_opened.sh "$build/raydiff"
    suite watertight sh tests/scripts/watertight.sh "$build/raydiff"
    alone bench sh tests/scripts/bench.sh "$build/raydiff"
    suite reported sh tests/reported/reported.sh "$build/raydiff"
    suite lists sh tests/reported/lists.sh "$build/raydiff"
    suite lazy sh tests/guest/lazy.sh "$build/raydiff"
    suite bytes sh tests/guest/bytes.sh "$build/raydiff"
    suite traffic_options sh tests/traffic/unused.sh "$build/raydiff"
    suite lives sh tests/life/lives.sh "$build/raydiff"
    alone fair sh tests/bench/fair.sh "$build/raydiff" quick
    suite diff sh tests/scripts/diff.sh "$build"
    suite diffs sh tests/diffs/diffs.sh "$build/raydiff"
    pairs window sh tests/scripts/window.sh "$build"
    suite construct sh tests/scripts/construct.sh "$build/raydiff"
    suite world_files sh tests/worlds/world_files.sh "$build/raydiff"
    suite explain_worlds sh tests/worlds/explain_worlds.sh "$build/raydiff"
    suite check_worlds sh tests/worlds/check_worlds.sh "$build/raydiff"
    suite fuzz_worlds sh tests/worlds/fuzz_worlds.sh "$build/raydiff"
    suite worlds_piped sh tests/worlds/worlds_piped.sh "$build/raydiff" most
    suite render sh tests/scripts/render.sh "$build/raydiff"
    suite orbit sh tests/scenes/orbit.sh "$build/raydiff"
    suite tree_files sh tests/scripts/tree_files.sh "$build/raydiff"
    alone frames sh tests/scripts/frames.sh "$build"
    suite show sh tests/scripts/show.sh "$build/raydiff"
    suite screens sh tests/scripts/screens.sh "$build/raydiff"
    suite explain_html sh tests/scripts/explain_html.sh "$build/raydiff"
    suite pages perl tests/docs/pages.pl "$build" README.md $(ls docs/*.md | grep -vE '/(my-|drivers)')
    suite action sh tests/docs/action.sh
    suite complete sh tests/docs/complete.sh "$build/raydiff"
    suite tables sh tests/docs/tables.sh
    suite wrong_inputs sh tests/docs/wrong_inputs.sh "$build/raydiff"
    suite links perl tests/docs/links.pl README.md CONTRIBUTING.md CHANGELOG.md SECURITY.md docs/*.md
    suite site sh tests/docs/site.sh
    suite schemas sh tests/docs/schemas.sh "$build/raydiff"
    suite ci_outputs sh tests/scripts/ci_outputs.sh "$build/raydiff"
    suite report sh tests/scripts/report.sh "$build/raydiff"
    suite report_browser sh tests/scripts/report_browser.sh "$build/raydiff" quick
    suite web sh tests/web/web.sh "$build/raydiff"
    suite build sh tests/build/build.sh "$build/raydiff"
    suite tree sh tests/trees/tree.sh "$build/raydiff"
    suite driver_trees sh tests/driver_trees/driver_trees.sh "$build/raydiff"
    waits web_browser sh tests/web/browser.sh "$build/raydiff"
    pairs fuzz sh tests/scripts/fuzz.sh "$build"
    pairs fuzz_screen sh tests/docs/fuzz_screen.sh "$build/raydiff"
    suite fuzz_picture sh tests/docs/fuzz_picture.sh "$build/raydiff"
    suite resumed sh tests/fuzz/resumed.sh "$build/raydiff"
    suite every_layout sh tests/fuzz/every_layout.sh "$build/raydiff"
    suite folders sh tests/scripts/folders.sh "$build/raydiff"
    suite standard_files sh tests/scripts/standard_files.sh "$build/raydiff"
    pairs signals sh tests/scripts/signals.sh "$build/raydiff"
    pairs ended sh tests/scripts/ended.sh "$build/raydiff"
    pairs peers sh tests/scripts/peers.sh "$build/raydiff"
    suite faults sh tests/scripts/faults.sh "$build/raydiff" -q -s 90
    suite heap_checked sh tests/house/heap_checked.sh "$logs"
    suite fetch sh tests/house/fetch.sh
    suite drivers sh tests/house/drivers.sh "$build/raydiff"
    suite libs sh tests/house/libs.sh
    suite runner sh tests/house/runner.sh
    suite other sh tests/house/other.sh
    suite image sh tests/house/image.sh
    suite hardware sh tests/house/hardware_steps.sh
    suite install sh tests/house/install.sh
    suite library sh tests/library/abi.sh "$build"
    suite library_python sh tests/library/python.sh "$build"
    waits plugin sh tests/scripts/plugin.sh "$build"
    suite plugin_findings sh tests/scripts/plugin_findings.sh "$build/raydiff"
    ;;
seldom)
    suite pages_my perl tests/docs/pages.pl "$build" docs/drivers.md docs/my-*.md
    suite faults sh tests/scripts/faults.sh "$build/raydiff"
    suite warnings sh tests/house/warnings.sh
    suite fresh sh tests/house/fresh.sh
    waits stubs sh tests/house/stubs.sh "$build"
    suite deb sh tests/house/deb.sh
    suite planted sh tests/planted/selftest.sh "$build"
    suite mutate sh tests/mutation/selftest.sh "$build"
    suite shader_mutants sh tests/shader_mutants/selftest.sh "$build"
    alone selftest make -s selftest-quick
    suite conform_hard_vulkan sh tests/conform/conform.sh "$build/raydiff" "$logs/hard_vulkan.xml" 3000 --hard --quick \
        --engine vulkan --box robust,watertight
    waits golden_drawn sh tests/golden/golden.sh "$build/raydiff" --drawn
    suite values_charts sh tests/values/values_paper.sh "$build/raydiff" charts
    suite tutorial sh tests/house/tutorial.sh "$build"
    ;;
sanitize)
    suite corpus sh tests/conform/corpus.sh "$build/raydiff"
    suite readers sh tests/scripts/readers.sh "$build"
    suite conform "$build/raydiff" conform --count 200
    suite conform_worlds "$build/raydiff" conform --worlds --engine cpu,brute --count 100
    suite conform_hard "$build/raydiff" conform 'hard.*.cpu.*.median.watertight.*'
    suite cli sh tests/scripts/cli.sh "$build/raydiff"
    suite guest sh tests/guest/guest.sh "$build/raydiff"
    suite guest_shader sh tests/guest/shader.sh "$build/raydiff"
    suite watertight sh tests/scripts/watertight.sh "$build/raydiff"
    suite diff sh tests/scripts/diff.sh "$build"
    suite frames sh tests/scripts/frames.sh "$build"
    suite window sh tests/scripts/window.sh "$build"
    suite pages perl tests/docs/pages.pl "$build" docs/quickstart.md
    suite ci_outputs sh tests/scripts/ci_outputs.sh "$build/raydiff"
    suite report sh tests/scripts/report.sh "$build/raydiff"
    suite fuzz sh tests/scripts/fuzz.sh "$build"
    suite folders sh tests/scripts/folders.sh "$build/raydiff"
    suite lives sh tests/life/lives.sh "$build/raydiff"
    suite tree_files sh tests/scripts/tree_files.sh "$build/raydiff"
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

. tests/heap.sh
for test in "$build"/tests/test_*; do
    case $test in *.d) continue ;; esac
    name=$(basename "$test")
    if [ "$mode" = tsan ]; then
        # Threads of drivers and of Embree are not ours to judge: CPU suites only.
        case $name in test_abi | test_bad_input | test_half_gpu | test_vulkan* | test_spirv) continue ;; esac
    fi
    # Those of whole streams of trials, and of false alarms alone.
    case $name:$mode in
    test_fuzz_seed:seldom | test_judge_honest:seldom | test_bounds_slack:seldom) ;;
    *:seldom | test_fuzz_seed:plain | test_judge_honest:plain | test_bounds_slack:plain) continue ;;
    esac
    if [ "$mode" = watch ]; then # what runs shaders
        case $name in test_abi | test_half_gpu | test_vulkan*) ;; *) continue ;; esac
    fi
    checked=
    case $mode in plain | made_up) checked="env $(heap_of "$name")" ;; esac # made_up: tests/house/runner.sh
    case $name in
    test_pipe | test_pipe_later | test_guardian | test_fuzz_shrink_apart) pairs "$name" $checked "$test" ;;
    test_fuzz_campaign_deaths) waits "$name" $checked "$test" ;;
    *) suite "$name" $checked "$test" ;;
    esac
done

# Beside each other they share processors: who waits for another thread sleeps.
jobs=$(env -u OMP_NUM_THREADS nproc 2>/dev/null || echo 2)
OMP_WAIT_POLICY=${OMP_WAIT_POLICY-passive} play "$logs/waits" 1 &
OMP_WAIT_POLICY=${OMP_WAIT_POLICY-passive} play "$logs/queue" "$jobs"
wait
OMP_WAIT_POLICY=${OMP_WAIT_POLICY-passive} play "$logs/pairs" 2
play "$logs/alone" 1

count() { cat "$logs"/*.word 2>/dev/null | grep -c "^$1$"; }
failed=$(count FAILED)
untold=$(($(cat "$logs/queue" "$logs/waits" "$logs/pairs" "$logs/alone" | wc -l) - $(cat "$logs"/*.word | wc -l)))
[ "$untold" -eq 0 ] || echo "FAILED   $untold suites were not played to their end"
echo "logs: $logs"
echo "$(count passed) passed, $((failed + untold)) failed, $(count skipped) skipped"
[ "$failed" -eq 0 ] && [ "$untold" -eq 0 ]
