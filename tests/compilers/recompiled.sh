#!/bin/sh
# Shaders compiled anew, from the command line: what is asked for is in names, tables and JSON; a pass that drops a
# decoration, one that reassociates and one that contracts are found by check and conform; a missing tool is named.
#   sh tests/compilers/recompiled.sh BUILD/raydiff
set -u
raydiff=$1
name=recompiled passes='copy drop reassociate contract fuse text invalid fails'
. tests/compilers/passes.sh
scene='sphere:n=8 --count 600 --repeat 1'

# Every compiler that is here, on engines with and without a tree; bits, decorations, WRONG.
expect 0 . check $scene --engine vulkan,vulkan_stackless,vulkan_brute --compiler raw,opt,size --layout f32,rf16 \
    --json "$dir/all.json"
has opt '^agrees +f32 +vulkan:opt ' '^agrees +rf16 +vulkan_stackless:size ' '^agrees +- +vulkan_brute:opt ' \
    '^compilers, sphere:n=8, driver any' '^opt +vulkan +f32 +[0-9]+ +([0-9]+) of \1 +0 equal +0 ' \
    '^size +vulkan_brute +- +[0-9]+ +([0-9]+) of \1 +0 equal +0 '
# The line of all rows of a compiler and an engine, from its rows.
awk '/^what it means/ { exit } /^compilers, / { rows = 1; next } /^all rows of a compiler/ { rows = 0; sums = 1; next } /^[^a-z]/ { next }
    rows && / of / {
        key = $1 " " $2
        n[key]++; kept[key] += $5; ops[key] += $7; open[key] += $8; equal[key] += $9 == "equal"; wrong[key] += $10
        if (!(key in least) || $11 + 0 < least[key]) least[key] = $11 + 0
        if ($11 + 0 > most[key]) most[key] = $11 + 0
        one = key
    }
    sums && / of / {
        key = $1 " " $2
        seen++
        if ($3 != n[key] || $4 != kept[key] || $6 != ops[key] || $7 != open[key] || $8 != equal[key] || $9 != 0 || $10 != wrong[key] ||
            $12 != sprintf("%.2f-%.2f", least[key], most[key]) || n[key] == 2 && ($11 - (least[key] + most[key]) / 2) ^ 2 > 0.0101 ^ 2) {
            print "FAILED  sums: " $0; exit 1
        }
    }
    END { exit seen != 4 }' "$dir/out" || bad 'a line of all rows is not their sum, or is not there'
[ "$(grep -c '^ *"compiler": ' "$dir/all.json")" -eq 10 ] || bad 'JSON: a compiler a compiled row'
[ "$(grep -c '^ *"lost": 0' "$dir/all.json")" -eq 10 ] || bad 'JSON: something lost'
expect 0 . check $scene --engine vulkan --compiler raw --layout f32
grep -q '^compilers' "$dir/out" && bad 'raw alone has a table of compilers'
expect 0 . check $scene --engine vulkan:opt,vulkan:passes:ccp --layout f32
has 'names of engines' '^agrees +f32 +vulkan:opt ' '^agrees +f32 +vulkan:passes:ccp '
expect 0 . check $scene --engine vulkan,vulkan_brute --compiler opt --layout f32 --query any,all
has queries '^opt +vulkan +f32 +any .*equal' '^opt +vulkan_brute +- +all .*equal'
expect 0 . check crowd:n=6 --count 2000 --repeat 1 --engine vulkan --compiler opt,size --layout f32
has worlds '^agrees +f32 +vulkan:opt '

# When the decorations come.
expect 0 . check $scene --engine vulkan --compiler raw,opt --decorate none --layout f32
has none '^opt:none +vulkan .* free, [0-9]+ +[0-9]+ 0 free +0 ' # of spirv-opt some versions fuse, others do not
expect 0 . check $scene --engine vulkan --compiler "passes:ccp+$dir/fuse" --decorate none --layout f32
has 'what is free may be fused' '^passes:.*/fuse:none +vulkan .* free, [0-9]+ +[1-9][0-9]* [0-9]+ free +0 '
expect 0 . check $scene --engine vulkan --compiler "passes:ccp+$dir/fuse" --layout f32
has 'what is decorated is not fused' '^passes:.*/fuse +vulkan .* ([0-9]+) of \1 +0 equal'
expect 1 . check $scene --engine vulkan --compiler "passes:ccp+$dir/fuse" --decorate final --layout f32
has final '^PRECISE ' '^passes:.*/fuse:final +vulkan .* ([0-9]+) of \1 +1 '

# The planted ones.
expect 0 . check $scene --engine vulkan --layout f32 --compiler "passes:$dir/copy+ccp+$dir/copy"
expect 1 . check $scene --engine vulkan --layout f32 --compiler "passes:ccp+$dir/drop"
has drop '^PRECISE ' 'NoContraction, 0 of open' '^passes:.*/drop +vulkan +f32 +([0-9]+ +|)[0-9]+ of [0-9]+ +0 '
awk '/^passes:.*\/drop +vulkan +f32 / { for (i = 2; i < NF; i++) if ($i == "of" && $(i - 1) == $(i + 1) - 1 && $(i + 1) > 90) one++ }
    END { exit one != 1 }' "$dir/out" || bad 'drop: not one decoration less than there are operations'
