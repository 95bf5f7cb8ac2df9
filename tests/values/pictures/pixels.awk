# What two pictures differ in, from the pixels that tests/values/pictures/png.sh prints: kept by pixels_of() in files whose
# names end with a.pixels and b.pixels; differences() sets is[].
function channels_apart(i,  k, d) {
    for (most = k = 0; k < 4; k++) {
        d = red[0, i, k] - red[1, i, k]
        apart[k] = d < 0 ? -d : d
        if (apart[k] > most) most = apart[k]
    }
    return most
}
function pixel_text(i, side,  k, text) {
    for (k = 0; k < 4; k++) text = text " " red[side, i, k]
    return substr(text, 2)
}
# is["different"], is["size 3-7"], is["largest red"], is["sum red"], is["box"], is["first"], is["worst"], is["largest"]
function differences(  i, k, d, size, worst) {
    split("red green blue alpha", channel, " ")
    for (i = 0; i < pixels[0]; i++) {
        d = channels_apart(i)
        if (d == 0) continue
        size = d >= 32 ? "32+" : d >= 8 ? "8-31" : d >= 3 ? "3-7" : d
        is["size " size]++
        x = i % width[0]
        y = int(i / width[0])
        if (is["different"]++ == 0) {
            is["first"] = i
            left = right = x
            top = y
        }
        if (x < left) left = x
        if (x > right) right = x
        bottom = y
        if (d > is["largest"]) {
            is["largest"] = d
            is["worst"] = i
        }
        for (k = 0; k < 4; k++) {
            is["sum " channel[k + 1]] += apart[k]
            if (apart[k] > is["largest " channel[k + 1]]) is["largest " channel[k + 1]] = apart[k]
        }
    }
    is["box"] = left " " right " " top " " bottom
}
FILENAME ~ /\.pixels$/ {
    side = FILENAME ~ /b\.pixels$/
    if (FNR == 1) {
        width[side] = $1
        height[side] = $2
        next
    }
    for (k = 0; k < 4; k++) red[side, FNR - 2, k] = $(3 + k)
    pixels[side] = FNR - 1
    next
}
