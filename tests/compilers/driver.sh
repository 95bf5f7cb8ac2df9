# Sourced by scripts that need a Vulkan driver, with $name and $raydiff: what is missing is what the program says it is.
. tests/scripts/expect.sh
"$raydiff" check soup:n=9 --count 9 --engine vulkan >"$dir/out" 2>&1
missing=$(grep -m 1 -oE 'vulkan: no (loader|device).*' "$dir/out")
[ -z "$missing" ] || { echo "SKIP $name: $missing"; exit 77; }