expect 1 . check $scene --engine vulkan --layout f32 --compiler "passes:$dir/contract"
has contract '^PRECISE ' '1 of open rounding'
expect 1 . check $scene --engine vulkan --layout f32,rf16 --compiler "passes:$dir/reassociate" --json "$dir/re.json"
# A row, and the line of both: none is equal, and so many bits are other.
has reassociate ' rf16 .* of [0-9]+ +0 +[1-9][0-9]* +0 ' 'vulkan +2 .* of [0-9]+ +0 +0 +[1-9][0-9]* +0 ' "^BITS differ from engine vulkan's: closest.vulkan:passes:" 'against the shaders as built: [1-9]'
grep -q '"against": "vulkan"' "$dir/re.json" || bad 'reassociate: JSON does not say against what'
# Their colours: red if a row fails, not if what is published is wrong as published.
red=$(printf '\033')'\[([01];)?31m' green=$(printf '\033')'\[([01];)?32m'
"$raydiff" check $scene --engine vulkan --layout f32,rf16 --compiler "passes:$dir/reassociate" --color always >"$dir/out" 2>"$dir/err"
has 'a sum of rows that fail' "^${red}passes:.* vulkan +2 "
"$raydiff" check $scene --engine vulkan --layout f32,rtrs_direct --compiler raw,opt --color always >"$dir/out" 2>"$dir/err"
has 'a sum of rows that are as published' "^${green}opt.* vulkan +2 .* of [0-9]+ +0 +2 +0 +[1-9]"
expect 3 . check $scene --engine vulkan --layout f32 --compiler "passes:$dir/invalid"
has invalid 'spirv-val ended with exit code 1'
expect 2 'wrote no SPIR-V module' check $scene --engine vulkan --compiler "passes:$dir/text"
expect 2 'ended with exit code 3: spirv_pass: on purpose' check $scene --engine vulkan --compiler "passes:$dir/fails"
for what in drop contract reassociate; do
    expect 1 . conform 'closest.vulkan*.f32.median.robust.mt.sphere.random.1' --engine vulkan \
        --compiler "passes:$dir/$what"
    has "conform $what" "^FAILED +closest.vulkan:passes:.*/$what.f32"
done
has 'conform reassociate' "not vulkan's bits"
name=closest.vulkan:passes:$dir/drop.f32.median.robust.mt.sphere.random.1
expect 1 . conform "$name"
has 'a whole name' "^FAILED +closest.vulkan:passes:.*/drop.f32"
expect 0 . conform closest.vulkan:opt.rf16.median.robust.mt.sphere.random.1 --verbose
has 'a whole name' 'bits 0 against vulkan$'

# A campaign keeps what a compiler breaks, and the finding is played again.
if "$raydiff" fuzz --compiler "passes:$dir/reassociate" --engine vulkan --layout f32 --trials 40 --corpus none \
    --dir "$dir/found" --jobs 1 >"$dir/out" 2>"$dir/err"; then
    bad 'fuzz: a compiler that reassociates is not found'
fi
finding=$(ls -d "$dir"/found/vulkan=passes* 2>/dev/null | head -n 1)
[ -n "$finding" ] || bad 'fuzz: no folder of a finding'
expect 1 . replay "$finding/smallest.trial" --brief --engine "vulkan:passes:$dir/reassociate"
has replay 'STILL FAILS'
expect 0 . replay "$finding/smallest.trial" --brief --engine vulkan:opt
expect 0 . fuzz --compiler opt --engine vulkan --layout f32 --trials 20 --corpus none --dir "$dir/clean" --jobs 1
expect 0 . fuzz --trials 30 --corpus none --dir "$dir/clean" --jobs 1
has 'a resumed campaign' 'vulkan:opt.f32 answered 30 trials'

expect 0 . bench layouts --scene sphere:n=5 --layout f32,rf16 --count 500 --rounds 2 --compiler opt --csv "$dir/rows.csv"
grep -q '[",]vulkan:opt[",]' "$dir/rows.csv" || bad 'bench: CSV without the compiler'
has bench '^compilers, primary, driver any' '^opt +vulkan +rf16 .* equal +0 +[0-9.]+$'

# What is not used, not known or not here.
expect 2 'needs an engine vulkan' check $scene --engine cpu --compiler opt
expect 2 '--decorate: not used here: it needs --compiler' check $scene --decorate none
expect 2 "--decorate: 'opt:final' has its own" check $scene --compiler opt:final --decorate none
expect 2 'vulkan:opt is named twice' check $scene --compiler opt,size,opt
expect 2 "'fast' is no compiler" check $scene --compiler fast
expect 2 "Unknown flag '--no-such-pass'" check $scene --compiler passes:ccp+no-such-pass
expect 2 'there is no program /no/such' check $scene --engine vulkan --compiler passes:/no/such/pass
printf '#!/bin/sh\nPATH=/nonexistent exec %s "$@"\n' "$(realpath "$raydiff")" >"$dir/bare"
chmod +x "$dir/bare"
whole=$raydiff raydiff=$dir/bare
expect 77 'no program spirv-opt \(Debian package spirv-tools\)' check $scene --compiler opt
expect 77 'no program spirv-cross \(Debian package spirv-cross\)' conform --compiler hlsl
raydiff=$whole

# The translators, where they are.
for compiler in cross:spirv-cross hlsl:spirv-cross shaderc:glslc; do
    if ! command -v ${compiler#*:} >/dev/null || ! command -v spirv-cross >/dev/null; then
        echo "SKIP ${compiler%%:*}: ${compiler#*:} is not installed (Debian package ${compiler#*:})"
        continue
    fi
    expect 0 . check $scene --engine vulkan,vulkan_brute --compiler ${compiler%%:*} --layout f32,rf16 --tri mt,woop \
        --query closest,any
    [ "$(grep -cE "^${compiler%%:*} .* equal +0 " "$dir/out")" -eq 12 ] || bad "${compiler%%:*}: bits differ"
done
exit $((failed > 0))
