#!/bin/sh
# .ci/drivers.sh without network: apt and dpkg-deb are played by scripts. And where a program looks for what it fetched.
#   sh tests/house/drivers.sh RAYDIFF
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

mkdir "$dir/bin" "$dir/etc" "$dir/etc/sources.list.d"
for tool in sh sha256sum cut mkdir mktemp rm cat tail head grep sed awk sort join find cp mv id dirname; do
    ln -s "$(command -v "$tool")" "$dir/bin/$tool"
done
printf 'ID=debian\nVERSION_CODENAME=bookworm\n' >"$dir/os-release"
sed "s|/etc/os-release|$dir/os-release|" .ci/drivers.sh >"$dir/drivers.sh"
cp .ci/apt_sources.sh "$dir"

# run CODE WHAT: fetches into $dir/to with these tools and expects the exit code.
run() {
    PATH=$dir/bin APT_ROOT=$dir/etc sh "$dir/drivers.sh" "$dir/to" >"$dir/out" 2>&1
    got=$?
    [ "$got" -eq "$1" ] && echo "passed  $2" || bad "$2: exit $got, not $1"
}
says() { grep -q -- "$1" "$dir/out" || bad "no line like /$1/"; }
holds() {
    now=$(cd "$dir/to" && ls -A | grep -v '^apt$' | tr '\n' ' ')
    [ "$now" = "$1" ] || bad "the folder holds '$now', not '$1'"
}
tool() {
    rm -f "$dir/bin/$1"
    cat >"$dir/bin/$1"
    chmod +x "$dir/bin/$1"
}

run 77 'without apt everything is skipped'
says 'skipped: apt-get is needed'
holds ''

# A machine with both forms of entries; the fake apt notes what it is asked.
cat >"$dir/etc/sources.list" <<'END'
# deb http://commented.example/debian bookworm main
deb [arch=amd64 signed-by=/some/key.gpg] http://one.example/debian bookworm main contrib
END
cat >"$dir/etc/sources.list.d/debian.sources" <<'END'
Types: deb deb-src
# a comment
URIs: http://two.example/debian-security
Suites: bookworm-security
Components: main
Signed-By: /other/key.gpg

Types: deb
Enabled: no
URIs: http://off.example/debian
Suites: bookworm
END
tool apt-get <<END
#!/bin/sh
echo "\$*" >>"$dir/asked"
case "\$*" in
*update*) [ ! -e "$dir/offline" ] || { echo "E: cannot reach anything" >&2; exit 100; } ;;
*install*)
    echo 'Inst libdrm2 [1.0] (2.0~bpo Debian Backports:stable-backports [amd64])'
    echo 'Inst unrelated (9 Debian:stable [amd64])'
    echo 'Inst mesa-vulkan-drivers [22] (25.0~bpo Debian Backports:stable-backports [amd64])' ;;
*download*)
    for last; do :; done
    [ ! -e "$dir/broken" ] || case \$last in chromium*) echo "E: 404" >&2; exit 100 ;; esac
    echo "\$last" >"\${last%%=*}.deb" ;;
esac
END
tool apt-cache <<'END'
#!/bin/sh
printf 'mesa-vulkan-drivers\n  Depends: libdrm2\nlibdrm2\nlibc6\n'
END
tool dpkg-deb <<'END'
#!/bin/sh
[ "$1" = -f ] && { case $3 in Package) basename=${2##*/}; echo "${basename%.deb}" ;; *) echo 25.0 ;; esac; exit; }
case ${2##*/} in
*mesa*)
    mkdir -p "$3/usr/lib" "$3/usr/share"
    echo lvp >"$3/usr/lib/libvulkan_lvp.so"
    echo other >"$3/usr/lib/libvulkan_other.so"
    echo '{"ICD": {"api_version": "1.4.305", "library_path": "libvulkan_lvp.so"}}' >"$3/usr/share/lvp_icd.json" ;;
*libdrm*) mkdir -p "$3/usr/lib"; echo drm >"$3/usr/lib/libdrm.so.2" ;;
*chromium*)
    mkdir -p "$3/usr/lib/chromium"
    echo swift >"$3/usr/lib/chromium/libvk_swiftshader.so"
    echo '{"ICD": {"api_version": "1.0.5"}}' >"$3/usr/lib/chromium/vk_swiftshader_icd.json" ;;
esac
END

: >"$dir/offline"
run 77 'without network everything is skipped'
says 'skipped: no package lists: E: cannot reach anything'
holds ''
grep -qx 'deb \[signed-by=/some/key.gpg\] http://one.example/debian bookworm-backports main' \
    "$dir/to/apt/sources.list" || bad 'no entry for the backports'
grep -qx 'deb \[signed-by=/other/key.gpg\] http://two.example/debian-security bookworm-security main' \
    "$dir/to/apt/sources.list" || bad 'no entry for security'
grep -q 'commented\|off.example' "$dir/to/apt/sources.list" && bad 'an entry that is switched off was used'

