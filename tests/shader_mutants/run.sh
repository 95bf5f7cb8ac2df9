#!/bin/sh
# Plays mutants of shaders and prints the scores: sh tests/shader_mutants/run.sh BUILD FOLDER SAMPLE SEED SHADER...
# First on six pipelines of the shader that reach the mutant, survivors on all, then on the shaders' own tests. What
# tests/shader_mutants/equivalent.txt has needs no more than the first.
set -u
build=$1 folder=$2 sample=$3 seed=$4
shift 4
mkdir -p "$folder"
for shader; do
    "$build/shader_mutants" play "$folder" "$shader" "$sample" "$seed" 6
    [ $? -le 1 ] || exit
    [ -e "$folder/$shader.again" ] || "$build/shader_mutants" play "$folder" "$shader" "$sample" "$seed" 0 again
    [ $? -le 1 ] || exit
    touch "$folder/$shader.again"
    sh tests/shader_mutants/own_tests.sh "$build" "$folder" "$shader"
done
files=
for shader; do files="$files $folder/$shader.csv"; done
perl tests/shader_mutants/score.pl tests/shader_mutants/equivalent.txt $files
