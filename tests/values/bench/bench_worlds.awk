# The text of `raydiff bench worlds` against its JSON: awk -v rounds=N -f lib.awk -f bench_worlds.awk FLAT TEXT
# mesh: triangles of the mesh; count: --count; differ: engines choose other triangles at equal t
/^worlds: [0-9]+ thread/ { threads = $2; next }
/^  rays  *engine / { next }
/ instances, .* triangles placed/ {
    scene = $1
    sub(/:$/, "", scene)
    instances = $2
    placed = $4
    equal("placed triangles", placed, instances * mesh)
    truth("seconds of the trees", $(NF - 1) ~ /^[0-9]+\.[0-9]$/ && $NF == "s")
    next
}
/^  mean / {
    product = 1
    for (i = 0; i < r; i++) if (v["rows." i ".engine"] == $2) product *= v["rows." i ".ratio"]
    same("mean of " $2, $NF, "%.3f", product ^ 0.25)
    means++
    next
}
/^  / {
    p = "rows." r++
    name = v[p ".rays"] " " v[p ".engine"] " "
    equal(name "scene", v[p ".scene"], scene)
    equal(name "instances", v[p ".instances"], instances)
    equal(name "triangles", v[p ".triangles"], placed)
    equal(name "threads", v[p ".threads"], threads)
    equal(name "rays", $1, v[p ".rays"])
    equal(name "engine", $2, v[p ".engine"])
    same(name "Mray/s", $3, "%.3f", v[p ".mrays"])
    if (v[p ".ratio"] != "null") {
        same(name "ratio", $4, "%.3f", v[p ".ratio"])
        same_span(name "ratio", $5, "%.3f", v[p ".ratio_least"], v[p ".ratio_most"])
    }
    equal(name "missed", $6, v[p ".missed"])
    equal(name "WRONG", $7, v[p ".wrong"])
    truth(name "as many are judged as are first", v[p ".judged"] >= (count < 2000 ? count : 2000) && v[p ".judged"] <= count)
    if (differ && v[p ".rays"] == "random") truth(name "is judged where engines differ", v[p ".judged"] > 2000)
    truth(name "is judged where another hits", v[p ".judged"] >= v[p ".missed"])
    for (i = 0; i < v["rows.count"]; i++) {
        q = "rows." i
        if (v[q ".engine"] == "embree" && v[q ".rays"] == v[p ".rays"] && rounds == 1)
            near(name "ratio to embree", v[p ".ratio"], v[p ".mrays"] / v[q ".mrays"])
    }
}
END {
    equal("rows", r, v["rows.count"])
    if (v["rows.0.ratio"] != "null") equal("means", means, r / 4 - 1)
    print "bench worlds: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
