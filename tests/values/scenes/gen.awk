# What `raydiff judge gen` writes against the scene as OBJ and the same request in the other form (hexadecimal and
# decimal): awk -f lib.awk -f floats.awk -f obj.awk -f gen.awk -v query=Q -v count=N -v seed=S -v scene=SPEC NONE x.obj HEX DECIMAL
FNR == 1 {
    form++
    equal("head", $0, "raydiff 1")
    v_ = t_ = r_ = 0
}
$1 == "from" {
    equal("from", $3 " " $4 " " $6, seed " " count " " scene)
    if (form == 1) hash = $2
    equal("hash", $2, hash)
    truth("hash", $2 ~ /^[0-9a-f]+$/ && length($2) == 16)
}
$1 == "query" { equal("query", $2, query) }
$1 == "v" { for (k = 0; k < 3; k++) near("vertex " v_, float_number($(2 + k)), vertex[v_, k]); v_++ }
$1 == "t" { for (k = 0; k < 3; k++) equal("triangle " t_, $(2 + k), corner[t_, k]); t_++ }
$1 == "r" {
    equal("numbers of a ray", NF, 9)
    for (k = 2; k <= NF; k++) {
        if (form == 1) ray[r_, k] = float_number($k)
        near("ray " r_, float_number($k), ray[r_, k])
    }
    truth("ray " r_ " has a direction and a range", ray[r_, 6] ^ 2 + ray[r_, 7] ^ 2 + ray[r_, 8] ^ 2 > 0 && ray[r_, 5] <= ray[r_, 9])
    if (r_ > 0 && $0 != before) other_rays++
    before = $0
    r_++
}
$1 == "end" {
    equal("vertices", v_, vertices)
    equal("triangles", t_, triangles)
    equal("rays", r_, count)
    ends++
}
END {
    equal("requests", ends, 2)
    truth("rays are others", other_rays >= count)
    print "gen: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
