# `raydiff render` against its paths (CSV), its picture and what --show counts (other.flat: boxes of the same view, if
# a path has one segment): awk -f lib.awk -f pixels.awk -f paths.awk -f render.awk FLAT [other.flat] [a.pixels] a.csv TEXT
function size_of(text) { return text == "f32" ? 32 : text == "rf16" || text == "rtrs_rf" ? 16 : 48 }
function dot(a, b,  k, sum) {
    for (k = 0; k < 3; k++) sum += v[a "." k] * v[b "." k]
    return sum + 0
}
function close_to(what, number, is) { truth(what ": " number ", and computed anew " is, (number - is) ^ 2 < 1e-8 * (1 + is * is)) }
function frame(f,  p, turn) {
    p = "frames." f
    name = "frame " f " "
    if ((0, f) in in_all) {
        equal(name "rays of paths", v[p ".rays.closest"], in_all[0, f])
        equal(name "rays to lights", v[p ".rays.shadow"], lights[0, f])
        equal(name "pixels that hit", v[p ".rays.hit_pixels"], hit[0, f])
        with_paths++
    }
    truth(name "tracing takes no longer than all", v[p ".trace_ns"] <= v[p ".wall_ns"] && v[p ".wall_ns"] <= took)
    truth(name "ns", v[p ".wall_ns"] > 1000)
    turn = 2 * 3.14159265358979 * f / v["frames.count"]
    close_to(name "angle", v[p ".angle"], turn)
    close_to(name "forward has length 1", dot(p ".forward", p ".forward"), 1)
    # It turns around its target, in a plane: as far from it as in the first frame, and by that angle.
    if (orbit) {
        close_to(name "distance", dot(p ".pos", p ".pos"), dot("frames.0.pos", "frames.0.pos"))
        near(name "height", v[p ".pos.1"], v["frames.0.pos.1"])
        close_to(name "turn", dot(p ".forward", "frames.0.forward"), cos(turn))
    }
    sum_ns += v[p ".trace_ns"]
}
function laws(  f, tree) {
    for (f = 0; f < v["frames.count"]; f++) frame(f)
    # Of scene rtrs, as scene info has it.
    if (v["scene"] == "rtrs") equal("camera", v["frames.0.pos.0"] " " v["frames.0.pos.1"] " " v["frames.0.pos.2"], "0.0 0.0 -10.0")
    if (width[0]) equal("size of the picture", width[0] "x" height[0], v["width"] "x" v["height"])
    if (pixels[0]) equal("pixels", pixels[0], v["width"] * v["height"])
    if (v["tree"] != "null")
        equal("bytes", v["tree.node_bytes"], size_of(v["tree.layout"]) * v["tree.records"])
    if (v["tree.layout"] == "f32") equal("items", v["tree.item_bytes"], 4 * v["triangles"])
    if (v["tree.layout"] ~ /rf/) equal("items", v["tree.item_bytes"], 0)
    if (v["bounces"] == 1) equal("a ray a pixel", v["frames.0.rays.closest"], v["width"] * v["height"])
    if (!("layers.0.counted.boxes" in w)) return
    equal("boxes of --show", v["frames.0.box_tests"], w["layers.0.counted.boxes"])
    equal("triangles of --show", v["frames.0.triangle_tests"], w["layers.0.counted.triangles"])
    compared++
}
FNR == 1 {
    laws()
    if (with_paths) equal("frames with paths", with_paths, v["frames.count"])
}
/ rays \([0-9]+ of them to lights\), / {
    match($0, /: [0-9]+ x [0-9]+, /)
    equal("file", substr($0, 1, RSTART - 1), v["frames.0.file"])
    split(substr($0, RSTART + 2), word, /[ ,():]+/)
    equal("size", word[1] " " word[3], v["width"] " " v["height"])
    equal("rays", word[4], v["frames.0.rays.closest"] + v["frames.0.rays.shadow"])
    equal("rays to lights", word[6], v["frames.0.rays.shadow"])
    same("ms tracing", word[11], "%.1f", v["frames.0.trace_ns"] * 1e-6)
    same("ms in all", word[18], "%.1f", v["frames.0.wall_ns"] * 1e-6)
    equal("clock", word[16], v["frames.0.clock"] "'s")
    if (v["tree"] != "null") equal("bytes", word[22] " " word[23], v["tree.layout"] " " v["tree.node_bytes"] + v["tree.item_bytes"])
    told++
}
/^[0-9]+ pictures?, / {
    equal("pictures", $1, v["frames.count"])
    equal("first", $3, v["frames.0.file"])
    same("ms tracing each", $6, "%.1f", sum_ns / v["frames.count"] * 1e-6)
    equal("clock", $(NF - 1), v["frames.0.clock"] "'s")
    told++
}
END {
    equal("lines", told, 1)
    if (w["show"] != "") truth("nothing is compared with --show", compared)
    print "render: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
