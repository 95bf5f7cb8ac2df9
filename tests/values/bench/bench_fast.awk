# The text of `raydiff bench fast` against its JSON: awk -v rounds=N -f lib.awk -f bench_fast.awk FLAT TEXT
function engine_at(column,  name) {
    name = substr($0, column, 16)
    sub(/ *$/, "", name)
    return name
}
/^fast: [0-9]+ thread/ { threads = $2; next }
/^  rays  *engine / { part = "rows"; next }
/^  engine  *byte/ { part = "engines"; next }
/^  fast small *byte.tri  least$/ { part = "parts"; next }
/^  [a-z ]* left out: / { next }
!part { scene = $0; next }
/^  mean / {
    engine = engine_at(11)
    product = product_warm = 1
    for (i = 0; i < r; i++) if (v["rows." i ".engine"] == engine) {
        product *= v["rows." i ".ratio"]
        product_warm *= v["rows." i ".warm"]
    }
    split(substr($0, 27), word, " ")
    same("mean of " engine, word[1], "%.2f", product ^ 0.25)
    same("warm mean of " engine, word[2], "%.2f", product_warm ^ 0.25)
    means++
    next
}
# What fast small holds: the parts are the whole, and none is less than what it has to hold.
part == "parts" && $1 != "all" {
    truth("least of " $1, $3 + 0 <= $2 + 0)
    held += $2
    needed += $3
    parts++
    next
}
part == "parts" {
    for (i = 0; i < r; i++) if (v["rows." i ".engine"] == "fast small") {
        same("all of fast small", $2, "%.2f", v["rows." i ".bytes_per_triangle"])
        whole++
    }
    truth("parts of fast small", parts == 6 && ($2 - held) ^ 2 < 0.04 ^ 2 && ($3 - needed) ^ 2 < 0.04 ^ 2)
    next
}
part == "engines" {
    engine = engine_at(3)
    missed = found = 0
    for (i = 0; i < r; i++) if (v["rows." i ".engine"] == engine) {
        found++
        missed += v["rows." i ".missed"]
        split(substr($0, 19), word, " ")
        same(engine " bytes a triangle", word[1], "%.1f", v["rows." i ".bytes_per_triangle"])
        equal(engine " called", substr($0, 38), v["rows." i ".called"])
    }
    equal(engine " kinds", found, 4)
    equal(engine " missed", word[2], missed)
    truth(engine " is called as it is", $0 ~ (engine == "embree 16" ? "rtcIntersect16" : engine ~ /^embree/ ? "rtcIntersect1 or" : "raydiff's rays"))
    engines++
    next
}
{
    p = "rows." r++
    name = v[p ".rays"] " " v[p ".engine"] " "
    equal(name "scene", v[p ".scene"], scene)
    equal(name "threads", v[p ".threads"], threads)
    equal(name "rays", $1, v[p ".rays"])
    equal(name "engine", engine_at(11), v[p ".engine"])
    split(substr($0, 27), word, " ")
    same(name "Mray/s", word[1], "%.3f", v[p ".mrays"])
    same(name "warm Mray/s", word[4], "%.3f", v[p ".warm_mrays"])
    if (v[p ".ratio"] != "null") {
        same(name "ratio", word[2], "%.2f", v[p ".ratio"])
        same_span(name "ratio", word[3], "%.2f", v[p ".ratio_least"], v[p ".ratio_most"])
        same(name "warm ratio", word[5], "%.2f", v[p ".warm"])
        same_span(name "warm ratio", word[6], "%.2f", v[p ".warm_least"], v[p ".warm_most"])
    }
    truth(name "whole bytes", v[p ".bytes_per_triangle"] * v[p ".triangles"] - int(v[p ".bytes_per_triangle"] * v[p ".triangles"] + 0.5) < 1e-4)
    for (i = 0; i < v["rows.count"]; i++) {
        q = "rows." i
        if (v[q ".engine"] == "embree" && v[q ".rays"] == v[p ".rays"] && rounds == 1) {
            near(name "ratio to embree", v[p ".ratio"], v[p ".mrays"] / v[q ".mrays"])
            near(name "warm ratio to embree", v[p ".warm"], v[p ".warm_mrays"] / v[q ".warm_mrays"])
        }
        if (v[q ".engine"] == v[p ".engine"]) equal(name "bytes on other rays", v[q ".bytes_per_triangle"], v[p ".bytes_per_triangle"])
    }
    if (v[p ".engine"] ~ /^fast/) truth(name "fast loses what embree hits", v[p ".missed"] == 0)
    if (v[p ".mrays"] + 0 != v[p ".warm_mrays"] + 0) apart++
}
END {
    equal("rows", r, v["rows.count"])
    equal("engines", engines, r / 4)
    equal("parts of fast small on its kinds of rays", whole, 4)
    truth("a warm speed is one of its own", apart > r / 2)
    if (v["rows.0.ratio"] != "null") equal("means", means, r / 4 - 1)
    print "bench fast: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
