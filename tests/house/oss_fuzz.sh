#!/bin/sh
# fuzz/oss-fuzz/build.sh with the variables that OSS-Fuzz sets, on this machine, without its image; then
# each fuzzer plays its own seed corpus as OSS-Fuzz's check_build does: sh tests/house/oss_fuzz.sh FOLDER
set -eu
folder=$1
for tool in clang clang++ zip unzip; do
    command -v $tool >/dev/null || { echo "SKIP: $tool is missing"; exit 77; }
done
mkdir -p "$folder/work" "$folder/out"
folder=$(cd "$folder" && pwd)
sanitize="-fsanitize=address -fsanitize-address-use-after-scope -fsanitize=fuzzer-no-link"
SRC=$(dirname "$(pwd)") WORK=$folder/work OUT=$folder/out CC=clang CXX=clang++ \
    CFLAGS="-O1 -fno-omit-frame-pointer -gline-tables-only $sanitize" \
    CXXFLAGS="-O1 -fno-omit-frame-pointer -gline-tables-only $sanitize" \
    LIB_FUZZING_ENGINE=-fsanitize=fuzzer bash -eu fuzz/oss-fuzz/build.sh
bad=0
for source in tests/readers/entry_*.c; do
    name=$(basename "$source" .c)
    name=${name#entry_}
    seeds=$folder/seeds/$name
    rm -rf "$seeds"
    mkdir -p "$seeds"
    unzip -qo "$folder/out/${name}_seed_corpus.zip" -d "$seeds"
    if "$folder/out/$name" -runs=0 "$seeds" >"$folder/$name.log" 2>&1; then
        echo "$name: $(ls "$seeds" | wc -l) seeds, $(grep -c . "$folder/out/$name.dict") words"
    else
        echo "$name: FAILED, see $folder/$name.log"
        bad=1
    fi
done
exit $bad
