# `raydiff fuzz --self-test` against its JSON and its table: awk -v found=N -v planted=N -v skipped=N -v wanted=CODE
# -v least=TRIALS -f lib.awk -f selftest.awk FLAT selftest.txt TEXT
function median(n,  i, k, x) {
    for (i = 2; i <= n; i++) {
        x = sorted[i]
        for (k = i - 1; k >= 1 && sorted[k] > x; k--) sorted[k + 1] = sorted[k]
        sorted[k + 1] = x
    }
    return (sorted[int((n + 1) / 2)] + sorted[int(n / 2) + 1]) / 2
}
# A control plays as many trials as the bugs of its field needed, and as many as it must at least.
function control_law(p,  i, most) {
    most = least
    for (i = 0; i < v["bugs.count"]; i++) {
        if (v["bugs." i ".engines"] v["bugs." i ".layouts"] != v[p ".engines"] v[p ".layouts"]) continue
        if (v["bugs." i ".trials"] > most) most = v["bugs." i ".trials"]
    }
    if (v[p ".end"] == "clean") equal("trials of a control", v[p ".trials"], most)
}
function laws(  i, p, n, ends) {
    for (i = 0; i < v["bugs.count"]; i++) {
        p = "bugs." i
        equal("row of " v[p ".bug"], v[p ".unit"] " " v[p ".engines"] " " v[p ".layouts"] " " v[p ".kind"], of_table[v[p ".bug"]])
        ends[v[p ".end"]]++
        if (v[p ".end"] == "found") sorted[++n] = v[p ".seconds"] + 0
        if (v[p ".bug"] == "QUICK" || v[p ".bug"] == "SLOW") equal("end of " v[p ".bug"], v[p ".end"], "found")
        if (v[p ".bug"] == "SLOW") truth("SLOW takes its second", v[p ".seconds"] >= 1)
        if (v[p ".bug"] == "KEPT") equal("end of KEPT", v[p ".end"], "NOT FOUND")
        if (v[p ".bug"] == "ABSENT") equal("end of ABSENT", v[p ".end"] ": " v[p ".said"], "skipped: no card is here")
        if (v[p ".bug"] == "ENDS") truth("end of ENDS", v[p ".end"] == "FAILED" && v[p ".said"] ~ /9.*: the last line$/)
    }
    equal("found", v["found"] " " v["of"], found " " planted)
    equal("found are rows", v["found"], ends["found"] + 0)
    equal("planted are rows", v["of"], v["bugs.count"] - ends["skipped"])
    for (i = 0; i < v["controls.count"]; i++) {
        clean += v["controls." i ".end"] == "clean"
        equal("a control has no bug", v["controls." i ".bug"] v["controls." i ".unit"] v["controls." i ".kind"], "")
        skips += v["controls." i ".end"] == "skipped"
        control_law("controls." i)
    }
    equal("skipped", v["skipped"], skipped)
    equal("skipped are rows", v["skipped"], ends["skipped"] + skips)
    equal("passed", v["passed"], wanted == 0 ? "true" : "false")
    if (n > 0) { # of six digits
        truth("median", (v["median_s"] / median(n) - 1) ^ 2 < 1e-10)
        truth("slowest", (v["slowest_s"] / sorted[n] - 1) ^ 2 < 1e-10)
    }
    if (n == 0) equal("times of none", v["median_s"] + v["slowest_s"], 0)
}
FILENAME ~ /selftest\.txt$/ { of_table[$1] = $2 " " $3 " " $4 " " $5; next }
/^bug  *planted in/ { laws(); rows = 1; next }
NF == 0 { blanks++; next }
/ s in all; a bug's median / {
    rows = 0
    same("seconds", $1, "%.0f", v["seconds"])
    same("median", $8, "%.2f", v["median_s"])
    same("slowest", $(NF - 1), "%.2f", v["slowest_s"])
    sums++
    next
}
/^[0-9]+ skipped$/ { equal("skipped", $1, v["skipped"]); told_skipped = 1; next }
/^without a bug / { equal("clean", $4 " " $6, clean + 0 " " v["controls.count"] - skips); sums++; next }
/^found [0-9]+ of / { equal("found", $2 " " $4, v["found"] " " v["of"]); sums++; next }
rows {
    p = r < v["bugs.count"] ? "bugs." r + 0 : "controls." (r - v["bugs.count"])
    r++
    if (p ~ /^bugs/) {
        unit = v[p ".unit"]
        sub(/.*\//, "", unit)
        sub(/\.c$/, "", unit)
        equal("head of " p, $1 " " $2 " " $3, v[p ".bug"] " " unit " " v[p ".kind"])
        at = 4
    } else {
        equal("head of " p, $1 " " $2 " " $3 " " $4, "no bug " v[p ".engines"] " " v[p ".layouts"])
        at = 5
    }
    equal("trials of " p, $at, v[p ".trials"])
    same("seconds of " p, $(at + 1), "%.2f", v[p ".seconds"])
    text = substr($0, index($0, " " $(at + 1) "  ") + length($(at + 1)) + 3)
    is = v[p ".end"] == "found" ? v[p ".said"] : v[p ".end"] (v[p ".said"] == "" ? "" : ": " v[p ".said"])
    equal("what " p " found", text, is)
}
END {
    equal("rows", r + 0, v["bugs.count"] + v["controls.count"])
    equal("sums", sums + 0, 3)
    equal("skipped are told", told_skipped + 0, v["skipped"] > 0 ? 1 : 0)
    print "self-test: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0
}
