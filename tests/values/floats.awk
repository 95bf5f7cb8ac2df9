# Floats that JSON has as a value and as the bits of its word: "bits": "0x3f800000".
function hex(text,  i, n) {
    text = tolower(text)
    for (i = 3; i <= length(text); i++) n = n * 16 + index("0123456789abcdef", substr(text, i, 1)) - 1
    return n
}
# The float of a word; of infinities and what is no number the word itself.
function float_of(word,  sign, exponent, fraction) {
    sign = word >= 2147483648 ? -1 : 1
    word %= 2147483648
    exponent = int(word / 8388608)
    fraction = word % 8388608
    if (exponent == 255) return word
    return sign * (exponent ? (1 + fraction / 8388608) * 2 ^ (exponent - 127) : fraction * 2 ^ -149)
}
# Every value of the JSON is that of its bits. Returns how many there are.
function floats_are_their_bits(  k, path, n) {
    for (k in v) {
        if (k !~ /\.bits$/) continue
        path = k
        sub(/\.bits$/, ".value", path)
        n++
        # Of nine digits or more.
        if (v[path] != "null") near(path, v[path], float_of(hex(v[k])))
    }
    return n + 0
}
