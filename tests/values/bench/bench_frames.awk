# The text and the CSV of `raydiff bench frames` against its JSON, where every frame's time stands; bytes against
# `raydiff check` (other.flat): awk -f lib.awk -f bench_frames.awk FLAT other.flat TEXT CSV
# Sorts values 1 to n of `value`.
function sort(value, n,  i, k, x) {
    for (i = 2; i <= n; i++) {
        x = value[i]
        for (k = i - 1; k >= 1 && value[k] > x; k--) value[k + 1] = value[k]
        value[k + 1] = x
    }
}
function median(value, n) {
    sort(value, n)
    return n % 2 ? value[(n + 1) / 2] : (value[n / 2] + value[n / 2 + 1]) / 2
}
# Of the samples: sum, least, most, median; the ratio to the first handler, frame by frame.
function laws(h, name,  i, n, sum, one, ratio, c, engine) {
    engine = v[h ".handler"]
    sub(/.*\(/, "", engine)
    sub(/[ )].*/, "", engine)
    equal(name "what is timed", v[h ".clock"] ~ /, rays alone$/, waves || engine !~ /^vulkan(_brute)?$/)
    n = v[h ".samples_ms.count"]
    equal(name "samples", n, v["frames"])
    for (i = 1; i <= n; i++) {
        sum += one[i] = v[h ".samples_ms." i - 1]
        ratio[i] = one[i] / v["handlers.0.samples_ms." i - 1]
    }
    near(name "average", v[h ".average_ms"], sum / n)
    near(name "median", v[h ".median_ms"], median(one, n))
    near(name "least", v[h ".min_ms"], one[1])
    near(name "most", v[h ".max_ms"], one[n])
    if ((h ".ratio.to") in v) {
        equal(name "ratio to", v[h ".ratio.to"], v["handlers.0.handler"])
        near(name "ratio, median", v[h ".ratio.median"], median(ratio, n))
        near(name "ratio, least", v[h ".ratio.min"], ratio[1])
        near(name "ratio, most", v[h ".ratio.max"], ratio[n])
    }
    for (c = 0; c < w["rows.count"]; c++)
        if (w["rows." c ".status"] == "ok" && w["rows." c ".engine"] " " w["rows." c ".layout"] == v[h ".handler"]) {
            equal(name "bytes of check", v[h ".bytes"], w["rows." c ".node_bytes"] + w["rows." c ".item_bytes"])
            compared++
        }
}
FILENAME ~ /csv$/ {
    gsub(/"host clock, rays alone"/, "host clock; rays alone")
    gsub(/"GPU timestamps, rays alone"/, "GPU timestamps; rays alone")
    if (FNR == 1) next
    split($0, field, ",")
    frame = (FNR - 2) % v["frames"]
    if (frame == 0) h = "handlers." csv++
    name = "CSV " field[1] " frame " frame " "
    equal(name "handler", field[1], v[h ".handler"])
    equal(name "bytes", field[2], v[h ".bytes"])
    gsub(/;/, ",", field[3])
    equal(name "clock", field[3], v[h ".clock"])
    equal(name "number", field[4], frame)
    near(name "angle", field[5] + 0, 360 * v["turns"] * frame / v["frames"])
    near(name "ms", field[6] + 0, v[h ".samples_ms." frame])
    near(name "average", field[7] + 0, v[h ".average_ms"])
    near(name "least", field[8] + 0, v[h ".min_ms"])
    near(name "most", field[9] + 0, v[h ".max_ms"])
    near(name "median", field[10] + 0, v[h ".median_ms"])
    next
}
FNR == 1 {
    equal("title", $0, v["title"])
    equal("scene", substr($0, 1, index($0, ": ") - 1), v["notes.scene"])
    next
}
/^[0-9]+ frames over [0-9]+ turn/ {
    equal("frames", $1, v["frames"])
    equal("frames asked for", v["frames"], v["frames_asked"])
    equal("turns", $4, v["turns"])
    text = $0
    sub(/.*; /, "", text)
    split(text, word, " ")
    equal("dropped", word[1], v["warm_up_dropped"])
    next
}
/^handler / {
    heads($0)
    equal("columns", wide ? columns : 9, 9)
    rows = 1
    next
}
/^ms per frame/ {
    equal("ratios are told of", /first handler$/, v["handlers.count"] > 1)
    next
}
/^written: / { next }
rows {
    h = "handlers." r++
    name = v[h ".handler"] " "
    phrase["handler"] = v[h ".handler"]
    phrase["clock"] = v[h ".clock"]
    cells($0)
    says(name, "bytes", v[h ".bytes"])
    number(name, "average", "%.3f", v[h ".average_ms"])
    number(name, "least", "%.3f", v[h ".min_ms"])
    number(name, "most", "%.3f", v[h ".max_ms"])
    number(name, "median", "%.3f", v[h ".median_ms"])
    if ((h ".ratio.to") in v) {
        number(name, "ratio", "%.3f", v[h ".ratio.median"])
        span(name, "ratio least-most", "%.3f", v[h ".ratio.min"], v[h ".ratio.max"])
    } else
        says(name, "ratio", "-")
    truth(name "what tells it apart", ("handler" in cell) && ("average" in cell) && ("clock" in cell))
    laws(h, name)
}
END {
    equal("handlers", r, v["handlers.count"])
    truth("versions of raydiff and of what it uses", v["notes.versions"] ~ /^raydiff [0-9.]+/)
    equal("handlers in CSV", csv, v["handlers.count"])
    if (w["rows.count"] > 0) truth("bytes of check", compared > 0)
    print "bench frames: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
