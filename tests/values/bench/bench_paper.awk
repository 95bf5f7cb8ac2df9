# The text of `raydiff bench paper` against its JSON; of one frame a ratio is that of two times:
# awk -v rounds=N -f lib.awk -f bench_paper.awk FLAT TEXT
function row_of(kind, field, value,  i) {
    for (i = 0; i < v["rows.count"]; i++)
        if (v["rows." i ".benchmark"] == kind && v["rows." i ".scene"] == scene && v["rows." i "." field] == value) return "rows." i
    return ""
}
function ms(line) { return v[row_of("paper_frames", "line", line) ".median_ms"] }
# Bytes of Figure 8, by hand.
function figure(p) {
    equal("geometry", v[p ".geometry"], 16 * v[p ".triangles"] + 40)
    equal("with vertices", v[p ".with_vertices"], 16 * (v[p ".triangles"] + 1) + 32 * v[p ".vertices"])
    equal("direct", v[p ".direct"], 48 * v[p ".direct_nodes"])
    equal("RF", v[p ".rf"], 16 * (3 * v[p ".rf_leaves"] - 1))
    equal("leaves", v[p ".direct_leaf"] " " v[p ".rf_leaf"], "2 4")
    if (v[p ".mesh"] == "the paper's")
        equal("published", v[p ".geometry"] " " v[p ".direct"] " " v[p ".rf"], v[p ".geometry_paper"] " " v[p ".direct_paper"] " " v[p ".rf_paper"])
}
# "WHAT bytes published of-geometry % with-vertices %"
function figure_line(p, what) {
    equal(what, $(NF - 5) " " $(NF - 4), v[p "." what] " " v[p "." what "_paper"])
    same(what " of geometry", $(NF - 3), "%.1f", 100 * v[p "." what] / v[p ".geometry"])
    same(what " with vertices", $(NF - 1), "%.1f", 100 * v[p "." what] / v[p ".with_vertices"])
}
function same_tree(p) {
    equal("nodes of a tree", $2 " " $3 " " $4 " " $5, v[p ".nodes"] " " v[p ".leaves"] " " v[p ".depth"] " " v[p ".largest_leaf"])
    equal("bytes of a tree", $6 " " $7 " " $8 " " $9, v[p ".direct48"] " " v[p ".plain32"] " " v[p ".plain32"] + v[p ".items"] " " v[p ".rf16"])
    same("48 : 16", $10, "%.3f", v[p ".direct48"] / v[p ".rf16"])
    same("32 : 16", $11, "%.3f", v[p ".plain32"] / v[p ".rf16"])
    same("+items : 16", $12, "%.3f", (v[p ".plain32"] + v[p ".items"]) / v[p ".rf16"])
    equal("forms", v[p ".direct48"] " " v[p ".plain32"] " " v[p ".rf16"], 48 * v[p ".nodes"] " " 32 * v[p ".nodes"] " " 16 * (3 * v[p ".leaves"] - 1))
    equal("a binary tree", v[p ".nodes"], 2 * v[p ".leaves"] - 1)
}
function ratio(what, text, span, number, least, most,  format) {
    format = number < 0.1 ? "%.2g" : "%.3f"
    same(what, text, format, number)
    same_span(what, span, format, least, most)
}
function line(p, name,  word, n, k, other) {
    n = split(substr($0, 28), word, " ")
    equal(name "bytes", word[1], v[p ".bytes"])
    same(name "average", word[2], "%.3f", v[p ".average_ms"])
    same(name "least", word[3], "%.3f", v[p ".min_ms"])
    same(name "most", word[4], "%.3f", v[p ".max_ms"])
    same(name "median", word[5], "%.3f", v[p ".median_ms"])
    equal(name "apart from cpu", word[6], v[p ".cpu_paths_apart"] == "null" ? "-" : v[p ".cpu_paths_apart"] "/" v[p ".cpu_pixels_apart"])
    equal(name "wrong", word[7], v[p ".pixels_wrong"])
    truth(name "pixels", v[p ".pixels_wrong"] <= v[p ".pixels"] && (v[p ".cpu_pixels_apart"] == "null" || v[p ".cpu_pixels_apart"] <= v[p ".pixels"]))
    truth(name "clock", index($0, v[p ".clock"]) > 0)
    if (v[p ".layout"] == "f32") equal(name "bytes of nodes and items", v[p ".bytes"], 32 * v[p ".nodes"] + 4 * triangles)
    if (v[p ".layout"] ~ /^(rf16|rtrs_rf)$/ && v[p ".line"] != "blank") equal(name "bytes of records", v[p ".bytes"], 16 * (3 * (v[p ".nodes"] + 1) / 2 - 1))
    if (v[p ".layout"] == "rtrs_direct") equal(name "bytes of nodes", v[p ".bytes"], 48 * v[p ".nodes"])
    if (v[p ".line"] == v[p ".ratio_to"]) return
    ratio(name "ratio", word[8], word[9], v[p ".ratio_median"], v[p ".ratio_min"], v[p ".ratio_max"])
    truth(name "to what", index($0, ") of " v[p ".ratio_to"]) > 0)
    if (rounds == 1) near(name "ratio", v[p ".ratio_median"], v[p ".median_ms"] / ms(v[p ".ratio_to"]))
}
# "TEXT 12.3 % less time (ratio 1.140, 1.120-1.160)": of the time of `from` to that of `to`.
function saved(from, to,  x, text) {
    if (ms(from) == "" || ms(from) == "null" || ms(to) == "" || ms(to) == "null") { bad("told of what was not measured: " from ", " to); return }
    x = ms(from) / ms(to)
    text = $0
    sub(/.*: +/, "", text)
    split(text, word, /[ ,()]+/)
    if (rounds != 1) return
    same(from " to " to, word[6], "%.3f", x)
    same(from " to " to " saves", word[1], "%.1f", x >= 1 ? 100 * (1 - 1 / x) : 100 * (1 / x - 1))
    equal(from " to " to, word[3], x >= 1 ? "less" : "more")
    sayings++
}
/: the paper's default scene, [0-9]+ triangles, / {
    scene = substr($0, 1, index($0, ": ") - 1)
    p = row_of("figure8", "mesh", "the paper's")
    triangles = $(NF - 3)
    equal("triangles and vertices", triangles " " $(NF - 1), v[p ".triangles"] " " v[p ".vertices"])
    figure(p)
    next
}
/^  geometry, 16 n \+ 40 / { figure_line(p, "geometry"); next }
/^  direct, leaf [0-9]+: [0-9]+ nodes of 48 / {
    equal("nodes", $3 $4, v[p ".direct_leaf"] ":" v[p ".direct_nodes"])
    figure_line(p, "direct")
    next
}
/^  RF, leaf [0-9]+: [0-9]+ records of 16 / {
    equal("records", $3 $4, v[p ".rf_leaf"] ":" 3 * v[p ".rf_leaves"] - 1)
    figure_line(p, "rf")
    next
}
/^  leaf  *nodes leaves/ { trees = 1; next }
trees && /^ +[0-9]+ +[0-9]+/ { same_tree(row_of("same_tree", "leaf", $1)); told_trees++; next }
/^  ms per frame  *bytes/ { trees = 0; lines = 1; next }
/^  cpu: paths\/pixels/ { lines = 0 }
/^  wrong: pixels of [0-9]+ / { equal("pixels", $4, v[row_of("paper_frames", "line", "naive") ".pixels"]) }
lines && /^  / {
    name = substr($0, 3, 24)
    sub(/ *$/, "", name)
    p = row_of("paper_frames", "line", name)
    truth("line " name, p != "")
    if (v[p ".left_out"] != "null") truth(name " is left out", index($0, v[p ".left_out"]) > 0)
    else { line(p, name " "); measured++ }
    told_lines++
    next
}
/ of time saved that is [0-9.]+$/ {
    # As published: from the numbers that stand before it.
    same("the paper's 19 % of the default scene", $NF, "%.1f", 100 * (1 - $18 / $16))
    large = 100 * (1 - substr($24, 1, length($24) - 1) / $22)
}
/^and [0-9.]+ %, and the two have other leaf sizes/ { same("the paper's 19 % of the teapot", $2, "%.1f", large) }
/^ as published, / { section = "direct" }
/^ once the box test culls, / { section = "repaired" }
/^  RF \(leaf 4\) against direct \(leaf 2\):/ { saved("direct, leaf 2", "RF, leaf 4") }
/^  the layout alone, same tree, leaf 4:/ {
    if (section == "direct") saved("direct, leaf 4", "RF, leaf 4")
    else saved("f32, leaf 4", "rf16, leaf 4")
}
/^  direct alone, leaf 4 against leaf 2:/ { saved("direct, leaf 2", "direct, leaf 4") }
/^  RF against direct, whole paths:/ { saved("direct, leaf 2, whole", "RF, leaf 4, whole") }
/^  the naive handler, never timed, against RF:/ { saved("RF, leaf 4", "naive") }
/^  rf16, leaf 4, against f32, leaf 2:/ { saved("f32, leaf 2", "rf16, leaf 4") }
/^  the layout alone, same tree, leaf 2:/ { saved("f32, leaf 2", "rf16, leaf 2") }
/^  whole paths: rf16, leaf 4, to f32, leaf 2:/ { saved("f32, leaf 2, whole", "rf16, leaf 4, whole") }
/^  whole paths: the layout alone, leaf 4:/ { saved("f32, leaf 4, whole", "rf16, leaf 4, whole") }
/^  whole paths: the layout alone, leaf 2:/ { saved("f32, leaf 2, whole", "rf16, leaf 2, whole") }
/^  repaired rf16 against published RF:/ { saved("RF, leaf 4", "rf16, leaf 4") }
/^  the same, whole paths against published RF:/ { saved("RF, leaf 4", "rf16, leaf 4, whole") }
END {
    equal("trees", told_trees, 4)
    equal("lines and rows", told_lines + told_trees + 1, v["rows.count"])
    if (measured == told_lines && rounds == 1) equal("words", sayings, 13)
    print "bench paper: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
