# JSON as lines "path=value": awk -f tests/values/flat.awk FILE. A path is names and numbers with dots between:
# rows.0.counts.wrong=0; of a text the quotes are taken off, "\"" and "\\" are read. Exit 1: it is no JSON.
function wrong(what) {
    print "flat: " what " at byte " place >"/dev/stderr"
    bad = 1
    exit 1
}
# `rest` is what is left of a line: a value may go on in the next, no word of it does.
function skip() {
    if (match(rest, /^[ \t\r]+/)) take(RLENGTH)
    while (rest == "" && at < NR) {
        rest = line[++at]
        place++
        if (match(rest, /^[ \t\r]+/)) take(RLENGTH)
    }
}
function take(length_) {
    rest = substr(rest, length_ + 1)
    place += length_
}
function text(  out) {
    if (!match(rest, /^"([^"\\]|\\.)*"/)) wrong("no text")
    out = substr(rest, 2, RLENGTH - 2)
    take(RLENGTH)
    gsub(/\\"/, "\"", out)
    gsub(/\\\\/, "\\", out)
    return out
}
function value(path,  name, i, first) {
    skip()
    first = substr(rest, 1, 1)
    if (first == "{" || first == "[") {
        take(1)
        skip()
        for (i = 0; substr(rest, 1, 1) !~ /[]}]/; i++) {
            if (i > 0) {
                if (substr(rest, 1, 1) != ",") wrong("no comma")
                take(1)
                skip()
            }
            name = i
            if (first == "{") {
                name = text()
                skip()
                if (substr(rest, 1, 1) != ":") wrong("no colon")
                take(1)
            }
            value(path == "" ? name : path "." name)
            skip()
        }
        if (substr(rest, 1, 1) != (first == "{" ? "}" : "]")) wrong("no end")
        take(1)
        if (first == "[") print path ".count=" i
    } else if (first == "\"")
        print path "=" text()
    else if (match(rest, /^(-?[0-9][-+.eE0-9]*|true|false|null)/)) {
        print path "=" substr(rest, 1, RLENGTH)
        take(RLENGTH)
    } else
        wrong("no value")
}
{ line[NR] = $0 }
END {
    if (bad) exit 1
    place = -1
    value("")
    skip()
    if (rest != "") wrong("more than one value")
}
