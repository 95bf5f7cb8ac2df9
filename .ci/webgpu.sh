#!/bin/sh
# Installs Dawn for Node, in which engine webgpu runs WGSL: the npm package of gpu/webgpu/package.json, at the versions
# and with the checksums of the lock file beside it.
#   sh .ci/webgpu.sh DIR
# DIR/node_modules holds the packages, DIR/versions their names, versions and checksums. No script of a package is
# run, nothing is installed into the system. It is there or not, never in part; what is there costs no network.
# Exit codes: 0 it is there; 77 it is not, with the reason; 2 usage.
set -u
LC_ALL=C
export LC_ALL

[ $# -eq 1 ] || { echo "usage: sh .ci/webgpu.sh DIR" >&2; exit 2; }
from=$(dirname "$0")/../gpu/webgpu
mkdir -p "$1" && dir=$(cd "$1" && pwd) || exit 77
skip() { echo "webgpu: skipped: $1"; exit 77; }
same() { cmp -s "$from/package-lock.json" "$dir/package-lock.json"; }

if [ -s "$dir/versions" ] && same; then
    echo "webgpu: Dawn is there"
    exit 0
fi
for tool in node npm; do
    command -v "$tool" >/dev/null || skip "$tool is needed"
done
temp=$(mktemp -d "$dir/.fetch.XXXXXX") || skip "no temporary folder"
trap 'rm -rf "$temp"' EXIT
trap 'exit 130' INT TERM HUP
cp "$from/package.json" "$from/package-lock.json" "$temp" || skip "no package.json"
if ! (cd "$temp" && npm ci --ignore-scripts --no-audit --no-fund) >"$temp/log" 2>&1; then
    why=$(grep -i 'err' "$temp/log" | head -n 1 | cut -c 1-160)
    skip "npm: ${why:-$(tail -n 1 "$temp/log")}"
fi
[ -s "$temp/node_modules/webgpu/index.js" ] || skip "the package has no index.js"
rm -rf "$dir/node_modules" "$dir/versions"
mv "$temp/node_modules" "$dir/node_modules" && cp "$temp/package-lock.json" "$dir" || skip "cannot write $dir"
awk -F '"' '/"node_modules\// {name = substr($2, 14)} /"version":/ && name {version = $4}
    /"integrity":/ && name {print name, version, $4; name = ""}' "$dir/package-lock.json" >"$dir/versions"
awk '{print "webgpu:", $1, $2}' "$dir/versions"
