# What `raydiff precompute` tells of a tree against the JSON that it wrote (other.flat, "tree." before each path) and
# the scene as OBJ: awk -f lib.awk -f tree.awk -f obj.awk -f precompute.awk NONE other.flat x.obj TEXT VERIFIED
# Bounds of what lies beneath a node, in low[] and high[]; nodes stand before their children.
function grow(node, from_low, from_high,  k) {
    for (k = 0; k < 3; k++) {
        if (!(node in grown) || from_low[k] < low[node, k]) low[node, k] = from_low[k]
        if (!(node in grown) || from_high[k] > high[node, k]) high[node, k] = from_high[k]
    }
    grown[node] = 1
}
# Inner nodes that do not contain their triangles.
function loose(  n, i, k, c, p, first, count, child, lo, hi, off) {
    n = w["tree.uniforms.count"]
    for (i = n - 1; i >= 0; i--) {
        p = "tree.uniforms." i
        count = w[p ".item_count"]
        for (first = w[p ".item_idx"]; count > 0; count--) {
            for (c = 0; c < 3; c++) {
                for (k = 0; k < 3; k++) lo[k] = hi[k] = vertex[corner[w["tree.indices." first] + 0, c], k]
                grow(i, lo, hi)
            }
            first++
        }
        if (w[p ".item_count"] > 0) continue
        for (child = 0; child < 2; child++) {
            c = w[p (child ? ".snd" : ".fst")] + 0
            for (k = 0; k < 3; k++) {
                lo[k] = low[c, k]
                hi[k] = high[c, k]
            }
            grow(i, lo, hi)
        }
        off = 0
        for (k = 0; k < 3; k++) off += low[i, k] < w[p ".bounds.min." k] || high[i, k] > w[p ".bounds.max." k]
        made["loose"] += off > 0
    }
    return made["loose"] + 0
}
# "51 nodes, 26 leaves of at most 2 items, depth 7, 0 inner boxes too small", from a word on.
function told(first) {
    gsub(",", "")
    equal("nodes", $first, made["nodes"])
    equal("leaves", $(first + 2), made["leaves"])
    equal("largest leaf", $(first + 7), made["largest"])
    equal("depth", $(first + 10), made["depth"])
    equal("inner boxes too small", $(first + 11), made["loose"] + 0)
}
/ triangles, [0-9]+ nodes, / {
    measure("tree")
    loose()
    equal("triangles", $2, triangles)
    equal("items", w["tree.indices.count"], made["items"])
    told(4)
    lines++
    next
}
/: [0-9]+ nodes, / {
    told(2)
    lines++
}
/: layout [a-z0-9_]+, [0-9]+ records, / {
    gsub(",", "")
    if ($3 == "rf16") equal("records of rf16", $4, 3 * made["leaves"] - 1)
    else if ($3 == "f32") equal("records of f32", $4, made["nodes"])
    equal("faults", $6 " " $10 " " $(NF - 2), made["loose"] + 0 " 0 0")
    lines++
}
END {
    equal("lines", lines, 4)
    print "precompute: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
