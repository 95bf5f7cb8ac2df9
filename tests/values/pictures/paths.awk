# The segments of `raydiff render --paths FILE.csv`, kept of files whose names end with a.csv and b.csv; bits() counts.
function bits(word,  n) {
    for (; word > 0; word = int(word / 2)) n += word % 2
    return n + 0
}
# True if every bit of `part` is one of `whole`.
function within(part, whole) {
    for (; part > 0; part = int(part / 2)) {
        if (part % 2 > whole % 2) return 0
        whole = int(whole / 2)
    }
    return 1
}
FILENAME ~ /[ab]\.csv$/ {
    side = FILENAME ~ /b\.csv$/
    if (FNR == 1) {
        equal("columns", $0, "frame,x,y,segment,t,prim,asked,shadowed")
        next
    }
    split($0, field, ",")
    at = field[1] - 1 SUBSEP field[2] SUBSEP field[3]
    equal("segments in their order", field[4], of_path[side, at] + 0)
    segment[side, at, field[4]] = field[5] SUBSEP field[6] SUBSEP field[7] SUBSEP field[8]
    of_path[side, at]++
    in_all[side, field[1] - 1]++
    lights[side, field[1] - 1] += field[6] == "" ? 0 : bits(field[7])
    hit[side, field[1] - 1] += field[4] == 0 && field[6] != ""
    truth("what is in a shadow was asked", within(field[8], field[7]))
    next
}
