#!/bin/sh
# Tracers that are shared objects, from the command line: the samples, in C and in C++, agree in both ways;
# a planted bug is found by check and by a campaign, and shrunk; a crash, a hang and endless memory are
# findings, and the campaign goes on; what is wrong with a file is told in one line.
# usage: sh tests/guest/guest.sh PATH/raydiff
set -u
. tests/guest/outsiders.sh

samples=$root/fuzz/samples/engine
strict='-Wall -Wextra -Werror -O2 -shared -fPIC'
cc -std=c11 $strict "-I$root" -o brute.so "$samples/brute_engine.c" || bad 'the template in C'
cc -std=c11 $strict "-I$root" -DBUG=1 -o brute_bug.so "$samples/brute_engine.c" || bad 'its bug'
c++ -std=c++11 $strict "-I$root" -o bvh.so "$samples/bvh_engine.cpp" || bad 'the tracer in C++'
c++ -std=c++11 $strict "-I$root" -DBUG=1 -o bvh_bug.so "$samples/bvh_engine.cpp" || bad 'its bug'
c++ -std=c++11 $strict "-I$root" -DBUG=2 -o bvh_crash.so "$samples/bvh_engine.cpp" || bad 'its crash'
[ "$(wc -l <"$samples/bvh_engine.cpp")" -le 129 ] || bad 'the tracer in C++ is no short one'
cc -O2 -shared -fPIC "-I$root" -o guest.so "$root/tests/peers/guest_bad.c" || bad 'the guest of tests'
cc -O2 -shared -fPIC "-I$root" -DSYMBOL=other -o none.so "$root/tests/peers/guest_bad.c" || bad 'none'
printf '#include "ref/raydiff_engine.h"\n#include "ref/plugin.h"\nint main() { return 0; }\n' >both.cpp
c++ -std=c++11 -Wall -Wextra -Werror "-I$root" -o both both.cpp || bad 'both headers in C++'

# --- they agree, and both ways agree
expect 0 '4 of 4 rows agree, 0 of 4000 answers WRONG' check sphere:n=8 --count 1000 --repeat 1 \
    --engine ./brute.so,inside:./brute.so,bvh.so,inside:bvh.so
expect 0 '4 of 4 rows agree' check needles --query any --count 500 --repeat 1 \
    --engine ./brute.so,inside:./brute.so,./bvh.so,inside:./bvh.so
for way in '' inside:; do # a ray each, with all bits of the answers
    expect 0 'conclusion: the answer is (right|allowed)' explain terrain --rays mixed --index 8 --engine "$way./bvh.so"
    grep -vE '^(engine|again|conclusion)' out | sed 's/inside://g' >"bits_$way"
done
cmp -s bits_ bits_inside: || bad 'the two ways answer alike, to the bit'
expect 0 '50 passed, 0 failed' conform 'closest.*.vertices.1' --engine inside:./bvh.so
expect 0 '1 passed, 0 failed' conform 'closest.inside:./bvh.so.-.-.-.mt.soup.vertices.1'
expect 0 '1 passed, 0 failed' conform 'closest../bvh.so.-.-.-.mt.soup.vertices.1'
expect 0 'inside:bvh.so' bench matrix --scene sphere:n=4 --engine inside:./bvh.so --count 500 --rounds 1
expect 0 'inside:bvh.so +64.0 .* trace of raydiff.s rays' bench fast --scene sphere:n=4 --engine inside:./bvh.so --count 500 --rounds 1
expect 0 'allowed are 4 uM, not 32' check terrain --engine ./bvh.so --count 2000 --repeat 1
expect 0 '0 distinct' fuzz --trials 200 --engine ./bvh.so --corpus none --dir clean

# --- as many as there can be: four of one's own beside all of the program's
own=$("$raydiff" list engines | sed -n 's/^  \([a-z_]*\) .*/\1/p' | paste -sd, -)
for command in 'check --layout f32 --repeat 1' 'conform'; do
    case $command in conform*) subject='closest.*.soup.random.1 --builder median --layout f32,cwbvh80' ;; *) subject=sphere:n=4 ;; esac
    "$raydiff" $command $subject --count 50 --engine "$own,./brute.so,inside:./brute.so,./bvh.so,inside:./bvh.so" >out 2>err
    ! grep -q 'more than' out err && [ "$(grep -cE '^engine (inside:)?\./(brute|bvh)\.so answered ([1-9][0-9]*) of \3$' out)" -eq 4 ] ||
        bad "$command: every engine and four of one's own"
done

