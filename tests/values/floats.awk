# Floats that JSON has as a value and as the bits of its word: "bits": "0x3f800000".
function hex(text,  i, n) {
    text = tolower(text)
    for (i = 3; i <= length(text); i++) n = n * 16 + index("0123456789abcdef", substr(text, i, 1)) - 1
    return n
}
# A number as printf has it, also as a hexadecimal float, of which not every awk knows.
function float_number(text,  part, sign, n, dot, i) {
    if (text !~ /0x/) return text + 0
    sign = text ~ /^-/ ? -1 : 1
    sub(/^[-+]?0x/, "", text)
    split(text, part, "p")
    for (i = 1; i <= length(part[1]); i++)
        if (substr(part[1], i, 1) == ".") dot = i
        else n = n * 16 + index("0123456789abcdef", substr(part[1], i, 1)) - 1
    return sign * n * 2 ^ (part[2] - (dot ? 4 * (length(part[1]) - dot) : 0))
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
