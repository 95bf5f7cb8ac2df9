# raydiff explain --query all: the page against its JSON, and what is made of the hits.
/^scene / { equal("scene", substr($2, 1, length($2) - 1), v["scene"]) }
/^ray / {
    equal("index", $2, v["index"])
    equal("rays", $4, v["rays"])
}
/^engine / { equal("engine", $2 " " $4, v["engine"] ", " v["query"]) }
/^list / {
    equal("kept", $2, v["exact"] - v["lost"])
    equal("exact", $4, v["exact"])
    equal("listed", $7, v["listed"])
}
/^verdict / {
    what = v["wrong"] != "not" ? "WRONG: " v["wrong"] ", triangle" : v["verdict"] == "right" ? "right" : "allowed: " v["verdict"]
    equal("verdict", substr($0, 11, length(what)), what)
    at_fault = $NF
}
/^    +[0-9]+ / {
    at = "hits." lines++ "."
    equal(at "prim", $1, v[at "prim"])
    if (v[at "t"] == "null") equal(at "t", $2 $3 $4, "-nohit")
    else {
        same(at "t", sprintf("%.9g", $2), "%.9g", v[at "t"])
        equal(at "where", $3, v[at "where"])
        exact++
        truth(at "t: sorted", exact == 1 || v[at "t"] + 0 >= last)
        last = v[at "t"] + 0
        truth(at "t: exact before the others", lines == exact)
    }
    text = $0
    sub(/^.*(LOST|no hit|inside|edge|vertex|in_plane) */, "", text)
    if (v[at "listed"] == 0) {
        lost++
        truth(at "lost", $0 ~ / LOST/ && v[at "hit"] == "null")
        truth(at "nearest", $0 ~ (v[at "nearest"] == "true" ? ", found as" : ", lost as"))
        asked++
        found += v[at "nearest"] == "true"
    } else {
        sub(/[ ,].*/, "", text)
        same(at "hit.t", text, "%.9g", v[at "hit.t.value"] + 0)
        equal(at "hit.prim", v[at "hit.prim"], v[at "prim"])
        equal(at "nearest", v[at "nearest"], "null")
        truth(at "times", ($0 ~ /times$/ ? $(NF - 1) : 1) == v[at "listed"])
        listed += v[at "listed"]
    }
}
/^conclusion: / {
    if (v["index"] == "null") {
        truth("conclusion", $0 ~ /no list is wrong$/)
        next
    }
    truth("conclusion: " v["listed"] " listed", $0 ~ "; " v["listed"] " listed, of " v["exact"] " exact hits?, " v["lost"] " lost")
    truth("conclusion: verdict", v["exit"] == 1 ? index($0, "WRONG: " v["wrong"] ";") : $0 ~ /the list is (right|allowed)/)
    if (asked) truth("conclusion: nearest", index($0, "of which " found " found as the nearest from there on"))
}
END {
    if (v["index"] != "null") {
        equal("lines", lines, v["hits.count"])
        equal("exact", exact + 0, v["exact"])
        equal("lost", lost + 0, v["lost"])
        equal("listed", listed + 0, v["listed"])
        truth("exit", v["exit"] == (v["wrong"] != "not"))
    }
    print "explain_list: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
