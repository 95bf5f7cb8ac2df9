#!/bin/sh
# The suites that run what a mutation can change, a line each: NAME COMMAND...
#   sh tests/mutation/suites.sh BUILD
# Those of `make check` but what plays bugs itself, looks at the source alone, or measures times.
set -u
build=$1
logs='"$logs"'
raydiff=$build/raydiff
for test in "$build"/tests/test_*; do
    case $test in *.d) continue ;; esac
    echo "$(basename "$test") $test"
done
sed -n '/^plain)/,/;;/p' tests/run.sh | sed -e ':more' -e '/\\$/{N;s/\\\n *//;b more' -e '}' | sed -nE 's/^    (suite|waits|pairs|alone) //p' |
    grep -vE '^(rules|constants|heap_checked|fields|honest|mutants|mutate|planted|selftest|fetch|drivers|warnings|libs|links|complete|tables|action|site|deb|image|hardware|fresh|runner|stubs|other|install|library|tutorial|report_browser|web_browser|fences|window|signals|ended|peers|faults|fuzz_screen|fuzz_picture|bench|options|parallel)[ _]' |
    sed "s|\"\\\$build/raydiff\"|$raydiff|g; s|\"\\\$build\"|$build|g; s|\"\\\$build/|\"$build/|g"
