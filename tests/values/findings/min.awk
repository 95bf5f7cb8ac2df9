# The table of `raydiff min FOLDER`, or the page of `raydiff min FILE`, against the JSON: awk -f lib.awk -f min.awk FLAT TEXT
FILENAME != ARGV[1] { page = page " " $0 }
/^finding +triangles, rays +now +asks/ { heads++; next }
/ findings, [0-9]+ of them smaller now$/ {
    equal("findings", $2, v["findings.count"])
    equal("smaller", $4, smaller + 0)
    sums++
    next
}
heads && NF >= 6 {
    p = "findings." rows++
    equal("finding", $1, v[p ".signature"])
    equal("triangles before", $2, v[p ".before.triangles"] ",")
    equal("rays before", $3, v[p ".before.rays"])
    equal("triangles after", $4, v[p ".after.triangles"] ",")
    equal("rays after", $5, v[p ".after.rays"])
    equal("asks", $6, v[p ".asks"])
    equal("more may help", /; more --asks or --time may help$/, v[p ".end"] != "fixpoint")
    sub(/;$/, "", $7)
    equal("result", $7, v[p ".result"])
    truth("triangles " $1, v[p ".after.triangles"] <= v[p ".before.triangles"])
    truth("bytes " $1, v[p ".result"] != "smaller" || v[p ".written"] != "")
    truth("asked no more than tried " $1, v[p ".asks"] <= v[p ".tried"] + 0)
    truth("accepted " $1, v[p ".accepted"] <= v[p ".asks"] + 0 && (v[p ".accepted"] > 0) == (v[p ".written"] != ""))
    truth("rounds " $1, v[p ".rounds"] >= 1)
    smaller += v[p ".written"] != ""
    if (v[p ".exit"] > worst) worst = v[p ".exit"]
}
/^  (before|after) +[0-9]/ {
    p = "findings.0." $1
    equal($1 " triangles", $2, v[p ".triangles"])
    equal($1 " rays", $4, v[p ".rays"])
    equal($1 " vertices", $6, v[p ".vertices"])
    equal($1 " bits", $8, v[p ".bits"])
    equal($1 " bytes", $12, v[p ".bytes"])
    pages++
    next
}
/^  asked +[0-9]+ trials? in / {
    equal("tried", $2, v["findings.0.tried"])
    equal("rounds", $5, v["findings.0.rounds"])
    equal("asks", $7, "(" v["findings.0.asks"])
    equal("accepted", $9, v["findings.0.accepted"])
    pages++
    next
}
# The words that tell how min ended, what the result shows and where it lies.
function words(text) {
    gsub(/[ \n]+/, " ", text)
    return text
}
function page_laws(p,  end_of, cause, text) {
    end_of["fixpoint"] = "no smaller candidate is left"
    end_of["asks"] = "a larger --asks may find a smaller one"
    end_of["time"] = "ended by --time"
    page = words(page)
    truth("why it ended: " v[p ".end"], (v[p ".end"] in end_of) && index(page, " smaller; " end_of[v[p ".end"]] " ") > 0)
    cause = v[p ".signature"]
    sub(/.*\./, "", cause)
    truth("the cause is the signature's", v[p ".signature"] ~ /\.(crash|hang)\./ || index(page, " cause " cause ": ") > 0)
    text = words(v[p ".text"])
    if (text != "" && match(page, / shows ray [0-9]+ /)) {
        truth("what it shows", index(page, substr(page, RSTART, RLENGTH) text) > 0)
        split(substr(page, RSTART, RLENGTH), word, " ")
        truth("its ray is one of the result", word[3] < v[p ".after.rays"])
    } else equal("a ray that it shows", text, "")
    truth("where it was written", index(page, v[p ".written"] != "" ? " wrote " v[p ".written"] " " : " wrote nothing: it is the smallest ") > 0)
    truth("what plays it", index(page, " replay raydiff replay " (v[p ".written"] != "" ? v[p ".written"] : v[p ".file"])) > 0)
    equal("smaller", v[p ".result"], v[p ".accepted"] > 0 ? "smaller" : "smallest")
}
END {
    if (heads) {
        equal("rows", rows, v["findings.count"])
        equal("a line of sums", sums, 1)
        equal("exit", v["exit"], worst + 0)
    } else {
        equal("lines of a page", pages, 3)
        equal("findings of a page", v["findings.count"], 1)
        page_laws("findings.0")
    }
    print "min: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
