# The heat map of `raydiff diff A.png B.png --out HEAT.png`: a pixel is a square where the text has it, gray if both are
# equal there, else not: awk -f lib.awk -f pixels.awk -f heat.awk NONE a.pixels b.pixels heat.map TEXT
FILENAME ~ /heat\.map$/ {
    if (FNR > 1) map[$1, $2] = $3 " " $4 " " $5
    next
}
/^  heat map / {
    match($0, /at \([0-9]+ \+ [0-9]+ x, [0-9]+ \+ [0-9]+ y\)/)
    split(substr($0, RSTART + 4, RLENGTH - 5), of, /[ ,+xy]+/)
    equal("squares", of[2], of[4])
    for (y = 0; y < height[0]; y++) for (x = 0; x < width[0]; x++) {
        left = of[1] + of[2] * x
        top = of[3] + of[4] * y
        one = map[left, top]
        truth("pixel " x "," y " is in the map", one != "")
        for (i = 0; i < of[2]; i++)
            for (k = 0; k < of[4]; k++) truth("a square at " x "," y, map[left + i, top + k] == one)
        split(one, of_it, " ")
        gray = of_it[1] == of_it[2] && of_it[2] == of_it[3]
        equal("gray at " x "," y, gray, channels_apart(y * width[0] + x) == 0)
        coloured += !gray
    }
    maps++
}
END {
    equal("maps", maps, 1)
    truth("pixels that differ", coloured > 0 && coloured < width[0] * height[0])
    print "heat map: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