# --- a bug is found, and shrunk
expect 1 'WRONG  *-  *./brute_bug.so' check sphere:n=4 --engine ./brute_bug.so --count 500 --repeat 1
expect 1 'new  *bvh_bug.so.-.missed.outside' fuzz --trials 60 --engine ./bvh_bug.so --corpus none --no-shrink --dir found
finding=$(ls found/bvh_bug.so.-.missed.outside/*.trial | head -n 1)
expect 0 . min "$finding" --engine ./bvh_bug.so --out small.trial
grep -q '^triangles 1$' small.trial || bad 'min leaves one triangle'
expect 1 'STILL FAILS' replay --brief small.trial --engine ./bvh_bug.so
expect 1 'answer *a miss' explain small.trial --engine ./bvh_bug.so
grep -q 'WRONG: missed, triangle 0 was to be found' out || bad 'explain says what is missed'
expect 2 'name its file: --engine PATH/FILE.so' replay small.trial
mkdir -p mended && cp bvh.so mended/bvh_bug.so # a name without its folder is the same
expect 0 'does not fail' replay --brief small.trial --engine mended/bvh_bug.so

# --- vertices move, and an object of version 1 does without that
steps='--steps refit:jitter:3,rebuild:mirror,refit:one:5'
c++ -std=c++11 $strict "-I$root" -DBUG=3 -o bvh_stale.so "$samples/bvh_engine.cpp" || bad 'its update that keeps boxes'
mkdir -p old/ref
sed -e '/(\*move)/d' -e '/define RAYDIFF_ENGINE_MOVE/d' -e 's/ENGINE_VERSION 2u/ENGINE_VERSION 1u/' \
    "$root/ref/raydiff_engine.h" >old/ref/raydiff_engine.h
cc -std=c11 $strict -Iold -o brute_old.so "$samples/brute_engine.c" || bad 'a tracer of version 1'
for way in '' inside:; do
    expect 0 '4 of 4 rows agree' check sphere:n=8 $steps --engine "$way./bvh.so" --count 400 --repeat 1
    [ "$(grep -c "engines that updated what they held: $way./bvh.so" out)" -eq 2 ] &&
        [ "$(grep -c 'engines prepared anew' out)" -eq 1 ] || bad "${way}bvh.so updates after refits alone"
    expect 0 '4 of 4 rows agree' check sphere:n=8 $steps --engine "$way./brute_old.so" --count 400 --repeat 1
    [ "$(grep -c "engines prepared anew: $way./brute_old.so" out)" -eq 3 ] || bad "${way}brute_old.so is built anew"
    expect 1 '[1-9][0-9]* of 400 answers WRONG .missed' check sphere:n=8 $steps --engine "$way./bvh_stale.so" \
        --count 400 --repeat 1
    [ "$(grep -c "prepared anew: $way./bvh_stale.so: 0 WRONG in place of [1-9]" out)" -eq 2 ] || bad "${way}bvh_stale.so is stale"
    grep -q 'conclusion: 2 of 4 rows agree' out || bad "${way}bvh_stale.so is right as built, and after a rebuild"
done

# The page of a ray has the cause of the finding, after one step or several, replayed or explained.
expect 1 'new  *bvh_stale.so.-.missed.stale' fuzz --steps --trials 12 --jobs 1 --engine ./bvh_stale.so --corpus none \
    --no-shrink --dir stale
for steps in refit:zero:881 refit:jitter:3,refit:zero:881 refit:jitter:3,rebuild:mirror,refit:zero:881; do
    sed "s/^steps .*/steps $steps/" stale/bvh_stale.so.-.missed.stale/first.trial >steps.trial
    for command in replay explain; do
        expect 1 '^cause *stale: ' $command steps.trial --engine ./bvh_stale.so
    done
done

# --- it dies, and the campaign goes on
for what in crash hang memory; do
    [ $what = crash ] && more= || more='--peer-time 1 --peer-memory 64'
    GUEST=$what expect 1 'guest.so.-.(crash|hang).unexplained  *3 times' fuzz --trials 3 --rays 20 --jobs 1 \
        --engine ./guest.so --corpus none --no-shrink --dir "dies_$what" $more
    grep -q '^trials  *3 ' out || bad "the campaign plays all trials where the guest does: $what"
done
GUEST=crash expect 3 'it was ended by signal 11 before the answer to ray 0' \
    check sphere:n=4 --engine ./guest.so --count 50 --repeat 1
expect 1 'bvh_crash.so.-.crash.unexplained +[0-9]+ times, smallest: 17 triangles' fuzz --trials 20 --jobs 1 \
    --engine ./bvh_crash.so --corpus none --dir no_room # it has room for 16
grep -q '^trials  *20 ' out || bad 'the campaign plays all trials where the tracer in C++ crashes'
expect 3 'it was ended by signal 6' check sphere:n=4 --engine ./bvh_crash.so --count 50 --repeat 1
GUEST=exit expect 1 'inside:guest.so.-.crash' fuzz --trials 2 --rays 20 --jobs 1 --engine inside:./guest.so \
    --corpus none --no-shrink --dir dies_inside

# What answers within --trial-time does not hang, and parts of a second count.
sed '1i #include <unistd.h>
    s/^    (void)reason;$/    (void)reason; usleep(400000);/' "$samples/brute_engine.c" >slow.c
cc -D_GNU_SOURCE -O1 -shared -fPIC "-I$root" -o slow.so slow.c || bad 'a slow tracer'
expect 0 'contestant inside:./slow.so answered 3 trials' fuzz --trials 3 --rays 20 --jobs 1 --engine inside:./slow.so --corpus none \
    --trial-time 0.95 --no-shrink --dir in_time

# --- what is wrong with a file
echo 'no object' >text.so
expect 2 "--engine: ./text.so: cannot be loaded as a shared object" check sphere --engine ./text.so
expect 2 'does not export raydiff_engine' check sphere --engine inside:./none.so
expect 2 'cannot be loaded as a shared object: .*No such file' fuzz --trials 1 --engine ./nothing.so
GUEST=version expect 2 'version 3 of .* compile it with its ref/raydiff_engine.h' check sphere --engine guest.so
GUEST=load_crash expect 3 'crashed while being opened' check sphere --engine guest.so
GUEST=open_refuses expect 77 'refused: no such card' check sphere:n=4 --count 50 --engine guest.so
GUEST=open_refuses expect 77 'refused: no such card' check sphere:n=4 --count 50 --engine inside:guest.so
expect 2 'peer-time: not used here' check sphere --engine inside:./bvh.so --peer-time 3
[ "$failed" -eq 0 ] && echo 'tracers that are shared objects: as they should be'
exit "$failed"
