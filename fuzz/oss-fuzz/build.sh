#!/bin/bash -eu
# Builds the readers of files as OSS-Fuzz wants them: $OUT/NAME with $OUT/NAME_seed_corpus.zip and
# $OUT/NAME.dict. Given: $SRC, $OUT, $WORK, $CC, $CFLAGS, $CXX, $CXXFLAGS, $LIB_FUZZING_ENGINE. Run in
# the repository; `make fuzz-oss` does so with what is on this machine.
build=$WORK/raydiff
libraries="-Wl,-Bstatic -ljansson -lpng -lz -Wl,-Bdynamic -ldl -lm -lpthread"

# The program itself writes the seeds; it is built without the fuzzer's flags. Embree is left out.
make -s -j"$(nproc)" OUT="$build" CC=cc HAVE_EMBREE= "$build/readers/seeds"
make -s -j"$(nproc)" OUT="$build" CC=cc HAVE_EMBREE= READER_OUT="$WORK/readers" READER_CC="$CC" \
    READER_FLAGS="$CFLAGS" READER_LINK="$CXX" READER_LINK_FLAGS="$CXXFLAGS" \
    READER_ENGINE="$LIB_FUZZING_ENGINE" READER_LIBS="$libraries" readers-engine

for fuzzer in "$WORK"/readers/fuzz_*; do
    name=${fuzzer##*/fuzz_}
    cp "$fuzzer" "$OUT/$name"
    found=tests/readers/found/$name
    [ -d "$found" ] || found=
    rm -f "$OUT/${name}_seed_corpus.zip"
    zip -qj "$OUT/${name}_seed_corpus.zip" "$build/readers/seeds/$name"/* ${found:+"$found"/*}
    [ ! -r "tests/readers/dict/$name.dict" ] || cp "tests/readers/dict/$name.dict" "$OUT/$name.dict"
    printf '[libfuzzer]\nmax_len = 16384\ntimeout = 10\n' >"$OUT/$name.options"
done
