# The text of `raydiff bench error` against its JSON, hits against `raydiff check` (other.flat):
# awk -f lib.awk -f bench_error.awk FLAT other.flat TEXT
# Per million; of none the bound that holds with a chance of 95 %, 3 in all.
function rate(what, text, events, count,  number) {
    number = 1e6 * (events > 0 ? events : 3) / (count > 0 ? count : 1)
    checked++
    if (text != (count == 0 ? "-" : (events > 0 ? "" : "<") sprintf(number < 999.5 ? "%.3g" : "%.0f", number)))
        bad(what ": printed " text ", is " events " of " count)
}
# The row of the same scene and rays; engine, layout, box and test as given, '' as in `like`.
function row_of(like, engine, layout,  i, q) {
    for (i = 0; i < v["rows.count"]; i++) {
        q = "rows." i
        if (v[q ".scene"] == v[like ".scene"] && v[q ".rays"] == v[like ".rays"] && v[q ".engine"] == engine &&
            v[q ".layout"] == layout && (layout == "null" || (v[q ".box"] == v[like ".box"] && v[q ".tri"] == v[like ".tri"])))
            return q
    }
    return ""
}
# What is compared with is itself where it is not measured: "f32" or an engine's name.
function base_of(p,  q) {
    q = v[p ".base"] == v[p ".layout"] ? p : row_of(p, v[p ".engine"], v[p ".base"])
    return q != "" ? q : row_of(p, v[p ".base"], "null")
}
function quantiles(name, p, kind, first) {
    if (v[p "." kind "_p50"] == "null") {
        equal(name kind " of no hit", $first $(first + 1) $(first + 2), "nannannan")
        return
    }
    same(name kind " p50", $first, "%.3g", v[p "." kind "_p50"])
    same(name kind " p99", $(first + 1), "%.3g", v[p "." kind "_p99"])
    same(name kind " max", $(first + 2), "%.3g", v[p "." kind "_max"])
    truth(name kind " quantiles in order", v[p "." kind "_p50"] <= v[p "." kind "_p99"] && v[p "." kind "_p99"] <= v[p "." kind "_max"])
}
function laws(p, name,  q, nodes, f32, c, k, sum) {
    q = base_of(p)
    truth(name "what it is compared with is not measured", q != "")
    if (v[p ".engine"] ~ /^vulkan/ && v[p ".layout"] != "null") equal(name "base", v[p ".base"], row_of(p, v[p ".engine"], "f32") != "" ? "f32" : v[p ".layout"])
    if (v[p ".rounds"] == 1) near(name "ratio", v[p ".ratio_median"], v[p ".mrays_median"] / v[q ".mrays_median"])
    # A lost hit is one less than exactly there are, a phantom one more.
    if (v[p ".in_plane"] == 0 && v[p ".compared"] == v[p ".count"])
        equal(name "hits", v[p ".hits"], v[p ".exact_hits"] - v[p ".lost"] + v[p ".phantom"])
    truth(name "more wrong triangles than hits", v[p ".wrong_id"] + v[p ".phantom"] <= v[p ".hits"] + 0)
    truth(name "more named and WRONG than answers",
          v[p ".named"] + v[p ".wrong"] <= v[p ".count"] + v[p ".edge_rays"] + v[p ".vertex_rays"])
    # From inside a closed mesh at its edges and at its vertices, for each two rays one of each kind.
    if (v[p ".edge_rays"] + v[p ".vertex_rays"] > 0) {
        equal(name "rays at edges", v[p ".edge_rays"], int((v[p ".count"] + 1) / 2))
        equal(name "rays at vertices", v[p ".vertex_rays"], v[p ".edge_rays"])
    }
    truth(name "more leaks than rays", v[p ".edge_leaks"] <= v[p ".edge_rays"] && v[p ".vertex_leaks"] <= v[p ".vertex_rays"])
    equal(name "judged", v[p ".judged"], v[p ".layout"] ~ /^rtrs/ || v[p ".box"] == "rtrs" ? "false" : "true")
    if (v[p ".judged"] == "true") equal(name "WRONG", v[p ".wrong"], 0)
    if (v[p ".tri"] == "woop" && v[p ".box"] == "watertight" && v[p ".layout"] !~ /^rtrs/) equal(name "leaks of woop", v[p ".edge_leaks"] + v[p ".vertex_leaks"], 0)
    if (v[p ".scene"] ~ /^sphere/ && v[p ".tri"] == "mt" && v[p ".box"] == "robust" && v[p ".layout"] !~ /^rtrs/)
        truth(name "mt leaks, but not as a sieve", v[p ".edge_leaks"] + v[p ".vertex_leaks"] > 0 &&
              v[p ".edge_leaks"] + v[p ".vertex_leaks"] < v[p ".edge_rays"])
    # The error in t moves the point by sqrt(3) of it at most, away from the plane.
    if (v[p ".hits"] > 0 && v[p ".wrong_id"] + v[p ".phantom"] + v[p ".in_plane"] == 0)
        truth(name "off the plane by more than t is wrong", v[p ".plane_max"] <= 1.7321 * v[p ".forward_max"] &&
              v[p ".plane_p50"] <= 1.7321 * v[p ".forward_p50"])
    if (v[p ".layout"] == "null") {
        equal(name "bytes of no layout", v[p ".node_bytes"] + v[p ".item_bytes"] v[p ".bytes_per_node"], "0null")
        return
    }
    if (v[p ".layout"] in node_size) equal(name "bytes a node", v[p ".bytes_per_node"], node_size[v[p ".layout"]])
    truth(name "whole nodes", v[p ".node_bytes"] % v[p ".bytes_per_node"] == 0)
    f32 = row_of(p, v[p ".engine"], "f32")
    if (f32 != "") {
        if (v[p ".boxes_per_ray"] != "null")
            near(name "boxes to f32", v[p ".boxes_to_f32"], v[p ".boxes_per_ray"] / v[f32 ".boxes_per_ray"])
        if (v[p ".tris_per_ray"] != "null")
            near(name "triangles to f32", v[p ".tris_to_f32"], v[p ".tris_per_ray"] / v[f32 ".tris_per_ray"])
        nodes = v[f32 ".node_bytes"] / 32
        if (v[p ".layout"] == "rf16") equal(name "records of rf16", v[p ".node_bytes"], 16 * (3 * (nodes + 1) / 2 - 1))
    }
    for (c = 0; c < w["rows.count"]; c++) {
        q = "rows." c
        if (w[q ".scene"] != v[p ".scene"] || w[q ".layout"] != v[p ".layout"] || w[q ".box"] != v[p ".box"] ||
            w[q ".tri"] != v[p ".tri"] || w[q ".engine"] != v[p ".engine"] || v[p ".rays"] != "edges")
            continue
        compared++
        equal(name "hits of check", v[p ".hits"], w[q ".hits"])
        equal(name "nodes of check", v[p ".node_bytes"], w[q ".node_bytes"])
        equal(name "items of check", v[p ".item_bytes"], w[q ".item_bytes"])
        equal(name "memory of check", v[p ".memory_bytes"], w[q ".memory_bytes"])
        near(name "boxes of check", v[p ".boxes_per_ray"], w[q ".box_tests"] / w[q ".rays"])
        near(name "triangles of check", v[p ".tris_per_ray"], w[q ".triangle_tests"] / w[q ".rays"])
        truth(name "err/E is less than that of check", v[p ".err_over_bound"] >= w[q ".err_over_bound"] * 0.9999999)
        sum = 0
        for (k in w) if (index(k, q ".counts.") == 1 && k !~ /\.(right|wrong)$/) sum += w[k]
        if (v[p ".edge_rays"] == 0) {
            equal(name "named of check", v[p ".named"], sum)
            equal(name "WRONG of check", v[p ".wrong"], w[q ".counts.wrong"])
            near(name "err/E of check", v[p ".err_over_bound"], w[q ".err_over_bound"])
        } else # of the rays from inside no miss is right
            truth(name "named", v[p ".named"] >= sum + v[p ".edge_leaks"] + v[p ".vertex_leaks"])
        truth(name "WRONG is less than that of check", v[p ".wrong"] >= w[q ".counts.wrong"])
    }
}
BEGIN {
    node_size["f32"] = 32
    node_size["rf16"] = node_size["rtrs_rf"] = 16
}
/: [0-9]+ triangles; [0-9]+ [a-z]+ rays, seed / {
    p = "rows." (first = r + 0)
    table = 0
    at = match($0, /: [0-9]+ triangles; /)
    equal("scene", substr($0, 1, at - 1), v[p ".scene"])
    split(substr($0, at + 2), word, /[ ,;]+/)
    name = v[p ".scene"] ", " v[p ".rays"] " "
    equal(name "triangles", word[1], v[p ".triangles"])
    equal(name "count", word[3], v[p ".count"])
    equal(name "rays", word[4], v[p ".rays"])
    equal(name "seed", word[7], v[p ".seed"])
    equal(name "exact hits", word[11], v[p ".exact_hits"])
    equal(name "rounds", $(NF - 2), v[p ".rounds"])
    next
}
/^closed: / {
    equal(name "rays at edges", $2, v["rows." first ".edge_rays"])
    equal(name "rays at vertices", $(NF - 2), v["rows." first ".vertex_rays"])
    next
}
/^no leaks counted: / { equal(name "leak rays", v["rows." first ".edge_rays"] + v["rows." first ".vertex_rays"], 0) }
/^engine  *nodes .*Mray/ { table = 1; next }
/^engine  *nodes .*p50/ { table = 2; r = first; next }
table && NF >= 17 {
    gsub(/\( +/, "(")
    p = "rows." r++
    name = v[p ".scene"] ", " v[p ".rays"] " row " r - 1 " "
    equal(name "engine", $1, v[p ".engine"])
    equal(name "layout", $2, v[p ".layout"] == "null" ? "-" : v[p ".layout"])
    equal(name "box", $3, v[p ".box"] == "null" ? "-" : v[p ".box"])
    equal(name "tri", $4, v[p ".tri"] == "null" ? "own" : v[p ".tri"])
}
table == 1 && NF == 18 {
    same(name "Mray/s", $5, "%.3f", v[p ".mrays_median"])
    same_span(name "Mray/s", $6, "%.3f", v[p ".mrays_min"], v[p ".mrays_max"])
    same(name "ratio", $7, "%.2f", v[p ".ratio_median"])
    same_span(name "ratio", $8, "%.2f", v[p ".ratio_min"], v[p ".ratio_max"])
    equal(name "base", $10, v[p ".base"])
    rate(name "lost", $11, v[p ".lost"], v[p ".compared"])
    rate(name "phantom", $12, v[p ".phantom"], v[p ".compared"])
    rate(name "wrong id", $13, v[p ".wrong_id"], v[p ".compared"])
    rate(name "leaks at edges", $14, v[p ".edge_leaks"], v[p ".edge_rays"])
    rate(name "leaks at vertices", $15, v[p ".vertex_leaks"], v[p ".vertex_rays"])
    equal(name "named", $16, v[p ".named"])
    equal(name "WRONG", $17, v[p ".judged"] == "true" ? v[p ".wrong"] : "(" v[p ".wrong"] ")")
    same(name "err/E", $18, "%.3f", v[p ".err_over_bound"])
    laws(p, name)
    next
}
table == 2 && NF == 17 {
    quantiles(name, p, "forward", 5)
    quantiles(name, p, "plane", 8)
    quantiles(name, p, "point", 11)
    if (v[p ".boxes_to_f32"] == "null") equal(name "boxes to f32", $14, "-")
    else same(name "boxes to f32", $14, "%.3f", v[p ".boxes_to_f32"])
    if (v[p ".tris_to_f32"] == "null") equal(name "tris to f32", $15, "-")
    else same(name "tris to f32", $15, "%.3f", v[p ".tris_to_f32"])
    if (v[p ".layout"] == "null") equal(name "no bytes", $16 $17, "--")
    else {
        equal(name "bytes a node", $16, v[p ".bytes_per_node"])
        same(name "bytes a triangle", $17, "%.1f", (v[p ".node_bytes"] + v[p ".item_bytes"]) / v[p ".triangles"])
    }
    told++
}
END {
    equal("rows", r, v["rows.count"])
    equal("rows of the second table", told, v["rows.count"])
    if (w["rows.count"] > 0) truth("nothing is compared with check", compared > 0)
    print "bench error: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
