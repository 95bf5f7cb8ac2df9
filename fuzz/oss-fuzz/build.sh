#!/bin/bash -eu
# Builds the files under fire as OSS-Fuzz wants them: $OUT/NAME with $OUT/NAME_seed_corpus.zip and
# $OUT/NAME.dict. Given: $SRC, $OUT, $WORK, $CC, $CFLAGS, $CXX, $CXXFLAGS, $LIB_FUZZING_ENGINE. Run in
# the repository; `make fuzz-oss` does so with what is on this machine.
build=$WORK/raydiff
libraries="-Wl,-Bstatic -ljansson -lpng -lz -Wl,-Bdynamic -ldl -lm -lpthread"

# The program itself writes the seeds; it is built without the fuzzer's flags. Embree is left out.
make -s -j"$(nproc)" OUT="$build" CC=cc HAVE_EMBREE= "$build/fire/seeds"
make -s -j"$(nproc)" OUT="$build" CC=cc HAVE_EMBREE= FIRE_OUT="$WORK/fire" FIRE_CC="$CC" \
    FIRE_FLAGS="$CFLAGS" FIRE_LINK="$CXX" FIRE_LINK_FLAGS="$CXXFLAGS" \
    FIRE_ENGINE="$LIB_FUZZING_ENGINE" FIRE_LIBS="$libraries" fire-engine

for fuzzer in "$WORK"/fire/fuzz_*; do
    name=${fuzzer##*/fuzz_}
    cp "$fuzzer" "$OUT/$name"
    found=tests/readers/found/$name
    [ -d "$found" ] || found=
    rm -f "$OUT/${name}_seed_corpus.zip"
    zip -qj "$OUT/${name}_seed_corpus.zip" "$build/fire/seeds/$name"/* ${found:+"$found"/*}
    [ ! -r "tests/readers/dict/$name.dict" ] || cp "tests/readers/dict/$name.dict" "$OUT/$name.dict"
    printf '[libfuzzer]\nmax_len = 16384\ntimeout = 10\n' >"$OUT/$name.options"
done
