#!/bin/sh
# Fetches more Vulkan drivers that need no GPU, beside the system's and without touching it:
#   mesa25       the newer Mesa of Debian's backports, with the dependencies the system lacks
#   swiftshader  out of Debian's chromium-common
#   sh .ci/drivers.sh DIR
# DIR/NAME/ holds a driver's libraries and icd.json, DIR/versions what was found: driver, package,
# version, sha256 (recorded, not pinned: Debian replaces both packages with every update). Nothing
# is redistributed. apt uses lists, cache and sources of its own under DIR; the sources are derived
# from the machine's own Debian entry, proxies and keys stay the machine's. Needs no root.
# A driver is there or not, never in part; what is there costs no network and no time.
# Exit codes: 0 both drivers are there; 77 one is not, with the reason; 2 usage.
set -u
LC_ALL=C
export LC_ALL

[ $# -eq 1 ] || { echo "usage: sh .ci/drivers.sh DIR" >&2; exit 2; }
mkdir -p "$1" && dir=$(cd "$1" && pwd) || exit 77
there() { [ -s "$dir/$1/icd.json" ] && [ -s "$dir/$1/versions" ]; }
finish() {
    cat "$dir"/*/versions >"$dir/.versions" 2>/dev/null && mv "$dir/.versions" "$dir/versions"
    rm -f "$dir/.versions"
    if there mesa25 && there swiftshader; then
        exit 0
    fi
    exit 77
}
skip() { echo "drivers: $1: skipped: $2"; }
if there mesa25 && there swiftshader && [ -s "$dir/versions" ]; then
    echo "drivers: mesa25 and swiftshader are there"
    exit 0
fi
for tool in apt-get apt-cache dpkg-deb sha256sum; do
    command -v "$tool" >/dev/null || { skip all "$tool is needed"; exit 77; }
done
codename=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release 2>/dev/null)
case $(sed -n 's/^ID=//p' /etc/os-release 2>/dev/null):$codename in
debian:?*) ;;
*) skip all "this is not a Debian release"; exit 77 ;;
esac

# One at a time: a second run waits, then finds the drivers there.
if command -v flock >/dev/null && [ -z "${DRIVERS_LOCKED:-}" ]; then
    DRIVERS_LOCKED=1 exec flock "$dir/.lock" sh "$0" "$dir"
fi
temp=$(mktemp -d "$dir/.fetch.XXXXXX") || { skip all "no temporary folder"; exit 77; }
trap 'rm -rf "$temp"' EXIT
trap 'exit 130' INT TERM HUP
mkdir -p "$dir/apt/lists/partial" "$dir/apt/cache/archives/partial" || exit 77

keyring=/usr/share/keyrings/debian-archive-keyring.gpg
# One entry of our own: URI, suite, keys.
source_line() {
    keys=$3
    [ "$keys" != - ] || [ ! -r "$keyring" ] || keys=$keyring
    case $keys in
    -) echo "deb $1 $2 main" ;;
    *) echo "deb [signed-by=$keys] $1 $2 main" ;;
    esac
}
sh "$(dirname "$0")/apt_sources.sh" >"$temp/entries"
main=$(awk -v suite="$codename" '$2 == suite && $1 !~ /^cdrom/ {print; exit}' "$temp/entries")
[ -n "$main" ] || { skip all "apt has no source for Debian $codename"; exit 77; }
# shellcheck disable=SC2086 # an entry is three words
{
    set -- $main
    source_line "$1" "$codename" "$3"
    source_line "$1" "$codename-backports" "$3"
    set -- $(awk -v suite="$codename-security" '$2 == suite && $1 !~ /^cdrom/ {print; exit}' "$temp/entries")
    [ $# -lt 3 ] || source_line "$1" "$codename-security" "$3"
} | sort -u >"$dir/apt/sources.list"

# The machine's hooks after an update or an installation clean up the machine: not ours to do.
cat >"$temp/apt.conf" <<CONF
#clear APT::Update::Pre-Invoke;
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
#clear DPkg::Post-Invoke;
Dir::State::lists "$dir/apt/lists";
Dir::Cache "$dir/apt/cache";
Dir::Etc::sourcelist "$dir/apt/sources.list";
Dir::Etc::sourceparts "-";
Dir::Etc::preferences "-";
Dir::Etc::preferencesparts "-";
APT::Sandbox::User "$(id -un)";
APT::Update::Error-Mode "any";
APT::Default-Release "$codename-backports";
Acquire::Retries "1";
Acquire::http::Timeout "20";
Acquire::https::Timeout "20";
Acquire::Languages "none";
Debug::NoLocking "1";
CONF
apt() { command=$1; shift; "$command" -c "$temp/apt.conf" "$@"; }

echo "drivers: reading Debian's package lists"
if ! apt apt-get -q update >"$temp/log" 2>&1; then
    why=$(grep '^[EW]:' "$temp/log" | head -n 1 | cut -c 1-160)
    skip all "no package lists: ${why:-$(tail -n 1 "$temp/log")}"
    finish
fi

# Downloads packages $2.. for driver $1 and unpacks them into $temp/$1/root. On failure $why.
why=''
fetch() {
    name=$1
    shift
    mkdir -p "$temp/$name/deb" "$temp/$name/root"
    for package; do
        echo "drivers: $name: fetching $package"
        (cd "$temp/$name/deb" && apt apt-get -q download "$package") >"$temp/log" 2>&1 || {
            why="cannot download $package: $(grep '^E:' "$temp/log" | head -n 1 | cut -c 1-160)"
            return 1
        }
    done
    for deb in "$temp/$name/deb"/*.deb; do
        dpkg-deb -x "$deb" "$temp/$name/root" 2>"$temp/log" || { why="cannot unpack $deb"; return 1; }
        echo "$name $(dpkg-deb -f "$deb" Package) $(dpkg-deb -f "$deb" Version)" \
            "$(sha256sum <"$deb" | cut -d ' ' -f 1)" >>"$temp/$name/versions"
    done
}

# Makes $1/icd.json and $1/versions out of library $2 and puts the folder in its place.
place() {
    name=$1 library=$2
    out=$temp/$name/out
    echo "$name $library - $(sha256sum <"$out/$library" | cut -d ' ' -f 1)" >>"$temp/$name/versions"
    cp "$temp/$name/versions" "$out/versions" &&
        printf '{"file_format_version": "1.0.0",\n "ICD": {"library_path": "%s", "api_version": "%s"}}\n' \
            "$dir/$name/$library" "$3" >"$out/icd.json" && rm -rf "${dir:?}/$name" &&
        mv "$out" "$dir/$name" || { why="cannot write $dir/$name"; return 1; }
    awk '{print "drivers:", $1 ":", $2, $3}' "$dir/$name/versions"
}
api_of() { sed -n 's/.*"api_version": *"\([0-9.]*\)".*/\1/p' "$1"; }

# Of all that apt would install or upgrade, only what the driver depends on.
mesa() {
    apt apt-get -s -q --no-install-recommends install mesa-vulkan-drivers >"$temp/log" 2>&1 || {
        why="apt: $(grep '^E:' "$temp/log" | head -n 1 | cut -c 1-160)"
        return 1
    }
    sed -n 's/^Inst \([^ ]*\) \(\[[^]]*\] \)\{0,1\}(\([^ ]*\) .*/\1 \3/p' "$temp/log" | sort >"$temp/new"
    apt apt-cache depends --recurse --no-recommends --no-suggests --no-conflicts --no-breaks \
        --no-replaces --no-enhances mesa-vulkan-drivers 2>/dev/null | grep '^[a-z]' |
        grep -vx libc6 | sort -u >"$temp/closure" # a process has one C library
    packages=$(join "$temp/new" "$temp/closure" | sed 's/ /=/')
    case $packages in
    *mesa-vulkan-drivers=*) ;;
    *) why="$codename-backports has no newer Mesa than the system"; return 1 ;;
    esac
    # shellcheck disable=SC2086 # a list of packages
    fetch mesa25 $packages || return 1
    json=$(find "$temp/mesa25/root" -name 'lvp_icd*.json' | head -n 1)
    [ -n "$json" ] || { why="the package has no lvp_icd.json"; return 1; }
    mkdir "$temp/mesa25/out"
    # Of Mesa itself the software driver alone; of its dependencies every library, by its own name.
    find "$temp/mesa25/root" -name 'lib*.so*' ! -name 'libvulkan_*' ! -name 'libVkLayer_*' \
        -exec cp -P {} "$temp/mesa25/out" \;
    find "$temp/mesa25/root" -name libvulkan_lvp.so -exec cp {} "$temp/mesa25/out" \;
    place mesa25 libvulkan_lvp.so "$(api_of "$json")"
}

swiftshader() {
    fetch swiftshader chromium-common || return 1
    json=$(find "$temp/swiftshader/root" -name 'vk_swiftshader_icd.json' | head -n 1)
    [ -n "$json" ] || { why="chromium-common has no SwiftShader any more"; return 1; }
    mkdir "$temp/swiftshader/out" &&
        cp "$(dirname "$json")/libvk_swiftshader.so" "$temp/swiftshader/out" || return 1
    place swiftshader libvk_swiftshader.so "$(api_of "$json")"
}

there mesa25 || mesa || skip mesa25 "$why"
there swiftshader || swiftshader || skip swiftshader "$why"
finish
