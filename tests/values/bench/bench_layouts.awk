# The text of `raydiff bench layouts` against its JSON, bytes and work against `raydiff check` of the same rays
# (other.flat): awk -f lib.awk -f bench_layouts.awk FLAT other.flat TEXT
# The row of the same scene and rays with that engine and layout.
function row_of(like, engine, layout,  i, q) {
    for (i = 0; i < v["rows.count"]; i++) {
        q = "rows." i
        if (v[q ".scene"] == v[like ".scene"] && v[q ".rays"] == v[like ".rays"] && v[q ".engine"] == engine && v[q ".layout"] == layout)
            return q
    }
    return ""
}
# What all rows obey.
function laws(p, name,  base, tris, nodes, other) {
    tris = v[p ".triangles"]
    base = row_of(p, v[p ".base_engine"], v[p ".base_layout"])
    truth(name "what it is compared with is not measured", base != "")
    truth(name "what it is compared with has another base", v[base ".ratio_median"] == 1 && v[base ".ratio_max"] == 1)
    if (v[p ".engine"] ~ /^(vulkan|rayquery)/ && v[p ".layout"] != "-")
        equal(name "base", base, row_of(p, v[p ".engine"], "f32"))
    else if (row_of(p, "embree", "-") != "")
        equal(name "base", base, row_of(p, "embree", "-"))
    if (v[p ".rounds"] == 1) near(name "ratio", v[p ".ratio_median"], v[p ".mrays_median"] / v[base ".mrays_median"])
    truth(name "more than all triangles tested", v[p ".tris_per_ray"] + 0 <= tris + 0)
    truth(name "differences and allowed", v[p ".differences"] + v[p ".allowed"] <= v[p ".count"] + 0)
    if (v[p ".engine"] == "kd") { # a tree of its own: nodes of 8 bytes, entries of 4, and 48 a triangle
        equal(name "memory", v[p ".memory_bytes"], v[p ".node_bytes"] + v[p ".item_bytes"])
        truth(name "nodes of a binary tree", v[p ".node_bytes"] % 16 == 8)
        truth(name "items", v[p ".item_bytes"] % 4 == 0 && v[p ".item_bytes"] + 0 >= 52 * tris)
        return
    }
    if (v[p ".layout"] == "-") {
        truth(name "bytes of no layout", v[p ".node_bytes"] == "null" && v[p ".item_bytes"] == "null" && v[p ".memory_bytes"] != "0")
        if (v[p ".engine"] ~ /brute/) equal(name "triangles tested", v[p ".tris_per_ray"] + 0, tris)
        return
    }
    if (v[p ".engine"] ~ /^fast/) {
        equal(name "memory", v[p ".memory_bytes"], v[p ".node_bytes"] + v[p ".item_bytes"])
        return
    }
    if (v[p ".engine"] == "dual_split") { # its own nodes, of 12 bytes and 8, and what the layout has of items
        other = row_of(p, "cpu", v[p ".layout"])
        truth(name "memory is less than the tree", v[p ".memory_bytes"] + 0 >= v[p ".node_bytes"] + v[p ".item_bytes"])
        truth(name "nodes of 12 bytes and 8", v[p ".node_bytes"] % 4 == 0 && v[p ".node_bytes"] + 0 > 0)
        if (other != "") equal(name "items of its layout", v[p ".item_bytes"], v[other ".item_bytes"])
        return
    }
    truth(name "memory is less than the tree", v[p ".memory_bytes"] + 0 >= v[p ".node_bytes"] + v[p ".item_bytes"])
    other = row_of(p, v[p ".engine"], "f32")
    nodes = v[other ".node_bytes"] / 32
    truth(name "nodes of a binary tree", nodes % 2 == 1)
    truth(name "tests of boxes", v[p ".boxes_per_ray"] + 0 <= nodes && v[p ".boxes_per_ray"] + 0 >= v[other ".boxes_per_ray"] + 0)
    equal(name "items", v[p ".item_bytes"], v[p ".layout"] == "f32" ? 4 * tris : 0)
    if (v[p ".layout"] == "rf16") equal(name "records of rf16", v[p ".node_bytes"], 16 * (3 * (nodes + 1) / 2 - 1))
}
# The same as `raydiff check` has of engine cpu on bounce rays.
function as_check(p, name,  c, k, sum) {
    for (c = 0; c < w["rows.count"]; c++) {
        q = "rows." c
        if (w[q ".layout"] != v[p ".layout"] || w[q ".scene"] != v[p ".scene"]) continue
        equal(name "node bytes of check", v[p ".node_bytes"], w[q ".node_bytes"])
        equal(name "item bytes of check", v[p ".item_bytes"], w[q ".item_bytes"])
        equal(name "memory of check", v[p ".memory_bytes"], w[q ".memory_bytes"])
        near(name "box tests of check", v[p ".boxes_per_ray"], w[q ".box_tests"] / w[q ".rays"])
        near(name "triangle tests of check", v[p ".tris_per_ray"], w[q ".triangle_tests"] / w[q ".rays"])
        sum = 0
        for (k in w)
            if (index(k, q ".counts.") == 1 && k !~ /\.(right|wrong)$/) sum += w[k]
        equal(name "allowed of check", v[p ".allowed"], sum)
        equal(name "differences of check", v[p ".differences"], w[q ".differences"])
        # The same work on the same machine.
        near_speed(name "speed of check", v[p ".mrays_median"], w[q ".mrays_per_s.median"])
        compared++
    }
}
# Only another unit is that far off.
function near_speed(what, a, b) { truth(what ": " a " and " b, a < 300 * b && b < 300 * a) }
/: [0-9]+ triangles; .*, [0-9]+ rounds? interleaved$/ {
    at = match($0, /: [0-9]+ triangles; /)
    scene = substr($0, 1, at - 1)
    p = "rows." r + 0
    equal("scene", scene, v[p ".scene"])
    split(substr($0, at + 2), word, " ")
    equal(scene " triangles", word[1], v[p ".triangles"])
    equal(scene " rounds", $(NF - 2), v[p ".rounds"])
    equal(scene " rays", $(NF - 4), v[p ".count"])
    next
}
$8 == "of" && NF == 14 {
    p = "rows." r++
    name = scene " row " r - 1 " "
    tris = v[p ".triangles"]
    equal(name "rays", $1, v[p ".rays"])
    equal(name "engine", $2, v[p ".engine"])
    equal(name "layout", $3, v[p ".layout"])
    same(name "Mray/s", $4, "%.3f", v[p ".mrays_median"])
    same_span(name "Mray/s", $5, "%.3f", v[p ".mrays_min"], v[p ".mrays_max"])
    same(name "ratio", $6, "%.2f", v[p ".ratio_median"])
    same_span(name "ratio", $7, "%.2f", v[p ".ratio_min"], v[p ".ratio_max"])
    equal(name "base", $9, v[p ".base_engine"] == v[p ".engine"] && v[p ".base_layout"] != "-" ? v[p ".base_layout"] : v[p ".base_engine"])
    if (v[p ".layout"] == "-" && v[p ".engine"] != "kd")
        equal(name "no bytes", $10 $11, "--")
    else {
        same(name "nodeB", $10, "%.1f", v[p ".node_bytes"] / tris)
        same(name "+items", $11, "%.1f", (v[p ".node_bytes"] + v[p ".item_bytes"]) / tris)
    }
    same(name "mem/tri", $12, "%.1f", v[p ".memory_bytes"] / tris)
    equal(name "wrong", $13, v[p ".differences"])
    equal(name "named", $14, v[p ".allowed"])
    laws(p, name)
    if (v[p ".engine"] == "cpu" && v[p ".rays"] == "bounce") as_check(p, name)
    next
}
END {
    equal("rows", r, v["rows.count"])
    truth("nothing is compared with check", compared >= 2)
    print "bench layouts: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