rm "$dir/offline"
: >"$dir/broken"
run 77 'one of two drivers is kept'
says 'swiftshader: skipped: cannot download chromium-common: E: 404'
holds 'mesa25 versions '
[ -s "$dir/to/mesa25/libdrm.so.2" ] || bad 'the dependency is not beside the driver'
[ ! -e "$dir/to/mesa25/libvulkan_other.so" ] || bad 'another driver was unpacked too'
grep -q "\"library_path\": \"$dir/to/mesa25/libvulkan_lvp.so\", \"api_version\": \"1.4.305\"" \
    "$dir/to/mesa25/icd.json" || bad 'icd.json does not name the driver'
grep -q 'unrelated' "$dir/asked" && bad 'a package was fetched that the driver does not need'

rm "$dir/broken"
: >"$dir/asked"
run 0 'the other one follows'
holds 'mesa25 swiftshader versions '
grep -q 'download.*mesa' "$dir/asked" && bad 'what was there was fetched again'
grep -qE '^swiftshader chromium-common 25.0 [0-9a-f]{64}$' "$dir/to/versions" || bad 'no record of the package'

: >"$dir/asked"
run 0 'a second run does nothing'
[ ! -s "$dir/asked" ] || bad 'apt was asked though both drivers are there'

printf 'ID=fedora\n' >"$dir/os-release"
rm -rf "$dir/to"
run 77 'another system is skipped'
says 'not a Debian release'

# A folder "drivers" with a list of versions, beside the program or up to three folders above, the nearest first; else
# build/drivers. The program is moved down a chain of folders, with one such folder at the top or one in the middle, too.
unset RAYDIFF_DRIVERS
mkdir -p "$dir/top/drivers" "$dir/top/1/2/3/4/5"
: >"$dir/top/drivers/versions"
cp "$1" "$dir/top/raydiff"
at=$dir/top
# WHERE WHAT: the program in $at looks there.
looks() {
    (cd "$dir" && "$at/raydiff" check soup:n=1 --engine vulkan --layout f32 --driver mesa25 --count 1) >"$dir/out" 2>&1
    grep -q "^engine vulkan answered.* mesa25 is not in $1: run make drivers" "$dir/out" && echo "passed  $2" || bad "$2"
}
down() { mv "$at/raydiff" "$at/$1/" && at=$at/$1; }
for deep in 0 1 2 3 4 5; do
    [ $deep = 0 ] || down $deep
    [ $deep -le 3 ] && there=$dir/top/drivers || there=build/drivers
    looks "$there" "drivers $deep folders above the program"
done
mkdir "$dir/top/1/drivers" "$dir/top/1/2/3/drivers" # the second has no list
: >"$dir/top/1/drivers/versions"
looks build/drivers 'none of two is near'
mv "$at/raydiff" "$dir/top/1/2/3/" && at=$dir/top/1/2/3
looks "$dir/top/1/drivers" 'the nearer one of two, and one without a list is none'
mv "$at/raydiff" "$dir/top/1/" && at=$dir/top/1
looks "$dir/top/1/drivers" 'the one beside the program'

# With a fetched driver the libraries beside it are loaded, one after what it needs, but for other drivers and what is
# no library; with the same driver by its file none is. Each leaves a file when it is loaded.
fetched=$dir/top/1/drivers/mesa25
mkdir "$fetched" "$dir/loaded"
echo '{"file_format_version": "1.0.0", "ICD": {"library_path": "/nowhere/lib.so", "api_version": "1.1.0"}}' >"$fetched/icd.json"
# NAME NUMBER [NEEDED...]: such a library, with a function of that number.
library() {
    name=$1 number=$2
    shift 2
    printf '#include <stdio.h>\nint given%d(void) { return 1; }\n' "$number" >"$dir/library.c"
    printf '__attribute__((constructor)) static void mark(void)\n{\n    FILE *out = fopen("%s/loaded/%s", "w");\n' "$dir" "$name" >>"$dir/library.c"
    printf '    if (out)\n        fclose(out);\n}\n' >>"$dir/library.c"
    cc -shared -fPIC -Wl,--no-as-needed -o "$fetched/$name" "$dir/library.c" "$@" >"$dir/out" 2>&1 || bad "$name is not compiled"
}
wanted=
for pair in 1 2 3 4 5 6; do
    library "libgiven$pair.so.2" $pair "-Wl,-soname,libgiven$pair.so.2"
    library "libneeds$pair.so" 9 "-L$fetched" "-l:libgiven$pair.so.2"
    wanted="$wanted libgiven$pair.so.2 libneeds$pair.so"
done
for other in libvulkan_other.so libvk_other.so other.so libother.txt; do library $other 9; done
# DRIVER LIBRARIES: those that are loaded with it.
loads() {
    rm -f "$dir/loaded"/*
    (cd "$dir" && "$at/raydiff" check soup:n=1 --engine vulkan --layout f32 --driver "$1" --count 1) >"$dir/out" 2>&1
    grep -q 'no loader' "$dir/out" && return
    now=$(ls "$dir/loaded" | sort | tr '\n' ' ')
    [ "$now" = "$(echo $2 | tr ' ' '\n' | grep . | sort | tr '\n' ' ')" ] && echo "passed  libraries beside $3" ||
        bad "with $1 these are loaded: $now"
}
loads mesa25 "$wanted" 'a fetched driver'
loads "$fetched/icd.json" '' 'a driver by its file'

echo "$failed failed"
[ "$failed" -eq 0 ]
