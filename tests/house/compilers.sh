#!/bin/sh
# The program and all tests with each of these compilers, without a warning. A line a compiler; last the sum.
#   sh tests/house/compilers.sh FOLDER gcc-12 clang-19...    (in systems that have them: make warnings-check)
# NAME-MAJOR is a command of that name, or NAME itself where it has that version. Exit codes: 0 no warning;
# 1 a warning, or it does not build; 2 usage; 77 a compiler is not here.
set -u
usage() {
    echo "usage: sh tests/house/compilers.sh FOLDER gcc-MAJOR|clang-MAJOR..." >&2
    exit 2
}
[ $# -gt 1 ] || usage
folder=$1
shift
for wanted; do
    case $wanted in gcc-[1-9]* | clang-[1-9]*) ;; *) usage ;; esac
done

# The command for NAME-MAJOR, if there is one.
command_of() {
    for name in "$1" "${1%-*}"; do
        [ "$($name -dumpversion 2>/dev/null | cut -d. -f1)" = "${1#*-}" ] && echo "$name" && return
    done
}
worst=0 absent=0 told=''
for wanted; do
    compiler=$(command_of "$wanted")
    if [ -z "$compiler" ]; then
        echo "$wanted: not here"
        absent=1
        continue
    fi
    mkdir -p "$folder"
    log=$folder/$wanted.log start=$(date +%s)
    make -k -s -j"$(nproc)" "OUT=$folder/$wanted" "CC=$compiler" WERROR=1 all tests >"$log" 2>&1
    code=$?
    warnings=$(grep -cE '(warning|error):' "$log")
    version=$($compiler --version | sed -n '1s/.* \([0-9]*\.[0-9]*\.[0-9]*\).*/\1/p')
    if [ $code -ne 0 ] || [ "$warnings" -ne 0 ]; then
        grep -E '(warning|error|Error)[: ]' "$log" | head -n 20
        echo "FAILED $wanted $version: $warnings warnings, make ends with $code: $log"
        worst=1
        continue
    fi
    objects=$(find "$folder/$wanted" -name '*.o' | wc -l)
    line="${wanted%-*} $version no warning in $objects objects, $(($(date +%s) - start)) s"
    echo "$line"
    told="$told${told:+; }$line"
done
[ $worst -eq 0 ] || exit 1
[ $absent -eq 0 ] || exit 77
echo "$told"
