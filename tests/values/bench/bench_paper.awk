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
    says("tree ", "nodes", v[p ".nodes"])
    says("tree ", "leaves", v[p ".leaves"])
    says("tree ", "depth", v[p ".depth"])
    says("tree ", "largest", v[p ".largest_leaf"])
    says("tree ", "48", v[p ".direct48"])
    says("tree ", "32", v[p ".plain32"])
    says("tree ", "32+items", v[p ".plain32"] + v[p ".items"])
    says("tree ", "16", v[p ".rf16"])
    number("tree ", "48:16", "%.3f", v[p ".direct48"] / v[p ".rf16"])
    number("tree ", "32:16", "%.3f", v[p ".plain32"] / v[p ".rf16"])
    number("tree ", "+items:16", "%.3f", (v[p ".plain32"] + v[p ".items"]) / v[p ".rf16"])
    equal("forms", v[p ".direct48"] " " v[p ".plain32"] " " v[p ".rf16"], 48 * v[p ".nodes"] " " 32 * v[p ".nodes"] " " 16 * (3 * v[p ".leaves"] - 1))
    equal("a binary tree", v[p ".nodes"], 2 * v[p ".leaves"] - 1)
}
function line(p, name,  format) {
    phrase["of"] = v[p ".line"] == v[p ".ratio_to"] ? "-" : v[p ".ratio_to"]
    phrase["clock"] = v[p ".clock"]
    cells($0)
    says(name, "verdict", v[p ".cpu_paths_apart"] == "null" ? "-" : v[p ".cpu_paths_apart"] + v[p ".cpu_pixels_beyond_rounding"] > 0 ? "WRONG" : "agrees")
    number(name, "average", "%.3f", v[p ".average_ms"])
    number(name, "least", "%.3f", v[p ".min_ms"])
    number(name, "most", "%.3f", v[p ".max_ms"])
    number(name, "median", "%.3f", v[p ".median_ms"])
    says(name, "bytes", v[p ".bytes"])
    says(name, "cpu", v[p ".cpu_paths_apart"] == "null" ? "-" : v[p ".cpu_paths_apart"] "/" v[p ".cpu_pixels_apart"])
    says(name, "wrong", v[p ".pixels_wrong"])
    truth(name "what tells it apart", ("verdict" in cell) && ("wrong" in cell) && ("ratio" in cell) && ("of" in cell))
    if (v[p ".line"] == "blank") equal(name "wrong pixels, of which it has none", v[p ".pixels_wrong"], 0)
    truth(name "pixels", v[p ".pixels_wrong"] <= v[p ".pixels"] && (v[p ".cpu_pixels_apart"] == "null" || v[p ".cpu_pixels_apart"] <= v[p ".pixels"]))
    if (v[p ".layout"] == "f32") equal(name "bytes of nodes and items", v[p ".bytes"], 32 * v[p ".nodes"] + 4 * triangles)
    if (v[p ".layout"] ~ /^(rf16|rtrs_rf)$/ && v[p ".line"] != "blank") equal(name "bytes of records", v[p ".bytes"], 16 * (3 * (v[p ".nodes"] + 1) / 2 - 1))
    if (v[p ".layout"] == "rtrs_direct") equal(name "bytes of nodes", v[p ".bytes"], 48 * v[p ".nodes"])
    if (v[p ".line"] == v[p ".ratio_to"]) { says(name, "ratio", "-"); return }
    format = v[p ".ratio_median"] < 0.1 ? "%.2g" : "%.3f"
    number(name, "ratio", format, v[p ".ratio_median"])
    span(name, "of least-most", format, v[p ".ratio_min"], v[p ".ratio_max"])
    if (rounds == 1) near(name "ratio", v[p ".ratio_median"], v[p ".median_ms"] / ms(v[p ".ratio_to"]))
}
# "TEXT 12.3 % less (1.14, 1.12-1.16)": of the time of `from` to that of `to`.
function saved(from, to,  x, text) {
    if (ms(from) == "" || ms(from) == "null" || ms(to) == "" || ms(to) == "null") { bad("told of what was not measured: " from ", " to); return }
    x = ms(from) / ms(to)
    text = $0
    sub(/.*: +/, "", text)
    split(text, word, /[ ,()]+/)
    if (rounds != 1) return
    same(from " to " to, word[4], x < 99.995 ? "%.2f" : "%.0f", x)
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
/^leaf nodes / {
    heads($0)
    if (wide) equal("columns", columns, 12)
    trees = 1
    next
}
trees && /^ +[0-9]+ +[0-9]+/ { cells($0); same_tree(row_of("same_tree", "leaf", $1)); told_trees++; next }
/^verdict and cpu: / {
    lines = 0
    next
}
/^verdict / {
    heads($0)
    if (wide) equal("columns", columns, 13)
    trees = 0
    lines = 1
    next
}
/^wrong: pixels of [0-9]+ / { equal("pixels", $4, v[row_of("paper_frames", "line", "naive") ".pixels"]) }
/^  .*: left out: / {
    name = substr($0, 3, index($0, ": left out: ") - 3)
    p = row_of("paper_frames", "line", name)
    truth(name " is left out", p != "" && (!wide || index($0, v[p ".left_out"]) > 0))
    told_lines++
    next
}
lines && /^(agrees|WRONG|-) / {
    # The longest name that the row begins with.
    name = ""
    for (i = 0; i < v["rows.count"]; i++) {
        text = v["rows." i ".line"]
        if (text != "" && index(substr($0, 9), text " ") == 1 && length(text) > length(name)) name = text
    }
    p = row_of("paper_frames", "line", name)
    truth("line " name, p != "" && v[p ".left_out"] == "null")
    phrase["line"] = name
    line(p, name " ")
    measured++
    told_lines++
    next
}
/ ms: [0-9.]+ % of the time saved;$/ { # as published: from the numbers that stand before it
    same("the paper's 19 %", $5, "%.1f", 100 * (1 - $3 / $1))
    published = published " " $1 " " $3
}
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
    if (measured > 0) equal("published", published, " 6.168 5.069 258.567 214.569")
    if (measured == told_lines && rounds == 1) equal("words", sayings, 13)
    print "bench paper: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
