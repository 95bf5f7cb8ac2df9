# `raydiff report` against what it was made of: awk -f lib.awk -f report.awk FLAT
# bytes=N figures=N findings=N failing=N OTHER.FLAT TEXT. What it counts is counted again from the JSON of check.
/^[^ ].*: [0-9.]+ kB, [0-9]+ parts?, [0-9]+ figures?$/ {
    text = substr($0, match($0, /: [0-9.]+ kB/) + 2)
    split(text, word, " ")
    same("kB", word[1], "%.1f", v["bytes"] / 1000)
    equal("parts", word[3], v["parts.count"])
    equal("figures", word[5], v["figures"])
    heads++
    next
}
/ answers WRONG, / {
    equal("wrong", $1, v["wrong"])
    equal("answers", $3, v["answers"])
    equal("other bits", $6, v["bit_differences"])
    heads++
    next
}
# Parts that are not well, in their order.
/^  .*: exit code [0-9]+/ {
    for (part += told > 0; part < v["parts.count"] && (v["parts." part ".exit"] == 0 || v["parts." part ".known"] != ""); part++) continue
    p = "parts." part
    why = v[p ".why"]
    sub(/\n.*/, "", why)
    equal("part that is not well", $0, "  " v[p ".name"] ": exit code " v[p ".exit"] (why == "" ? "" : ": " why))
    told++
}
# The worse of two codes: 4, 3, 2, 1, 77, 0.
function worse(a, b,  order) {
    order = " 4 3 2 1 77 0 "
    return index(order, " " a " ") < index(order, " " b " ") ? a : b
}
END {
    for (r = 0; r < w["rows.count"]; r++) {
        p = "rows." r
        if (w[p ".status"] !~ /^(ok|vacuous)$/ || w[p ".judged"] != "true") continue
        answers += w[p ".rays"]
        wrongs += w[p ".counts.wrong"]
        bits += w[p ".bit_differences"]
    }
    equal("answers of check", v["answers"], answers + 0)
    equal("WRONG of check", v["wrong"], wrongs + 0)
    equal("bits of check", v["bit_differences"], bits + 0)
    equal("bytes of the file", v["bytes"], bytes)
    equal("figures of the page", v["figures"], figures)
    equal("findings in the folder", v["findings"], findings)
    equal("findings that fail", v["failing"], failing)
    equal("sums", heads + 0, answers ? 2 : 1)
    for (k = 0; k < v["parts.count"]; k++) {
        p = "parts." k
        known += v[p ".known"] != ""
        truth("what is known fails " k, v[p ".known"] == "" || v[p ".exit"] == 1)
        code = v[p ".known"] == "" ? v[p ".exit"] : 0
        worst = worse(code + 0, worst + 0)
        bads += code != 0
        truth("state " k, v[p ".state"] == (v[p ".command"] ~ /^# read from / ? "given" : "ran"))
        truth("seconds " k, (v[p ".seconds"] > 0) == (v[p ".state"] == "ran"))
        seconds += v["parts." k ".seconds"]
    }
    equal("known", v["known"], known + 0)
    equal("exit", v["exit"], worst + 0)
    equal("parts that tell their exit code", told + 0, bads + 0)
    truth("seconds of the parts", seconds * 1e9 <= took)
    print "report: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
