# What `raydiff conform --hard --summary --verbose` says below its tables against the JUnit of the same run: why what is waived or
# fails does, of how many trials, and which; sums. awk -f lib.awk -f summary.awk NONE JUNIT TEXT
function plain(text) {
    gsub(/&lt;/, "<", text)
    gsub(/&gt;/, ">", text)
    gsub(/&quot;/, "\"", text)
    gsub(/&#39;|&apos;/, "'", text)
    gsub(/&amp;/, "\\&", text)
    return text
}
function attribute(name) {
    if (!match($0, " " name "=\"[^\"]*\"")) return ""
    return plain(substr($0, RSTART + length(name) + 3, RLENGTH - length(name) - 4))
}
/^<testcase / {
    name = attribute("name")
    if (name !~ /^hard\./) next
    cases++
    why = attribute("message")
    if (/<failure /) { failure[name] = why; failures++ }
    else if (/<skipped /) {
        if (!skips[why]++) first[why] = name
        skipped++
    } else passed++
    next
}
/^(waived|FAILED|known)/ && !/hard\./ { section = $1; sub(/:$/, "", section); next }
/^$/ { section = "" }
section == "waived" && /^ +[0-9]+  / {
    why = $0
    sub(/^ +[0-9]+  /, "", why)
    equal("trials waived for: " why, $1, skips[why] + 0)
    waived += $1
    texts++
    next
}
section == "waived" && / first: / { equal("the first of them", $2, first[why]); next }
section == "FAILED" && /^  raydiff conform / {
    name = $3
    gsub(/'/, "", name)
    truth("a trial that fails: " name, name in failure)
    next
}
section == "FAILED" && /^      / {
    why = substr($0, 7)
    truth("why " name " fails", failure[name] != "" && index(why, failure[name]) == 1)
    fails++
    next
}
/^[0-9]+ hard cases, [0-9]+ rays: / {
    gsub(",", "")
    rays = $4
    equal("sum of failed", $6, failures + 0)
    equal("sum of waived", $8, waived + 0)
    equal("sum of known and passed", $10 + $12, passed + 0)
    equal("sum of refused and skipped", $14 + $16, skipped - waived)
    equal("trials", $6 + $8 + $10 + $12 + $14 + $16, cases)
    sums++
}
# Rays of each trial that is judged.
/^(PASSED|FAILED) +hard\..*: [0-9]+ parts, [0-9]+ rays, / {
    match($0, /: [0-9]+ parts, [0-9]+ rays/)
    split(substr($0, RSTART), word, " ")
    asked += word[4]
    next
}
/ rays judged: / { judged = $1 }
/ rays more in trials that are waived / { more = $1 }
END {
    equal("a line of sums", sums, 1)
    equal("a reason of each failed trial", fails + 0, failures + 0)
    equal("rays judged", judged, asked + 0)
    equal("rays", rays, judged + more)
    truth("texts of waivers", waivers == "" || texts >= waivers)
    print "summary: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
