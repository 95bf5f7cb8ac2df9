# `raydiff render --show` of one or two layouts against its CSV, where every pixel's value stands:
# awk -f lib.awk -f pixels.awk -f paths.awk -f floats.awk -f show.awk FLAT a.pixels [a.csv] s.csv TEXT
# a.csv: the paths of the first layout, of which t and prim must be those of the first segments.
function sort(count,  i, k, x) {
    for (i = 2; i <= count; i++) {
        x = sorted[i]
        for (k = i - 1; k >= 1 && sorted[k] > x; k--) sorted[k + 1] = sorted[k]
        sorted[k + 1] = x
    }
}
# The value of rank ceil(part * count).
function ranked(count, hundredths) { return sorted[int((count * hundredths + 99) / 100)] }
# Statistics of a column against the JSON at `p`.
function statistics(column, p, name,  i, n, sum, most, most_at) {
    for (i = 0; i < rows; i++) {
        if (cell[i, column] == "") continue
        sorted[++n] = cell[i, column] + 0
        sum += cell[i, column]
        if (n == 1 || cell[i, column] + 0 > most) {
            most = cell[i, column] + 0
            most_at = i
        }
    }
    sort(n)
    equal(name "pixels", v[p ".pixels"], n + 0)
    if (n == 0) return
    roughly(name "sum", v[p ".sum"], sum)
    roughly(name "mean", v[p ".mean"], sum / n)
    near(name "least", v[p ".least"], sorted[1])
    near(name "median", v[p ".median"], ranked(n, 50))
    near(name "99 %", v[p ".p99"], ranked(n, 99))
    near(name "most", v[p ".most"], most)
    place[p] = most_at % v["width"] "," int(most_at / v["width"]) ";"
}
function roughly(what, number, is) { truth(what ": " number ", and computed anew " is, (number - is) ^ 2 <= 1e-10 * (is * is + 1e-6)) }
# A line of statistics, against the JSON at `p`.
function line(p, first, name,  whole) {
    whole = v["show"] ~ /^(prim|boxes|triangles|depth|overlap|class)/ ? "%.0f" : "%.6g"
    same(name "sum", $first, whole, v[p ".sum"])
    same(name "least", $(first + 1), whole, v[p ".least"])
    same(name "mean", $(first + 2), "%.6g", v[p ".mean"])
    same(name "median", $(first + 3), whole, v[p ".median"])
    same(name "99 %", $(first + 4), whole, v[p ".p99"])
    same(name "most", $(first + 5), whole, v[p ".most"])
    equal(name "place of the most", $(first + 7), place[p])
    equal(name "pixels", $(first + 8) " " $(first + 10), v[p ".pixels"] " " v["width"] * v["height"])
    lines++
}
# Where to look closer: the first five pixels of the column that are not `plain`, with their names if `named`.
function places(column, plain, named,  i, n, text) {
    for (i = 0; i < rows && n < 5; i++)
        if (cell[i, column] != "" && cell[i, column] != plain)
            text = text (n++ ? ", " : "") i % v["width"] "," int(i / v["width"]) (named ? " " cell[i, column] : "")
    return text (n == 5 ? ", ..." : "")
}
function layer_name(l) { return ("layers." l ".layout") in v ? v["layers." l ".layout"] : v["layers." l ".engine"] }
# Between the normals of a pixel, which have three columns each.
function degrees(i,  k, a, b, dot, cross) {
    for (k = 0; k < 3; k++) {
        a = (k + 1) % 3
        b = (k + 2) % 3
        dot += cell[i, 3 + k] * cell[i, 6 + k]
        cross += (cell[i, 3 + a] * cell[i, 6 + b] - cell[i, 3 + b] * cell[i, 6 + a]) ^ 2
    }
    return atan2(sqrt(cross), dot) * 180 / 3.14159265358979
}
# Two layers, pixel by pixel.
function two(  i, more, less, one, d, count, different) {
    d = columns
    for (i = 0; i < rows; i++) {
        one += (cell[i, 3] == "") != (cell[i, 3 + planes] == "")
        more += cell[i, d] != "" && cell[i, d] + 0 > 0
        less += cell[i, d] != "" && cell[i, d] + 0 < 0
        if (planes > 1 && cell[i, 3] != "" && cell[i, 6] != "")
            truth("degrees at " i, (cell[i, d] - degrees(i)) ^ 2 < 1e-4)
        if (planes > 1) continue
        different += cell[i, 3] != cell[i, 4]
        if (names) {
            if (cell[i, 3] != "" || cell[i, 4] != "") equal("difference of names", cell[i, d], cell[i, 3] == cell[i, 4] ? 0 : 1)
        } else if (cell[i, 3] != "" && cell[i, 4] != "")
            truth("difference at " i, (cell[i, d] - (cell[i, 4] - cell[i, 3])) ^ 2 <= 1e-12 * (cell[i, 3] ^ 2 + cell[i, 4] ^ 2))
        else
            equal("no difference at " i, cell[i, d], "")
    }
    equal("only one has a value", v["difference.only_one"], one + 0)
    if (names) {
        equal("different", v["difference.different"], different + 0)
        equal("different in the difference", different + 0, more + 0)
        return
    }
    equal("more", v["difference.more"], more + 0)
    equal("less", v["difference.less"], less + 0)
    statistics(d, "difference.values", "difference ")
}
function first_segments(  i, at, hit) {
    for (i = 0; i < rows; i++) {
        at = 0 SUBSEP i % v["width"] SUBSEP int(i / v["width"])
        split(segment[0, at, 0], hit, SUBSEP)
        if (hit[2] == "") equal("nothing hit at " i, cell[i, 3], "")
        else if (v["show"] == "prim") equal("triangle at " i, cell[i, 3], hit[2])
        else same("t at " i, cell[i, 3], "%.9g", float_number(hit[1]))
        compared++
    }
}
# Normals have length 1.
function lengths(  i, l, k, square) {
    for (i = 0; i < rows; i++)
        for (l = 0; l < v["layers.count"]; l++) {
            if (cell[i, 3 + 3 * l] == "") continue
            square = 0
            for (k = 0; k < 3; k++) square += cell[i, 3 + 3 * l + k] ^ 2
            truth("length of the normal at " i, (square - 1) ^ 2 < 1e-10)
        }
}
function verdicts(l,  i, k, count, name) {
    for (i = 0; i < rows; i++) count[cell[i, 3 + l]]++
    for (k in v) {
        if (index(k, "layers." l ".verdicts.") != 1) continue
        name = substr(k, length("layers." l ".verdicts.") + 1)
        equal(layer_name(l) " " name, v[k], count[name] + 0)
        sum[l] += v[k]
    }
    equal(layer_name(l) " verdicts in all", sum[l], rows)
}
function laws(  l) {
    planes = v["show"] == "normal" ? 3 : 1
    names = v["show"] == "class" || v["show"] == "prim"
    equal("lines of CSV", rows, v["width"] * v["height"])
    equal("columns of CSV", columns, 2 + planes * v["layers.count"] + (v["layers.count"] == 2))
    for (l = 0; l < v["layers.count"]; l++) {
        if (planes == 1) equal("head of CSV", head[3 + l], layer_name(l))
        if (!names && planes == 1) statistics(3 + l, "layers." l ".values", layer_name(l) " ")
        if (v["show"] == "class") verdicts(l)
        if (v["show"] ~ /^(boxes|triangles)$/) equal("counted", v["layers." l ".counted." v["show"]], v["layers." l ".values.sum"] + 0)
    }
    if (v["layers.count"] == 2) two()
    if ((0, 0) in in_all && v["show"] ~ /^(t|prim)$/) first_segments()
    if (planes == 3) lengths()
}
function what_of(show) {
    if (show == "t") return "distance of the hit along its ray"
    if (show == "prim") return "which triangle was hit"
    if (show == "normal") return "the shading normal"
    if (show == "boxes" || show == "triangles") return show " tested"
    if (show == "depth") return "most entries on the traversal stack"
    if (show == "overlap") return "boxes of leaves that the hit point lies in"
    if (show == "overlap-all") return "boxes of leaves and inner nodes that it lies in"
    if (show == "inflation") return "surface of the boxes tested over that of their triangles' bounds, mean"
    if (show == "error") return "error of t in units of its proven bound: above 1 is a bug"
    return "verdict of the judge"
}
FILENAME ~ /s\.csv$/ {
    n = split($0, field, ",")
    if (FNR == 1) {
        columns = n
        for (k = 1; k <= n; k++) head[k] = field[k]
        next
    }
    equal("columns", n, columns)
    equal("place", field[1] "," field[2], rows % v["width"] "," int(rows / v["width"]))
    for (k = 3; k <= n; k++) cell[rows + 0, k] = field[k]
    rows++
    next
}
FNR == 1 {
    laws()
    equal("scene, and what it shows", $0, v["scene"] ": " what_of(v["show"]))
    next
}
!names && planes == 1 && $1 == layer_name(0) { line("layers.0.values", 2, $1 " "); next }
!names && planes == 1 && v["layers.count"] == 2 && $1 == layer_name(1) && $2 == "-" { line("difference.values", 4, "difference "); next }
!names && planes == 1 && v["layers.count"] == 2 && $1 == layer_name(1) { line("layers.1.values", 2, $1 " "); next }
/^degrees between / { line("difference.values", 3, "degrees "); next }
/^([a-z0-9_]+: )?pixels [0-9]+,[0-9]+/ {
    text = $0
    sub(/^[^,]*pixels /, "", text)
    if ($1 == "pixels") equal("places that differ", text, places(columns, "0", 0))
    else equal("places of " $1, text, places($1 == layer_name(0) ":" ? 3 : 4, "right", 1))
    placed++
    next
}
/: more in [0-9]+ pixels, less in / {
    equal("more", $4, v["difference.more"])
    equal("less", $NF, v["difference.less"])
    next
}
/^only one of them has a value in / { equal("only one", $(NF - 1), v["difference.only_one"]); next }
/: different in [0-9]+ of [0-9]+ pixels$/ {
    equal("different", $(NF - 3) " " $(NF - 1), v["difference.different"] " " v["width"] * v["height"])
    lines++
    next
}
/: engine .* counted / {
    l = $1 == layer_name(0) ":" ? 0 : 1
    equal("boxes counted", $5, v["layers." l ".counted.boxes"])
    equal("triangles counted", $7, v["layers." l ".counted.triangles"])
    next
}
names && ("layers.0.verdicts." $1) in v {
    for (l = 0; l < v["layers.count"]; l++) equal($1 " of " layer_name(l), $(2 + l), v["layers." l ".verdicts." $1])
    lines++
    next
}
/: [0-9]+ x [0-9]+$/ {
    equal("picture", substr($1, 1, length($1) - 1), v["picture"])
    if (width[0]) equal("size of the picture", $2 " " $4, width[0] " " height[0])
}
END {
    truth("lines", lines > 0)
    for (l = 0; l < v["layers.count"] && v["show"] == "class"; l++) to_place += places(3 + l, "right", 1) != ""
    if (names && v["layers.count"] == 2) to_place += places(columns, "0", 0) != ""
    equal("lines of places", placed + 0, to_place + 0)
    print "show " v["show"] ": " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
