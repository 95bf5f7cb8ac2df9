# The text of `raydiff bench matrix` against its JSON; the first contestant is what ratios are to:
# awk -v rounds=N -f lib.awk -f bench_matrix.awk FLAT TEXT
function name_of() {
    text = substr($0, 3, 30)
    sub(/ *$/, "", text)
    return text
}
function part(what, text, bytes, known) {
    if (known) same(name what, text, "%.1f", bytes / v[p ".triangles"])
    else equal(name what, text, "-")
}
function speeds(  k, product, product_warm, ratio, warm, base) {
    product = product_warm = 1
    base = "rows." first
    split(substr($0, 33), word, " ")
    for (k = 1; k <= 5; k++) {
        ratio = p "." kind[k] "_ratio"
        same(name kind[k], word[2 * k - 1], "%.2f", v[ratio])
        same_span(name kind[k], word[2 * k], "%.2f", v[ratio "_min"], v[ratio "_max"])
        truth(name kind[k] " span", v[ratio "_min"] <= v[ratio] && v[ratio] <= v[ratio "_max"])
        if (rounds == 1) near(name kind[k] " ratio", v[ratio], v[p "." kind[k] "_mrays"] / v[base "." kind[k] "_mrays"])
        warm = p "." kind[k] "_warm"
        truth(name kind[k] " warm span", v[warm "_min"] <= v[warm] && v[warm] <= v[warm "_max"])
        if (v[p ".name"] == v[base ".name"]) truth(name kind[k] " warm, to itself", v[warm] == 1)
        else if (v[warm] + 0 != v[ratio] + 0) apart++
        if (k <= 4) { product *= v[ratio]; product_warm *= v[warm] }
    }
    near(name "mean", v[p ".mean_ratio"], product ^ 0.25)
    same(name "mean", word[11], "%.2f", v[p ".mean_ratio"])
    near(name "warm mean", v[p ".mean_warm"], product_warm ^ 0.25)
    same(name "warm mean", word[12], "%.2f", v[p ".mean_warm"])
    same(name "prim Mr/s", word[13], "%.3f", v[p ".prim_mrays"])
}
# What a name is made of.
function members() {
    truth(name "engine", index(v[p ".name"], v[p ".engine"]) == 1)
    if (v[p ".engine"] == "cpu") truth(name "layout", index(v[p ".name"], "cpu " v[p ".layout"]) == 1)
    if (v[p ".engine"] == "fast") truth(name "builder", index(v[p ".name"], "fast " v[p ".builder"]) == 1)
    if (v[p ".layout"] == "-") equal(name "no members", v[p ".store"] v[p ".builder"], "--")
    else truth(name "storage", v[p ".store"] ~ /^(indexed|compact)$/)
}
function sizes(  k, touched, sum, at) {
    touched = v[p ".prim_line_bytes"] != "null"
    sum = v[p ".node_bytes"] + v[p ".item_bytes"] + v[p ".scene_bytes"]
    gsub(/ of /, "/")
    split(substr($0, 33), word, " ")
    part("nodes", word[1], v[p ".node_bytes"], touched)
    part("items", word[2], v[p ".item_bytes"], touched)
    part("scene", word[3], v[p ".scene_bytes"], 1)
    part("all", word[4], sum, 1)
    near(name "bytes a triangle", v[p ".bytes_per_triangle"], sum / v[p ".triangles"])
    at = 5
    for (k = 1; k <= 3; k++) {
        if (!touched) { equal(name "lines", word[at++], "-"); continue }
        same(name kind[k] " lines", word[at++], "%.0f", v[p "." kind[k] "_line_bytes"])
        same(name kind[k] " beyond L1", word[at++], "%.0f", v[p "." kind[k] "_beyond_l1"])
        same(name kind[k] " beyond L2", word[at++], "%.0f", v[p "." kind[k] "_beyond_l2"])
        truth(name kind[k] " beyond", v[p "." kind[k] "_line_bytes"] >= v[p "." kind[k] "_beyond_l1"] && v[p "." kind[k] "_beyond_l1"] >= v[p "." kind[k] "_beyond_l2"])
        truth(name kind[k] " a line for the root", v[p "." kind[k] "_line_bytes"] >= 64)
    }
    equal(name "lost", word[at++], v[p ".lost"] "/" v[p ".asked"])
    equal(name "wrong", word[at++], v[p ".wrong"] "/" v[p ".asked"])
    equal(name "leaks", word[at++], v[p ".leak_rays"] > 0 ? v[p ".leaks"] "/" v[p ".leak_rays"] : "-")
    equal(name "allowed", word[at++], v[p ".allowed"])
    equal(name "WRONG", word[at], v[p ".judged"] == "true" ? v[p ".judged_wrong"] : "(" v[p ".judged_wrong"] ")")
    if (v[p ".leak_rays"] > 0) equal(name "leak rays at edges and vertices", v[p ".leak_rays"], 2 * (v["rows.0.rays"] < 4096 ? v["rows.0.rays"] : 4096))
    equal(name "compared", v[p ".compared"], (v[p ".rays"] < v["rows.0.rays"] ? 2 : 4) * v[p ".asked"] + v[p ".leak_rays"])
    truth(name "verdicts", v[p ".allowed"] + v[p ".judged_wrong"] <= v[p ".compared"])
    equal(name "judged", v[p ".judged"], v[p ".layout"] ~ /^rtrs_/ ? "false" : "true")
    if (v[p ".judged"] == "true") any_wrong += v[p ".judged_wrong"]
}
BEGIN { split("prim rand diff o-shad o-rand", kind, " ") }
/: [0-9]+ triangles, [0-9]+ rays of each kind, / {
    p = "rows." (first = r + 0)
    match($0, /: [0-9]+ triangles, /)
    equal("scene", substr($0, 1, RSTART - 1), v[p ".scene"])
    split(substr($0, RSTART + 2), word, " ")
    equal("triangles", word[1], v[p ".triangles"])
    equal("rays", word[3], v[p ".rays"])
    equal("rounds", word[8], v[p ".rounds"])
    equal("threads", word[11], v[p ".threads"])
    next
}
/^  speed, least-most/ { table = 1; next }
/^  bytes per triangle/ { table = 2; r = first; next }
/^  front of size, speed and lost hits: / {
    text = ""
    for (i = first; i < r; i++) if (v["rows." i ".front"] == "true") text = text (text == "" ? "" : "; ") v["rows." i ".name"]
    shown = $0
    sub(/^[^:]*: /, "", shown)
    equal("front", shown, text)
    fronts++
    table = 0
    next
}
/^  worth using, nothing lost: / {
    shown = $0
    sub(/^[^:]*: /, "", shown)
    count = split(shown, word, ", ")
    for (i = first; i < r; i++) if (v["rows." i ".worth"] != "-") {
        worth++
        truth("worth using: " v["rows." i ".name"], index(", " shown ",", ", " v["rows." i ".name"] " (" v["rows." i ".worth"] "),") > 0)
        truth("worth using, but it loses hits", v["rows." i ".lost"] + v["rows." i ".leaks"] == 0)
        truth("worth using, but it is WRONG", v["rows." i ".judged_wrong"] == 0)
        for (other = first; other < r; other++) # each on its best tree
            if (v["rows." other ".engine"] == v["rows." i ".engine"] && v["rows." other ".layout"] == v["rows." i ".layout"] && v["rows." other ".store"] == v["rows." i ".store"])
                truth("worth using, but not on its best tree", v["rows." other ".mean_ratio"] <= v["rows." i ".mean_ratio"])
    }
    equal("worth using", count, worth + 0)
    worths++
    next
}
table && NF > 8 {
    p = "rows." r++
    name = v[p ".name"] " "
    equal("name", name_of(), v[p ".name"])
    members()
    if (table == 1) speeds()
    else sizes()
    next
}
END {
    equal("rows", r, v["rows.count"])
    truth("warm ratios are others", apart > 0)
    equal("exit code", v["exit"], any_wrong > 0 ? 1 : 0)
    for (i = 0; i < r; i++) is_worth += v["rows." i ".worth"] != "-"
    equal("lines of the front", fronts " " worths + 0, "1 " (is_worth > 0))
    print "bench matrix: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
