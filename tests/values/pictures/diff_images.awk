# `raydiff diff A.png B.png` against the pixels of both: awk -f lib.awk -f pixels.awk -f diff_images.awk FLAT
# a.pixels b.pixels TEXT
function number(what) { return is[what] + 0 }
# The JSON, against the pixels.
function json(  k, c, i, side, name) {
    differences()
    equal("width", v["width"], width[0])
    equal("height", v["height"], height[0])
    equal("pixels", v["pixels"], width[0] * height[0])
    equal("different", v["different"], number("different"))
    sizes = split("1 2 3-7 8-31 32+", size, " ")
    for (k = 1; k <= sizes; k++) equal("by size " size[k], v["by_size." size[k]], number("size " size[k]))
    for (c = 1; c <= 4; c++) {
        equal("largest " channel[c], v["largest." channel[c]], number("largest " channel[c]))
        near("mean " channel[c], v["mean." channel[c]], number("sum " channel[c]) / pixels[0])
    }
    if (number("different") == 0) {
        truth("no box", !("box.0" in v))
        return
    }
    equal("box", v["box.0"] " " v["box.2"] " " v["box.1"] " " v["box.3"], is["box"])
    split("first worst", name, " ")
    for (k = 1; k <= 2; k++) {
        i = is[name[k]]
        equal(name[k], v[name[k] ".x"] "," v[name[k] ".y"], i % width[0] "," int(i / width[0]))
        for (side = 0; side < 2; side++)
            for (c = 0; c < 4; c++)
                equal(name[k] " value", v[name[k] "." (side ? "b" : "a") "." c], red[side, i, c])
    }
}
FNR == 1 {
    json()
    equal("files", $1 " " $3, v["a"] " " v["b"] ":")
    equal("size", $(NF - 3) " " $(NF - 1), v["width"] " " v["height"])
    next
}
{ lines++ }
$1 == "different" {
    equal("different", $2 " " $4, v["different"] " " v["pixels"])
    same("per cent", substr($5, 2), "%.4f", 100 * v["different"] / v["pixels"])
}
/^  by size / {
    gsub(/[:,]/, " ")
    for (k = 3; k < NF; k += 2) equal("by size " $k, $(k + 1), v["by_size." $k])
    equal("sizes", NF, 12)
}
$1 == "largest" {
    gsub(",", " ")
    equal("channels of largest", NF, 9)
    for (c = 1; c <= 4; c++) equal("largest", $(2 * c) " " $(2 * c + 1), channel[c] " " v["largest." channel[c]])
}
/^  mean of all / {
    gsub(",", " ")
    equal("channels of mean", NF, 11)
    for (c = 1; c <= 4; c++) {
        equal("mean of", $(2 + 2 * c), channel[c])
        same("mean of " channel[c], $(3 + 2 * c), "%.6f", v["mean." channel[c]])
    }
}
$1 == "within" {
    gsub(",", "")
    equal("within", $3 " " $5 " " $7 " " $9, is["box"])
}
$1 == "first" || $1 == "worst" {
    name = $1
    gsub(/[(),:]/, " ")
    places = places name
    equal(name " numbers", NF, 13)
    equal(name " place", $2 " " $3, v[name ".x"] " " v[name ".y"])
    for (c = 0; c < 4; c++) {
        equal(name " value of a", $(5 + c), v[name ".a." c])
        equal(name " value of b", $(10 + c), v[name ".b." c])
    }
}
END {
    equal("lines", lines, v["different"] > 0 ? 7 : 1)
    equal("places", places "", v["different"] > 0 ? "firstworst" : "")
    print "diff of pictures: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
