# Rows of `raydiff bench` in JSON against its CSV, and what holds of every spread:
# awk -v rounds=N -f lib.awk -f rows.awk FLAT CSV
# The fields of a line with commas between; texts may stand in quotes, "" is one of them.
function fields_of(line, out,  n, text) {
    n = 0
    line = line ","
    while (line != "") {
        if (match(line, /^"([^"]|"")*",/)) {
            text = substr(line, 2, RLENGTH - 3)
            gsub(/""/, "\"", text)
        } else {
            match(line, /^[^,]*,/)
            text = substr(line, 1, RLENGTH - 1)
        }
        out[++n] = text
        line = substr(line, RLENGTH + 1)
    }
    return n
}
# Least, median and most of a row; of one round they are one, of two the median is the mean.
function spread(name, least, median, most) {
    if (median == "null" || least == "null") {
        truth(name ": null alone", median == least && least == most)
        return
    }
    truth(name ": " least " is above 0", least > 0)
    truth(name ": " least " <= " median " <= " most, least + 0 <= median + 0 && median + 0 <= most + 0)
    if (rounds == 1) truth(name ": one round, but " least ", " median ", " most, least == median && median == most)
    if (rounds == 2) near(name ": median of two rounds", median, (least + most) / 2)
}
/^benchmark,/ {
    columns = fields_of($0, column)
    next
}
{
    n = fields_of($0, field)
    p = "rows." r++ "."
    equal(p " columns", n, columns)
    equal(p " benchmark", field[1], v[p "benchmark"])
    for (k = 2; k <= columns; k++) {
        name = p column[k]
        seen[name] = 1
        if (!(name in v)) bad(name " is not in the JSON")
        else if (v[name] ~ /^-?[0-9][-+.e0-9]*$/) {
            checked++
            if (field[k] + 0 != v[name] + 0) bad(name ": CSV has " field[k] ", JSON " v[name])
        } else equal(name " in CSV", field[k], v[name] == "null" ? "" : v[name])
    }
}
END {
    equal("rows in CSV", r + 0, v["rows.count"])
    for (name in v) {
        if (name !~ /^rows\.[0-9]/ || name ~ /\.benchmark$/) continue
        if (!(name in seen)) bad(name " is not in the CSV")
        if (name !~ /_(min|least)$/) continue
        stem = name
        sub(/_(min|least)$/, "", stem)
        most = name ~ /_min$/ ? stem "_max" : stem "_most"
        spread(stem, v[name], (stem "_median") in v ? v[stem "_median"] : v[stem], v[most])
    }
    print "rows: " checked " values, " wrong + 0 " wrong"
    exit wrong > 0 || checked < least
}
