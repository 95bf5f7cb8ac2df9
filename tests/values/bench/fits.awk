# The tables of `raydiff bench` in 80 columns against the JSON, row by row:
# awk -v bench=NAME -f lib.awk -f fits.awk FLAT TEXT
# Of a name of several words the rest belongs to column `named`.
function rate(what, text, events, count,  number) {
    number = 1e6 * (events > 0 ? events : 3) / (count > 0 ? count : 1)
    equal(what, text, count == 0 ? "-" : (events > 0 ? "" : "<") sprintf(number < 999.5 ? "%.3g" : "%.0f", number))
}
function number(title, format, value) { if (title in cell) same(p " " title, cell[title], format, value) }
function word(title, text) { if (title in cell) equal(p " " title, cell[title], text == "null" ? "-" : text) }
function share(title, events, count) { if (title in cell) rate(p " " title, cell[title], v[p events], v[p count]) }
function bytes(title, count) {
    if (v[p ".layout"] == "-" && v[p ".engine"] != "kd") word(title, "-")
    else number(title, "%.1f", count / v[p ".triangles"])
}
function verdict(judged, wrong) { word("verdict", judged == "false" ? "counted" : wrong > 0 ? "WRONG" : "agrees") }
function row_of_layouts() {
    verdict("true", v[p ".differences"])
    word("wrong", v[p ".differences"])
    bytes("nodeB", v[p ".node_bytes"])
    bytes("+items", v[p ".node_bytes"] + v[p ".item_bytes"])
    number("mem/tri", "%.1f", v[p ".memory_bytes"] / v[p ".triangles"])
    word("of", v[p ".base_engine"] == v[p ".engine"] && v[p ".base_layout"] != "-" ? v[p ".base_layout"] : v[p ".base_engine"])
}
function row_of_error() {
    verdict(v[p ".judged"], v[p ".wrong"])
    word("WRONG", v[p ".wrong"])
    word("allowed", v[p ".named"])
    share("lost", ".lost", ".compared")
    share("phantom", ".phantom", ".compared")
    share("wrong-id", ".wrong_id", ".compared")
    share("edge", ".edge_leaks", ".edge_rays")
    share("vertex", ".vertex_leaks", ".vertex_rays")
    number("err/E", "%.3f", v[p ".err_over_bound"])
    word("of", v[p ".base"])
    if ("tri" in cell) word("tri", v[p ".tri"] == "null" ? "own" : v[p ".tri"])
    word("box", v[p ".box"])
}
function row_of_matrix() {
    verdict(v[p ".judged"], v[p ".judged_wrong"])
    word("contestant", v[p ".name"])
    word("WRONG", v[p ".judged_wrong"])
    word("lost", v[p ".lost"])
    word("leaks", v[p ".leaks"])
    number("B/tri", "%.1f", v[p ".bytes_per_triangle"])
    number("prim", "%.2f", v[p ".prim_ratio"])
    number("rand", "%.2f", v[p ".rand_ratio"])
    number("diff", "%.2f", v[p ".diff_ratio"])
    number("o-shad", "%.2f", v[p ".o-shad_ratio"])
    number("o-rand", "%.2f", v[p ".o-rand_ratio"])
    number("mean", "%.2f", v[p ".mean_ratio"])
    number("Mray/s", "%.3f", v[p ".prim_mrays"])
}
function row_of_spawn() {
    word("point", v[p ".point"])
    word("rule", v[p ".rule"])
    word("judge", v[p ".engine"])
    number("moved-p50", "%.2g", v[p ".moved_p50"])
    number("moved-max", "%.2g", v[p ".moved_max"])
    share("self", ".self", ".hits")
    share("beside", ".beside", ".hits")
    share("skip", ".skipped", ".hits")
}
function row_of_builders() {
    word("builder", v[p ".builder"] (v[p ".reinsert"] > 0 ? " reinsert=" v[p ".reinsert"] : v[p ".rotate"] > 0 ? " rotate=" v[p ".rotate"] : v[p ".presplit"] > 0 ? " presplit=" v[p ".presplit"] : v[p ".split_budget"] > 0 ? " split-budget=" v[p ".split_budget"] : ""))
    word("threads", v[p ".threads"])
    number("ns/tri", "%.1f", v[p ".ns_per_tri_median"])
    number("SAH", "%.2f", v[p ".sah"])
    number("overlap", "%.2f", v[p ".overlap"])
    word("nodes", v[p ".nodes"])
    number("fill", "%.2f", v[p ".leaf_fill"])
}
function row_of_tightness() {
    word("verdict", v[p ".alarms"] > 0 ? "ALARM" : "agrees")
    word("formula", v[p ".formula"])
    word("rounding", v[p ".rounding"])
    word("alarms", v[p ".alarms"])
    word("no-bound", v[p ".unbounded"])
    number("real", "%.2f", v[p ".real_p50"])
    number("99.9-%", "%.2f", v[p ".real_p999"])
    number("most", "%.3g", v[p ".real_most"])
    number("rejected", "%.3g", v[p ".rejected_p50"])
    number("medians", "%.1f", v[p ".medians"])
}
BEGIN { named["tightness"] = 3; named["matrix"] = 2; named["spawn"] = 3; named["builders"] = 1 }
length($0) > 80 { bad("longer than 80 columns: " $0) }
/^(verdict|point|builder) / {
    columns = split($0, title, " ")
    heads++
    next
}
columns && NF >= columns && !/^ / && $1 !~ /:$/ {
    more = NF - columns
    delete cell
    for (c = 1; c <= columns; c++) {
        text = $(c + (more > 0 && c > named[bench] ? more : 0))
        if (c == named[bench]) for (k = 1; k <= more; k++) text = text " " $(c + k)
        cell[title[c]] = text
    }
    p = "rows." rows++
    if (bench != "matrix" && bench != "spawn" && bench != "tightness") {
        word("engine", v[p ".engine"])
        word("layout", v[p ".layout"])
        word("rays", v[p ".rays"])
        number("Mray/s", "%.3f", v[p ".mrays_median"])
        number("ratio", "%.2f", v[p ".ratio_median"])
    }
    if (bench != "error") word("allowed", v[p ".allowed"])
    if (bench == "layouts") row_of_layouts()
    if (bench == "error") row_of_error()
    if (bench == "matrix") row_of_matrix()
    if (bench == "spawn") row_of_spawn()
    if (bench == "builders") row_of_builders()
    if (bench == "tightness") row_of_tightness()
    next
}
{ columns = 0 }
END {
    equal("rows in 80 columns", rows + 0, v["rows.count"])
    print "bench " bench " in 80 columns: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < 5
}
