# `raydiff scene info` against the scene as OBJ and as RTRS's JSON (other.flat), both by scene convert:
# awk -f lib.awk -f obj.awk -f scene_info.awk FLAT other.flat x.obj TEXT
function laws(  k) {
    facts()
    triangles += 0
    vertices += 0
    equal("triangles", v[p "triangles"], triangles)
    equal("vertices", v[p "vertices"], vertices)
    equal("zero area", v[p "zero_area"], made["zero_area"])
    equal("duplicates", v[p "duplicates"], made["duplicates"])
    near("longest side", v[p "longest_side"], made["longest"])
    near("largest coordinate", v[p "largest_coordinate"], made["largest"])
    if (triangles == 0) equal("bounds of nothing", v[p "least"] v[p "most"], "nullnull")
    for (k = 0; k < 3 && triangles > 0; k++) {
        near("least", v[p "least." k], made["lo " k])
        near("most", v[p "most." k], made["hi " k])
    }
    for (k = 0; k < 3; k++) {
        near("camera from", v[p "camera.from." k], w["camera.pos." k])
        near("camera at", v[p "camera.at." k], w["camera.at." k])
    }
    equal("triangles of RTRS's JSON", w["prims.count"], triangles)
    equal("vertices of RTRS's JSON", w["vertices.count"], vertices)
    equal("lights", v[p "lights"], w["lights.count"])
    if (v[p "materials"] > 0) equal("materials", v[p "materials"], w["materials.count"])
    equal("orbit", v[p "camera.orbit"], w["camera_controller"] == "Orbit" ? "true" : "false")
    equal("chosen", v[p "camera.chosen"], v[p "scene"] == "rtrs" || v[p "scene"] ~ /^cornell/ ? "false" : "true")
}
function vector(what, first, path,  k) {
    for (k = 0; k < 3; k++) near(what, $(first + k) + 0, v[p path "." k])
}
BEGIN { p = "scenes.0." }
FNR == 1 { equal("scene", $0, v[p "scene"]); laws(); next }
/^  triangles / { equal("triangles", $2, v[p "triangles"]) }
/^  vertices / { equal("vertices", $2, v[p "vertices"]) }
/^  bounds, least / { vector("least", 3, "least") }
/^  bounds, most / { vector("most", 3, "most") }
/^  longest side / { same("longest side", $3, "%.9g", v[p "longest_side"]) }
/^  largest coordinate / { same("largest coordinate", $3, "%.9g", v[p "largest_coordinate"]) }
/^  zero-area / { equal("zero area", $2, v[p "zero_area"]) }
/^  duplicates / { equal("duplicates", $2, v[p "duplicates"]) }
/^  normals / { equal("normals", $2, v[p "normals"] == "true" ? "yes" : "no") }
/^  lights, materials / { equal("lights and materials", $3 $4, v[p "lights"] "," v[p "materials"]) }
/^  camera from / {
    vector("camera from", 3, "camera.from")
    equal("chosen", /chosen/ ? "true" : "false", v[p "camera.chosen"])
}
/^  camera at / {
    vector("camera at", 3, "camera.at")
    equal("orbit", $NF, v[p "camera.orbit"] == "true" ? "orbit" : "fixed")
}
END {
    equal("lines", FNR, triangles > 0 ? 13 : 11)
    print "scene info: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
