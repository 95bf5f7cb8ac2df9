# What the value checks share: v[] holds the first file, "path=value" as tests/values/flat.awk prints it;
# w[] that of another command.
function bad(what) {
    if (++wrong <= 20) print "WRONG   " what
}
# A line "path=value" of a flat JSON; what looks like a number is one (of split() alone).
function keep(line, into,  at, part) {
    at = index(line, "=")
    split(substr(line, at + 1), part, "\001")
    into[substr(line, 1, at - 1)] = part[1]
}
# The text of a field is what `format` makes of the number, of which JSON has nine digits.
function same(what, text, format, number) {
    checked++
    if (text != sprintf(format, number) && text != sprintf(format, number * (1 + 2e-9)) &&
        text != sprintf(format, number * (1 - 2e-9)))
        bad(what ": printed " text ", is " sprintf(format, number))
}
# "(1.5-2.5)" of a least and a most.
function same_span(what, text, format, least, most,  side) {
    gsub(/[()]/, "", text)
    split(text, side, "-")
    same(what ", least", side[1], format, least)
    same(what ", most", side[2], format, most)
}
# Two numbers, one of them computed from others of nine digits.
function near(what, number, is,  far) {
    checked++
    far = number - is
    if (!((far < 0 ? -far : far) <= 1e-7 * (is < 0 ? -is : is))) bad(what ": " number ", and computed anew " is)
}
function truth(what, holds) {
    checked++
    if (!holds) bad(what)
}
function equal(what, text, is) {
    checked++
    if (text "" != is "") bad(what ": printed " text ", is " is)
}
FNR == NR {
    keep($0, v)
    next
}
# The last line of raydiff bench.
FILENAME ~ /text$/ && /^bench [a-z]+: [0-9]+ rows?: / {
    if ("rows.count" in v) equal("rows", $3, v["rows.count"])
    if ("handlers.count" in v) equal("rows", $3, v["handlers.count"])
    if ("exit" in v) equal("conclusion", /no answer is WRONG$|same|bits of engine cpu,|no correct|not judged$|nothing is judged$|no picture/ ? 0 : 1, v["exit"])
    next
}
# Files other.flat are of another command: w[].
FILENAME ~ /other\.flat$/ {
    keep($0, w)
    next
}
