# The pairs of members that met, from the names in JUnit's cases: fields 1 to `fields` of a name are members of as many
# tables, '-' is none.
#   awk -v prefix='world\\.' -v fields=N -v what='pairs of members' [-v unmet=1] -f pairs.awk JUNIT
# unmet: those that met only where nothing ran, as "A with B" and as "B with A".
/^<testcase / && !/\.answered"/ {
    name = $0
    sub(".* name=\"" prefix, "", name)
    sub(/".*/, "", name)
    split(name, part, ".")
    for (a = 1; a <= fields; a++)
        for (b = a + 1; b <= fields; b++)
            if (part[a] != "-" && part[b] != "-") {
                pair = a " " part[a] " " b " " part[b]
                met[pair] = met[pair] || !/<skipped/
                shown[pair] = part[a] " with " part[b] "\n" part[b] " with " part[a]
            }
}
END {
    for (pair in met) {
        all++
        lacking += !met[pair]
        if (unmet && !met[pair])
            print shown[pair]
    }
    if (!unmet)
        print all " " what " met, " lacking + 0 " of them only in trials that were refused or skipped"
}
