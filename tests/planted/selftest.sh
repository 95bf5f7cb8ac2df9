#!/bin/sh
# The planted bugs of fuzz/selftest.txt, before the fuzzer looks for them:
#   - every record finds its place, and every bug has a catcher
#   - with its bug a unit has another text, a shader other code, so that nothing else passes for a bug
#   - none is in the oracle or the judge
#   sh tests/planted/selftest.sh BUILD
set -u
build=$1
failed=0
work=$(mktemp -d) || exit 4
trap 'rm -rf "$work"' EXIT
fault() {
    echo "$1"
    failed=1
}
cc=$(cat "$build/gen/flags")
spirv="glslangValidator --quiet -V --target-env vulkan1.1 -I."

sh tests/planted/plant.sh --check || exit 1
awk '!/^#/ && NF {print $1, $2}' fuzz/selftest.txt >"$work/table"
while read -r bug unit; do
    tree=$work/$bug
    [ -d "$tree" ] || sh tests/planted/plant.sh "$bug" "$tree" || exit 1
    grep -rlq . "$tree/ref/oracle" "$tree/ref/judge" "$tree/fuzz/play/verdicts.c" 2>/dev/null && fault "$bug is in what judges"
    case $unit in
    *.c)
        [ -e "$work/healthy.$(basename "$unit")" ] || eval "$cc -E -P -o '$work/healthy.$(basename "$unit")' '$unit'" || fault "$unit"
        from=$tree/$unit
        [ -e "$from" ] || from=$unit
        eval "$cc -iquote '$tree' -E -P -o '$work/planted' '$from'" || fault "$unit does not compile with $bug"
        cmp -s "$work/healthy.$(basename "$unit")" "$work/planted" && fault "$bug changes nothing in $unit"
        ;;
    *)
        [ -d "$tree/shaders" ] || continue # is in the tool that decorates the shader
        mkdir -p "$tree/flat" && sh tests/planted/shaders.sh "$tree" "$tree/flat"
        $spirv "-I$tree/flat" -o "$work/planted" "$build/gen/$unit.comp" || fault "$unit does not compile with $bug"
        cmp -s "$build/spv/plain/$unit.spv" "$work/planted" && fault "$bug changes nothing in $unit"
        ;;
    esac
done <"$work/table"
[ "$failed" -eq 0 ] && echo "$(wc -l <"$work/table") of them are where fuzz/selftest.txt says"
exit "$failed"
