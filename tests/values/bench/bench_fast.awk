# The text of `raydiff bench fast` against its JSON: awk -v rounds=N -f lib.awk -f bench_fast.awk FLAT TEXT
/^fast: [0-9]+ thread/ { threads = $2; next }
/^  rays  *engine / { rows = 1; next }
!rows { scene = $0; next }
/^  mean / {
    engine = substr($0, 12, 14)
    sub(/ *$/, "", engine)
    product = 1
    for (i = 0; i < r; i++) if (v["rows." i ".engine"] == engine) product *= v["rows." i ".ratio"]
    same("mean of " engine, $NF, "%.3f", product ^ 0.25)
    means++
    next
}
{
    p = "rows." r++
    name = v[p ".rays"] " " v[p ".engine"] " "
    engine = substr($0, 12, 14)
    sub(/ *$/, "", engine)
    equal(name "scene", v[p ".scene"], scene)
    equal(name "threads", v[p ".threads"], threads)
    equal(name "rays", $1, v[p ".rays"])
    equal(name "engine", engine, v[p ".engine"])
    split(substr($0, 26), word, " ")
    same(name "Mray/s", word[1], "%.3f", v[p ".mrays"])
    if (v[p ".ratio"] != "null") {
        same(name "ratio", word[2], "%.3f", v[p ".ratio"])
        same_span(name "ratio", word[3], "%.3f", v[p ".ratio_least"], v[p ".ratio_most"])
    }
    same(name "bytes a triangle", word[4], "%.1f", v[p ".bytes_per_triangle"])
    equal(name "missed", word[5], v[p ".missed"])
    truth(name "whole bytes", v[p ".bytes_per_triangle"] * v[p ".triangles"] - int(v[p ".bytes_per_triangle"] * v[p ".triangles"] + 0.5) < 1e-4)
    for (i = 0; i < v["rows.count"]; i++) {
        q = "rows." i
        if (v[q ".engine"] == "embree" && v[q ".rays"] == v[p ".rays"] && rounds == 1)
            near(name "ratio to embree", v[p ".ratio"], v[p ".mrays"] / v[q ".mrays"])
        if (v[q ".engine"] == v[p ".engine"]) equal(name "bytes on other rays", v[q ".bytes_per_triangle"], v[p ".bytes_per_triangle"])
    }
    if (v[p ".engine"] ~ /^fast/) truth(name "fast loses what embree hits", v[p ".missed"] == 0)
}
END {
    equal("rows", r, v["rows.count"])
    if (v["rows.0.ratio"] != "null") equal("means", means, r / 4 - 1)
    print "bench fast: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
