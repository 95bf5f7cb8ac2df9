# The text of `raydiff check` against its JSON: awk -f lib.awk -f check.awk FLAT TEXT
# Every number of the text is computed anew from the numbers of the rows.
function row_is(path) { return v["rows." path] }
function rate(path) { return v["rows." path ".mrays_per_s.median"] }
# Whether two rows' ranges lie apart by a larger factor than the wider spans.
function told_apart(a, b,  lo_a, hi_a, lo_b, hi_b, wider) {
    lo_a = v["rows." a ".mrays_per_s.min"]; hi_a = v["rows." a ".mrays_per_s.max"]
    lo_b = v["rows." b ".mrays_per_s.min"]; hi_b = v["rows." b ".mrays_per_s.max"]
    wider = hi_a / lo_a > hi_b / lo_b ? hi_a / lo_a : hi_b / lo_b
    return wider > 1 && (lo_a / hi_b > wider || lo_b / hi_a > wider)
}
# The row of that engine that is like row r in all else, or "".
function row_like(r, engine,  k, i, same_all) {
    for (k = first; k < next_row; k++) {
        if (v["rows." k ".engine"] != engine || v["rows." k ".status"] != "ok") continue
        same_all = 1
        for (i = split("scene layout store builder box tri query", like, " "); i > 0; i--)
            same_all = same_all && v["rows." k "." like[i]] == v["rows." r "." like[i]]
        if (same_all) return k
    }
    return ""
}
# The first row of the scene with that layout, engine, box and triangle test.
function row_of(layout, engine, like,  r) {
    for (r = first; r < next_row; r++)
        if (v["rows." r ".status"] == "ok" && v["rows." r ".layout"] == layout && v["rows." r ".engine"] == engine &&
            (like == "" || (v["rows." r ".query"] == v["rows." like ".query"] && v["rows." r ".box"] == v["rows." like ".box"] &&
                            v["rows." r ".tri"] == v["rows." like ".tri"])))
            return r
    return -1
}
# Of counters of which those of 0 are left out: all of them, in their order.
function listed(part, count, names, of,  k, n, full) {
    n = 1
    for (k = 1; k <= of; k++) full[k] = n <= count && index(part[n], names[k] " ") == 1 && part[n] != names[k] " 0" ? part[n++] : names[k] " 0"
    if (n <= count) return count
    for (k = 1; k <= of; k++) part[k] = full[k]
    return of
}
BEGIN {
    kinds = split("right tie near_tie boundary border in_plane slab noise out_of_contract", kind, " ")
    wrongs = split("missed phantom triangle distance barycentric not_finite not_repeatable any_disagrees twice order masked culled opacity instance facing", of_wrong, " ")
    statuses = split("refused skipped failed vacuous", status, " ")
    scene = -1
    next_row = 0
}
/^[^ ].*: ([0-9]+ instances?, )?[0-9]+ triangles?, [0-9]+ vert(ex|ices); [0-9]+ rays?, set / {
    scene++
    first = next_row
    p = "scenes." scene
    split($0, part, ": ")
    equal("scene", part[1], v[p ".scene"])
    text = $0
    if (sub(/: [0-9]+ instances?, /, ": ", text)) {
        split(substr($0, length(part[1]) + 3), word, " ")
        equal("instances", word[1] " " word[2], v[p ".instances"] (v[p ".instances"] == 1 ? " instance," : " instances,"))
        match($0, /, masks and flags [a-z]+,/)
        equal("modes", substr($0, RSTART + 18, RLENGTH - 19), v[p ".modes"])
    } else
        truth("a scene has no instances", !((p ".instances") in v) && !((p ".modes") in v))
    match(text, /: [0-9]+ triangle/)
    split(substr(text, RSTART + 2), word, " ")
    equal("triangles", word[1], v[p ".triangles"])
    equal("vertices", word[3], v[p ".vertices"])
    equal("rays", word[5], v[p ".count"])
    next
}
/^tree: / {
    match($0, /: [0-9]+ nodes?, [0-9]+ lea(f|ves), depth [0-9]+, largest leaf [0-9]+/)
    split(substr($0, RSTART + 2), word, /[ ,]+/)
    r = first
    while (v["rows." r ".layout"] == "null") r++
    equal("nodes", word[1], v["rows." r ".tree.nodes"])
    equal("leaves", word[3], v["rows." r ".tree.leaves"])
    equal("depth", word[6], v["rows." r ".tree.depth"])
    equal("largest leaf", word[9], v["rows." r ".tree.largest_leaf"])
    next
}
/^(WRONG|BITS|  explain:|  world:|  got:|  expected:|  cpu's:|  \.\.\. and) ?/ && (rows || narrow) && !/^WRONG  *[^ ]+  *[^ ]+  *[0-9]/ { next }
/^layout  *engine / { rows = 1; next }
/^verdict  *layout / {
    narrow = 1
    for (i in place) delete place[i]
    for (i = 1; i <= NF; i++) place[$i] = i
    next
}
/^tests: / {
    for (k in tests) delete tests[k]
    count = split(substr($0, 8), part, /, /)
    for (k = 1; k <= count; k++) { split(part[k], word, " "); tests[word[1]] = word[2] }
    next
}
# Shaders compiled anew: a row for each compiled row, in their order; columns by their titles.
/^compilers, / {
    rows = narrow = 0
    compiled = 1
    compiled_row = first
    text = $0
    sub(/^compilers, /, "", text)
    sub(/, driver .*/, "", text)
    equal("scene of compilers", text, v["scenes." scene ".scene"])
    next
}
compiled && /^compiler +engine/ {
    for (i in column) delete column[i]
    for (i = 1; i <= NF; i++) column[$i] = i
    next
}
compiled && /^what it means/ {
    several = 0
    for (key in of_rows) several += of_rows[key] > 1
    equal("lines of all rows", sums_told + 0, several)
    for (key in of_rows) { delete of_rows[key]; delete of_kept[key]; delete of_ops[key]; delete of_open[key]; delete of_equal[key]; delete of_other[key]; delete of_wrong[key]; delete of_speeds[key] }
    compiled = sums_told = 0
}
# One line of all rows of a compiler and an engine that has several.
compiled && /^all rows of a compiler/ { compiled = 2; next }
compiled == 2 && /^ / { next }
compiled == 2 && NF {
    text = $0
    gsub(/ of /, "/", text)
    gsub(/free, /, "free,", text)
    split(text, cell, " ")
    key = cell[1] " " cell[2]
    name = "all rows of " key " "
    sums_told++
    equal(name "rows", cell[3], of_rows[key])
    equal(name "NoContraction", cell[4], of_decorated[key] ? of_kept[key] "/" of_ops[key] : "free," of_ops[key])
    equal(name "open", cell[5], of_open[key] + 0)
    equal(name "equal", cell[6], of_equal[key] + 0)
    equal(name "other", cell[7], of_other[key] + 0)
    equal(name "WRONG", cell[8], of_wrong[key] + 0)
    if (!of_speeds[key]) {
        equal(name "speed of none", cell[9] " " cell[10], "- -")
        next
    }
    for (i = 2; i <= of_speeds[key]; i++)
        for (k = i; k > 1 && of_speed[key, k] < of_speed[key, k - 1]; k--) {
            other = of_speed[key, k]; of_speed[key, k] = of_speed[key, k - 1]; of_speed[key, k - 1] = other
        }
    split(cell[10], span, "-")
    middle = int((of_speeds[key] + 1) / 2)
    same(name "speed", cell[9], "%.2f", (of_speed[key, middle] + of_speed[key, of_speeds[key] + 1 - middle]) / 2)
    same(name "least speed", span[1], "%.2f", of_speed[key, 1])
    same(name "most speed", span[2], "%.2f", of_speed[key, of_speeds[key]])
    next
}
compiled && NF {
    while (compiled_row < next_row && !(("rows." compiled_row ".compiled.compiler") in v)) compiled_row++
    p = "rows." compiled_row++
    name = v[p ".scene"] " compiled row " compiled_row - 1 " "
    # "109 of 110" is one column, "free, 110" and "0 free" are, too
    text = $0
    gsub(/ of /, "/", text)
    gsub(/free, /, "free,", text)
    sub(/ free /, "-free ", text)
    split(text, cell, " ")
    equal(name "compiler", cell[1], v[p ".compiled.compiler"])
    equal(name "engine and compiler", v[p ".compiled.raw"] ":" cell[1], v[p ".engine"])
    equal(name "engine", cell[2], v[p ".compiled.raw"])
    equal(name "layout", cell[3], v[p ".layout"] == "null" ? "-" : v[p ".layout"])
    if ("source" in column) equal(name "source", cell[column["source"]], v[p ".compiled.source"])
    equal(name "NoContraction", cell[column["NoContraction"]], v[p ".compiled.decorated"] == "true" ? v[p ".compiled.kept"] "/" v[p ".compiled.operations"] : "free," v[p ".compiled.operations"])
    equal(name "open", cell[column["open"]], v[p ".compiled.open"])
    equal(name "lost", v[p ".compiled.lost"], v[p ".compiled.decorated"] == "true" ? v[p ".compiled.operations"] - v[p ".compiled.kept"] + v[p ".compiled.open"] : 0)
    equal(name "bits", cell[column["bits"]], v[p ".compiled.bits_free"] == "true" ? v[p ".compiled.moved"] "-free" : v[p ".bit_differences"] == 0 ? "equal" : v[p ".bit_differences"])
    equal(name "WRONG", cell[column["WRONG"]], v[p ".counts.wrong"])
    raw = row_like(compiled_row - 1, v[p ".compiled.raw"])
    if (raw == "") equal(name "speed of none", cell[column["speed"]], "-")
    else same(name "speed", cell[column["speed"]], "%.2f", rate(compiled_row - 1) / rate(raw))
    key = cell[1] " " cell[2]
    of_rows[key]++
    of_decorated[key] = v[p ".compiled.decorated"] == "true"
    of_kept[key] += v[p ".compiled.kept"]
    of_ops[key] += v[p ".compiled.operations"]
    of_open[key] += v[p ".compiled.open"]
    of_equal[key] += v[p ".compiled.bits_free"] != "true" && v[p ".bit_differences"] == 0
    of_other[key] += v[p ".compiled.bits_free"] == "true" ? v[p ".compiled.moved"] : v[p ".bit_differences"]
    of_wrong[key] += v[p ".counts.wrong"]
    if (raw != "") of_speed[key, ++of_speeds[key]] = rate(compiled_row - 1) / rate(raw)
    next
}
/^what it means/ { rows = narrow = 0; next }
/^  [a-z0-9_, ]+: traces? scenes, not worlds$/ {
    text = $0
    sub(/^  /, "", text)
    sub(/: traces? scenes, not worlds$/, "", text)
    equal("engines that trace no worlds", text, v["scenes." scene ".scenes_only"])
    told_scenes_only[scene] = 1
    next
}
# The table that fits the screen: columns by their titles; what is no column is the same for all, or "-" or "own".
narrow && /^  / { next }
narrow {
    r = next_row++
    p = "rows." r
    name = v[p ".scene"] " row " r " "
    is["layout"] = v[p ".layout"] == "null" ? "-" : v[p ".layout"]
    is["engine"] = v[p ".engine"] == "null" ? "-" : v[p ".engine"]
    if (v[p ".status"] != "ok") {
        equal(name "verdict", $1, v[p ".status"])
        equal(name "layout", $2, is["layout"])
        equal(name "engine", $3, is["engine"])
        text = $0
        sub(/\.\.\.$/, "", text)
        match(text, /^[^ ]+ +[^ ]+ +[^ ]+ +/)
        truth(name "reason", index(v[p ".reason"], substr(text, RLENGTH + 1)) == 1)
        next
    }
    wrongs_of = v[p ".counts.wrong"]
    is["verdict"] = v[p ".judged"] != "true" ? "counted" : wrongs_of > 0 ? "WRONG" : v[p ".differences"] == 0 ? "agrees" : v[p ".bit_differences"] > 0 ? "BITS" : v[p ".compiled.lost"] > 0 && v[p ".compiled.translates"] == "false" ? "PRECISE" : "LOST"
    is["box"] = v[p ".box"] == "null" ? "-" : v[p ".box"]
    is["tri"] = v[p ".tri"]
    is["query"] = v[p ".query"]
    is["builder"] = v[p ".builder"] == "null" || is["layout"] == "-" ? "-" : v[p ".builder"]
    is["wrong"] = wrongs_of
    is["allowed"] = v[p ".rays"] - wrongs_of - v[p ".counts.right"]
    is["hits"] = v[p ".hits"]
    is["bits"] = (p ".other_bits") in v ? v[p ".other_bits"] : v[p ".bit_differences"] == "null" ? "-" : v[p ".bit_differences"]
    for (title in place) {
        text = $(place[title])
        if (title == "B/tri") {
            if (text == "-") equal(name title, is["layout"], "-")
            else same(name title, text, "%.1f", (v[p ".node_bytes"] + v[p ".item_bytes"] + v[p ".scene_bytes"]) / v["scenes." scene ".triangles"])
        }
        else if (title == "bits" && text == "-") equal(name title " that are not compared", is["bits"], 0) # of engines without C's bits
        else if (title == "Mray/s") same(name title, text, "%.3f", rate(r))
        else if (title == "least-most") same_span(name title, text, "%.3f", v[p ".mrays_per_s.min"], v[p ".mrays_per_s.max"])
        else if (title == "err/E" && (p ".displacement.p50" in v)) equal(name title, text, "-")
        else if (title == "err/E") same(name title, text, "%.2f", v[p ".err_over_bound"])
        else equal(name title, text, is[title])
    }
    for (title in tests)
        if (is[title] != "-" && is[title] != "own") equal(name title ", of all", tests[title], is[title])
    next
}
rows && NF >= 7 {
    r = next_row++
    p = "rows." r
    name = v[p ".scene"] " row " r " "
    equal(name "layout", $1, v[p ".layout"] == "null" ? "-" : v[p ".layout"])
    equal(name "engine", $2, v[p ".engine"])
    equal(name "box", $3, v[p ".box"] == "null" ? "-" : v[p ".box"])
    equal(name "tri", $4, v[p ".tri"])
    equal(name "query", $5, v[p ".query"])
    if (v[p ".status"] != "ok") {
        equal(name "status", $6, v[p ".status"] ":")
        if (index($0, v[p ".reason"]) == 0) bad(name "the reason is another")
        next
    }
    if ($6 != "-") {
        same(name "node bytes", $6, "%.1f", v[p ".node_bytes"] / 1000)
        same(name "item bytes", $7, "%.1f", v[p ".item_bytes"] / 1000)
    }
    equal(name "hits", $8, v[p ".hits"])
    for (k = 2; k <= kinds; k++) equal(name kind[k], $(7 + k), v[p ".counts." kind[k]])
    if (p ".displacement.p50" in v) {
        equal(name "err/E of an unknown formula", $17, "-")
        text = $0
        if (!sub(/.* displacement p50 /, "", text)) bad(name "no displacement")
        split(text, part, " ")
        same(name "displacement p50", part[1], "%.2g", v[p ".displacement.p50"])
        same(name "displacement p99", part[3], "%.2g", v[p ".displacement.p99"])
        same(name "displacement max", part[5], "%.3g", v[p ".displacement.max"])
        equal(name "lost in closed fans", part[7], v[p ".displacement.lost_in_closed_fans"])
        if (v[p ".displacement.allowed"] + 0 == 32) truth(name "what is usual", $0 !~ /allowed are/)
        else truth(name "what is allowed", index($0, "; allowed are " v[p ".displacement.allowed"] + 0 " uM, not 32"))
        if (v[p ".displacement.p50"] > v[p ".displacement.p99"] + 0 || v[p ".displacement.p99"] > v[p ".displacement.max"] + 0)
            bad(name "percentiles of the displacement")
    } else
        same(name "err/E", $17, "%.2f", v[p ".err_over_bound"])
    equal(name "WRONG", $18, v[p ".judged"] == "true" ? v[p ".counts.wrong"] : "count")
    equal(name "bits", $19, v[p ".bit_differences"])
    if ((p ".beside.engine") in v) {
        base = v[p ".beside.engine"]
        equal(name "the engine beside it", base, v[p ".engine"] ~ /:robust/ ? "embree_robust" : "embree")
        equal(name "which is right, in all", v[p ".beside.both_right"] + v[p ".beside.alone_right"] + v[p ".beside.other_right"] + v[p ".beside.neither_right"], v[p ".other_bits"])
        truth(name "which is right", v[p ".other_bits"] == 0 || index($0, " " v[p ".other_bits"] " answers with other bits than " base "'s: both right " v[p ".beside.both_right"] ", it alone " v[p ".beside.alone_right"] ", " base " alone " v[p ".beside.other_right"] ", neither " v[p ".beside.neither_right"]))
    }
    same(name "Mray/s", $20, "%.3f", v[p ".mrays_per_s.median"])
    equal(name "least and most", $21, sprintf("(%.3f-%.3f)", v[p ".mrays_per_s.min"], v[p ".mrays_per_s.max"]))
    if (match($0, /as published: .*/)) {
        text = substr($0, RSTART + 14)
        count = split(text, part, /, /)
        sum = 0
        for (k = 1; k <= count; k++) {
            split(part[k], word, " ")
            equal(name "as published", word[2], v[p ".wrong." word[1]])
            sum += word[2]
        }
        equal(name "as published in all", sum, v[p ".counts.wrong"])
    }
    sum = 0
    for (k = 1; k <= kinds; k++) sum += v[p ".counts." kind[k]]
    equal(name "verdicts in all", sum + v[p ".counts.wrong"], v[p ".rays"])
    sum = 0
    for (k = 1; k <= wrongs; k++) sum += v[p ".wrong." of_wrong[k]]
    equal(name "kinds of WRONG in all", sum, v[p ".counts.wrong"])
    if (!(v[p ".mrays_per_s.min"] + 0 <= rate(r) + 0 && rate(r) + 0 <= v[p ".mrays_per_s.max"] + 0))
        bad(name "the median is not between least and most")
    next
}
/^  [a-z0-9_]+ on [a-z0-9_]+: .* of f32's node bytes/ {
    sub(":", "", $3)
    r = row_of($1, $3, "")
    base = row_of("f32", $3, r)
    n = v["rows." r ".node_bytes"]
    same("node bytes of " $1, $4, "%.2f", n / v["rows." base ".node_bytes"])
    text = $0
    sub(/.*\(/, "", text)
    sub(/ .*/, "", text)
    same("bytes of " $1, text, "%.2f",
         (n + v["rows." r ".item_bytes"]) / (v["rows." base ".node_bytes"] + v["rows." base ".item_bytes"]))
    text = $0
    sub(/.*\), /, "", text)
    sub(/ .*/, "", text)
    same("speed of " $1 " on " $3, text, "%.2f", rate(r) / rate(base))
    equal("speed of " $1 " on " $3 " can be told from f32's", !/ its speed, within noise$/, told_apart(r, base))
    next
}
/^  cpu on [a-z0-9_]+: [0-9.]+ times the speed of / {
    sub(":", "", $3)
    same("speed of cpu by " $NF, $4, "%.2f", rate(row_of($3, "cpu", "")) / rate(row_of("null", $NF, "")))
    next
}
/^  bit for bit against cpu: / {
    for (r = first; r < next_row; r++)
        if (!(("rows." r ".compiled.raw") in v) && v["rows." r ".bit_differences"] != "null" && v["rows." r ".engine"] != "cpu" && v["rows." r ".engine"] != "brute") {
            rays += v["rows." r ".rays"]
            differ += v["rows." r ".bit_differences"]
        }
    equal("answers that differ", $6, differ + 0)
    rays = differ = 0
    next
}
/^  bits of modes beside [a-z_]+: / {
    base = $5
    sub(/:$/, "", base)
    rays = differ = both = alone = other = neither = 0
    for (r = first; r < next_row; r++)
        if (v["rows." r ".beside.engine"] == base) {
            rays += v["rows." r ".rays"]
            differ += v["rows." r ".other_bits"]
            both += v["rows." r ".beside.both_right"]
            alone += v["rows." r ".beside.alone_right"]
            other += v["rows." r ".beside.other_right"]
            neither += v["rows." r ".beside.neither_right"]
        }
    equal("modes beside " base, $0, "  bits of modes beside " base ": " differ " of " rays " answers differ; right are both in " both ", the mode alone in " alone ", " base " alone in " other ", neither in " neither)
    modes_told++
    rays = differ = 0
    next
}
/^  bit for bit against the shaders as built: / {
    for (r = first; r < next_row; r++)
        if (v["rows." r ".compiled.bits_free"] == "false") {
            rays += v["rows." r ".rays"]
            differ += v["rows." r ".bit_differences"]
        }
    equal("answers that differ from the shaders as built", $9 " of " $11, differ + 0 " of " rays)
    rays = differ = 0
    next
}
/^  against the exact truth: / {
    for (k in total) delete total[k]
    all = 0
    for (r = first; r < next_row; r++) {
        if (v["rows." r ".status"] != "ok" || v["rows." r ".judged"] != "true") continue
        all += v["rows." r ".rays"]
        total["wrong"] += v["rows." r ".counts.wrong"]
        for (k = 1; k <= kinds; k++) total[kind[k]] += v["rows." r ".counts." kind[k]]
        for (k = 1; k <= wrongs; k++) total[of_wrong[k]] += v["rows." r ".wrong." of_wrong[k]]
    }
    equal("answers WRONG", $5, total["wrong"] + 0)
    equal("answers judged", $7, all)
    text = $0
    sub(/.*\(/, "", text)
    sub(/\)$/, "", text)
    count = split(text, part, ", ")
    if (fits) count = listed(part, / WRONG$/ ? 0 : count, of_wrong, wrongs)
    equal("kinds of WRONG", count, wrongs)
    for (k = 1; k <= count; k++) equal("of all WRONG", part[k], of_wrong[k] " " total[of_wrong[k]] + 0)
    next
}
/^  right [0-9]+; allowed: / {
    text = $0
    sub(/^  /, "", text)
    sub(/; allowed: none$/, "", text)
    sub(/; allowed: /, ", ", text)
    if (fits) sub(/^right 0(, |$)/, "", text)
    count = split(text, part, ", ")
    if (fits) count = listed(part, count, kind, kinds)
    equal("verdicts", count, kinds)
    for (k = 1; k <= count; k++) equal("of all allowed", part[k], kind[k] " " total[kind[k]] + 0)
    next
}
/^  members as published are wrong in / {
    sum = 0
    for (r = first; r < next_row; r++)
        if (v["rows." r ".judged"] == "false") sum += v["rows." r ".counts.wrong"]
    equal("answers of members as published", $7, sum)
    next
}
/^engine [a-z_0-9]+ answered|^layout [a-z_0-9]+ answered/ {
    for (i = 0; i < v["named.count"]; i++)
        if (v["named." i ".kind"] == $1 && v["named." i ".name"] == $2) {
            equal($1 " " $2 " answered", $4, v["named." i ".answered"])
            equal($1 " " $2 " of", $6 + 0, v["named." i ".asked"])
            next
        }
    bad($1 " " $2 " is not in the JSON")
}
/^conclusion: / {
    concluded++
    for (r = 0; r < next_row; r++) {
        p = "rows." r
        ended[v[p ".status"]]++
        if (v[p ".status"] != "ok") continue
        if (v[p ".judged"] != "true") { published++; continue }
        good = v[p ".differences"] == 0
        agreeing += good
        of_all += v[p ".rays"]
        wrong_of_all += v[p ".counts.wrong"]
        for (base = 0; base < next_row && good; base++) {
            b = "rows." base
            if (base != r && v[b ".scene"] == v[p ".scene"] && v[b ".layout"] == "f32" && v[b ".engine"] == v[p ".engine"] && v[p ".layout"] != "null" &&
                v[b ".store"] == "indexed" && v[b ".judged"] == "true" && v[b ".differences"] == 0 && v[b ".box"] == v[p ".box"] && v[b ".tri"] == v[p ".tri"] &&
                v[b ".query"] == v[p ".query"] && v[b ".builder"] == v[p ".builder"]) {
                beside = 1
                if (!told_apart(r, base) || rate(r) / rate(base) <= best) continue
                best = rate(r) / rate(base)
                winner = v[p ".layout"] (v[p ".store"] == "indexed" ? "" : ":" v[p ".store"]) " on " v[p ".engine"]
            }
        }
    }
    text = "conclusion: " agreeing + 0 " of " next_row - published " rows agree"
    if (published) text = text ", " published " as published counted"
    for (k = 1; k <= statuses; k++) if (ended[status[k]]) text = text ", " ended[status[k]] " " status[k]
    if (of_all) text = text ", " wrong_of_all " of " of_all " answers WRONG"
    if (best) text = text "; " winner " has " sprintf("%.2f", best) " times f32's speed"
    else if (beside) text = text "; speeds cannot be told apart"
    equal("conclusion", $0, text)
    next
}
END {
    if (concluded != 1) bad(concluded + 0 " conclusions")
    for (i = 0; i < v["scenes.count"]; i++)
        equal("engines that trace no worlds are told", told_scenes_only[i] + 0, v["scenes." i ".scenes_only"] != "")
    if (scene + 1 != v["scenes.count"]) bad(scene + 1 " scenes, in JSON " v["scenes.count"])
    if (next_row != v["rows.count"]) bad(next_row " rows, in JSON " v["rows.count"])
    for (i = 0; i < v["named.count"]; i++) {
        p = "named." i
        equal("rows of " v[p ".name"], v[p ".answered"] + v[p ".refused"] + v[p ".skipped"] + v[p ".failed"], v[p ".asked"])
    }
    print "check: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
