#!/bin/sh
# Tracers that work only while they may be judged, in races: what is timed is what is judged, it is the same every
# time, and answers that were kept are of no use: sh tests/guest/lazy.sh PATH/raydiff
set -u
. tests/guest/outsiders.sh
strict='-Wall -Wextra -Werror -shared -fPIC -O2'
cc -std=c11 $strict "-I$root" -o honest.so "$root/fuzz/samples/engine/brute_engine.c" || bad 'the template'
for lazy in 1 2 3; do
    cc -std=c11 $strict "-I$root" "-DLAZY=$lazy" "-DHONEST=\"$dir/honest.so\"" -o "lazy$lazy.so" "$root/tests/peers/guest_lazy.c" -ldl ||
        bad "lazy $lazy does not compile"
done
scene='--scene sphere:n=4 --rounds 2'

# Honest ones pass, and so does one whose answers are kept, but not when they are of use.
expect 0 'no answer is WRONG' bench matrix $scene --count 1600 --threads 1 --engine inside:./honest.so
expect 0 'honest.so' bench fast $scene --count 1600 --engine inside:./honest.so
expect 0 'lazy3.so' bench fast $scene --count 16000 --engine inside:./lazy3.so
grep -q 'of use' out && bad 'answers that were kept are of use in a race'
# From the third call on it does nothing: by then it may have been judged.
for bench in fast matrix error; do
    expect 3 'its answer to ray [0-9]* is another one from trace to trace' bench $bench $scene --count 1600 --engine inside:./lazy1.so
done
# Large calls are not judged by small ones.
expect 1 WRONG bench matrix $scene --count 16000 --threads 1 --engine inside:./lazy2.so --csv lazy.csv
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    $at["name"] ~ /lazy/ { seen++; if ($at["lost"] != 0 || $at["judged_wrong"] < 1000) exit 1 }
    END { exit seen != 1 }' lazy.csv || bad 'what is timed is not judged'
expect 1 WRONG bench error $scene --count 16000 --engine inside:./lazy2.so
expect 0 'times; missed hits are counted, not judged' bench fast $scene --count 16000 --engine inside:./lazy2.so --csv lazy.csv
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    $at["engine"] ~ /lazy/ && $at["missed"] > 1000 { seen++ }
    END { exit seen != 4 }' lazy.csv || bad 'what is missed is not counted of what is timed'
[ "$failed" -eq 0 ] && echo 'lazy: none gains'
exit "$failed"
