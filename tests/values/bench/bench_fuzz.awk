# The text of `raydiff bench fuzz` against its JSON: awk -v rounds=N -v trials=N -f lib.awk -f bench_fuzz.awk FLAT TEXT
/^[0-9]+ workers?: / {
    p = "rows." r++
    name = v[p ".workers"] " workers: "
    engines = harness = 0
    equal(name "workers", $1, v[p ".workers"])
    same(name "trials/s", $3, "%.0f", v[p ".trials_per_s"])
    same_span(name "trials/s", $4, "%.0f", v[p ".trials_per_s_least"], v[p ".trials_per_s_most"])
    same(name "judged rays/s", $6, "%.3f", v[p ".judged_rays_per_s"] * 1e-6)
    split(substr($7, 2, length($7) - 2), span, "-")
    truth(name "judged rays/s in their span", span[1] <= $6 && $6 <= span[2] && (rounds > 1 || span[1] == span[2]))
    truth(name "rays of most trials are judged", v[p ".judged_rays_per_s"] >= 250 * v[p ".trials_per_s"])
    equal(name "trials", v[p ".trials"], v[p ".workers"] * rounds * trials)
    # A trial has 500 rays; of those that an engine refuses not all are judged.
    truth(name "rays a trial", v[p ".judged_rays_per_s"] <= 500.0001 * v[p ".trials_per_s"])
    truth(name "triangles of a trial", v[p ".triangles"] >= 16 && v[p ".triangles"] <= 64)
    if (rounds == 1) { # no worker played longer than the command ran
        truth(name "trials a second", v[p ".trials_per_s"] >= v[p ".trials"] / (took * 1e-9))
        truth(name "core time", v[p ".trials"] * v[p ".core_us_per_trial"] * 1e3 <= took * v[p ".workers"])
    }
    next
}
/^  harness / {
    lines++
    split(substr($4, 2, length($4) - 2), span, "-")
    truth(name "share in its span", span[1] <= $2 && $2 <= span[2] && (rounds > 1 || span[1] == span[2]))
    same(name "harness", $2, "%.1f", 100 * v[p ".harness_share"])
    same(name "harness to engines", $8, "%.2f", v[p ".harness_to_engines"])
    if (rounds == 1) near(name "share", v[p ".harness_share"], v[p ".harness_to_engines"] / (1 + v[p ".harness_to_engines"]))
    next
}
/^  [0-9]+ us of core time a trial$/ {
    lines++
    same(name "us of core time", $1, "%.0f", v[p ".core_us_per_trial"])
    next
}
/ trials of .* triangles, / {
    lines++
    equal(name "trials", $1, v[p ".trials"])
    same(name "triangles", $4, "%.1f", v[p ".triangles"])
    equal(name "at fault", $6, v[p ".at_fault"])
    equal(name "refusals", $(NF - 1), v[p ".refused"])
    next
}
/ us a trial$/ {
    same(name $1, $2, "%.1f", v[p "." $1])
    if ($1 ~ /^(generate|build|truth|judge)_us$/) {
        parts++
        harness += v[p "." $1]
    } else
        engines += v[p "." $1]
    if ($1 != "judge_us") next
    # What stands last: all parts are there.
    if (rounds == 1) near(name "harness to engines", v[p ".harness_to_engines"], harness / engines)
    # Times of parts are of the wall: other work on the machine lengthens them, twentyfold at most.
    truth(name "core time of parts", v[p ".core_us_per_trial"] >= 0.05 * (harness + engines))
    if (alone) equal(name "f32 refuses nothing", v[p ".refused"], 0)
}
END {
    equal("rows", r, v["rows.count"])
    equal("lines", lines, 3 * r)
    equal("parts of the harness", parts, 4 * r)
    if (r == 2) equal("one worker first", v["rows.0.workers"], 1)
    print "bench fuzz: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
length($0) > 80 && FILENAME ~ /text$/ { bad("longer than 80 columns: " $0) }
