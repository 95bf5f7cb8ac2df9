#!/bin/sh
# The whole product of raydiff conform has every combination of members once, and a run takes no longer than it takes.
#   sh tests/conform/product.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh

# All that raydiff list names is there, what is built on a device, too.
"$raydiff" conform --all --list --engine cpu | sort >"$dir/all"
uniq -d "$dir/all" | grep . && bad 'conform --all: a name stands twice'
product=2 # closest and any
for field in 4:builders 5:box 6:triangle 7:scenes 8:ray; do
    named=$("$raydiff" list "${field#*:}" | sed -n 's/^  \([a-z][a-z0-9_]*\) .*/\1/p' | sort)
    cut -d . -f "${field%:*}" "$dir/all" | sort -u >"$dir/names"
    [ "${field%:*}" -gt 6 ] || product=$((product * $(wc -l <"$dir/names")))
    [ "$named" = "$(cat "$dir/names")" ] || bad "conform --all: other ${field#*:} than raydiff list names"
done
product=$((product * $(cut -d . -f 3 "$dir/all" | sort -u | wc -l)))
[ "$(wc -l <"$dir/all")" -eq $product ] || bad "conform --all: not all of $product combinations"
cut -d . -f 1-6 "$dir/all" | sort -u | wc -l | grep -qx $product || bad 'conform --all: a combination stands twice'

# What a way to be told of it has no use for is refused with its name.
: >"$dir/waivers"
unused() { # way, who does not use it, options with what they take
    way=$1 who=$2
    shift 2
    for option; do
        expect 2 "^raydiff conform: ${option%% *}: not used by $who" conform $way $option
    done
}
unused --tap '--tap, which has a line per trial' --verbose '--summary --hard' --wide '--color always'
unused --list --list '--count 9' '--brute 0' '--require cpu' "--waivers $dir/waivers" --verbose --tap "--junit $dir/x" \
    '--threads 1' '--driver stock' '--device 0' '--workgroup 1' --wide '--color always'
unused '--list --hard' --list '--require cpu' '--summary' "--markdown $dir/x" "--html $dir/x"
unused --hard 'the hard cases' '--count 9' '--brute 0' --all '--store compact' '--displacement 9'
unused 'closest.*' 'a PATTERN' --all --worlds

# Its cases together take no longer than all of it, and this, in JUnit and as text, no longer than the command.
begun=$(date +%s)
expect 0 . conform 'closest.cpu.f32.median.*.mt.cornell.*.1' --count 200 --junit "$dir/xml"
took=$(($(date +%s) - begun + 1))
told=$(sed -n 's/^[0-9]* trials in \([0-9.]*\) s.*/\1/p' "$dir/out")
awk -v took="$took" -v told="${told:-9999}" '
    /^<testsuite / { sub(/.* time="/, ""); all = $0 + 0 }
    /^<testcase / { sub(/.* time="/, ""); sum += $0; cases++ }
    END { exit !(cases > 9 && all > 0 && all <= took && told <= took && sum > 0 && sum <= 1.01 * all + 0.0005 * NR) }' \
    "$dir/xml" || bad "conform: times of cases, of all of them and of the command, $took s"

echo "product: $failed failed"
[ "$failed" -eq 0 ]
