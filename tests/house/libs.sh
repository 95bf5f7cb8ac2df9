#!/bin/sh
# .ci/libs.sh with libraries, a compiler and a pkg-config that are made up: what it finds, what it prefers,
# and what is told where something is missing.
#   sh tests/house/libs.sh
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $1"
    sed 's/^/        /' "$dir/out"
    failed=$((failed + 1))
}
has() { grep -qx -- "$1" "$dir/out" || bad "$2: no line /$1/"; }
hasnt() { grep -q -- "$1" "$dir/out" && bad "$2: a line /$1/"; }

# A pkg-config that knows what has a file in $dir/pc: its flags, then its libraries.
mkdir "$dir/pc" "$dir/links"
cat >"$dir/pkg-config" <<END
#!/bin/sh
case \$1 in
--version) echo 1 ;;
--exists) [ -e "$dir/pc/\$2" ] ;;
--cflags) shift; for one; do sed -n 1p "$dir/pc/\$one"; done | tr '\n' ' ' ;;
--libs) shift; for one; do sed -n 2p "$dir/pc/\$one"; done | tr '\n' ' ' ;;
--variable=libdir) echo "$dir/links" ;;
--variable=includedir) echo "/else/where" ;;
--libs-only-L) echo "-L$dir/links" ;;
esac
END
cat >"$dir/cc" <<END
#!/bin/sh
case \$1 in
-print-search-dirs) printf 'install: /x\nlibraries: =/no/such:%s:%s:/neither\n' "\${first:-/nor/this}" "$dir/links" ;;
-print-file-name=*) [ -e "$dir/links/\${1#*=}" ] && echo "$dir/links/\${1#*=}" || echo "\${1#*=}" ;;
esac
END
chmod +x "$dir/pkg-config" "$dir/cc"
libs() { first=${linked:-} CC=$dir/cc PKG_CONFIG=${tool:-$dir/pkg-config} CMAKE_PREFIX_PATH=${prefix:-} sh .ci/libs.sh >"$dir/out" 2>"$dir/err"; }
package() { printf '%s\n%s\n' "$2" "$3" >"$dir/pc/$1"; }

tool=no-such-command libs
has 'LIBS_MISSING :=  the command no-such-command (Debian: pkg-config)' 'without pkg-config'
tool=''
libs
has 'LIBS_MISSING :=  jansson (Debian: libjansson-dev), libpng (Debian: libpng-dev), zlib.*' 'all libraries missing'
package jansson '' -ljansson
package libpng '-I/odd place' '-L/odd -lpng99'
package zlib '' -lz
libs
has 'LIBS_MISSING :=  vulkan (Debian: libvulkan-dev)' 'one library missing'
hasnt '^LIBS :=' 'one library missing'
package vulkan -I/vulkan ''
libs
has 'LIBS_MISSING := ' 'all there'
has 'LIBS_CFLAGS :=  -isystem /odd place  -isystem /vulkan.*' "others' headers"
has 'LIBS := -ljansson -L/odd -lpng99 -lz *' 'libraries'
has 'TEST_LIBS_MISSING :=  cmocka (Debian: libcmocka-dev), gmp (Debian: libgmp-dev)' 'the tests want more'
hasnt HAVE_ 'what is optional'

# glslang of two releases, and where C++ has no library.
package glslang '' ''
package SPIRV-Tools '' '-lSPIRV-Tools-opt -lSPIRV-Tools'
for name in glslang-default-resource-limits SPIRV glslang MachineIndependent GenericCodeGen OSDependent; do
    : >"$dir/links/lib$name.a"
