# What the value checks share: v[] holds the first file, "path=value" as tests/values/flat.awk prints it.
function bad(what) {
    print "WRONG   " what
    wrong++
}
# The text of a field is what `format` makes of the number.
function same(what, text, format, number) {
    checked++
    if (text != sprintf(format, number)) bad(what ": printed " text ", is " sprintf(format, number))
}
function equal(what, text, is) {
    checked++
    if (text "" != is "") bad(what ": printed " text ", is " is)
}
FNR == NR {
    at = index($0, "=")
    v[substr($0, 1, at - 1)] = substr($0, at + 1)
    next
}
