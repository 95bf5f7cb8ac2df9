# `raydiff construct --json` against the same without it (TEXT) and what it wrote (other.flat):
# awk -f lib.awk -f construct.awk FLAT other.flat TEXT
# True if the corners of the triangle written as number t lie on a line or coincide.
function no_area(t,  k, a, b, u, x, sum) {
    for (k = 0; k < 3; k++) {
        u[k] = at_corner(t, 1, k) - at_corner(t, 0, k)
        x[k] = at_corner(t, 2, k) - at_corner(t, 0, k)
    }
    for (k = 0; k < 3; k++) {
        a = (k + 1) % 3
        b = (k + 2) % 3
        sum += (u[a] * x[b] - u[b] * x[a]) ^ 2
    }
    return sum == 0
}
function at_corner(t, c, k) { return w["vertices." w["prims." t ".indices." c] ".pos." k] }
function laws(  i, t, triangles, vertices, used, of, shaped, bare, unused, written) {
    for (i = 0; i < v["models.count"]; i++) {
        triangles += v["models." i ".triangles"]
        vertices += v["models." i ".vertices"]
        of[v["models." i ".material"] + 0] += v["models." i ".triangles"]
    }
    equal("triangles of all models", v["triangles"], triangles)
    equal("vertices of all models", v["vertices"], vertices)
    equal("triangles written", w["prims.count"], v["triangles"])
    equal("vertices written", w["vertices.count"], v["vertices"])
    equal("materials written", w["materials.count"], v["materials"])
    equal("lights written", w["lights.count"], v["lights"])
    equal("camera written", tolower(w["camera_controller"]), v["camera"])
    for (t = 0; t < w["prims.count"]; t++) {
        written[w["prims." t ".material"] + 0]++
        for (i = 0; i < 3; i++) used[w["prims." t ".indices." i] + 0] = 1
    }
    # Vertices whose triangles have no area have no normal of them.
    for (t = 0; t < w["prims.count"]; t++)
        for (i = 0; i < 3 && !no_area(t); i++) shaped[w["prims." t ".indices." i] + 0] = 1
    for (i in used) bare += !(i in shaped)
    equal("vertices without a normal", v["filled_normals"], bare + 0)
    for (i in of) equal("triangles of material " i, written[i], of[i])
    for (i = 0; i < w["vertices.count"]; i++) unused += !(i in used)
    equal("vertices of no triangle", v["unused_vertices"], unused + 0)
    if (v["default_material"] != "null") equal("default material is the last", v["default_material"], v["materials"] - 1)
}
FNR == 1 {
    laws()
    equal("out", $1, v["out"] ":")
    gsub(",", "")
    equal("models", $2, v["models.count"])
    equal("triangles and vertices", $4 " " $6, v["triangles"] " " v["vertices"])
    equal("materials and lights", $8 " " $10, v["materials"] " " v["lights"])
    equal("camera", $NF, v["camera"])
}
/ is the default red$/ { equal("default material", $2, v["default_material"]); told["default"] = 1 }
/^vertices of no triangle, / { equal("unused", $NF, v["unused_vertices"]); told["unused"] = 1 }
/^vertices without a normal / { equal("filled", $NF, v["filled_normals"]); told["filled"] = 1 }
END {
    equal("default red is told", told["default"] + 0, v["default_material"] != "null")
    equal("unused are told", told["unused"] + 0, v["unused_vertices"] > 0)
    equal("filled are told", told["filled"] + 0, v["filled_normals"] > 0)
    print "construct: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
