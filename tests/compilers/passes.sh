# Sourced by scripts of compilers, with $name, $raydiff and the planted passes in $passes: the tools and a driver are here,
# and each pass is a program in $dir.
for tool in spirv-opt spirv-val; do
    command -v $tool >/dev/null || { echo "SKIP $name: $tool is needed (Debian: spirv-tools)"; exit 77; }
done
. tests/compilers/driver.sh
${CC:-cc} -std=c17 -O1 -o "$dir/spirv_pass" tests/compilers/spirv_pass.c || { echo "FAILED  spirv_pass.c"; exit 1; }
for what in $passes; do
    printf '#!/bin/sh\nexec "%s/spirv_pass" %s\n' "$dir" $what >"$dir/$what"
    chmod +x "$dir/$what"
done
