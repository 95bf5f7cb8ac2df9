# The text of `raydiff replay` against its JSON: awk -v trial=FILE -f lib.awk -f replay.awk FLAT TEXT
# Every line of text, except for the page of `raydiff explain`, is made of the JSON and compared in its order.
function line(text) { wanted[++lines] = text }
function plural(n, what) { return n " " what (n == 1 ? "" : "s") }
# "missed cut_box" of "cpu.f32.missed.cut_box"
function kind_and_cause(signature,  part, n) {
    n = split(signature, part, ".")
    return part[n - 1] " " part[n]
}
function kind_of(signature,  part) {
    split(kind_and_cause(signature), part, " ")
    return part[1]
}
# A ray as its eight numbers, whatever form they are written in.
function ray_is(text,  word, k, out) {
    gsub(/[^-+.0-9a-z]+/, " ", text)
    split(text, word, " ")
    for (k = 1; k <= 8; k++) out = out " " (word[k] ~ /inf/ ? word[k] : float_number(word[k]))
    return out
}
function keep_trial(  text, at) {
    while ((getline text <trial) > 0) {
        split(text, words, " ")
        if (("rays" in of) && at < of["rays"] + 0 && words[1] ~ /^[-+0-9]/) {
            sub(/#.*/, "", text)
            trial_ray[at++] = ray_is(text)
        }
        if (!(words[1] in of)) of[words[1]] = words[2]
        if (words[1] == "builder") leaf = words[4]
        if (words[1] == "recipe") recipe = substr(text, 8)
        if (words[1] == "origin") from = "  from     seed " words[3] ", trial " words[5] " of stream " words[9] ", generators " words[7]
    }
    close(trial)
}
function player(p,  head, k, q, text) {
    head = sprintf("  %-13s %-13s ", v[p ".engine"], v[p ".layout"] == "null" ? "-" : v[p ".layout"])
    truth("status " v[p ".status"], v[p ".status"] ~ /^(played|skipped|refused|crashed|hung|failed)$/)
    players[v[p ".status"]]++
    if (v[p ".status"] != "played") {
        line(head v[p ".status"] ": " v[p ".reason"])
        equal("findings of who was not played", v[p ".findings.count"], 0)
        truth("reason of " v[p ".engine"], length(v[p ".reason"]) > 3)
        return
    }
    equal("reason of who was played", v[p ".reason"], "")
    if (v[p ".findings.count"] == 0) line(head "nothing wrong")
    for (k = 0; k < v[p ".findings.count"]; k++) {
        q = p ".findings." k
        text = kind_and_cause(v[q ".signature"])
        if (v[q ".text"] != "") text = text ", ray " v[q ".ray"] " " v[q ".text"]
        line((k ? sprintf("  %-13s %-13s ", "", "") : head) text (v[q ".expected"] == "true" ? " <- expected" : ""))
        expected += v[q ".expected"] == "true"
        found++
        truth("one finding of " kind_of(v[q ".signature"]), !seen[p, kind_of(v[q ".signature"])]++) # the first of a kind
        truth("a signature names " v[p ".engine"], v[p ".engine"] ~ /^pipe:/ || index(v[q ".signature"], v[p ".engine"] "." (v[p ".layout"] == "null" ? "-" : v[p ".layout"]) ".") == 1)
        # Of an engine without a layout the kind is what can be expected of a finding on one.
        if (v[q ".expected"] == "true" && v[p ".layout"] == "null" && v["files.0.expect"] !~ /\.-\./)
            equal("what was expected", kind_of(v[q ".signature"]), kind_of(v["files.0.expect"]))
        else if (v[q ".expected"] == "true") equal("what was expected", v[q ".signature"], v["files.0.expect"])
        if (v[q ".signature"] ~ /\.(tree|refused)\./) equal("ray of what is on none", v[q ".ray"], "null")
        truth("ray " v[q ".ray"], v[q ".ray"] == "null" || v[q ".ray"] < v["files.0.rays"])
        # The ray that is shown is the trial's of that number.
        if (match(v[q ".text"], /o=\(.*\) d=\(.*\) t=\[[^]]*/)) {
            text = substr(v[q ".text"], RSTART, RLENGTH)
            gsub(/[odt]=/, " ", text)
            equal("ray " v[q ".ray"] " of the file", ray_is(text), trial_ray[v[q ".ray"]])
            if (v[q ".expected"] == "true" && explained == "") {
                explained = trial_ray[v[q ".ray"]]
                cause = v[q ".signature"]
                sub(/.*\./, "", cause)
            }
        }
    }
}
function versions(title, path,  k) {
    for (k = 0; k < v[path ".count"]; k++) line(sprintf("  %-8s %s", k ? "" : title, v[path "." k]))
}
FNR == 1 && !begun {
    begun = 1
    p = "files.0"
    keep_trial()
    split("does~not~fail STILL~FAILS clean FAILS", outcome, " ")
    text = outcome[(v[p ".expect"] == "clean" ? 3 : 1) + (v[p ".fails"] == "true")]
    gsub(/~/, " ", text)
    if (v[p ".exit"] == 77) text = "not played: its engine cannot run here"
    line(v[p ".file"] ": " v[p ".expect"] ": " text)
    equal("file", v[p ".file"], trial)
    equal("expected", v[p ".expect"], of["expect"])
    equal("triangles", v[p ".triangles"], of["triangles"])
    equal("rays", v[p ".rays"], of["rays"])
    line("  trial    " plural(of["triangles"], "triangle") ", " plural(of["rays"], "ray") ", builder " of["builder"] ", leaf " leaf \
        ", box " of["box"] ", triangle " of["tri"] ", query " of["query"])
    if (recipe != "") line("  made as  " recipe)
    if (from != "") line(from)
    for (k = 0; k < v[p ".played.count"]; k++) player(p ".played." k)
    versions("then", p ".then")
    versions("now", p ".now")
    worst = players["crashed"] + players["hung"] ? 3 : v[p ".fails"] == "true" ? 1 : players["skipped"] ? 77 : 0
    equal("exit code", v["exit"], worst)
    truth("exit code of the file " v[p ".exit"], v[p ".exit"] == worst || (v[p ".exit"] == 0 && worst == 77))
    truth("what is expected is found if and only if it fails", v[p ".expect"] == "clean" ? (found > 0) == (v[p ".fails"] == "true") : \
        (expected > 0) == (v[p ".fails"] == "true"))
    equal("this program's version", v[p ".now.0"], "raydiff " v["raydiff"])
}
FNR <= lines {
    # What is said of a finding on no ray stands in place of the ray; the JSON has it not.
    bare = wanted[FNR]
    mark = sub(/ <- expected$/, "", bare) ? " <- expected" : ""
    if (bare ~ / (refused|tree) [a-z_]+$/ && index($0, bare ", ") == 1) equal("end of line " FNR, substr($0, length($0) - length(mark) + 1), mark)
    else equal("line " FNR, $0, wanted[FNR])
}
# So is the ray that is explained, which shows what was expected.
/^origin / { page = $2 " " $4 " " $6 }
/^direction / { page = page " " $2 " " $4 " " $6 }
/^range / { equal("the ray that is explained", ray_is(page " " $2 " " $4), explained) }
/^cause / { equal("the cause that is explained", $2, cause ":") }
END {
    truth("lines " FNR, FNR >= lines)
    if (status != "") truth("one that is " status, players[status])
    print "replay: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
