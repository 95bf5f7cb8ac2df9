# The table of `raydiff min FOLDER` against its JSON: awk -f lib.awk -f min.awk FLAT TEXT
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
    equal("result", $7, v[p ".result"])
    truth("triangles " $1, v[p ".after.triangles"] <= v[p ".before.triangles"])
    truth("bytes " $1, v[p ".result"] != "smaller" || v[p ".written"] != "")
    truth("asked no more than tried " $1, v[p ".asks"] <= v[p ".tried"] + 0)
    truth("accepted " $1, v[p ".accepted"] <= v[p ".asks"] + 0 && (v[p ".accepted"] > 0) == (v[p ".written"] != ""))
    truth("rounds " $1, v[p ".rounds"] >= 1)
    smaller += v[p ".written"] != ""
    if (v[p ".exit"] > worst) worst = v[p ".exit"]
}
END {
    equal("rows", rows, v["findings.count"])
    equal("a line of sums", sums, 1)
    equal("exit", v["exit"], worst + 0)
    print "min: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
