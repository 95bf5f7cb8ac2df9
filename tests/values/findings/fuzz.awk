# The text of `raydiff fuzz` against its JSON: awk -v rays=N -f lib.awk -f fuzz.awk FLAT TEXT
# rays: of a trial. Sums, rates and shares are computed anew.
function sum(prefix, count, key,  k, n) {
    for (k = 0; k < count; k++) n += v[prefix "." k "." key]
    return n + 0
}
function plural(n, what) { return n " " what (n == 1 ? "" : "s") }
FNR == 1 && !begun {
    begun = 1
    n = v["contestants.count"]
    for (k in v) {
        if (k ~ /^verdicts\./) verdicts += v[k]
        if (k ~ /^core_seconds\./ && k !~ /\.(generate|build|truth|judge|explain)$/) engines += v[k]
    }
    harness = v["core_seconds.generate"] + v["core_seconds.build"] + v["core_seconds.truth"] + v["core_seconds.judge"]
    near("harness share", v["harness_share"], harness / (harness + engines))
    near("harness to engines", v["harness_to_engines"], harness / engines)
    near("trials/s", v["trials_per_s"], v["trials"] / v["play_seconds"])
    near("judged rays/s", v["judged_rays_per_s"], v["judged"] / v["play_seconds"])
    equal("at fault", v["at_fault"], v["verdicts.wrong"])
    truth("judged", v["judged"] <= v["rays"] + 0 && (v["judged"] > 0 || v["trials"] == 0 || v["trials_before"] > 0))
    # Of a whole campaign that has generated trials alone.
    whole = v["trials_before"] + v["corpus"] + v["mutants"] == 0
    # A trial with steps has its rays traced after each of them.
    refused = sum("contestants", n, "refused") + sum("contestants", n, "refused_in_this_run") + sum("contestants", n, "unasked_in_this_run")
    answered = rays * sum("contestants", n, "answered")
    if (whole && !refused) equal("verdicts of all answers", verdicts, n * v["rays"])
    if (whole) truth("verdicts of all answers", verdicts >= answered && verdicts <= answered + n * (v["rays"] - rays * v["trials"]))
    if (whole) truth("rays " v["rays"], v["rays"] >= rays * v["trials"] && v["rays"] % rays == 0 && v["rays"] <= 1.3 * rays * v["trials"])
    for (k = 0; k < n && whole; k++)
        equal("trials of a contestant", v["contestants." k ".answered"] + v["contestants." k ".refused"] + v["contestants." k ".refused_in_this_run"] + v["contestants." k ".unasked_in_this_run"], v["trials"])
    equal("states of coverage", v["coverage.reached"] + v["coverage.never.count"], v["coverage.known"])
    near("triangles of all trials", v["triangles_mean"] * v["trials"], sprintf("%.0f", v["triangles_mean"] * v["trials"]))
    truth("seconds", v["seconds"] >= v["play_seconds"] + 0)
    for (k = 1; k < v["pairs.rarest.count"]; k++) truth("rarest pairs first", v["pairs.rarest." k ".trials"] >= v["pairs.rarest." k - 1 ".trials"] + 0)
    equal("rarest pair", v["pairs.rarest.0.trials"], v["pairs.least"])
    truth("median of pairs", v["pairs.median"] >= v["pairs.least"] + 0)
    truth("pairs met", v["pairs.met"] <= v["pairs.possible"] + 0)
}
/^(new|known|flaky) +[^ ]+  [0-9]+ times?, smallest: / {
    p = "findings." found++
    equal("state", $1, v[p ".state"])
    at = index($0, "  " v[p ".signature"] "  ")
    truth("signature " v[p ".signature"], at)
    equal("finding", substr($0, at + length(v[p ".signature"]) + 4), plural(v[p ".count"], "time") ", smallest: " \
        plural(v[p ".triangles"], "triangle") ", " plural(v[p ".rays"], "ray"))
    news += v[p ".known"] == "false" && v[p ".flaky"] == "false"
    truth("known", (v[p ".known"] == "true") == ($1 == "known"))
    getline
    equal("cause", substr($0, 10), v[p ".cause"])
    getline
    if (substr($0, 10) != v[p ".replay"]) getline
    equal("replay", substr($0, 10), v[p ".replay"])
    next
}
/^trials     / {
    equal("trials", $2, v["trials"])
    gsub(/[^0-9]/, "", $3)
    same("trials/s", $3, "%.0f", v["trials_per_s"])
    same("triangles", $5, "%.1f", v["triangles_mean"])
    equal("median", $8, v["triangles_median"] ")" ($9 == "" ? "" : ","))
    rest = substr($0, index($0, "median"))
    sub(/^[^,]*/, "", rest)
    equal("kinds of trials", rest, (v["corpus"] > 0 ? ", " v["corpus"] " of the corpus" : "") (v["mutants"] > 0 ? ", " v["mutants"] " mutants" : "") \
        (v["trials_before"] > 0 ? ", after " v["trials_before"] " generated ones of earlier runs" : ""))
    heads++
    next
}
/^judged     / {
    equal("judged", $2, v["judged"])
    gsub(/[^0-9]/, "", $4)
    same("judged/s", $4, "%.0f", v["judged_rays_per_s"])
    same("harness", $6, "%.0f", 100 * v["harness_share"])
    heads++
    next
}
/^coverage   / { equal("coverage", $2 " of " $4, v["coverage.reached"] " of " v["coverage.known"]); heads++; next }
/^pairs      / {
    equal("pairs possible", $2, v["pairs.possible"])
    equal("pairs met", $7, v["pairs.met"])
    equal("least of a pair", $14, v["pairs.least"] ",")
    equal("median of a pair", $16, v["pairs.median"])
    for (k = 0; k < 5; k++) {
        getline
        equal("rarest pair " k, substr($0, 12), v["pairs.rarest." k ".pair"] " " v["pairs.rarest." k ".trials"])
    }
    heads++
    next
}
/^(contestant|          ) .* answered [0-9]+ trials, refused / {
    p = "contestants." who++
    wanted = v[p ".name"] " answered " v[p ".answered"] " trials, refused " v[p ".refused"]
    if (v[p ".refused_in_this_run"] > 0) wanted = wanted "; its layout refused " v[p ".refused_in_this_run"] " of this run"
    if (v["turns"] == "true" && v[p ".unasked_in_this_run"] > 0) wanted = wanted "; in " v[p ".unasked_in_this_run"] " trials of this run it was another's turn"
    vacuous += v[p ".vacuous"] != "null"
    if (v[p ".vacuous"] != "null") wanted = wanted "; vacuous: " v[p ".vacuous"]
    equal("contestant", substr($0, 12), wanted)
    truth("right hits", v[p ".with_a_right_hit"] <= v[p ".answered"] + 0)
    next
}
/^findings   / {
    equal("distinct", $2, v["findings.count"])
    equal("outside the baseline", $4, news + 0)
    equal("folder", $NF, v["dir"])
    heads++
    next
}
END {
    equal("lines of sums", heads, 5)
    equal("findings printed", found + 0, v["findings.count"])
    equal("contestants printed", who, v["contestants.count"])
    truth("exit code", v["exit"] == (news + vacuous > 0 ? 1 : 0))
    print "fuzz: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
