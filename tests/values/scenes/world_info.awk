# `raydiff scene info` of a world against its file as scene convert writes it (other.flat):
# awk -f lib.awk -f world_info.awk FLAT other.flat TEXT
function cell(i, r, c) { return w["instances." i ".transform." (4 * r + c)] + 0 }
function mirrored(i,  j, k, l, det) {
    if (!(("instances." i ".transform.count") in w)) return 0
    for (j = 0; j < 3; j++) {
        k = (j + 1) % 3
        l = (j + 2) % 3
        det += cell(i, 0, j) * (cell(i, 1, k) * cell(i, 2, l) - cell(i, 1, l) * cell(i, 2, k))
    }
    return det < 0
}
function identity(i,  k) {
    if (!(("instances." i ".transform.count") in w)) return 1
    for (k = 0; k < 12; k++)
        if (w["instances." i ".transform." k] + 0 != (k % 5 == 0)) return 0
    return 1
}
function laws(  i, k, m, count, made, of) {
    for (i = 0; i < w["meshes.count"]; i++) {
        m = "meshes." i "."
        made["vertices"] += w[m "vertices.count"] / 3
        made["triangles"] += w[m "indices.count"] / 3
        count = (m "geometries.count") in w ? w[m "geometries.count"] : 1
        made["geometries"] += count
        for (k = 0; k < count; k++) made["not_opaque"] += w[m "geometries." k ".opaque"] == "false"
    }
    for (i = 0; i < w["instances.count"]; i++) {
        of = w["instances." i ".mesh"]
        if (of != "null") made["placed_triangles"] += w["meshes." of ".indices.count"] / 3
        made["inactive"] += of == "null" || w["instances." i ".mask"] "" == "0"
        made["mirrored"] += mirrored(i)
        made["identity"] += identity(i)
    }
    equal("meshes", v[p "meshes"], w["meshes.count"])
    equal("instances", v[p "instances"], w["instances.count"])
    count = split("vertices triangles geometries not_opaque placed_triangles inactive mirrored identity", key, " ")
    for (i = 1; i <= count; i++) equal(key[i], v[p key[i]], made[key[i]] + 0)
    equal("filter", v[p "filter"], ("filter.kind" in w) ? w["filter.kind"] : "all")
    equal("share", v[p "share"], w["filter.share"] + 0)
}
BEGIN { p = "scenes.0." }
FNR == 1 { equal("world", $0, v[p "world"]); laws(); next }
{ gsub(",", "") }
/^  meshes / { equal("meshes", $2, v[p "meshes"]) }
/^  geometries / { equal("geometries", $2 " " $5, v[p "geometries"] " " v[p "not_opaque"]) }
/^  vertices / { equal("vertices", $2, v[p "vertices"]) }
/^  triangles / { equal("triangles", $2, v[p "triangles"]) }
/^  instances / {
    equal("instances", $2 " " $4 " " $6, v[p "instances"] " " v[p "inactive"] " " v[p "mirrored"])
    equal("at the identity", $NF, v[p "identity"])
}
/^  placed triangles / { equal("placed triangles", $3, v[p "placed_triangles"]) }
/^  filter / { equal("filter", $2 " " $3, v[p "filter"] " " v[p "share"]) }
END {
    equal("lines", FNR, 8)
    print "world info: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
