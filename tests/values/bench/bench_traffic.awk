# The text of `raydiff bench traffic` against its JSON: awk -f lib.awk -f bench_traffic.awk FLAT TEXT. Tables of any
# width: a column is found by its title.
function parts(level) {
    return v[p "." level "_nodes"] + v[p "." level "_triangles"] + v[p "." level "_stack"] + v[p "." level "_rays"] + v[p "." level "_hits"]
}
function moved(level) {
    return v[p "." level "_read"] + v[p "." level "_written"]
}
function shown(title, format, number) {
    if (title in cell) same(name title, cell[title], format, number)
}
/: [0-9]+ triangles; [0-9]+ paths?,/ { next }
/^(verdict +)?scheduler / {
    columns = split($0, title, " ")
    next
}
columns && NF == columns && !/^ / {
    delete cell
    for (c = 1; c <= columns; c++) cell[title[c]] = $c
    p = "rows." r++
    name = v[p ".scheduler"] " " v[p ".layout"] " " v[p ".depth"] " "
    rays = v[p ".rays"]
    dram = moved("dram")
    if ("verdict" in cell) equal(name "verdict", cell["verdict"], v[p ".wrong"] > 0 ? "WRONG" : "agrees")
    equal(name "scheduler", cell["scheduler"], v[p ".scheduler"])
    equal(name "layout", cell["layout"], v[p ".layout"])
    if ("store" in cell) equal(name "store", cell["store"], v[p ".store"])
    equal(name "depth", cell["depth"], v[p ".depth"])
    shown("DRAM/ray", "%.1f", v[p ".dram_per_ray"])
    if (v[p ".ratio"] == "null") equal(name "ratio", cell["ratio"], "-")
    else shown("ratio", "%.2f", v[p ".ratio"])
    shown("nodes", "%.1f", v[p ".dram_nodes"] / rays)
    shown("tris", "%.1f", v[p ".dram_triangles"] / rays)
    shown("stack", "%.1f", v[p ".dram_stack"] / rays)
    shown("rays", "%.1f", v[p ".dram_rays"] / rays)
    shown("hits", "%.1f", v[p ".dram_hits"] / rays)
    shown("L1/ray", "%.0f", moved("l1") / rays)
    shown("L2/ray", "%.0f", moved("l2") / rays)
    shown("row-hits", "%.2f", v[p ".row_hits"] / (v[p ".row_hits"] + v[p ".row_misses"]))
    shown("set", "%.2f", v[p ".working_set"] / 1048576)
    shown("ties", "%d", v[p ".ties"])
    shown("alive", "%d", v[p ".alive"])
    # What is counted by cause is what is counted in all; DRAM moves bursts, and level 1 misses no more than it is asked.
    equal(name "level 1 by cause", parts("l1"), moved("l1"))
    equal(name "level 2 by cause", parts("l2"), moved("l2"))
    equal(name "DRAM by cause", parts("dram"), dram)
    equal(name "bursts", dram, 64 * (v[p ".row_hits"] + v[p ".row_misses"]))
    truth(name "misses", v[p ".l1_misses"] <= v[p ".l1_lookups"] && v[p ".l2_misses"] <= v[p ".l2_lookups"])
    truth(name "the working set is read", v[p ".working_set"] <= v[p ".dram_nodes"] + v[p ".dram_triangles"])
    near(name "bytes per ray", v[p ".dram_per_ray"], dram / rays)
    near(name "bytes per frame", v[p ".dram_per_frame"], dram / v[p ".paths"] * 1000000)
    equal(name "verdict", v[p ".wrong"] > 0, 0)
    equal(name "conserved", v[p ".conserved"], "true")
    truth(name "rays", rays >= v[p ".paths"] && rays <= v[p ".paths"] * v[p ".depth"] && v[p ".alive"] <= v[p ".paths"])
    if (v[p ".depth"] == 1) equal(name "rays of depth 1", rays " " v[p ".alive"], v[p ".paths"] " " v[p ".paths"])
    if (v[p ".scheduler"] == "depth_first") base[v[p ".scene"], v[p ".layout"], v[p ".store"], v[p ".depth"]] = dram
    of = v[p ".scheduler"] == "raycore" ? v["rows.0.layout"] SUBSEP v["rows.0.store"] : v[p ".layout"] SUBSEP v[p ".store"]
    # To depth_first of the same tree, if that was played before.
    equal(name "has a ratio", v[p ".ratio"] != "null", (v[p ".scene"], of, v[p ".depth"]) in base)
    if (v[p ".ratio"] != "null") near(name "ratio to depth_first", v[p ".ratio"], dram / base[v[p ".scene"], of, v[p ".depth"]])
    # Deeper paths are more rays, and the same ones at first.
    key = v[p ".scene"] SUBSEP v[p ".scheduler"] SUBSEP v[p ".layout"] SUBSEP v[p ".store"]
    if (key in rays_before) truth(name "deeper paths are more rays", v[p ".depth"] < depth_before[key] || rays >= rays_before[key])
    rays_before[key] = rays
    depth_before[key] = v[p ".depth"]
    next
}
END {
    equal("rows", r + 0, v["rows.count"])
    print "bench traffic: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
