# The text of `raydiff doctor` against its JSON: awk -f lib.awk -f doctor.awk FLAT processors=N TEXT
# Every line of a card is made of the JSON.
function choice(path, other,  telling) {
    telling = v[path ".telling"]
    equal(path " in all", v[path ".as_written"] + v[path ".other"] + v[path ".neither"], telling)
    if (v[path ".as_written"] == telling) return "as written, each operation rounded (" telling " of " telling " telling)"
    if (v[path ".other"] == telling) return other " (" telling " of " telling " telling)"
    return "of " telling " telling " v[path ".as_written"] " as written, " v[path ".other"] " " other ", " v[path ".neither"] " neither"
}
function root(path) {
    truth(path " differs where there is an ulp", (v[path ".differs"] > 0) == (v[path ".worst_ulp"] > 0))
    truth(path " is among its count", v[path ".differs"] + 0 <= v[path ".count"] + 0)
    return v[path ".differs"] " of " v[path ".count"] " differ from the nearest, at most " v[path ".worst_ulp"] " ulp"
}
function is_cut(path,  k, cut) {
    for (k = 0; k < 3; k++) {
        truth("a loop runs no longer than it is asked to", v[path ".ran." k] + 0 <= v[path ".asked." k] + 0)
        cut = cut || v[path ".ran." k] != v[path ".asked." k]
    }
    equal("ended early", v[path ".ended_early"], cut ? "true" : "false")
    return cut
}
# The lines of a card, by what they are called.
function card(p,  k, sum) {
    delete line
    line["sqrt"] = root(p ".sqrt")
    line["inversesqrt"] = root(p ".inversesqrt")
    line["with one NaN"] = "min gives " v[p ".min.with_one_nan"] ", max " v[p ".max.with_one_nan"]
    line["of -0 and +0"] = "min gives " v[p ".min.of_zeros"] ", max " v[p ".max.of_zeros"]
    line["fma(a,b,c)"] = choice(p ".fma", "fused")
    line["a*b+c, if free"] = choice(p ".free_mul_add", "fused")
    line["(a-b)*c, if free"] = choice(p ".free_distribution", "as a*c-b*c")
    line["unpackHalf2x16"] = "zeros, normal, infinite, NaN: " v[p ".half.unpack.wrong"] " wrong; subnormal: " \
        v[p ".half.unpack.subnormal_kept"] " kept, " v[p ".half.unpack.subnormal_zero"] " zero, " v[p ".half.unpack.subnormal_wrong"] " wrong"
    # Both signs of 1023 subnormals, in either half of a word.
    equal("subnormals", v[p ".half.unpack.subnormal_kept"] + v[p ".half.unpack.subnormal_zero"] + v[p ".half.unpack.subnormal_wrong"], 4 * 1023)
    k = p ".half.pack"
    equal("halves not nearest", v[k ".overflow"] + v[k ".tiny"] + v[k ".normal"], v[k ".not_nearest"])
    line["packHalf2x16"] = v[k ".not_nearest"] " of " v[k ".count"] " are not the nearest half"
    k = p ".loops"
    line["loops"] = !is_cut(k) ? "run to their end (" v[k ".asked.1"] " iterations)" : "ENDED EARLY, silently: " v[k ".ran.0"] " of " \
        v[k ".asked.0"] "; two in turn " v[k ".ran.1"] " of " v[k ".asked.1"] "; nested " v[k ".ran.2"] " of " v[k ".asked.2"]
    for (k = sum = 0; k < v[p ".ops.count"]; k++) {
        sum += v[p ".ops." k ".ordinary_differs"]
        if (v[p ".judge.flushes"] != "true") sum += v[p ".ops." k ".special_differs"] # subnormals are among them
        truth("ordinary " k, v[p ".ops." k ".ordinary_differs"] + 0 <= v[p ".ops." k ".ordinary"] + 0)
        truth("special " k, v[p ".ops." k ".special_differs"] + 0 <= v[p ".ops." k ".special"] + 0)
        truth("an ulp where it differs " k, (v[p ".ops." k ".ordinary_differs"] > 0) == (v[p ".ops." k ".worst_ulp"] > 0))
    }
    truth("C's bits only where nothing differs", v[p ".judge.bits"] == "false" || sum == 0)
}
BEGIN { e = d = -1 }
/^raydiff  / { equal("version", $2, v["raydiff"] ","); next }
/^processors / { equal("processors", $2, processors); next }
/^float / { next }
/^driver / {
    p = "drivers." ++d
    equal("driver", $2, v[p ".name"])
    equal("runs " $2, $3 == "SKIPPED" ? "false" : "true", v[p ".runs"])
    if ($3 != "SKIPPED") {
        equal("device of " $2, substr($0, 21), v[p ".card.device"] ", " v[p ".card.driver"])
        card(p ".card")
        of_cards++
    }
    next
}
/^conclusion: / {
    for (k = 0; k < v["engines.count"]; k++) running += v["engines." k ".runs"] == "true"
    for (k = 0; k < v["drivers.count"]; k++) here += v["drivers." k ".runs"] == "true"
    equal("conclusion", $0, "conclusion: " running + 0 " of " v["engines.count"] " engines run, " here + 0 " of " v["drivers.count"] " Vulkan drivers are here")
    next
}
/^[a-z]/ {
    p = "engines." ++e
    equal("engine", $1, v[p ".name"])
    equal("runs " $1, $2 == "SKIPPED" ? "false" : "true", v[p ".runs"])
    truth("why " $1, (v[p ".why"] == "null") == (v[p ".runs"] == "true"))
    next
}
/^    why: / { equal("why", substr($0, 10), v[p ".why"]); next }
# What is the same as of an engine before is not repeated.
d < 0 && /^    as [a-z_]+$/ {
    for (k = 0; k < e && v["engines." k ".name"] != $2; k++) continue
    truth(v[p ".name"] " is as one before", k < e)
    equal("text of " v[p ".name"], v[p ".text"], v["engines." k ".text"])
    next
}
d < 0 { truth("text of " v[p ".name"], index(v[p ".text"], substr($0, 5))); next }
{
    for (name in line)
        if (index($0, "    " name "  ") == 1) {
            is = substr($0, 28)
            # Beside halves that are not the nearest stands which.
            if (name == "packHalf2x16") sub(/:.*/, "", is)
            equal(name, is, line[name])
            found++
        }
}
END {
    equal("engines", e + 1, v["engines.count"])
    equal("drivers", d + 1, v["drivers.count"])
    equal("lines of cards", found + 0, 10 * of_cards)
    truth("a card", of_cards)
    print "doctor: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
