# The text of `raydiff bench oracle` against its JSON: awk -v points=N -v rounds=N -f lib.awk -f bench_oracle.awk FLAT TEXT
# points: triangles of one point in the scene: every pair with one is left to integers by the full filter.
/: [0-9]+ triangles, [0-9]+ rays; the filter on [0-9]+ of them$/ {
    p = "rows." r++
    name = v[p ".scene"] " "
    match($0, /: [0-9]+ triangles/)
    equal(name "scene", substr($0, 1, RSTART - 1), v[p ".scene"])
    split(substr($0, RSTART + 2), word, " ")
    equal(name "triangles", word[1], v[p ".tris"])
    equal(name "rays", word[3], v[p ".rays"])
    filtered = word[8]
    equal(name "rays of the filter", filtered, v[p ".rays"] < 1000 ? v[p ".rays"] : 1000)
    equal(name "pairs", v[p ".pairs"], filtered * v[p ".tris"])
    if (v["rows.count"] > 0 && rounds == 1) near(name "ratio", v[p ".ratio"], v[p ".filter_ns"] / v[p ".scalar_ns"])
    near(name "chosen", v[p ".filter_ns"], v[p "." v[p ".kernel"] "_ns"])
    next
}
/ ns per pair/ {
    same(name $1, $2, "%.3f", v[p "." $1 "_ns"])
    gsub(/[()]/, "", $3)
    split($3, span, "-")
    truth(name $1 " in its span", span[1] + 0 <= $2 + 0 && $2 + 0 <= span[2] + 0)
    if (rounds == 1) truth(name $1 " of one round", span[1] == $2 && span[2] == $2)
    equal(name $1 " chosen", $NF == "chosen", $1 == v[p ".kernel"])
    kernels++
    truth(name $1 " takes time", v[p "." $1 "_ns"] > 0)
    next
}
/^  chosen \/ scalar / {
    lines++
    # The chosen kernel is there because it is faster.
    truth(name "faster than the full filter", v[p ".ratio"] < 1)
    same(name "chosen to scalar", $4, "%.3f", v[p ".ratio"])
    next
}
/^  left to integers of / {
    lines++
    gsub(/[:,]/, "")
    $0 = $0
    equal(name "pairs", $5, v[p ".pairs"])
    equal(name "left to integers", $7, v[p ".undecided"])
    # The first look decides no pair that the full filter does not.
    truth(name "left to integers", v[p ".undecided"] <= $NF + 0)
    equal(name "left by scalar", $NF, v[p ".scene"] ~ /points/ ? filtered * points : 0)
    next
}
/^  exact nearest hits: brute / {
    lines++
    same(name "brute", $5, "%.3f", v[p ".brute_s"])
    truth(name "brute, in s", v[p ".brute_s"] <= took * 1e-9)
    next
}
/^  +tree .* us per ray$/ {
    lines++
    same(name "tree", $2, "%.3f", v[p ".tree_us"])
    # No unit is another: all rays by the tree took less than the command, and more than no time.
    truth(name "tree, in us", v[p ".tree_us"] * 1e-6 * v[p ".rays"] <= took * 1e-9 && v[p ".tree_us"] > 0.01)
    truth(name "tree, not brute force", v[p ".tree_us"] * 1e-6 * v[p ".rays"] / v[p ".brute_s"] - 1 > 1e-6 || v[p ".tree_us"] * 1e-6 * v[p ".rays"] / v[p ".brute_s"] - 1 < -1e-6)
    truth(name "ns of pairs", v[p ".scalar_ns"] * 1e-9 * v[p ".pairs"] <= took * 1e-9 && v[p ".scalar_ns"] > 0.1)
}
END {
    equal("rows", r, v["rows.count"])
    equal("lines", lines, 4 * r)
    truth("kernels", kernels >= 2 * r)
    print "bench oracle: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
