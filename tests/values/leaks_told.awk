# What `raydiff leaks` tells of several scenes and worlds, scene by scene, against its JSON: what each is, what broke, the
# rays, what promises, why a row did not run, and the conclusion. Lines are whole; x.obj is the scene of which hits are double.
#   awk -f lib.awk -f floats.awk -f obj.awk -f leaks_told.awk FLAT x.obj TEXT
function many(count, noun) { return count " " noun (count == 1 ? "" : "s") }
# What breaks a row is in its sums: what must not be is told where it is more than none.
function broken_of(p,  must, text) {
    must = v[p ".promises"] == "true" || (v["profile"] == "dxr" && v["scenes." scene ".seams"] != "true")
    if (must && v[p ".total.misses"] > 0) text = text ", " v[p ".total.misses"] " missed"
    if (must && v[p ".total.empty"] > 0) text = text ", " v[p ".total.empty"] " listed nothing"
    if (must && v[p ".total.lost"] > 0) text = text ", " v[p ".total.lost"] " lost a wall"
    if (v[p ".promises"] == "true" && v[p ".total.phantoms"] > 0) text = text ", " v[p ".total.phantoms"] " hit a wall that is not there"
    if (v["profile"] == "dxr" && v[p ".total.double_hits"] > 0) text = text ", " v[p ".total.double_hits"] " hit twice"
    return substr(text, 3)
}
# The lines that must follow the head of a scene, in their order: line[1], ...
function expect_scene(  i, k, n, p, f, name, promise, rows_of, reason) {
    p = "scenes." scene
    lines = done = 0
    for (i = 0; i < v["rows.count"]; i++) {
        p = "rows." i
        if (v[p ".scene"] != v["scenes." scene ".scene"]) continue
        rows_of++
        promise += v[p ".promises"] == "true"
        name = v[p ".layout"] == "null" ? "-" : v[p ".layout"]
        if (v[p ".status"] != "ok") {
            if (!((scene, v[p ".reason"]) in reason)) line["why " ++whys] = "  " v[p ".engine"] " skipped: " v[p ".reason"]
            reason[scene, v[p ".reason"]] = 1
            did_not_run++
            continue
        }
        equal("what broke row " i, v[p ".broken"], broken_of(p))
        kept += v[p ".broken"] == "" && v[p ".promises"] == "true"
        counted += v[p ".broken"] == "" && v[p ".promises"] != "true"
        broken += v[p ".broken"] != ""
        if (v[p ".broken"] == "") continue
        line["broken " ++breaks] = "  " v[p ".engine"] " on " name ": BROKEN: " v[p ".broken"]
        for (k = 0; k < v[p ".findings.count"]; k++) {
            f = p ".findings." k
            line["ray " ++rays] = (v[f ".kind"] == "miss" ? "MISS " : "DOUBLE ") v[p ".engine"] "." name "." v[p ".tri"] \
                " ray " v[f ".ray"] " at " v[f ".aim"] ":" (v[f ".kind"] == "miss" ? "" : ", triangles " v[f ".triangles.0"] " and " v[f ".triangles.1"])
            bits["ray " rays] = f ".ray_bits."
        }
    }
    line["promise"] = "  " promise + 0 " of " rows_of " rows promise"
}
# The next of those of a kind is this text.
function told(kind, text) { equal(kind, text, line[kind " " ++seen[kind]]) }
# Lines of a kind that were to come, and did not.
function all_told(  kind) {
    equal("lines of what broke", seen["broken"] + 0, breaks + 0)
    equal("lines of rays", seen["ray"] + 0, rays + 0)
    equal("lines of why", seen["why"] + 0, whys + 0)
}
function corners_shared(a, b,  i, k, n) {
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) n += corner[a, i] == corner[b, k]
    return n
}
BEGIN { scene = -1 }
/^[^ ].*: [0-9]+ (placed )?triangles, / {
    if (scene >= 0) all_told()
    p = "scenes." ++scene
    sub(/^ */, "")
    if (v[p ".points"] > 0)
        is = many(v[p ".triangles"], "triangle") ", " many(v[p ".points"], "point") ", " many(v[p ".edges"], "edge") ", closed; " \
            many(v[p ".rays"], "ray") " from " many(v[p ".origins"], "point") " inside, seed " seed "; " \
            sprintf("%.1f", 100 * v[p ".aimed_exactly"] / v[p ".rays"]) " % of them aimed without rounding"
    else
        is = many(v[p ".triangles"], "placed triangle") ", " many(v[p ".instances"], "instance") ", " \
            (v[p ".seams"] == "true" ? "closed only together" : "each closed, that rays start in") "; " \
            many(v[p ".rays"], "ray") " from " many(v[p ".origins"], "point") " inside, seed " seed
    equal("scene " scene, $0, v[p ".scene"] ": " is)
    expect_scene()
    next
}
/^seams between instances/ { truth("seams of scene " scene, v["scenes." scene ".seams"] == "true"); seams++; next }
/^layout  *engine / { wide = 1; next }
/^verdict  *layout / { wide = 0; next }
wide && / BROKEN: / { told("broken", "  " $2 " on " $1 ": " substr($0, index($0, "BROKEN: "))); next }
/^(MISS|DOUBLE) / {
    text = $0
    is_double = sub(/^DOUBLE .* triangles /, "")
    if (is_double) {
        need = text ~ / at vertex:/ ? 1 : 2
        truth("triangles " $1 " and " $3 " have what the ray is aimed at", $1 != $3 && corners_shared($1, $3) >= need)
        doubles++
    }
    at = "ray " (seen["ray"] + 1)
    n = split(text, word, /[ ,]+/)
    for (i = 1; i <= n; i++)
        if (word[i] == "org" || word[i] == "dir")
            for (k = 1; k <= 3; k++)
                near(word[i] " of " at, float_number(word[i + k]), float_of(hex(v[bits[at] (word[i] == "org" ? k - 1 : k + 3)])))
    sub(/: org .* dir [^,]*/, ":", text)
    told("ray", text)
    next
}
/^  .* BROKEN: / { told("broken", $0); next }
/ rows promise / { equal("promises of scene " scene, substr($0, 1, length(line["promise"])), line["promise"]); promised++; next }
/^  .* skipped: / { told("why", $0); next }
/^conclusion: / {
    equal("conclusion", $0, "conclusion: " many(v["rows.count"], "row") ": " kept + 0 " kept, " broken + 0 " broken, " counted + 0 " counted" \
        (did_not_run ? ", " did_not_run " did not run" : ""))
    concluded = 1
}
END {
    all_told()
    for (i = 0; i < v["scenes.count"]; i++) with_seams += v["scenes." i ".seams"] == "true"
    equal("lines of seams", seams + 0, with_seams + 0)
    equal("scenes", scene + 1, v["scenes.count"])
    equal("promises", promised + 0, v["scenes.count"])
    truth("a conclusion", concluded)
    truth("hits that are double", doubles > 0)
    print "leaks, what is told: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
