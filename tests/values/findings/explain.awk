# The page of `raydiff explain` against its JSON: awk -v triangles=N -v lost=HINTS -f lib.awk -f floats.awk -f explain.awk FLAT TEXT
function word(path) { return hex(v[path ".bits"]) }
# As printf has it; infinities and what is no number by their bits, "" of any.
function number_is(what, text, format, path,  bits) {
    bits = word(path)
    checked++
    if (bits % 2147483648 == 2139095040) truth(what ": printed " text, text == (bits > 2147483648 ? "-inf" : "inf"))
    else if (bits % 2147483648 > 2139095040) truth(what ": printed " text, text ~ /^-?nan$/)
    else if (text != sprintf(format, float_of(bits))) bad(what ": printed " text ", is " sprintf(format, float_of(bits)))
}
# 0x1.5p-2
function hexadecimal(text,  sign, part, digits, k, n) {
    sign = sub(/^-/, "", text) ? -1 : 1
    split(substr(text, 3), part, "p")
    split(part[1], digits, ".")
    n = hex("0x" digits[1])
    for (k = 1; k <= length(digits[2]); k++) n += hex("0x" substr(digits[2], k, 1)) / 16 ^ k
    return sign * n * 2 ^ part[2]
}
function hex_is(what, text, path) {
    if (text ~ /inf|nan/) number_is(what, text, "%.9g", path)
    else truth(what ": printed " text, hexadecimal(text) == float_of(word(path)))
}
# "0x1p-1 (0.5)"
function float_is(what, text, path,  part) {
    split(text, part, / [(]|[)]/)
    hex_is(what, part[1], path)
    number_is(what, part[2], "%.9g", path)
}
function floats_are(what, text, count, paths,  part, path, k) {
    split(paths, path, " ")
    equal(what " has", split(text, part, "  "), count)
    for (k = 1; k <= count; k++) float_is(what " " k, part[k], path[k])
}
# "a miss" or "triangle 0 at t = 0x1p-1 (0.5), u = 0.25, v = 0.5"
function hit_is(what, text, path,  part) {
    if (v[path ".prim"] == "null") { equal(what, text, "a miss"); return }
    split(text, part, / at t = |, [uv] = /)
    equal(what, part[1], "triangle " v[path ".prim"])
    float_is(what " t", part[2], path ".t")
    number_is(what " u", part[3], "%.9g", path ".u")
    number_is(what " v", part[4], "%.9g", path ".v")
}
# Places of floats in their order, -0 and 0 in one.
function order(bits) { return bits < 2147483648 ? bits : 2147483648 - bits }
function magnitude(x,  e) {
    if (x < 0) return -magnitude(-x)
    if (x < 2 ^ -14) return x * 2 ^ 24
    for (e = -14; x >= 2 ^ (e + 1); e++) continue
    return 1024 * (e + 14 + x / 2 ^ e)
}
# A line of a bound and the next: all its numbers, and its steps computed from the bits.
function bound_is(name, path, side,  from, to) {
    hex_is(name " exact", $3, path ".exact")
    hex_is(name " of the tree", $4, path ".tree")
    hex_is(name " in the bytes", $5, path ".decoded")
    equal(name " float32 steps", $7, v[path ".float32_steps"])
    same(name " float16 steps", $6, "%.4g", v[path ".float16_steps"])
    from = word(path ".exact")
    to = word(path ".decoded")
    equal(name " steps", $7, side * (order(to) - order(from)))
    if (from % 2147483648 < 2139095040 && to % 2147483648 < 2139095040)
        near(name " halves", v[path ".float16_steps"] + 0, side * (magnitude(float_of(to)) - magnitude(float_of(from))))
    equal(name " fault", words_from(8), fault[v[path ".fault"]])
    getline
    number_is(name " exact", $1, "%.9g", path ".exact")
    number_is(name " of the tree", $2, "%.9g", path ".tree")
    number_is(name " in the bytes", $3, "%.9g", path ".decoded")
}
function words_from(k,  text) {
    for (; k <= NF; k++) text = text (text == "" ? "" : " ") $k
    return text
}
function note(path) {
    if (v[path ".tested"] == "false") return "never reached"
    if (v[path ".hit"] == "false") return "TURNED AWAY"
    if (v[path ".entered"] == "true") return "entered, t from"
    if (v[path ".skipped"] == "true") return "SKIPPED: entry"
    return "hit, never entered"
}
BEGIN {
    split("ok= overflow=not~finite flushed=flushed~to~0 rounded=rounded~inward stored=another~box cut=cut~by~the~builder", pair, " ")
    for (k in pair) {
        split(pair[k], side, "=")
        gsub(/~/, " ", side[2])
        fault[side[1]] = side[2]
    }
    tried = hints = 0
    classes = " miss inside edge vertex in_plane zero_area "
}
FNR == 1 { equal("scene", $0, "scene     " v["subject.scene"] ": " triangles " triangle" (triangles == 1 ? "" : "s")); next }
/^origin    / { floats_are("origin", substr($0, 11), 3, "origin.0 origin.1 origin.2"); next }
/^direction / { floats_are("direction", substr($0, 11), 3, "direction.0 direction.1 direction.2"); next }
/^range     / { floats_are("range", substr($0, 11), 2, "tmin tmax"); next }
/^engine    / {
    text = v["subject.engine"]
    if (v["subject.layout"] != "null")
        text = text ", layout " v["subject.layout"] ", builder " v["subject.builder"] ", leaf " v["subject.leaf"] ", box " v["subject.box"]
    equal("engine", substr($0, 11), text ", triangle " v["subject.tri"] ", query " v["subject.query"])
    next
}
/^truth     / {
    text = "a miss"
    if (v["truth.prim"] != "null")
        text = "triangle " v["truth.prim"] (v["truth.ties"] > 1 ? " and others at the same t" : "") \
            sprintf(" at t in [%.17g, %.17g], ", v["truth.t_lo"], v["truth.t_hi"]) v["truth.class"]
    equal("truth", substr($0, 11), text)
    next
}
/^answer    / {
    if (v["finished"] == "true") hit_is("answer", substr($0, 11), "answer")
    else equal("answer", substr($0, 11), v["reason"])
    next
}
/^verdict   / {
    if (v["finished"] != "true") {
        equal("verdict", substr($0, 11), "not finished")
        equal("exit code", v["exit"], 3)
        next
    }
    wrong_one = v["judgement.verdict"] == "wrong"
    text = wrong_one ? "WRONG: " v["judgement.wrong"] : (v["judgement.verdict"] == "right" ? "" : "allowed: ") v["judgement.verdict"]
    if (wrong_one && v["judgement.expected"] != "null") text = text ", triangle " v["judgement.expected"] " was to be found"
    if (v["judgement.lost"] != "null") text = text ", or at the least triangle " v["judgement.lost"] " behind it"
    if (v["judgement.over"] > 0) text = text sprintf(", error of t %.3g of its bound", v["judgement.over"])
    if (v["judgement.displacement"] > 0)
        text = text sprintf(", right if vertices move by %.3g u of their distance", v["judgement.displacement"])
    equal("verdict", substr($0, 11), text)
    equal("exit code", v["exit"], wrong_one ? 1 : 0)
    next
}
/^traversal path [(]cpu[)] to triangle / { goal = $6; on_way = 1; getline; next }
on_way && /^ +[0-9]+ +-?[0-9]+ (leaf|inner) / {
    p = "way." steps++
    equal("node", $1, v[p ".node"])
    equal("record", $2, v[p ".record"] == "null" ? -1 : v[p ".record"])
    equal("kind", $3, v[p ".leaf"] == "true" ? "leaf" : "inner")
    text = words_from(4)
    wanted = note(p)
    if (wanted ~ /^(entered|SKIPPED)/) {
        equal("box test of a node", substr(text, 1, length(wanted)), wanted)
        number_is("entry of a node", $(wanted ~ /^entered/ ? 7 : 6), "%.9g", p ".entry")
    } else
        equal("box test of a node", text, wanted)
    if (v[p ".children"] != "ok") {
        getline
        equal("children", words_from(1), "its children are not the tree's" (v[p ".children"] == "truncated" ? ": cut to fewer bits" : ""))
    }
    next
}
on_way && /^node [0-9]+, record / {
    p = "way." v["last"]
    equal("page of node", $2, v[p ".node"] ",")
    equal("its record", $4, v[p ".record"] ",")
    for (text = k = 0; k < v[p ".words.count"]; k++) equal("word " k, $(6 + k), v[p ".words." k])
    equal("words", NF - 5, v[p ".words.count"])
    on_node = 1
    next
}
on_node && /^  [xyz] (lo|hi) / { bounds++; bound_is($1 " " $2, p "." $2 "." index("xyz", $1) - 1, $2 == "lo" ? -1 : 1); next }
$0 == "  (the last two: steps outward from the triangles' bound to the bytes')" { meaning++; next }
on_node && /^  [xyz]  / {
    q = p ".slab." index("xyz", $1) - 1
    slabs++
    number_is("enter " $1, $2, "%.9g", q ".enter")
    number_is("leave " $1, $3, "%.9g", q ".leave")
    for (k = 4; k <= 5; k++) {
        text = v[q (k == 4 ? ".exact_enter" : ".exact_leave")]
        if (text == "null") truth("exact slab " $1 ": " $k, $k ~ /inf|nan/)
        else equal("exact slab " $1, $k, sprintf("%.17g", text))
    }
    next
}
/^  box test: entry / {
    sub(/,$/, "", $4)
    number_is("entry", $4, "%.9g", p ".entry")
    sub(/,$/, "", $9)
    number_is("best t", $9, "%.9g", p ".best")
    equal("box test", words_from(10), v[p ".hit"] == "true" ? "hit" : "no hit")
    next
}
/^triangle [0-9]+ exactly: / {
    exactly[$2]++
    class = $4
    sub(/,$/, "", class)
    truth("class " class, index(classes, " " class " "))
    if ($2 == v["truth.prim"]) {
        equal("class of the truth", class, v["truth.class"])
        equal("t of the truth", $7 " " $8, sprintf("[%.17g, %.17g],", v["truth.t_lo"], v["truth.t_hi"]))
    }
    next
}
/^  its formula: t = / {
    formulas++
    text = words_from(index($0, ";") ? 11 : 1)
    truth("formula: " text, text ~ /^(certainly a hit|hit or miss within its rounding|certainly no hit)(, the determinant's sign is open)?$/)
    next
}
/^cause     / {
    told = 1
    split($2, part, ":")
    equal("cause", part[1], v["cause"])
    next
}
# A repair that changes something; those of the JSON in their order.
told && /^  [a-z0-9_]+ +[^ ].*: ((allowed|wrong), [^:]*|right)$/ {
    while (tried < v["tried.count"] && v["tried." tried ".changed"] == "false") tried++
    q = "tried." tried++
    changed++
    equal("cause of a repair", $1, v[q ".cause"])
    at = index($0, v[q ".repair"] ": ")
    truth("repair " v[q ".repair"] " in: " $0, at)
    text = substr($0, at + length(v[q ".repair"]) + 2)
    at = match(text, /: ((allowed|wrong), [^:]*|right)$/)
    equal("opinion of a repair", substr(text, at), ": " (v[q ".allowed"] == "true" ? (v[q ".verdict"] == "right" ? "" : "allowed, ") : "wrong, ") v[q ".verdict"])
    if (v[q ".finished"] == "true") hit_is("answer of a repair", substr(text, 1, at - 1), q ".answer")
    else equal("answer of a repair", substr(text, 1, at - 1), "not finished")
    next
}
/^(lost by[?]|        )   .* [(][a-z_0-9]+[)]$/ && v["hints.count"] > hints {
    q = "hints." hints++
    equal("hint", substr($0, 12), v[q ".text"] " (" v[q ".cause"] ")")
    equal("title of a hint", substr($0, 1, 8), hints == 1 ? "lost by?" : "        ")
    next
}
/^lost by[?]/ { bad("a hint that the JSON has not: " $0) }
/^again     raydiff / { again++; next }
END {
    floats_are_their_bits()
    equal("lines that show how to get the page again", again, 1)
    equal("nodes of the way", steps + 0, goal == "" ? 0 : v["last"] + 1)
    if (on_node) {
        equal("bounds of the node", bounds, 6)
        equal("slabs of the node", slabs, 3)
        equal("meaning of the steps", meaning, 1)
    }
    truth("a page of the node where the way ended", (v["end"] ~ /^(box|skipped)$/) == on_node + 0)
    if (goal != "") equal("pages of the triangle", exactly[goal], 1)
    if (v["answer.prim"] != "null") equal("pages of the answer", exactly[v["answer.prim"]], 1)
    equal("hints", hints + 0, v["hints.count"])
    # Only an engine whose tree is unknown and that answers a miss has lost what is exactly hit.
    equal("hints", v["hints.count"], lost && v["answer.prim"] == "null" && v["truth.prim"] != "null" ? lost : 0)
    while (tried < v["tried.count"]) if (v["tried." tried++ ".changed"] == "true" && v["inside"] == "true") bad("a repair is not printed")
    print "explain: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
