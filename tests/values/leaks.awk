# The text of `raydiff leaks` against its JSON: awk -f lib.awk -f leaks.awk FLAT TEXT
# Per million: of no miss the bound that holds with a chance of 95 %, 3 in all rays.
function rate(what, text, count, rays) {
    if (count > 0)
        same(what, text, "%.1f", 1e6 * count / rays)
    else
        same(what, text, "<%.3g", 3e6 / rays)
}
BEGIN {
    aims = split("vertex midpoint edge beside", aim, " ")
    counts = split("misses empty double_hits even lost phantoms repeated", count_of, " ")
    scene = -1
    r = 0
}
/ triangles, [0-9]+ points, [0-9]+ edges, closed; / {
    scene++
    p = "scenes." scene
    split($0, part, ": ")
    equal("scene", part[1], v[p ".scene"])
    text = substr($0, length(part[1]) + 3)
    split(text, word, " ")
    equal("triangles", word[1], v[p ".triangles"])
    equal("points", word[3], v[p ".points"])
    equal("edges", word[5], v[p ".edges"])
    equal("rays", word[8], v[p ".rays"])
    equal("origins", word[11], v[p ".origins"])
    sub(/.*seed [0-9]+; /, "", text)
    same("aimed exactly", substr(text, 1, index(text, " ") - 1), "%.1f", 100 * v[p ".aimed_exactly"] / v[p ".rays"])
    # Euler: a closed mesh of one piece without holes.
    if (v[p ".scene"] ~ /^sphere/) equal("points - edges + triangles", v[p ".points"] - v[p ".edges"] + v[p ".triangles"], 2)
    next
}
/^profile / { equal("profile", $2, v["profile"] ":"); next }
/^layout  *engine / { rows = 1; next }
/^verdict  *layout / {
    narrow = 1
    for (i in place) delete place[i]
    for (i = 1; i <= NF; i++) place[$i] = i
    next
}
/^tests: / {
    for (k in tests) delete tests[k]
    count = split(substr($0, 8), part, /, /)
    for (k = 1; k <= count; k++) { split(part[k], word, " "); tests[word[1]] = word[2] }
    next
}
/^what it means/ { rows = narrow = 0; next }
narrow && /^(  |MISS|DOUBLE)/ { next }
# The table that fits the screen: columns by their titles.
narrow {
    p = "rows." r++
    name = v[p ".scene"] " row " r - 1 " "
    is["layout"] = v[p ".layout"] == "null" ? "-" : v[p ".layout"]
    is["engine"] = v[p ".engine"] == "null" ? "-" : v[p ".engine"]
    is["builder"] = is["layout"] == "-" ? "-" : v[p ".builder"]
    is["box"] = v[p ".box"] == "null" ? "-" : v[p ".box"]
    is["tri"] = v[p ".tri"]
    is["verdict"] = v[p ".broken"] != "" ? "BROKEN" : v[p ".promises"] == "true" ? "kept" : "counted"
    is["misses"] = v[p ".total.misses"]
    for (a = 1; a <= aims; a++) is[aim[a]] = v[p ".aims." aim[a] ".misses"]
    is["doubles"] = v[p ".total.double_hits"]
    is["lost"] = v[p ".total.lost"]
    is["phantom"] = v[p ".total.phantoms"]
    is["even"] = v[p ".total.even"]
    is["repeat"] = v[p ".total.repeated"]
    is["bits"] = v[p ".bit_differences"] == "null" ? "-" : v[p ".bit_differences"]
    if (v[p ".status"] == "ok") {
        for (title in place) equal(name title, $(place[title]), is[title])
        for (title in tests)
            if (is[title] != "-" && is[title] != "own") equal(name title ", of all", tests[title], is[title])
    }
    next
}
rows {
    p = "rows." r++
    name = v[p ".scene"] " row " r - 1 " "
    equal(name "layout", $1, v[p ".layout"] == "null" ? "-" : v[p ".layout"])
    equal(name "engine", $2, v[p ".engine"])
    if (v[p ".status"] != "ok") next
    rays = v[p ".total.rays"]
    rate(name "misses per million", $5, v[p ".total.misses"], rays)
    for (a = 1; a <= aims; a++) {
        equal(name "misses at " aim[a], $(5 + a), v[p ".aims." aim[a] ".misses"])
        if (v[p ".total.double_hits"] != "null") equal(name "doubles at " aim[a], $(10 + a), v[p ".aims." aim[a] ".double_hits"])
    }
    rate(name "doubles per million", $10, v[p ".total.double_hits"], rays)
    equal(name "even", $15, v[p ".total.even"])
    equal(name "lost", $16, v[p ".total.lost"])
    equal(name "phantoms", $17, v[p ".total.phantoms"])
    equal(name "repeated", $18, v[p ".total.repeated"])
    equal(name "word", $20, v[p ".broken"] != "" ? "BROKEN:" : v[p ".promises"] == "true" ? "kept" : "counted")
    for (c = 1; c <= counts; c++) {
        sum = 0
        for (a = 1; a <= aims; a++) sum += v[p ".aims." aim[a] "." count_of[c]]
        equal(name count_of[c] " of all aims", sum, v[p ".total." count_of[c]])
    }
    sum = 0
    for (a = 1; a <= aims; a++) sum += v[p ".aims." aim[a] ".rays"]
    equal(name "rays of all aims", sum, rays)
    # Moeller-Trumbore loses hits at shared edges and makes none up; Woop on watertight boxes does neither.
    if (v[p ".engine"] == "fast") equal(name "test of fast", v[p ".tri"], "woop")
    if (v[p ".tri"] == "mt" && v[p ".total.lost"] + 0 == 0) bad(name "mt loses nothing")
    if (v[p ".total.phantoms"] + 0 != 0) bad(name "a phantom")
    if (v[p ".tri"] == "woop" && v[p ".total.lost"] + 0 != 0) bad(name "woop loses a hit")
    next
}
/ rows promise a closed mesh to be closed/ {
    for (i = 0; i < v["rows.count"]; i++) promised += v["rows." i ".promises"] == "true"
    equal("rows that promise", $1, promised + 0)
    equal("rows", $3, v["rows.count"])
}
END {
    if (scene + 1 != v["scenes.count"]) bad(scene + 1 " scenes, in JSON " v["scenes.count"])
    if (r != v["rows.count"]) bad(r " rows, in JSON " v["rows.count"])
    print "leaks: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
