#!/bin/sh
# A planted data race that ThreadSanitizer must report, and its repaired form that it must not.
#   sh tests/house/race.sh FOLDER
set -u
dir=$1
cat >"$dir/race.c" <<'C'
#include <stdio.h>
int main(void)
{
    long sum = 0;
#ifdef RACE
#pragma omp parallel for num_threads(4)
#else
#pragma omp parallel for num_threads(4) reduction(+ : sum)
#endif
    for (int i = 0; i < 100000; i++)
        sum += i;
    printf("%ld\n", sum);
    return 0;
}
C
flags='-g -O1 -fsanitize=thread -fopenmp'
clang $flags -DRACE -o "$dir/race" "$dir/race.c" && clang $flags -o "$dir/no_race" "$dir/race.c" || exit 4
"$dir/race" && { echo "the planted race was not seen"; exit 1; }
"$dir/no_race" || { echo "a race was seen where there is none"; exit 1; }
echo "planted race seen"