done
libs
hasnt HAVE_GLSLANG 'without the C++ library'
: >"$dir/links/libstdc++.so"
libs
has 'HAVE_GLSLANG := 1' 'glslang'
has 'GLSLANG_LIBS := .* -lOSDependent -lSPIRV-Tools-opt.* -lstdc++' 'a glslang without OGLCompiler'
: >"$dir/links/libOGLCompiler.a"
libs
has 'GLSLANG_LIBS := .* -lOSDependent -lOGLCompiler -lSPIRV-Tools-opt.*' 'a glslang with it'
rm "$dir/links/libglslang-default-resource-limits.a"
libs
hasnt HAVE_GLSLANG 'half a glslang'
package sdl2 '' -lSDL2
libs
has 'SDL2_CFLAGS := -isystem /else/where' 'SDL2'

# embree FOLDER MAJOR MINOR: as its CMake package describes it, with the library and the header.
embree() {
    place=$1/cmake/embree-$2.$3.0
    mkdir -p "$place" "$1/include/embree$2" "$1/lib"
    : >"$1/include/embree$2/rtcore.h"
    : >"$1/lib/libembree$2.so.$2"
    cat >"$place/embree-config.cmake" <<END
SET(EMBREE_ROOT_DIR "\${CMAKE_CURRENT_LIST_DIR}/../../")
SET(EMBREE_LIBRARY "\${EMBREE_ROOT_DIR}/lib/libembree$2.so.$2")
SET(EMBREE_VERSION_MAJOR $2)
SET(EMBREE_VERSION_MINOR $3)
END
}
chosen() { sed -n 's/^HAVE_EMBREE := //p' "$dir/out" | tail -n 1; }
embree "$dir/links" 3 13
libs
[ "$(chosen)" = 3 ] || bad 'Embree 3 is found'
has "EMBREE_CFLAGS := -isystem $dir/links/include -DEMBREE_FOLDER='\"$dir/links/lib\"'" 'outside /usr'
hasnt EMBREE_LIBS 'nothing is linked with Embree'
embree "$dir/links" 4 3
libs
[ "$(chosen)" = 4 ] || bad 'Embree 4 goes before 3'
rm "$dir/links/lib/libembree4.so.4"
libs
[ "$(chosen)" = 3 ] || bad 'an Embree without its library is none'
embree "$dir/links" 5 0
libs
[ "$(chosen)" = 3 ] || bad 'an unknown Embree is none'
mkdir -p "$dir/merged/usr/lib"
ln -s usr/lib "$dir/merged/lib"
embree "$dir/merged/usr/lib/x-y" 4 2
mv "$dir/merged/usr/lib/x-y/include" "$dir/merged/usr"
sed -i 's|/../../")|/../../../../")|; s|/lib/libembree|/lib/x-y/lib/libembree|' "$dir"/merged/usr/lib/x-y/cmake/*/*.cmake
linked=$dir/merged/lib/x-y libs
[ "$(chosen)" = 4 ] || bad 'a folder that a link leads to'
has "EMBREE_CFLAGS := -isystem $dir/merged/usr/include -DEMBREE_FOLDER='\"$dir/merged/usr/lib/x-y/lib\"'" 'headers beside the folder that the link leads to'
embree "$dir/torn" 4 9
rm "$dir/torn/lib/libembree4.so.4"
linked=$dir/torn libs
[ "$(chosen)" = 3 ] || bad 'an older Embree behind a newer one without its library'
embree "$dir/own/lib" 4 1
prefix=/nothing:$dir/own libs
[ "$(chosen)" = 4 ] || bad 'CMAKE_PREFIX_PATH is searched'
[ ! -s "$dir/err" ] || { cp "$dir/err" "$dir/out"; bad 'it says something on standard error'; }

# What the Makefile makes of it: one line before anything is compiled.
make PKG_CONFIG=no-such-command "OUT=$dir/build" all >"$dir/out" 2>&1
[ $? -eq 2 ] || bad 'make without pkg-config ends with 2'
grep -q '^make: missing to build raydiff: the command no-such-command (Debian: pkg-config)$' "$dir/out" ||
    bad 'make says what is missing'
[ -z "$(find "$dir/build" -name '*.o')" ] || bad 'something was compiled all the same'
echo "libs: $failed failed"
[ "$failed" -eq 0 ]
