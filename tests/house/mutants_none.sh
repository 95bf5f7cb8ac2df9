#!/bin/sh
# The shipped program holds none of the planted bugs of fuzz/selftest.txt, and each of them is in its
# unit and nowhere else:
#   - what was compiled is, byte for byte, what a number that is no bug's gives
#   - with a bug's number the unit has another text, the shader other code, so a misspelt name cannot pass for a bug
#   - the oracle and the judge know none of the names
#   sh tests/house/mutants_none.sh BUILD
set -u
build=$1
failed=0
none=999999
work=$(mktemp -d) || exit 4
trap 'rm -rf "$work"' EXIT
fault() {
    echo "$1"
    failed=1
}
cc=$(cat "$build/gen/flags")
spirv="glslangValidator --quiet -V --target-env vulkan1.1 -g0 -I. -Ishaders"

grep -n MUTANT "$build/gen/flags" && fault "the flags of the build plant a bug"
awk '$1 == "#define" && $2 ~ /^MUTANT_/ && NF > 2 && $3 < 1 {print; bad = 1} END {exit bad}' ref/base/mutant.h ||
    fault "ref/base/mutant.h: a bug without a number is in every program"
awk '$1 == "#define" && $2 ~ /^MUTANT_/ {print $2}' ref/base/mutant.h | sort >"$work/defined"
for name in $(git ls-files 'ref/*' 'gpu/*' 'fuzz/*' 'cmd/*' 'shaders/*' | xargs grep -ohE '\bMUTANT_[A-Z0-9_]+' | sort -u); do
    grep -qx "$name" "$work/defined" || [ "$name" = MUTANT_H ] || [ "$name" = MUTANT_BUG ] ||
        fault "$name has no number: it would be in every program"
done

awk '!/^#/ && NF {print $1, $2}' fuzz/selftest.txt >"$work/table"
for unit in $(awk '{print $2}' "$work/table" | sort -u); do
    case $unit in
    *.c)
        eval "$cc -DMUTANT=$none -c -o '$work/unit.o' '$unit'" || fault "$unit does not compile"
        cmp -s "$work/unit.o" "$build/obj/${unit%.c}.o" ||
            fault "$unit: the shipped object is not the one without a bug"
        eval "$cc -E -P -o '$work/healthy' '$unit'" || fault "$unit"
        ;;
    *)
        $spirv -DMUTANT=$none -o "$work/healthy" "shaders/$unit.comp" ||
            fault "$unit does not compile"
        cmp -s "$work/healthy" "$build/spv/raw/$unit.spv" ||
            fault "$unit: the shipped shader is not the one without a bug"
        ;;
    esac
    for bug in $(awk -v unit="$unit" '$2 == unit {print $1}' "$work/table"); do
        case $unit in
        *.c) eval "$cc -E -P -DMUTANT=MUTANT_$bug -o '$work/mutant' '$unit'" || fault "$unit" ;;
        *)
            [ "$bug" = NO_PRECISE ] && continue # is in the tool that decorates the shader
            $spirv "-DMUTANT=MUTANT_$bug" -o "$work/mutant" "shaders/$unit.comp" || fault "$unit"
            ;;
        esac
        cmp -s "$work/healthy" "$work/mutant" && fault "$bug changes nothing in $unit"
    done
done
while read -r bug unit; do
    grep -lw "MUTANT_$bug" ref/oracle/* ref/judge/* fuzz/play/verdicts.c && fault "$bug is in who judges"
done <"$work/table"

[ "$failed" -eq 0 ] && echo "no planted bug is in the program, and $(wc -l <"$work/table") are where the table says"
exit "$failed"
