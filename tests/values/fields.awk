# Paths of a flat JSON against the table of fields: awk -v command=NAME -f fields.awk TABLE... FLAT; see fields.sh.
# With -v ran='WORDS OF A COMMAND' values whose line begins with an option are what that command was given for it.
function wrong(what) {
    print "FIELD   " what
    bad = 1
}
# '' or what is wrong with a value of that unit
function misfit(value, unit) {
    if (value == "null") return unit ~ /\|null$/ ? "" : "is null"
    sub(/\|null$/, "", unit)
    if (unit == "text") return ""
    if (unit == "float.bits") return value ~ /^0x[0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f]$/ ? "" : "is no word"
    if (unit == "float.value") unit = "number"
    if (unit == "bool") return value == "true" || value == "false" ? "" : "is no bool"
    if (unit in whole) return value ~ /^[0-9]+$/ ? "" : "is no whole number of 0 or more"
    if (value !~ /^-?[0-9]+(\.[0-9]+)?(e[-+]?[0-9]+)?$/) return "is no number"
    if (unit != "number" && value < 0) return "is below 0"
    if (unit == "share" && value > 1) return "is over 1"
    return ""
}
# The line of a path: the same, or with '*' for a name or a part of one.
function line_of(path,  k) {
    if (path in unit_of) return path
    if (path ~ /\.(value|bits)$/) { # of a float
        k = path
        sub(/\.[a-z]+$/, "", k)
        k = line_of(k)
        if (k != "" && unit_of[k] ~ /^float/) return k
    }
    for (k = 1; k <= patterns; k++)
        if (path ~ pattern[k]) return pattern_line[k]
    return ""
}
# The path with '*' for each place of an array.
function general(path) {
    while (match(path, /(^|\.)[0-9]+(\.|$)/))
        path = substr(path, 1, RSTART - 1) (substr(path, RSTART, 1) == "." ? "." : "") "*" \
            (substr(path, RSTART + RLENGTH - 1, 1) == "." ? "." : "") substr(path, RSTART + RLENGTH)
    return path
}
# True for flat.awk's own line, how many values an array has.
function is_length(path, value) {
    return sub(/\.count$/, "", path) && ((path in array) || (value == 0 && line_of(general(path ".count")) == ""))
}
# Sizes of bytes have letters.
function number_of(text) {
    if (text !~ /^[0-9.]+[kmKM]$/) return text
    return text * (text ~ /[kK]$/ ? 1024 : 1048576)
}
# What words give for each option; of --an-option A:B:C, "--an-option:2" is B.
function take(words,  word, count, k, name, part, parts, p) {
    count = split(words, word, " ")
    for (k = 1; k <= count; k++) {
        if (word[k] !~ /^--[a-z]/) continue
        name = word[k]
        if (!sub(/=.*/, "", name)) given[name] = k < count && word[k + 1] !~ /^--/ ? word[k + 1] : ""
        else given[name] = substr(word[k], length(name) + 2)
        parts = split(given[name], part, ":")
        for (p = 1; p <= parts; p++) given[name ":" p] = part[p]
    }
}
# Values of a line that begins with an option are of the list that was given, and each of the list is one of them.
function members_of(option) {
    return split(given[option], member, option == "--scene" ? ";" : ",")
}
function echoed(line, path, value,  k) {
    if (!(line in option_of) || given[option_of[line]] == "" || given[option_of[line]] ~ /^(all|every)$|\*/) return
    echoes[line] = 1
    for (k = members_of(option_of[line]); k > 0; k--) {
        if (value != number_of(member[k])) continue
        met[line, k] = 1
        return
    }
    if (!(value == 0 && zero_of[line])) wrong(command ": " path " = " value ", but " option_of[line] " " given[option_of[line]])
}
function check(path, value,  name, line, what) {
    if (is_length(path, value)) return
    name = general(path)
    line = line_of(name)
    checked++
    if (line == "") {
        if (!(name in told)) wrong(command ": " name " has no line in the table")
        told[name] = 1
        return
    }
    printed[line] = 1
    what = unit_of[line]
    if (what ~ /^float/) sub(/float/, "float" (path ~ /\.bits$/ ? ".bits" : ".value"), what)
    what = misfit(value, what)
    if (what != "") wrong(command ": " path " = " value " " what " (" unit_of[line] ")")
    echoed(line, path, value)
}
BEGIN {
    # Whole numbers of 0 or more; numbers of 0 or more; numbers.
    split("count bytes index pixels ns seed", word, " ")
    for (k in word) whole[word[k]] = known[word[k]] = 1
    split("text bool share ratio number ms us s ns_each Mray/s per_s ulp u degrees length float", word, " ")
    for (k in word) known[word[k]] = 1
    last = ARGV[ARGC - 1]
    take(ran)
}
FILENAME == last && unseen { if ($1 == command) printed[$2] = 1; next }
FILENAME == last {
    at = index($0, "=")
    path[++paths] = substr($0, 1, at - 1)
    value[paths] = substr($0, at + 1)
    for (k = 1; match(substr(path[paths], k), /\.0(\.|$)/); k += RSTART) array[substr(path[paths], 1, k + RSTART - 2)] = 1
    next
}
/^#/ || NF == 0 { next }
/^command [a-z_0-9]+: ./ {
    name = $2
    sub(/:$/, "", name)
    if (name in named) wrong(FILENAME ":" FNR ": " name " stands twice")
    named[name] = 1
    next
}
{
    if (NF < 4 || name == "") wrong(FILENAME ":" FNR ": PATH UNIT FORMAT and where it comes from")
    plain = $2
    sub(/\|null$/, "", plain)
    if (!(plain in known)) wrong(FILENAME ":" FNR ": no unit is called " plain)
    if ($3 != "-" && $3 !~ /%/) wrong(FILENAME ":" FNR ": '" $3 "' is no format")
    sometimes = sub(/\?$/, "", $1)
    if ((name, $1) in stands) wrong(FILENAME ":" FNR ": " $1 " stands twice")
    stands[name, $1] = 1
    if (name != command || $1 ~ /^text:/) next
    unit_of[$1] = $2
    if (!sometimes) must[$1] = 1
    if ($4 ~ /^--[a-z]/) {
        option_of[$1] = $4
        sub(/[,;]$/, "", option_of[$1])
        zero_of[$1] = /; 0 /
    }
    if ($1 ~ /\*/) {
        pattern_line[++patterns] = $1
        pattern[patterns] = $1
        gsub(/\./, "\\.", pattern[patterns])
        gsub(/\*/, "[^.]+", pattern[patterns])
        pattern[patterns] = "^" pattern[patterns] "$"
    }
}
END {
    for (k = 1; k <= paths && command in named; k++) check(path[k], value[k])
    for (line in echoes)
        for (k = members_of(option_of[line]); k > 0; k--)
            if (!((line, k) in met)) wrong(command ": " option_of[line] " " member[k] " was given, and no " line " is that")
    if (command != "" && !(command in named)) wrong(command ": no such command in the table")
    else if (command != "" && !unseen && checked == 0) wrong(command ": no path at all")
    if (unseen)
        for (line in must)
            if (!(line in printed)) wrong(command ": " line " is in no JSON")
    if (command != "" && !unseen)
        for (line in printed) print command, line >>seen
    exit bad
}
