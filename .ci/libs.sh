#!/bin/sh
# Finds the libraries and prints make variables that say how they are compiled with and linked:
#   CC=... PKG_CONFIG=... sh .ci/libs.sh
# pkg-config knows all of them but Embree, of which a CMake package is read (CMake itself is not
# needed): that in CMAKE_PREFIX_PATH, else one in the folders that the compiler links from; the newest.
# What is missing is in LIBS_MISSING, so that whatever needs no library can still be made.
set -u
CC=${CC:-gcc}
PKG_CONFIG=${PKG_CONFIG:-pkg-config}

pkg() { # shellcheck disable=SC2086 # may be a command with options
    $PKG_CONFIG "$@" 2>/dev/null
}
has() { pkg --exists "$1"; }
# Headers of others are not warned about.
cflags() { pkg --cflags "$@" | sed 's/-I *\([^ ]\)/-isystem \1/g'; }

# Those of "name:package" that are not there, as a sentence's end.
absent() {
    for entry; do
        has "${entry%%:*}" || printf ' %s (Debian: %s),' "${entry%%:*}" "${entry#*:}"
    done | sed 's/,$//'
}
if pkg --version >/dev/null; then
    missing=$(absent jansson:libjansson-dev libpng:libpng-dev zlib:zlib1g-dev vulkan:libvulkan-dev)
    missing_tests=$(absent cmocka:libcmocka-dev gmp:libgmp-dev)
else
    missing=" the command $PKG_CONFIG (Debian: pkg-config)"
    missing_tests=$missing
fi
echo "LIBS_MISSING := $missing"
echo "TEST_LIBS_MISSING := $missing_tests"
[ -n "$missing" ] || echo "LIBS_CFLAGS := $(cflags jansson libpng zlib vulkan)"
[ -n "$missing" ] || echo "LIBS := $(pkg --libs jansson libpng zlib)"
[ -n "$missing_tests" ] || printf 'CMOCKA_LIBS := %s\nGMP_LIBS := %s\n' "$(pkg --libs cmocka)" "$(pkg --libs gmp)"

# The window's: the code includes SDL2/SDL.h and opens the library when a window is asked for.
if has sdl2; then
    include=$(pkg --variable=includedir sdl2)
    echo "HAVE_SDL2 := 1"
    [ "$include" = /usr/include ] || echo "SDL2_CFLAGS := -isystem $include"
fi

# glslang's own file leaves out what compiles to SPIR-V, and which libraries there are depends on the
# release: those of the known ones that are there, in the order in which they need each other. They
# are C++, whose own library may be absent where only a C compiler was installed.
runtime=$($CC -print-file-name=libstdc++.so)
if [ -e "$runtime" ] && has glslang && has SPIRV-Tools; then
    folder=$(pkg --variable=libdir glslang)
    libs=
    for name in glslang-default-resource-limits SPIRV glslang MachineIndependent GenericCodeGen OSDependent \
        OGLCompiler; do
        for file in "$folder/lib$name".*; do
            [ ! -e "$file" ] || { libs="$libs -l$name"; break; }
        done
    done
    case $libs in
    *-lglslang-default-resource-limits*-lglslang*)
        echo "HAVE_GLSLANG := 1"
        echo "GLSLANG_CFLAGS := $(cflags glslang SPIRV-Tools)"
        echo "GLSLANG_LIBS := $(pkg --libs-only-L glslang)$libs $(pkg --libs SPIRV-Tools) -lstdc++"
        ;;
    esac
fi

# The value of a variable that a CMake file sets.
cmake_value() { # FILE NAME
    sed -n "s|^ *[Ss][Ee][Tt] *( *$2 *\"\{0,1\}\([^\")]*\)\"\{0,1\} *).*|\1|p" "$1" | head -n 1
}

# One path a line.
paths() { printf '%s\n' "$1" | tr : '\n' | grep /; }
embree_files() {
    paths "${CMAKE_PREFIX_PATH:-}" | while read -r prefix; do
        ls "$prefix"/lib*/cmake/embree*/embree-config.cmake "$prefix"/lib/*/cmake/embree*/embree-config.cmake
    done
    paths "$($CC -print-search-dirs | sed -n 's/^libraries: *=//p')" | while read -r folder; do
        ls "$folder"/cmake/embree*/embree-config.cmake
    done
}

best=0
embree_files 2>/dev/null | while read -r file; do
    major=$(cmake_value "$file" EMBREE_VERSION_MAJOR)
    minor=$(cmake_value "$file" EMBREE_VERSION_MINOR)
    case $major in 3 | 4) ;; *) continue ;; esac
    [ $((major * 1000 + minor)) -gt "$best" ] || continue
    # Without links, since /lib is often one to /usr/lib.
    here=$(cd "$(dirname "$file")" && pwd -P)
    root=$(cmake_value "$file" EMBREE_ROOT_DIR | sed "s|\${CMAKE_CURRENT_LIST_DIR}|$here|")
    root=$(cd "$root" 2>/dev/null && pwd) || continue
    library=$(cmake_value "$file" EMBREE_LIBRARY | sed "s|\${EMBREE_ROOT_DIR}|$root|")
    [ -e "$library" ] && [ -e "$root/include/embree$major/rtcore.h" ] || continue
    best=$((major * 1000 + minor))
    echo "HAVE_EMBREE := $major"
    # The library is opened by name, and outside /usr by its place.
    if [ "$root" = /usr ]; then
        echo "EMBREE_CFLAGS :="
    else
        echo "EMBREE_CFLAGS := -isystem $root/include -DEMBREE_FOLDER='\"$(dirname "$library")\"'"
    fi
done
