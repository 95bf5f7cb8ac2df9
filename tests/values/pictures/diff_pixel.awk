# `raydiff diff SCENE --pixel X,Y` against its JSON, and against the pictures of the first two engines:
# awk -f lib.awk -f pixels.awk -f floats.awk -f diff_pixel.awk FLAT a.pixels b.pixels TEXT
# The highest bit that two words differ in, from 0; -1: none.
function highest_bit(a, b,  at, bit) {
    bit = -1
    for (at = 0; a > 0 || b > 0; at++) {
        if (a % 2 != b % 2) bit = at
        a = int(a / 2)
        b = int(b / 2)
    }
    return bit
}
function in_order(word) { return word >= 2147483648 ? 2147483648 - word : word }
function step_of(value) { return int(255 * (value < 0 ? 0 : value > 1 ? 1 : value) + 0.5) }
function laws(e,  p, k, i, last, word, s, l, a, b) {
    p = "paths." e
    last = p ".segments." v[p ".segments.count"] - 1
    for (k = 0; k < 3; k++) {
        word = word " " int(v[p ".value"] / 256 ^ k) % 256
        equal(p " colour of the last segment", step_of(v[last ".color." k ".value"]), int(v[p ".value"] / 256 ^ k) % 256)
    }
    rgb[v[p ".engine"]] = substr(word, 2)
    length_of[v[p ".engine"]] = v[p ".segments.count"]
    equal(p " opaque", int(v[p ".value"] / 256 ^ 3), 255)
    if (e < 2) {
        i = v["pixel.1"] * width[e] + v["pixel.0"]
        equal(p " value in the picture", word " 255", " " pixel_text(i, e))
    }
    for (s = 0; s < v[p ".segments.count"]; s++)
        for (l = 0; l < v[p ".segments." s ".lights.count"]; l++) {
            k = p ".segments." s ".lights." l
            # Behind the shading normal's plane; or the face's.
            if (v[k ".asked"] == "false") { truth(k " is behind", v["profile"] == "repaired" || v[k ".normal_light.value"] <= 0); continue }
            equal(k " shadowed", v[k ".shadowed"], v[k ".shadow_ray.hit.prim"] == "null" ? "false" : "true")
            if (v["profile"] == "repaired") near(k " ends at the light", v[k ".distance.value"], v[k ".shadow_ray.ray.tmax.value"])
        }
    if (v[p ".first_bit"] == "null") return
    a = hex(v[p ".first_bit.bits.0"])
    b = hex(v[p ".first_bit.bits.1"])
    equal(p " first bit", v[p ".first_bit.bit"], highest_bit(a, b))
    # A number of a triangle is no float; -0 and 0 are none apart.
    a = v[p ".first_bit.value"] == "triangle" ? 0 : in_order(a)
    b = v[p ".first_bit.value"] == "triangle" ? 0 : in_order(b)
    equal(p " floats apart", v[p ".first_bit.floats_apart"], a > b ? a - b : b - a)
    differ++
}
FNR == 1 {
    truth("floats", floats_are_their_bits() > 20)
    for (e = 0; e < v["paths.count"]; e++) laws(e)
    next
}
/^pixel [0-9]+,[0-9]+$/ { equal("pixel", $2, v["pixel.0"] "," v["pixel.1"]) }
# Every path is told to its end and no farther, and as many segments as the longest has.
/^segment [0-9]+$/ {
    equal("segment", $2, segments++)
    segment = $2
}
/^  [a-z_0-9]+$/ || /^  [a-z_0-9]+: / {
    engine = $1
    sub(/:$/, "", engine)
    equal(engine " segment " segment, /: its path has ended$/ ? "none" : "one", segment < length_of[engine] ? "one" : "none")
    told_of[engine]++
}
/^  [a-z_0-9]+$/ {
    engine = $1
    for (e = 0; v["paths." e ".engine"] != engine; e++) continue
}
/^    (hit|  met) .*triangle / {
    ray = $1 == "hit" ? "closest" : "lights." light ".shadow_ray"
    p = "paths." e ".segments." segment "." ray ".hit"
    equal(p " triangle", $3 + 0, v[p ".prim"])
    equal(p " bits of t", substr($9, 1, length($9) - 1), v[p ".t.bits"])
    same(p " u", substr($11, 1, length($11) - 1), "%.9g", v[p ".u.value"])
    same(p " v", $13, "%.9g", v[p ".v.value"])
    told++
    hits_told[e]++
}
# "0x1p+1 (2)  0x0p+0 (0)  ..." against the floats at a path.
function vector(path,  k, text, value) {
    text = $0
    for (k = 0; k < 3; k++) {
        match(text, /\([^)]*\)/)
        value = v[path "." k ".value"]
        if (value == "-0.0") equal(path, substr(text, RSTART + 1, RLENGTH - 2), "-0") # a number would lose the sign
        else same(path, substr(text, RSTART + 1, RLENGTH - 2), "%.9g", value + 0)
        text = substr(text, RSTART + RLENGTH)
    }
    vectors[$1]++
}
/^    origin / { vector("paths." e ".segments." segment ".closest.ray.origin") }
/^    direction / { vector("paths." e ".segments." segment ".closest.ray.direction") }
/^    (point|normal|plane) / { vector("paths." e ".segments." segment "." $1) }
/^    (hit|  met)  *a miss$/ {
    ray = $1 == "hit" ? "closest" : "lights." light ".shadow_ray"
    equal("a miss", v["paths." e ".segments." segment "." ray ".hit.prim"], "null")
    told++
}
/^      met / { met++ }
/^    explain   raydiff explain / { explained++ }
/^    exact / {
    exact++
    p = "paths." e ".segments." segment "." ray "."
    equal(p "exact", $2 == "a" ? "null" : $3, v[p "exact_triangle"])
    if (match($0, / at t in \[[^]]*\]/)) {
        split(substr($0, RSTART + 10, RLENGTH - 11), of, ", ")
        near(p "t_lo", of[1] + 0, v[p "t_lo"] + 0)
        truth(p "t_lo and t_hi", v[p "t_lo"] <= v[p "t_hi"] && of[1] == sprintf("%.17g", v[p "t_lo"]) && of[2] == sprintf("%.17g", v[p "t_hi"]))
    }
    text = $0
    sub(/, error of t.*/, "", text)
    sub(/.*: /, "", text)
    equal(p "verdict", text, v[p "verdict"] == "wrong" ? "WRONG, " v[p "wrong"] : v[p "verdict"])
}
/^    light [0-9]+ / {
    light = $2
    p = "paths." e ".segments." segment ".lights." light
    asked += !/not traced/
    if (/not traced/) same(p " cosine", substr($NF, 1, length($NF) - 1), "%.9g", v[p ".normal_light.value"])
    else same(p " distance", substr($6, 2, length($6) - 3), "%.9g", v[p ".distance.value"])
    equal(p " shadow", /not traced/ ? "false false" : /in the shadow/ ? "true true" : "true false", v[p ".asked"] " " v[p ".shadowed"])
}
/^    exact .*error of t / {
    match($0, /error of t [^ ]+/)
    same("error of t", substr($0, RSTART + 11, RLENGTH - 11), "%.3g", v["paths." e ".segments." segment "." ray ".err_over_bound"])
}
/^    weight / {
    p = "paths." e ".segments." segment
    same(p " weight", substr($2, 1, length($2) - 1), "%.9g", v[p ".weight.value"])
    for (k = 0; k < 3; k++) same(p " colour", $(6 + k), "%.9g", v[p ".color." k ".value"])
}
/^    FIRST / {
    match($0, /, bit [0-9]+: /)
    equal("bit", substr($0, RSTART + 6, RLENGTH - 8), v["paths." e ".first_bit.bit"])
    if (match($0, /, [0-9]+ floats? apart/)) equal("floats apart", substr($0, RSTART + 2) + 0, v["paths." e ".first_bit.floats_apart"])
}
/^[a-z_0-9]+: [0-9]+ segments?, value / {
    engine = substr($1, 1, length($1) - 1)
    gsub(",", "")
    equal(engine " segments", $2, length_of[engine])
    equal(engine " in each segment", told_of[engine], segments)
    if ($2 > longest) longest = $2
    equal(engine " value", $5 " " $6 " " $7, rgb[engine])
    ends++
}
END {
    equal("engines", ends, v["paths.count"])
    equal("segments", segments, longest)
    truth("nothing is told of a hit", told > 0)
    equal("exact of each", exact, told)
    equal("a command for each", explained, told)
    equal("lights that are asked", met + 0, asked + 0)
    equal("a ray has two vectors", vectors["origin"], vectors["direction"])
    equal("a hit has a normal", vectors["point"] + 0, vectors["normal"] + 0)
    print "diff of a pixel: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
