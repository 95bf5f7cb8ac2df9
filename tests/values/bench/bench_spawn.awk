# The text of `raydiff bench spawn` against its JSON: awk -f lib.awk -f bench_spawn.awk FLAT TEXT
function rate(what, text, events, count,  number) {
    number = 1e6 * (events > 0 ? events : 3) / (count > 0 ? count : 1)
    checked++
    if (text != (count == 0 ? "-" : (events > 0 ? "" : "<") sprintf(number < 999.5 ? "%.3g" : "%.0f", number)))
        bad(what ": printed " text ", is " events " of " count)
}
# The block's first row, and its rows: as many for each line of the table as there are judges, and one for the truth.
/, scale .*, far .*: [0-9]+ triangles; / {
    match($0, /, scale .*, far .*: [0-9]+ triangles; /)
    first = r + 0
    line = 0
    p = "rows." first
    equal("scene", substr($0, 1, RSTART - 1), v[p ".scene"])
    split(substr($0, RSTART + 2), word, /[ ,:;]+/)
    name = v[p ".scene"] " " word[2] " " word[4] " "
    same(name "scale", word[2], "%g", v[p ".scale"])
    same(name "far", word[4], "%g", v[p ".far"])
    equal(name "triangles", word[5], v[p ".triangles"])
    rays = word[7]
    equal(name "rays", word[8], v[p ".rays"])
    equal(name "seed", word[11], v[p ".seed"])
    equal(name "hits", word[12], v[p ".hits"])
    truth(name "more hits than rays", word[12] + 0 <= rays + 0)
    near_most = "?"
    if (match($0, /moved: up to [0-9]+ \(/)) near_most = substr($0, RSTART + 13, RLENGTH - 15)
    blocks++
    equal(name "undecided", substr($(NF - 1), 2), v[p ".undecided"])
    next
}
/^  *moved  *exact/ {
    judges = 0
    while (v["rows." (first + judges + 1) ".engine"] != "exact" && v["rows." (first + judges + 1) ".engine"] != "") judges++
    for (j = 1; j <= judges; j++) truth(name "heads", index($0, "  " v["rows." (first + j) ".engine"] " ") > 0)
    next
}
/^(o\+td|bary) / {
    for (j = 0; j <= judges; j++) {
        p = "rows." r++
        what = name $1 " " $2 " " v[p ".engine"] " "
        equal(what "point", $1, v[p ".point"])
        equal(what "rule", $2, v[p ".rule"])
        same(what "moved p50", $3, "%.2g", v[p ".moved_p50"])
        same(what "moved max", $4, "%.2g", v[p ".moved_max"])
        rate(what "self", $(5 + 3 * j), v[p ".self"], v[p ".hits"])
        rate(what "beside", $(6 + 3 * j), v[p ".beside"], v[p ".hits"])
        rate(what "skip", $(7 + 3 * j), v[p ".skipped"], v[p ".hits"])
        truth(what "a ray has one fate", v[p ".self"] + v[p ".beside"] + v[p ".skipped"] <= v[p ".hits"] + 0)
        # No two triangles of a soup touch, unless rounding far away moves their corners together.
        if (v[p ".scene"] ~ /^soup/ && v[p ".far"] < 1e5) equal(what "beside", v[p ".beside"], 0)
        if (v[p ".scene"] ~ /^sphere/ && v[p ".far"] > 1e5 && $2 == "none") beside += v[p ".beside"]
        if (v[p ".scene"] ~ /^sphere/) spheres++
        apart += v[p ".moved_p99"] < v[p ".moved_max"]
        truth(what "moved, in order", v[p ".moved_p50"] <= v[p ".moved_p99"] && v[p ".moved_p99"] <= v[p ".moved_max"])
        # Who is moved less than a constant is rounded to where it was.
        if ($2 == "1e-3") truth(what "moved as far as told", v[p ".moved_p99"] >= 0.9e-3)
        if ($2 == "1e-4" && v[p ".far"] == 0 && v[p ".scale"] <= 1) truth(what "moved as far as told", v[p ".moved_p50"] >= 0.9e-4 && v[p ".moved_p50"] < 2e-4)
        if ($2 == "1e-5" && v[p ".far"] == 0 && v[p ".scale"] <= 1) truth(what "moved as far as told", v[p ".moved_p50"] >= 0.9e-5 && v[p ".moved_p50"] < 2e-5)
        truth(what "skipped without a surface near", v[p ".skipped"] <= v[p ".near"] + 0)
        if ($2 == "least") {
            truth(what "steps, in order", v[p ".steps_p50"] <= v[p ".steps_p99"] && v[p ".steps_p99"] <= v[p ".steps_max"])
            if (j == 0) equal(what "freed all but those that no step frees", v[p ".self"], v[p ".never"])
        } else
            equal(what "steps", v[p ".steps_p50"] v[p ".never"], "null0")
        if (j == 0 && v[p ".near"] + 0 > most_near + 0) most_near = v[p ".near"]
    }
    line++
    next
}
/^(o\+td|bary): / {
    point = $1
    sub(":", "", point)
    if (line > 0) equal(name "most near", near_most, most_near + 0)
    line = most_near = 0
    least_told++
    for (i = first; i < r; i++)
        if (v["rows." i ".point"] == point && v["rows." i ".rule"] == "least" && v["rows." i ".engine"] == "exact") p = "rows." i
    what = name point " "
    same(what "steps for 50 %", $2, "%.0f", v[p ".steps_p50"])
    same(what "steps for 99 %", $11, "%.0f", v[p ".steps_p99"])
    same(what "steps for all", $15, "%.0f", v[p ".steps_max"])
    never = match($0, / but [0-9]+,/) ? substr($0, RSTART + 5, RLENGTH - 6) : 0
    equal(what "no step frees", never, v[p ".never"])
}
END {
    equal("rows", r, v["rows.count"])
    # Who does not move from a mesh that is far away is beside the triangle it left, some time.
    truth("beside", spheres == 0 || beside > 0)
    equal("lines of the rule least", least_told, 2 * blocks)
    truth("the largest move is not the 99th percentile everywhere", apart > 0 || v["rows.0.hits"] <= 100)
    print "bench spawn: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
