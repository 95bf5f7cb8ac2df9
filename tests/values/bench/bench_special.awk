# The text of `raydiff bench special` against its JSON: awk -v rounds=N -f lib.awk -f bench_special.awk FLAT TEXT
/^scene  *special  *general/ { rows = 1; next }
rows && /bits equal|BITS DIFFER/ {
    p = "rows." r++
    name = substr($0, 1, 30)
    sub(/ *$/, "", name)
    equal("scene", name, v[p ".what"])
    split(substr($0, 31), word, " ")
    same(name " special", word[1], "%.3f", v[p ".special_ms"])
    same(name " general", word[2], "%.3f", v[p ".general_ms"])
    same(name " ratio", word[3], "%.3f", v[p ".ratio_median"])
    same_span(name " ratio", word[4], "%.3f", v[p ".ratio_min"], v[p ".ratio_max"])
    equal(name " bits", /bits equal/ ? "true" : "false", v[p ".bits_equal"])
    if (rounds == 1) near(name " ratio", v[p ".ratio_median"], v[p ".general_ms"] / v[p ".special_ms"])
    equal(name " frames", v[p ".frames"], rounds)
    # Too few frames bound no median.
    if (rounds < 5) equal(name " median's bound", v[p ".ratio_median_95_most"], "null")
    equal(name " bounces", /4 bounces asked to 1: / ? "told" : "", v[p ".four_to_one_bounce"] == "null" ? "" : "told")
    if (!match($0, /4 bounces asked to 1: /)) next
    split(substr($0, RSTART + RLENGTH), word, " ")
    same(name " bounces", word[1], "%.3f", v[p ".four_to_one_bounce"])
    same_span(name " bounces", word[2], "%.3f", v[p ".four_to_one_bounce_min"], v[p ".four_to_one_bounce_max"])
}
END {
    equal("rows", r, v["rows.count"])
    truth("scenes", r >= 3)
    print "bench special: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
