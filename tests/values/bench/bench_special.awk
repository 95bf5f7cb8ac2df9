# The text of `raydiff bench special` against its JSON: awk -v rounds=N -f lib.awk -f bench_special.awk FLAT TEXT
/^verdict / {
    heads($0)
    if (wide) equal("columns", columns, 8)
    rows = 1
    next
}
rows && /^(agrees|DIFFERS|SLOWER) / {
    p = "rows." r++
    name = v[p ".what"] " "
    phrase["scene"] = v[p ".what"]
    cells($0)
    number(name, "special", "%.3f", v[p ".special_ms"])
    number(name, "general", "%.3f", v[p ".general_ms"])
    number(name, "ratio", "%.3f", v[p ".ratio_median"])
    span(name, "ratio least-most", "%.3f", v[p ".ratio_min"], v[p ".ratio_max"])
    equal(name "bits", /^DIFFERS/ ? "false" : "true", v[p ".bits_equal"])
    if (rounds == 1) near(name "ratio", v[p ".ratio_median"], v[p ".general_ms"] / v[p ".special_ms"])
    equal(name "frames", v[p ".frames"], rounds)
    # Too few frames bound no median.
    if (rounds < 5) equal(name "median's bound", v[p ".ratio_median_95_most"], "null")
    if (v[p ".four_to_one_bounce"] == "null") { says(name, "paid", "-"); next }
    paid++
    number(name, "paid", "%.3f", v[p ".four_to_one_bounce"])
    span(name, "paid least-most", "%.3f", v[p ".four_to_one_bounce_min"], v[p ".four_to_one_bounce_max"])
}
END {
    equal("rows", r, v["rows.count"])
    truth("scenes", r >= 3)
    equal("scenes without a bounce", paid, 1)
    print "bench special: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
