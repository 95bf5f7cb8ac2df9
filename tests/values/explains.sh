#!/bin/sh
# The commands that `raydiff check` prints to explain findings: of every kind of fault, of closest, any and all hits, each
# command that is run shows a WRONG answer of the same kind and triangle, and ends with 1.
#   sh tests/values/explains.sh RAYDIFF
set -u
raydiff=$1
. tests/values/compare.sh
shows=0

# The engine is what the commands name: beside the checkout's files it has no path of its own.
engine() { # fault
    cc -std=c17 -O1 -shared -fPIC -I . -DWAY="$1" -o "$dir/way$1.so" tests/peers/wrong_engine.c || bad "way $1 is not compiled"
}
value() { sed -n "s/^$2=//p" "$dir/$1" | head -n 1; }

# A finding of the JSON, by its path: what its command shows.
explained() {
    query=$(value flat "${1%.findings.*}.query") kind=$(value flat "$1.judgement.wrong") line=$(value flat "$1.explain")
    got=$(value flat "$1.got.prim") expected=$(value flat "$1.judgement.expected")
    case $kind in
    not_repeatable) # one run cannot show these
        [ -z "$line" ] || bad "$kind of a list has a command: $line"
        return
        ;;
    esac
    [ -n "$line" ] || { bad "$query $kind: no command"; return; }
    shows=$((shows + 1))
    echo "$query $kind" >>"$dir/kinds"
    eval "\"\$raydiff\" ${line#raydiff } --wide --json \"\$dir/page.json\"" >"$dir/page" 2>&1
    code=$?
    awk -f tests/values/flat.awk "$dir/page.json" >"$dir/page.flat"
    shown=$(sed -n 's/^verdict  *WRONG: \([a-z_]*\).*/\1/p' "$dir/page")
    case $line in
    *' --query all'*) # the list itself, by the same rules
        fault=$expected
        [ "$kind" = missed ] || fault=$got
        [ "$code" -eq 1 ] && [ "$shown" = "$kind" ] && grep -qx "verdict  *WRONG: $kind, triangle $fault" "$dir/page" ||
            bad "all $kind: exit $code, $(grep '^verdict' "$dir/page"): $line"
        return
        ;;
    esac
    [ "$code" -eq 1 ] && [ -n "$shown" ] || { bad "$query $kind: exit $code, $(grep '^verdict' "$dir/page"): $line"; return; }
    # Of a list the nearest hit from there on stands for the one at fault: a triangle that is not hit hides one that is,
    # and behind what is not a number there may be another.
    case $query,$kind,$shown in
    *,"$kind","$kind" | all,phantom,triangle | all,not_finite,missed) ;;
    *) bad "$query $kind: the command shows $shown: $line" ;;
    esac
    truth=$(sed -n 's/^truth  *triangle \([0-9]*\) .*/\1/p' "$dir/page") answer=$(sed -n 's/^answer  *triangle \([0-9]*\) .*/\1/p' "$dir/page")
    case $query in
    all)
        [ -z "$expected" ] || [ "$expected" = null ] || [ "$truth" = "$expected" ] || bad "all $kind: expected $expected, explained $truth: $line"
        [ -z "$got" ] || [ "$shown" = missed ] || [ "$answer" = "$got" ] || bad "all $kind: got $got, explained $answer: $line"
        ;;
    *) [ "$answer" = "$got" ] || bad "$query $kind: got $got, explained '$answer': $line" ;;
    esac
}

# Lost, another triangle, too far, too near, u and v exchanged, not a number, made up.
for way in 1 2 3 4 5 6 7; do
    engine "$way"
    run check soup:n=60,size=0.8 --engine "inside:$dir/way$way.so" --query closest,any,all --count 500 --repeat 1 --brute 0 --json "$dir/json"
    [ "$code" -eq 1 ] || bad "way $way: exit $code"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    for finding in $(sed -n 's/^\(rows\.[0-9]*\.findings\.[0-9]*\)\.ray=.*/\1/p' "$dir/flat"); do explained "$finding"; done
done
# Each kind was met with each query that can show it.
for kind in missed distance barycentric not_finite phantom; do
    for query in closest any all; do grep -qx "$query $kind" "$dir/kinds" || bad "no finding: $query $kind"; done
done
# Without a fault nothing is found.
engine 0
run check soup:n=60,size=0.8 --engine "inside:$dir/way0.so" --query closest,any,all --count 500 --repeat 1 --brute 0
[ "$code" -eq 0 ] || bad "without a fault: exit $code"

# The page of a list by value: of what is lost, listed twice, made up, right, and where no list is wrong.
for way in 0 1 2 3 7; do
    [ -f "$dir/way$way.so" ] || engine "$way"
    compare explain_list "$([ "$way" = 0 ] && echo 1 || echo 20)" explain soup:n=60,size=0.8 --engine "inside:$dir/way$way.so" --query all --count 200 --wide
    compare explain_list 20 explain soup:n=60,size=0.8 --engine "inside:$dir/way$way.so" --query all --count 200 --index 5 --wide
done
compare explain_list 12 explain soup:n=60,size=0.8 --engine cpu --query all --ray '0,0,0 1,0.5,0.25' --wide
all_seen explain_list

echo "explains: $shows commands, $failed failed"
[ "$failed" -eq 0 ] && [ "$shows" -gt 50 ]
