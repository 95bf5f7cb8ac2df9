#!/bin/sh
# System calls of campaigns, merges, shrinkings, checks and reports fail, one at a time
# (tests/faults/faults_main.c). Without more arguments a sample: of each call in each process every 30th, in each
# of its ways, and little of the reports that take longest.
#   sh tests/scripts/faults.sh PROGRAM [COMMAND | OPTION...]     COMMAND: of the sample only these; -s 1: all of them
set -u
program=$1
shift
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
${CC:-cc} -std=c17 -O2 -Wall -Wextra -Wno-format-truncation -I. -o "$dir/faults" tests/faults/*.c || exit 4
case ${1-} in
'') set -- -q -s 30 ;;
[!-]*) set -- -q -s 30 -n "$1" ;;
esac
"$dir/faults" "$@" "$program"
