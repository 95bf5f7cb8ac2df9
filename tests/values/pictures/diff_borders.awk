# Values of the same path on both sides of a rounding border, `raydiff diff SCENE --engine cpu,vulkan --list N`,
# against JSON; then `--pixel` of the first of them, with its JSON (other.flat), where the second engine's own renderer is told of:
# awk -v list=N -f lib.awk -f diff_borders.awk FLAT other.flat TEXT
function word_of(k, side,  word, c) {
    word = v["pairs.0.borders." k ".values." side]
    for (c = 0; c < 3; c++) of[side, c] = int(word / 256 ^ c) % 256
    equal("opaque", int(word / 256 ^ 3), 255)
    return of[side, 0] " " of[side, 1] " " of[side, 2]
}
function laws(  k, c, apart, place, before, most) {
    equal("listed", v["pairs.0.borders.count"], v["pairs.0.at_a_border"] < 16 ? v["pairs.0.at_a_border"] : 16)
    equal("values that differ", v["pairs.0.values_different"], v["pairs.0.at_a_border"])
    equal("to explain", v["pairs.0.to_explain"], 0)
    before = -1
    for (k = 0; k < v["pairs.0.borders.count"]; k++) {
        text[k] = word_of(k, 0) " and " word_of(k, 1)
        apart = 0
        for (c = 0; c < 3; c++) {
            if ((of[0, c] - of[1, c]) ^ 2 > apart) apart = (of[0, c] - of[1, c]) ^ 2
            if (apart > most) most = apart
        }
        truth("a value differs", apart > 0)
        place = v["pairs.0.borders." k ".y"] * v["width"] + v["pairs.0.borders." k ".x"]
        truth("pixels in order", place > before && v["pairs.0.borders." k ".x"] < v["width"] + 0)
        truth("a bound below a step", v["pairs.0.borders." k ".bound"] > 0 && v["pairs.0.borders." k ".bound"] < 1)
        before = place
    }
    if (v["pairs.0.at_a_border"] <= 16) equal("largest", v["pairs.0.largest"] ^ 2, most)
}
FNR == 1 && !begun++ { laws() }
/^  pixel [0-9]+,[0-9]+ border: rgb / {
    p = "pairs.0.borders." shown + 0
    equal("place " shown, $2, v[p ".x"] "," v[p ".y"])
    match($0, /rgb .*, bound/)
    equal("values " shown, substr($0, RSTART + 4, RLENGTH - 11), text[shown + 0])
    same("bound " shown, $(NF - 3), "%.3g", v[p ".bound"])
    shown++
}
/^pixel [0-9]+,[0-9]+$/ { equal("pixel", $2, w["pixel.0"] "," w["pixel.1"]) }
/^vulkan: [0-9]+ segments?, value / {
    equal("value of the walk", w["paths.1.value"], v["pairs.0.borders.0.values.0"])
    equal("own renderer", w["paths.1.own_renderer_parts"], "same")
    truth("own renderer, text", /; its own renderer: the same segments, value [0-9 ]+$/)
    equal("value of its own renderer", $(NF - 2) " " $(NF - 1) " " $NF, of_second())
    ends++
}
function of_second() { return substr(text[0], index(text[0], " and ") + 5) }
END {
    equal("lines of borders", shown + 0, list < v["pairs.0.borders.count"] ? list : v["pairs.0.borders.count"])
    equal("lines of the engine", ends, 1)
    equal("exit codes", v["exit"] w["exit"], "00")
    print "values beside a border: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
