# The text of `raydiff bench builders` against its JSON, and trees against those that `raydiff precompute` wrote
# (other.flat, each path with the builder's name before it): awk -f lib.awk -f tree.awk -f bench_builders.awk FLAT other.flat TEXT
# Its name, as it is printed.
function how(p) {
    return v[p ".builder"] (v[p ".reinsert"] > 0 ? " reinsert=" v[p ".reinsert"] : v[p ".rotate"] > 0 ? " rotate=" v[p ".rotate"] : v[p ".presplit"] > 0 ? " presplit=" v[p ".presplit"] : v[p ".split_budget"] > 0 ? " split-budget=" v[p ".split_budget"] : "")
}
function laws(p, name,  tree, other, i) {
    equal(name "a binary tree", v[p ".nodes"], 2 * v[p ".leaves"] - 1)
    truth(name "fill and largest leaf", v[p ".leaf_fill"] <= v[p ".largest_leaf"] && v[p ".largest_leaf"] <= v[p ".triangles"])
    if (v[p ".builder"] != "sbvh" && v[p ".presplit"] == 0) near(name "fill", v[p ".leaf_fill"], v[p ".triangles"] / v[p ".leaves"])
    equal(name "overlap is exact", v[p ".overlap_exact"], v[p ".triangles"] <= 50000 ? "true" : "false")
    for (i = 0; i < v["rows.count"]; i++) { # as many threads as they are, it is one tree
        other = "rows." i
        if (v[other ".scene"] != v[p ".scene"] || v[other ".builder"] != v[p ".builder"] || how(other) != how(p)) continue
        if (v[other ".threads"] != v[p ".threads"]) threaded++
        equal(name "tree of other threads", v[other ".sah"] v[other ".nodes"] v[other ".overlap"], v[p ".sah"] v[p ".nodes"] v[p ".overlap"])
    }
    built += rounds * v[p ".triangles"] * v[p ".ns_per_tri_median"]
    most_built += rounds * v[p ".triangles"] * v[p ".ns_per_tri_max"]
    tree = how(p)
    sub(/ /, "_", tree)
    if (!((tree ".uniforms.count") in w)) return
    compared++
    measure(tree)
    equal(name "nodes of precompute", v[p ".nodes"], made["nodes"])
    equal(name "leaves of precompute", v[p ".leaves"], made["leaves"])
    equal(name "depth of precompute", v[p ".depth"], made["depth"])
    equal(name "largest leaf of precompute", v[p ".largest_leaf"], made["largest"])
    near(name "fill of precompute", v[p ".leaf_fill"], made["items"] / made["leaves"])
    near(name "SAH of precompute", v[p ".sah"], made["sah"])
    equal(name "loose boxes of precompute", v[p ".loose"], w[tree ".loose"])
}
/: [0-9]+ triangles$/ {
    match($0, /: [0-9]+ triangles$/)
    equal("scene", substr($0, 1, RSTART - 1), v["rows." r + 0 ".scene"])
    equal("triangles", $(NF - 1), v["rows." r + 0 ".triangles"])
    next
}
# A box more is read than written for each merge, and all but one triangle's is merged away.
/^ploctree: / {
    p = ""
    for (i = 0; i < v["rows.count"]; i++)
        if (v["rows." i ".sweeps"] != "null" && v["rows." i ".scene"] == v["rows." r - 1 ".scene"]) p = "rows." i
    name = v[p ".scene"] " stream "
    equal(name "builder", $1, v[p ".builder"] ":")
    equal(name "sweeps", $2, v[p ".sweeps"])
    equal(name "boxes read", $5, v[p ".boxes_read"])
    equal(name "boxes written", $9 ",", v[p ".boxes_written"] ",,")
    equal(name "merges", v[p ".boxes_read"] - v[p ".boxes_written"], v[p ".triangles"] - 1)
    same(name "bytes a sweep", $(NF - 6), "%.0f", 28 * (v[p ".boxes_read"] + v[p ".boxes_written"]) / v[p ".sweeps"])
    same(name "bytes a triangle", $(NF - 2), "%.1f", 28 * (v[p ".boxes_read"] + v[p ".boxes_written"]) / v[p ".triangles"])
    streams++
    next
}
/^  builder  *threads/ { rows = 1; next }
rows && NF >= 11 {
    p = "rows." r++
    shift = NF - 11
    name = v[p ".scene"] " " how(p) " " v[p ".threads"] " "
    equal(name "builder", $1 (shift ? " " $2 : ""), how(p))
    equal(name "threads", $(2 + shift), v[p ".threads"])
    same(name "ns a triangle", $(3 + shift), "%.1f", v[p ".ns_per_tri_median"])
    same_span(name "ns a triangle", $(4 + shift), "%.1f", v[p ".ns_per_tri_min"], v[p ".ns_per_tri_max"])
    same(name "SAH", $(5 + shift), "%.2f", v[p ".sah"])
    same(name "overlap", $(6 + shift), "%.2f", v[p ".overlap"])
    equal(name "depth", $(7 + shift), v[p ".depth"])
    equal(name "nodes", $(8 + shift), v[p ".nodes"])
    same(name "fill", $(9 + shift), "%.2f", v[p ".leaf_fill"])
    equal(name "largest leaf", $(10 + shift), v[p ".largest_leaf"])
    equal(name "loose", $(11 + shift), v[p ".loose"])
    laws(p, name)
    next
}
END {
    equal("rows", r, v["rows.count"])
    if (w["median.uniforms.count"] > 0) truth("trees of precompute", compared >= 5)
    truth("trees of more threads", threaded > 0)
    truth("streams", streams > 0)
    # All trees together took less time than the command, and no thousandth of it.
    truth("ns a triangle: all trees took " built " of " took, built <= took && most_built > took / 500)
    print "bench builders: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
