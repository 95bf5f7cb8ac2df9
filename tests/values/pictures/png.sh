#!/bin/sh
# The pixels of a PNG file of 8 bits a channel, as one reads them who knows nothing of the program:
#   sh tests/values/pictures/png.sh FILE.png      "WIDTH HEIGHT", then a line "x y red green blue alpha" for each pixel
#   sh tests/values/pictures/png.sh --size FILE   the first line alone
# Exit 1: it is no such file.
set -u
export LC_ALL=C
what=pixels
[ "$1" = --size ] && { what=size; shift; }
file=$1
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT

# Head: width, height, channels; then where each part of the pixels begins, and how long it is.
od -An -v -tu1 "$file" | awk '
    { for (i = 1; i <= NF; i++) byte[n++] = $i }
    function number(at) { return ((byte[at] * 256 + byte[at + 1]) * 256 + byte[at + 2]) * 256 + byte[at + 3] }
    END {
        split("137 80 78 71 13 10 26 10", head, " ")
        for (i = 0; i < 8; i++) if (byte[i] != head[i + 1]) exit 1
        channels = byte[25] == 6 ? 4 : byte[25] == 2 ? 3 : 0
        if (byte[24] != 8 || !channels || byte[28] != 0) exit 1
        print number(16), number(20), channels
        for (at = 8; at < n; at += 12 + number(at))
            if (byte[at + 4] == 73 && byte[at + 5] == 68 && byte[at + 6] == 65 && byte[at + 7] == 84) print at + 9, number(at)
    }' >"$dir/head" || exit 1
read -r width height channels <"$dir/head"
echo "$width $height"
[ $what = size ] && exit
sed 1d "$dir/head" | while read -r from length; do
    tail -c "+$from" "$file" | head -c "$length"
done >"$dir/packed"
# Two bytes of zlib, then what gzip packs, too; gzip misses its own end.
{ printf '\037\213\010\000\000\000\000\000\000\000'; tail -c +3 "$dir/packed"; } | gzip -dc 2>"$dir/err" >"$dir/raw"

od -An -v -tu1 "$dir/raw" | awk -v width="$width" -v height="$height" -v channels="$channels" '
    function paeth(a, b, c,  p, pa, pb, pc) {
        p = a + b - c
        pa = p > a ? p - a : a - p
        pb = p > b ? p - b : b - p
        pc = p > c ? p - c : c - p
        return pa <= pb && pa <= pc ? a : pb <= pc ? b : c
    }
    { for (i = 1; i <= NF; i++) byte[n++] = $i }
    END {
        row = width * channels
        if (n != height * (row + 1)) { print "raw bytes: " n >"/dev/stderr"; exit 1 }
        at = 0
        for (y = 0; y < height; y++) {
            filter = byte[at++]
            for (i = 0; i < row; i++) {
                a = i >= channels ? line[i - channels] : 0
                b = y > 0 ? before[i] : 0
                c = y > 0 && i >= channels ? before[i - channels] : 0
                add = filter == 0 ? 0 : filter == 1 ? a : filter == 2 ? b : filter == 3 ? int((a + b) / 2) : paeth(a, b, c)
                line[i] = (byte[at++] + add) % 256
            }
            for (i = 0; i < row; i++) before[i] = line[i]
            for (x = 0; x < width; x++) {
                i = x * channels
                print x, y, line[i], line[i + 1], line[i + 2], channels == 4 ? line[i + 3] : 255
            }
        }
    }'
