# The text of `raydiff bench tightness` against its JSON: awk -f lib.awk -f bench_tightness.awk FLAT TEXT
/: [0-9]+ triangles, [0-9]+ pairs$/ {
    match($0, /: [0-9]+ triangles, /)
    equal("scene", substr($0, 1, RSTART - 1), v["rows." r + 0 ".scene"])
    equal("pairs", $(NF - 1), v["rows." r + 0 ".pairs"])
    next
}
/^  formula  *rounding/ { rows = 1; next }
rows && NF >= 13 {
    p = "rows." r++
    name = v[p ".formula"] " " v[p ".rounding"] " "
    shift = NF - 13
    equal(name "formula", $1, v[p ".formula"])
    equal(name "rounding", $2 (shift ? " " $3 : ""), v[p ".rounding"])
    same(name "real", $(3 + shift), "%.2f", v[p ".real_p50"])
    same(name "real, 99.9 %", $(4 + shift), "%.2f", v[p ".real_p999"])
    same(name "real, most", $(5 + shift), "%.3g", v[p ".real_most"])
    same(name "rejected", $(6 + shift), "%.3g", v[p ".rejected_p50"])
    same(name "rejected, 99.9 %", $(7 + shift), "%.3g", v[p ".rejected_p999"])
    same(name "medians", $(8 + shift), "%.1f", v[p ".medians"])
    same(name "times", $(9 + shift), "%.1f", v[p ".times"])
    same(name "groups", $(10 + shift), "%.1f", v[p ".group_p50"])
    same(name "worst", $(11 + shift), "%.1f", v[p ".group_most"])
    equal(name "alarms", $(12 + shift), v[p ".alarms"])
    equal(name "no bound", $(13 + shift), v[p ".unbounded"])
    near(name "medians", v[p ".medians"], v[p ".rejected_p50"] / v[p ".real_p50"])
    near(name "times", v[p ".times"], v[p ".rejected_p50"] / v[p ".real_p999"])
    truth(name "in order", v[p ".real_p50"] <= v[p ".real_p999"] && v[p ".real_p999"] <= v[p ".real_most"] &&
          v[p ".rejected_p50"] <= v[p ".rejected_p999"] && v[p ".group_p50"] <= v[p ".group_most"])
    # Fewer than two thousand that have a bound are one group.
    if (v[p ".pairs"] < 2000) equal(name "one group", v[p ".group_p50"], v[p ".group_most"])
    if (v[p ".unbounded"] == 0 && v[p ".pairs"] < 2000) near(name "the group of all", v[p ".group_p50"], v[p ".times"])
    equal(name "alarms", v[p ".alarms"], 0)
    # The real error is of the formula; what is rejected grows with the rounding that is allowed.
    if (v[p ".formula"] == before) {
        equal(name "real of another rounding", v[p ".real_p50"] " " v[p ".real_most"], v["rows." r - 2 ".real_p50"] " " v["rows." r - 2 ".real_most"])
        truth(name "rejects more than a stricter rounding", v[p ".rejected_p50"] >= v["rows." r - 2 ".rejected_p50"])
    }
    before = v[p ".formula"]
}
END {
    equal("rows", r, v["rows.count"])
    print "bench tightness: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
