# A tree of `raydiff precompute --out FILE.json`, kept in w[] with its name before each path: measure() sets made[].
function half_area(p,  k, side) {
    for (k = 0; k < 3; k++) side[k] = w[p ".bounds.max." k] - w[p ".bounds.min." k]
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0]
}
# Depth (0 of a root alone), leaves, items and cost of the tree.
function measure(tree,  i, p, n, level) {
    tree = tree ".uniforms."
    n = w[tree "count"]
    made["leaves"] = made["items"] = made["largest"] = made["depth"] = made["sah"] = 0
    level[0] = 0
    for (i = 0; i < n; i++) {
        p = tree i
        if (level[i] > made["depth"]) made["depth"] = level[i]
        if (w[p ".item_count"] > 0) {
            made["leaves"]++
            made["items"] += w[p ".item_count"]
            if (w[p ".item_count"] > made["largest"]) made["largest"] = w[p ".item_count"]
        } else
            level[w[p ".fst"] + 0] = level[w[p ".snd"] + 0] = level[i] + 1
        made["sah"] += (w[p ".item_count"] > 0 ? w[p ".item_count"] : 1) * half_area(p)
    }
    made["sah"] /= half_area(tree "0")
    made["nodes"] = n
}
