#!/bin/sh
# All shaders in one folder, those of TREE (tests/planted/plant.sh) in the place of ours: what a shader
# includes is looked for beside it first.
#   sh tests/planted/shaders.sh TREE FOLDER
set -eu
cp shaders/*.glsl shaders/*.comp shaders/layouts/*.glsl shaders/probes/*.comp shaders/build/*.comp shaders/build/*.glsl "$2"
[ ! -d "$1/shaders" ] || find "$1/shaders" -type f -exec cp {} "$2" ';'
