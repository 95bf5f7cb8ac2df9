#!/bin/sh
# Planted bugs: tests/planted/*.txt, a text for each room or some small ones, has a record of each. The program
# holds none of them.
#
#   bug NAME: what is wrong
#   in FILE: FUNCTION               FILE alone: anywhere in the file
#    a line as it is                as many as it takes to find the place, which must be there once;
#   -a line that goes               what a line is indented by does not matter
#   +a line that comes
#   caught KIND UNIT CATCHER        who must catch it, if UNIT is compiled with it (tests/planted/play.sh);
#                                   fuzz/selftest.txt names those that the fuzzer must find
#
#   sh tests/planted/plant.sh BUG FOLDER    the files with the bug in them, copied into FOLDER
#   sh tests/planted/plant.sh --check       every record finds its place, every bug has a catcher
#   sh tests/planted/plant.sh --list        what catches them, a line each: KIND BUG UNIT CATCHER
# Exit 2: there is no such bug, or a record does not fit; a line names record, file and rule.
set -u
what=${1?BUG FOLDER, --check or --list}
folder=${2-}
[ -n "$folder" ] && { mkdir -p "$folder" || exit 4; }
awk -v what="$what" -v folder="$folder" -v table=fuzz/selftest.txt '
    function wrong(place, rule) {
        printf "%s: bug %s: %s\n", at[place], bug_of[place], rule >"/dev/stderr"
        bad = 1
    }
    function bare(text) {
        sub(/^[ \t]+/, "", text)
        return text
    }
    function load(file, line) {
        count = 0
        while ((getline line <file) > 0) text[++count] = line
        close(file)
        return count > 0
    }
    # The lines of a place, as they are without the bug, among lines `from` to `to`.
    function look(place, from, to, start, k) {
        for (start = from; start + old[place] - 1 <= to; start++) {
            for (k = 1; k <= old[place] && bare(text[start + k - 1]) == bare(old_line[place, k]); k++) continue
            if (k > old[place]) {
                found++
                first = start
            }
        }
    }
    # Name of the function whose body begins in a line; `head` is where its declaration does.
    function name_at(line, k, declaration) {
        for (head = line - 1; head > 1 && text[head] !~ /^[A-Za-z_]/; head--) continue
        for (k = head; k < line; k++) declaration = declaration " " text[k]
        if (!match(declaration, /[A-Za-z_0-9]+ *\(/)) return ""
        declaration = substr(declaration, RSTART, RLENGTH - 1)
        sub(/ +$/, "", declaration)
        return declaration
    }
    function change(place, line, end, k, shift) {
        found = 0
        if (function_of[place] == "")
            look(place, 1, count)
        else
            for (line = 2; line <= count; line++)
                if (text[line] == "{" && name_at(line) == function_of[place]) {
                    for (end = line; end < count && text[end] !~ /^}/; end++) continue
                    look(place, head, end)
                }
        if (found != 1) {
            wrong(place, file_of[place] ": " (found ? found " places fit" : "no place fits") \
                (function_of[place] == "" ? "" : " in " function_of[place]))
            return
        }
        shift = new[place] - old[place]
        for (k = 1; k <= count; k++) kept[k] = text[k]
        for (k = first + old[place]; k <= count; k++) text[k + shift] = kept[k]
        for (k = 1; k <= new[place]; k++) text[first + k - 1] = new_line[place, k]
        count += shift
    }

    /^#/ && !inside { next }
    /^bug / {
        name = $2
        if (name !~ /^[A-Z0-9_]+:$/ || NF < 3) { printf "%s:%d: bug NAME: what is wrong\n", FILENAME, FNR >"/dev/stderr"; bad = 1 }
        sub(/:$/, "", name)
        if (name in record) { printf "%s:%d: bug %s: there are two of that name\n", FILENAME, FNR, name >"/dev/stderr"; bad = 1 }
        record[name] = FILENAME ":" FNR
        next
    }
    /^in / {
        place = ++places
        at[place] = FILENAME ":" FNR
        bug_of[place] = name
        file_of[place] = $2
        sub(/:$/, "", file_of[place])
        function_of[place] = $3
        planted[name] = inside = 1
        next
    }
    /^caught / {
        inside = 0
        caught[name] = 1
        kind = $2
        rest = $0
        sub(/^caught +[a-z]+ +/, "", rest)
        if (kind == "watched") {
            kind = kind " " $3
            sub(/^[a-z]+ +/, "", rest)
        }
        if (what == "--list") print kind, name, rest
        next
    }
    inside && /^[ +-]/ {
        if (!/^\+/) old_line[place, ++old[place]] = substr($0, 2)
        if (!/^-/) new_line[place, ++new[place]] = substr($0, 2)
        if (!/^ /) changes[place] = 1
        next
    }
    /^$/ { inside = 0; next }
    { printf "%s:%d: this is no line of a record\n", FILENAME, FNR >"/dev/stderr"; bad = 1 }

    END {
        if (what != "--list") {
            for (p = 1; p <= places; p++) {
                if (what != "--check" && bug_of[p] != what) continue
                if (what == "--check" || !(file_of[p] in open)) {
                    if (!load(file_of[p])) {
                        wrong(p, file_of[p] ": there is no such file")
                        continue
                    }
                } else
                    load(open[file_of[p]])
                if (!changes[p]) wrong(p, "it changes nothing")
                change(p)
                if (what == "--check") continue
                copy = folder "/" file_of[p]
                path = copy
                sub("/[^/]*$", "", path)
                if (system("mkdir -p \"" path "\"")) exit 4
                printf "" >copy
                for (k = 1; k <= count; k++) print text[k] >copy
                close(copy)
                open[file_of[p]] = copy
            }
            if (what != "--check" && !(what in record)) {
                print "tests/planted: there is no bug " what >"/dev/stderr"
                bad = 1
            }
        }
        if (what == "--check") {
            while ((getline line <table) > 0)
                if (split(line, word, " ") && word[1] !~ /^#/) {
                    caught[word[1]] = 1
                    if (!(word[1] in record)) { print table ": there is no bug " word[1] >"/dev/stderr"; bad = 1 }
                }
            for (name in record) {
                if (!caught[name]) { print record[name] ": bug " name ": it has no catcher" >"/dev/stderr"; bad = 1 }
                if (!planted[name]) { print record[name] ": bug " name ": it is planted nowhere" >"/dev/stderr"; bad = 1 }
            }
            if (!bad) {
                for (name in record) bugs++
                print bugs " planted bugs in " places " places"
            }
        }
        exit bad ? 2 : 0
    }' tests/planted/*.txt
