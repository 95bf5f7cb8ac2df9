# `raydiff diff SCENE --engine A,B` against the paths and the pictures that `raydiff render` makes with each:
# awk -f lib.awk -f pixels.awk -f paths.awk -f diff_engines.awk FLAT a.csv b.csv a.pixels b.pixels TEXT
# Paths part where another triangle is hit, or another light is asked for or in a shadow.
function count_paths(  y, x, at, i, n, a, b, none, apart, parts) {
    split("t triangle asked shadowed", field_name, " ")
    for (y = 0; y < v["height"]; y++) for (x = 0; x < v["width"]; x++) {
        at = 0 SUBSEP x SUBSEP y
        n = of_path[0, at] > of_path[1, at] ? of_path[0, at] : of_path[1, at]
        apart = parts = 0
        for (i = 0; i < n; i++) {
            none = "" SUBSEP "none" SUBSEP 0 SUBSEP 0
            split((0, at, i) in segment ? segment[0, at, i] : none, a, SUBSEP)
            split((1, at, i) in segment ? segment[1, at, i] : none, b, SUBSEP)
            is["segments"]++
            hits += (a[2] != "" && a[2] != "none") || (b[2] != "" && b[2] != "none")
            for (k = 1; k <= 4; k++) {
                is[field_name[k]] += a[k] "" != b[k] ""
                apart += a[k] "" != b[k] ""
                parts += k > 1 && a[k] "" != b[k] ""
            }
        }
        is["paths_that_part"] += parts > 0
        is["paths_different"] += apart > 0
    }
    is["paths"] = v["width"] * v["height"]
}
function laws(p,  k, sum, allowed) {
    for (k in v) {
        if (index(k, p ".why.") == 1) sum += v[k]
        if (index(k, p ".allowed.") == 1) allowed += v[k]
    }
    equal("reasons in all", sum, v[p ".to_explain"])
    equal("allowed in all", allowed + 0, v[p ".why.allowed"])
    faults = v[p ".why.wrong"] + v[p ".why.renderer"] + v[p ".why.unexplained"]
    equal("agrees", v[p ".agrees"], faults == 0 && v[p ".vacuous"] == "false" ? "true" : "false")
    truth("vacuous", v[p ".vacuous"] == "false" || (faults == 0 && v[p ".paths_different"] == 0))
    truth("values differ, but by nothing", (v[p ".values_different"] > 0) == (v[p ".largest"] > 0))
    truth("to explain", v[p ".to_explain"] >= v[p ".paths_different"] && v[p ".to_explain"] <= v[p ".paths"])
    split("same rounding allowed drift published renderer wrong unexplained", kind, " ")
    for (k = 1; k <= 8; k++) {
        sum = v[p ".pixels." kind[k] ".count"]
        equal("listed of " kind[k], sum, v[p ".why." kind[k]] < 16 ? v[p ".why." kind[k]] : 16) # PAIR_KEPT
    }
    if (v[p ".reference"] != "cpu" || v[p ".engine"] != engine) return
    count_paths()
    differences()
    for (k = split("paths paths_different segments triangle t asked shadowed", name, " "); k > 0; k--)
        equal(name[k] " of paths", v[p "." name[k]], is[name[k]] + 0)
    equal("paths that part", v[p ".to_explain"] - v[p ".why.same"] - v[p ".why.rounding"] - v[p ".why.renderer"], is["paths_that_part"] + 0)
    equal("values that differ", v[p ".values_different"], is["different"] + 0)
    equal("largest", v[p ".largest"], is["largest"] + 0)
    compared++
}
# The engine that is named has the verdict. With "border" both can be right, on either side of a light.
function blamed(q, engine,  a, class) {
    a = v[q ".answers.0.engine"] == engine ? 0 : 1
    class = v[q ".class"]
    if (class == "renderer") return
    equal(q " of whom", engine, v[q ".answers." a ".engine"])
    if (class == "wrong" || class == "published") equal(q " is wrong", v[q ".answers." a ".verdict"], "wrong")
    else if (class != "border" || v[q ".answers." 1 - a ".verdict"] != "right") equal(q " has the verdict", v[q ".answers." a ".verdict"], class)
    named[class]++
}
# Both answers to their own rays against the truth. Of a shadow ray any hit is right.
function answers(q,  a, p, t, closest) {
    closest = v[q ".light"] == "null" || v["profile"] == "rtrs"
    for (a = 0; a < 2; a++) {
        p = q ".answers." a
        if (v[p] == "null") continue
        equal(p " kind of WRONG", v[p ".wrong"] == "not", v[p ".verdict"] != "wrong")
        if (closest && v[p ".verdict"] == "right") equal(p " is the triangle", v[p ".answer.prim"], v[p ".expected"])
        if (v[p ".expected"] == "null") continue
        truth(p " interval of t", v[p ".t_lo"] + 0 <= v[p ".t_hi"] + 0)
        t = v[p ".answer.t.value"]
        if (closest && v[p ".verdict"] == "right") truth(p " t", (t - v[p ".t_lo"]) ^ 2 < 1e-8 * t * t)
    }
}
# "WRONG missed cpu o=... => miss  expected: prim=32 t=9.59" and its command, of the pixel told of last.
function wrong_answer(  a, p) {
    a = v[told_of ".answers.0.engine"] == $3 ? 0 : 1
    p = told_of ".answers." a
    equal(p " who is wrong", $3, v[p ".engine"])
    equal(p " verdict", v[p ".verdict"] " " v[p ".wrong"], "wrong " $2)
    if (match($0, /=> (miss|prim=[0-9]+)/)) equal(p " answer", substr($0, RSTART + 3, RLENGTH - 3), v[p ".answer.prim"] == "null" ? "miss" : "prim=" v[p ".answer.prim"])
    if (match($0, /expected: prim=[0-9]+ t=[^ ]+/)) {
        split(substr($0, RSTART, RLENGTH), word, /[ =]/)
        equal(p " expected", word[3], v[p ".expected"])
        truth(p " expected t", (word[5] - v[p ".t_lo"]) ^ 2 < 1e-24 * word[5] ^ 2)
    }
    told_wrong = p
}
# The rest of such a line: "; pictures part at segment 0 (t); rays at segment 1, light 2, of cpu".
function details(q,  text, word) {
    if (match($0, /; pictures part at segment [0-9]+ \([a-z]+\)/)) {
        split(substr($0, RSTART + 2, RLENGTH - 3), word, /[ (]+/)
        equal(q " pictures part", word[5] " " word[6], v[q ".picture_segment"] " " v[q ".picture_field"])
    } else
        equal(q " pictures do not part", v[q ".picture_field"], "same")
    if (match($0, /; rays at segment [0-9]+(, light [0-9]+)?/)) {
        n = split(substr($0, RSTART + 2, RLENGTH - 2), word, /[ ,]+/)
        equal(q " rays part", word[4] " " (n > 4 ? word[6] : "null"), v[q ".segment"] " " v[q ".light"])
    } else
        truth(q " where rays part is not told", v[q ".class"] == "rounding" || v[q ".class"] == "same" || v[q ".class"] == "renderer")
    if (match($0, /, of [^ ,]+$/)) blamed(q, substr($0, RSTART + 5))
    else truth(q " no engine is named", v[q ".class"] ~ /^(same|rounding|drift|unexplained)$/)
    told_of = q
    described++
}
# What is listed of a kind: place and value of each pixel.
function listed(p, kind,  k, q, i, before) {
    for (k = 0; k < v[p ".pixels." kind ".count"]; k++) {
        q = p ".pixels." kind "." k
        i = v[q ".y"] * v["width"] + v[q ".x"]
        if (k > 0) truth(q " is behind the pixel before", i > before)
        before = i
        if (!(q in answered)) answers(q)
        answered[q] = 1
        if (v[p ".engine"] == engine) equal("value of a pixel that is listed", v[q ".value_difference"], channels_apart(i))
        if ($2 == v[q ".x"] "," v[q ".y"] && $3 == v[q ".class"] ":") {
            equal("value of " $2, $7 + 0, v[q ".value_difference"])
            details(q)
            shown++
        }
    }
}
FNR == 1 {
    at = match($0, /: [0-9]+ triangles; /)
    equal("scene", substr($0, 1, at - 1), v["scene"])
    split(substr($0, at + 2), word, /[ ,;]+/)
    equal("triangles", word[1], v["triangles"])
    equal("size", word[3] " " word[5], v["width"] " " v["height"])
    equal("profile", word[8], v["profile"])
    equal("bounces", word[9], v["bounces"])
    equal("lights", word[11], v["lights"])
    next
}
/ against .*: / {
    p = "pairs." r++
    equal("engine", $1, v[p ".engine"])
    equal("reference", $3, v[p ".reference"] ":")
    equal("demanded", /the same bits are demanded/ ? "true" : "false", v[p ".same_bits_demanded"])
    laws(p)
    next
}
/^tree: builder / {
    gsub(",", "")
    equal("tree", $5 " " $NF, v["layout"] " " v["tri"])
    trees++
}
/^    WRONG / { wrongs++; wrong_answer() }
/^    explain: / { equal("command", substr($0, 14), v[told_wrong ".explain"]) }
/^  (as it should be|DIFFERS|vacuous: .*)$/ {
    ends++
    equal("it agrees", $1 == "as" ? "true" : "false", v[p ".agrees"])
    equal("it is vacuous", $1 == "vacuous:" ? "true" : "false", v[p ".vacuous"])
    if (v[p ".vacuous"] == "true") equal("exit code of what is vacuous", v["exit"], 1)
}
$1 ~ /^(paths|segments|values|explained|faults)$/ { lines++ }
$1 == "paths" { equal("paths", $2 " " $4, v[p ".paths_different"] " " v[p ".paths"]) }
$1 == "segments" {
    gsub(",", "")
    equal("segments", $2 " " $6 " " $8 " " $11 " " $13, v[p ".segments"] " " v[p ".triangle"] " " v[p ".t"] " " v[p ".asked"] " " v[p ".shadowed"])
}
$1 == "values" {
    gsub(/[,;]/, "")
    equal("values", $2 " " $4 " " $8, v[p ".values_different"] " " v[p ".paths"] " " v[p ".largest"])
    equal("at a border, and beyond", $13 " " $(NF - 1), v[p ".at_a_border"] " " v[p ".beyond_the_bound"])
}
$1 == "explained" {
    text = $0
    sub(/^[^:]*: /, "", text)
    explained = 0
    count = split(text, part, ", ")
    for (k = 1; k <= count; k++) {
        n = split(part[k], word, " ")
        what = word[1]
        if (what == "same" || what == "rounding" || what == "drift") equal(what, word[n], v[p ".why." what])
        else if (what == "wrong") equal("wrong as published", word[n], v[p ".why.published"])
        else equal(what, word[n], v[p ".allowed." what])
        explained += word[n]
    }
    equal("explained", $2, explained)
    equal("to explain", $4, v[p ".to_explain"])
    equal("classes", count, 12)
}
$1 == "faults" {
    gsub(/[,;]/, "")
    equal("faults", $4 " " $10 " " $12, v[p ".why.wrong"] " " v[p ".why.renderer"] " " v[p ".why.unexplained"])
    same("err/E", $NF, "%.3g", v[p ".err_over_bound"])
}
/^  pixel [0-9]+,[0-9]+ [a-z_ ]+: values differ by/ {
    shown = 0
    for (i = split("same rounding allowed drift published renderer wrong unexplained", of, " "); i > 0; i--) listed(p, of[i])
    equal("pixels of that place in JSON", shown, 1)
}
END {
    equal("lines", lines, 5 * r)
    equal("ends", ends, r)
    equal("line of the tree", trees, 1)
    # Of each kind four pixels are listed, of the answers of each those that are WRONG.
    for (i = 0; i < r; i++)
        for (k = split("same rounding allowed drift published renderer wrong unexplained", of, " "); k > 0; k--) {
            n = v["pairs." i ".why." of[k]]
            to_list += n < 4 ? n : 4
            for (n = 0; n < 4; n++)
                for (side = 0; side < 2; side++) to_wrong += v["pairs." i ".pixels." of[k] "." n ".answers." side ".verdict"] == "wrong"
        }
    equal("pixels listed", described + 0, to_list + 0)
    equal("answers WRONG", wrongs + 0, to_wrong + 0)
    equal("pairs", r, v["pairs.count"])
    truth("nothing is compared with paths", compared || engine == "none")
    print "diff of engines: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
