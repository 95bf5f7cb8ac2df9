#!/bin/sh
# Plays mutants of shaders and prints the scores: sh tests/shader_mutants/run.sh BUILD FOLDER SAMPLE SEED SHADER...
# First on six pipelines of the shader that reach the mutant; survivors on the shaders' own tests, then on all pipelines,
# but those that tests/shader_mutants/equivalent.txt has.
set -u
build=$1 folder=$2 sample=$3 seed=$4
shift 4
mkdir -p "$folder"
left() { # survivors that are not proven to be equivalent
    perl tests/shader_mutants/score.pl tests/shader_mutants/equivalent.txt "$folder/$1.csv" 2>/dev/null |
        sed -n 's/^survived: [^ ]* \([^ ]*\): .*/\1/p'
}
for shader; do
    "$build/shader_mutants" play "$folder" "$shader" "$sample" "$seed" 6
    [ $? -le 1 ] || exit
    sh tests/shader_mutants/own_tests.sh "$build" "$folder" "$shader"
    touch "$folder/$shader.all"
    left "$shader" | grep -vxFf "$folder/$shader.all" >"$folder/$shader.left" 2>/dev/null
    [ ! -s "$folder/$shader.left" ] || "$build/shader_mutants" play "$folder" "$shader" "$sample" "$seed" 0 "$folder/$shader.left"
    [ $? -le 1 ] || exit
    cat "$folder/$shader.left" >>"$folder/$shader.all"
done
files=
for shader; do files="$files $folder/$shader.csv"; done
perl tests/shader_mutants/score.pl tests/shader_mutants/equivalent.txt $files
