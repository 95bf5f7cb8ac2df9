#!/bin/sh
# Rules of the house that a compiler does not check. Prints every breach; exit 1 if there is one.
set -u
bad=0
breach() {
    echo "$1"
    bad=1
}
scratch=${TMPDIR:-/tmp}/rules.$$

# Who may include whom: docs/rooms.txt, where every room stands below those that include it.
grep -nE '#[ 	]*include "' $(git ls-files '*.c' '*.h' '*.glsl' '*.comp') | awk -F: '{split($3, part, "\""); print $1, $2, part[2]}' | awk -v rooms=docs/rooms.txt '
    function breach(text) { print text; bad = 1 }
    function room_of(file) {
        if (file in place) return file
        return sub("/[^/]*$", "", file) ? file : "."
    }
    BEGIN {
        while ((getline line < rooms) > 0) {
            if (line ~ /^#/ || line == "") continue
            if (line !~ /^ /) { # else it goes on with the line before
                room = line
                sub(":.*", "", room)
                sub("[^:]*:", "", line)
                place[room] = ++known
            }
            count = split(line, word, " ")
            for (i = 1; i <= count; i++) {
                if (!(word[i] in place) || word[i] == room)
                    breach(rooms ": " room " names " word[i] ", which does not stand below it")
                allowed[room, word[i]] = 1
            }
        }
        while (("git ls-files" | getline file) > 0) {
            there[file] = 1
            seen[room_of(file)] = 1
        }
        for (room in place)
            if (!(room in seen)) breach(rooms ": " room " is empty")
    }
    {
        from = room_of($1)
        target = $3
        if (!(target in there)) { # of GLSL, from its own folder
            folder = $1
            sub("[^/]*$", "", folder)
            target = (folder target in there ? folder : "shaders/" target in there ? "shaders/" : "shaders/layouts/") target
            if (!(target in there)) next # made, or of a library
        }
        to = room_of(target)
        if (!(from in place)) breach($1 ":" $2 ": " rooms " has no room " from)
        else if (from != to && !((from, to) in allowed))
            breach($1 ":" $2 ": " from " includes nothing of " to " (" rooms ")")
        used[from, to] = 1
    }
    END {
        for (pair in allowed)
            if (!(pair in used)) {
                split(pair, side, SUBSEP)
                breach(rooms ": " side[1] " includes nothing of " side[2] " any more")
            }
        exit bad
    }' || breach "folders include downward, as docs/rooms.txt says"
grep -nE '#include "(ref|scenes)/.*(engine_|layout_|build_|gen_)[a-z0-9_]*\.[ch]"' $(git ls-files '*.c' '*.h') &&
    breach "members of a table are reached through their table"
grep -lE '#include <embree[34]?/' $(git ls-files '*.c' '*.h') | grep -vE '^(ref/engines/embree_library.h|fuzz/templates/embree.c|fuzz/samples/engine/embree_engine.c)$' &&
    breach "one file includes Embree, beside a program that is written out and a sample"

# Shaders: nothing whose result may differ between drivers, but in the probes that measure how.
awk -v placed=1 -f tests/house/code.awk $(git ls-files 'shaders/*.comp' 'shaders/*.glsl' |
    grep -vx 'shaders/probes/probe_\(card\|pack\).comp') >"$scratch" # comments may name what the code must not
grep -E '\bpackHalf2x16|\bfma *\(' "$scratch" &&
    breach "packHalf2x16 and fma differ between drivers"
grep -E '^shaders/build/.*\b(float|d?vec[234]|[a-z]*mat[234]|intBitsToFloat|uintBitsToFloat)\b' "$scratch" &&
    breach "shaders that build have no floats"
grep -v '^shaders/build/' "$scratch" | grep -E '\b(cross|dot|normalize|length|distance|mix|min|max) *\(' &&
    breach "write the operations out: these are never decorated NoContraction"

# The library prints nothing and does not exit; a broken invariant ends a program as assert does.
grep -nE '(^|[^a-z_])(printf|puts|perror|exit|abort) *\(' $(git ls-files 'ref/*.c' 'gpu/*.c' 'scenes/*.c' ':!ref/base/invariant.c') &&
    breach "the library neither prints nor exits"

# Two draws of a sequence among the arguments of one call come in the order that a compiler likes.
perl -0777 -ne '
    s{/\*.*?\*/}{$& =~ tr/\n//cdr}gse;
    while (/\b(?!(?:if|for|while|switch|return|rng_make)\b)\w+(\((?:[^()]++|(?1))*\))/g) {
        my ($call, $line) = ($1, 1 + (substr($_, 0, $-[0]) =~ tr/\n//));
        pos() = $+[0] - length($call) + 1; # what is inside is looked at as well
        my @inner = substr($call, 1, -1) =~ /((?:[^(),{}\[\]]++|(\((?:[^()]++|(?2))*\))|[\[\]{}])+)/g;
        my $draws = grep { defined && /\w\([^()]*\brng\b/ } @inner[grep { $_ % 2 == 0 } 0 .. $#inner];
        print "$ARGV:$line\n" if $draws > 1;
    }' $(git ls-files '*.c' '*.h') >"$scratch"
[ -s "$scratch" ] && cat "$scratch" && breach "one draw after the other: arguments are evaluated in any order"

# "1 page", "2 pages": the word goes with the number that stands before it.
perl -0777 -ne 's{/\*.*?\*/}{$& =~ tr/\n//cdr}gse;
    while (/\bplural(\((?:[^()]++|(?1))*\))/g) {
        my ($of, $at) = (substr($1, 1, -1), $-[0]);
        my ($before, $line) = (substr($_, 0, $at), 1 + (substr($_, 0, $at) =~ tr/\n//));
        next if $before =~ /\*\z/; # where it is declared
        print "$ARGV:$line\n" unless $before =~ /[,(]\s*(?:\([a-z ]+\))?\Q$of\E,\s*\z/;
    }' $(git ls-files '*.c' '*.h') >"$scratch"
[ -s "$scratch" ] && cat "$scratch" && breach "a word is plural by another number than that before it"

# The project speaks of itself alone: nothing lies beside the checkout.
git grep -nF shared/ -- . ':!tests/house/rules.sh' ':!tests/house/rules_planted.sh' |
    grep -E '\.\./shared/|(^|[^a-z./])shared/(scenes|design|notes)' && breach "what is not part of the project is named by an option or a variable"

# What is not played finds nothing.
perl tests/house/played.pl || breach "a script of the tests is played by nothing"
grep -q '^deep:.* seldom-check' tests/checks.mk || breach "make deep lacks what make check leaves to it"

# The picture of the rooms.
sh tests/house/rooms_graph.sh edges | sort >"$scratch"
sed -n 's|^<title>\(.*\)&#45;&gt;\(.*\)</title>$|\1 \2|p' docs/rooms.svg | sort | diff "$scratch" - ||
    breach "docs/rooms.svg is not docs/rooms.txt: make rooms-graph"

# One name, one source.
git ls-files '*.c' '*.h' '*.glsl' '*.comp' | sed 's|.*/||' | sort | uniq -d | grep . && breach "two sources have the same name"

# One tag, one type, but in programs that are written for others.
grep -hoE '^(typedef )?(struct|enum|union) [a-z_0-9]+ \{' $(git ls-files '*.c' '*.h' | grep -vE '^(fuzz/(samples|templates)|tests/peers)/') |
    awk '{print $(NF - 1)}' | sort | uniq -d | grep . && breach "two types have the same tag"

# Plain English: persons are people, and terms are those of the field.
git grep -niE '\bnobody|(is|was|be|are) gone on with|\bwho (is|was) (killed|ended|interrupted|asked)|the seed.s\b|(plays|played) engines against|\b(moody|meetings|court|under fire|way of c)\b' -- \
    ref gpu scenes fuzz bench cmd shaders tests raydiff.c ':!bench/results' ':!tests/house/rules*.sh' && breach "write it plainly: no person where there is none, RTRS by its name"

# A number of a fault of RTRS is told as that, in what is printed and in pages: F7 alone tells a reader nothing.
{
    git grep -nE '"[^"]*\bF[0-9]{1,2}\b' -- ref gpu scenes fuzz bench cmd raydiff.c tests/hard ':!bench/results' | grep -E '"[^"]*\bF[0-9]{1,2}\b[^"]*"'
    git grep -nE '\bF[0-9]{1,2}\b' -- README.md docs/*.md tests/waivers.txt ':!docs/rtrs-faults.md' ':!docs/glossary.md'
} | grep -vE "faults? F[0-9]|RTRS's" && breach "a fault of RTRS is told by its number alone"

# The front of the house.
git ls-files | grep -v / | grep -vxE '\.clang-format|\.gitignore|CHANGELOG\.md|CITATION\.cff|CONTRIBUTING\.md|LICENSE|Makefile|README\.md|SECURITY\.md|raydiff\.c' &&
    breach "what stands at the root is named in tests/house/rules.sh"

# One version, which debian/changelog has as well; debian/control wants what .ci/deps.sh installs.
[ "$(sed -n 's/^VERSION := //p' Makefile)" = "$(sed -n '1s/^raydiff (\(.*\)) .*/\1/p' debian/changelog)" ] ||
    breach "debian/changelog: the version of its first line is not VERSION of the Makefile"
for told in "$(sed -n 's/^version: //p' CITATION.cff)" "$(sed -n 's/^## \([0-9.]*\),.*/\1/p' CHANGELOG.md | head -n 1)"; do
    [ "$(sed -n 's/^VERSION := //p' Makefile)" = "$told" ] || breach "CITATION.cff and CHANGELOG.md have the version of the Makefile first"
done
for package in $(sed -n "/^run='/,/'$/p" .ci/deps.sh | tr " '" '\n\n' | sed -n 's/:.*//p' | sed 's/^run=//'); do
    case $package in
    gcc | libc6-dev | mesa-vulkan-drivers) continue ;; # of every build; of no build
    pkg-config) package=pkgconf ;;
    esac
    sed -n '/^Build-Depends/,/^[^ B]/p' debian/control | grep -qE "[ ,]$package,?\$" ||
        breach "debian/control: Build-Depends lacks $package of .ci/deps.sh"
done

# Small rooms; results are data.
git ls-files -- ':!bench/results' | sed -n 's|/[^/]*$||p' | sort | uniq -c | awk '$1 > 40 {print $2 ": " $1 " files"; bad = 1} END {exit !bad}' &&
    breach "a folder has at most 40 files"
[ "$(wc -l <Makefile)" -le 200 ] || breach "Makefile: over 200 lines; its parts stand in the rooms that they build"
wc -l $(git ls-files '*.c' '*.h' '*.glsl' '*.comp') | awk '$1 > 400 && $2 != "total" {print $2 ": " $1 " lines"; bad = 1} END {exit !bad}' &&
    breach "one concept a file, at most 400 lines"
awk 'length($0) > 100 {print FILENAME ":" FNR ": " $0; bad = 1} END {exit !bad}' $(git ls-files '*.c' '*.h' '*.glsl' '*.comp') &&
    breach "a line has at most 100 columns"
awk 'FNR == 1 {code = 0} /^```/ {code = !code; next} !code && !/^\|/ && length($0) > 120 {print FILENAME ":" FNR; bad = 1} END {exit !bad}' \
    $(git ls-files '*.md' ':!bench/results') && breach "a line of a page has at most 120 columns, but in tables and in what is shown"
awk 'FNR == 1 {begin = 0} /^\{/ {begin = FNR} /^\}/ && begin {if (FNR - begin - 1 > 60) {print FILENAME ":" begin ": " FNR - begin - 1 " lines"; bad = 1}; begin = 0} END {exit !bad}' \
    $(git ls-files '*.c' '*.h') && breach "a function has at most 60 lines"

# Results are read by people: tables and texts, and no more than that.
git ls-files bench/results | grep -vE '\.(csv|txt|md)$' && breach "bench/results: CSV and text only"
[ "$(git ls-files -z bench/results | xargs -0 cat | wc -l)" -le 3000 ] || breach "bench/results: over 3,000 lines"

for folder in ref/builders ref/layouts; do
    [ "$(git ls-files "$folder" | wc -l)" -le 25 ] || breach "$folder: over 25 files, and more members come: tools of theirs have a room of their own"
done

# The paths of docs/reading.md: files that are there, at most 8 to follow a ray or a trial, at most 600
# lines to a new layout.
awk -F'`' '/^## / {path++; name[path] = $0} /^\| `/ {
        lines = 0
        while ((getline line <$2) > 0) lines++
        if (!lines) { print "docs/reading.md:" FNR ": " $2 " is not there"; bad = 1 }
        files[path]++
        total[path] += lines
    }
    END {
        if (path != 3) { print "docs/reading.md: three paths"; bad = 1 }
        for (p = 1; p <= 2; p++) if (files[p] > 8) { print "docs/reading.md: " name[p] ": " files[p] " files, at most 8"; bad = 1 }
        if (total[3] > 600) { print "docs/reading.md: " name[3] ": " total[3] " lines, at most 600"; bad = 1 }
        exit !bad
    }' docs/reading.md && breach "docs/reading.md: a path is too long or does not lead there"

# What the pages name is there.
grep -noE '`(ref|gpu|scenes|fuzz|bench|cmd|shaders|tests|docs)/[A-Za-z0-9_./-]+\.(c|h|sh|mk|txt|glsl|comp|md|svg|png|trial)`' README.md CONTRIBUTING.md docs/*.md |
    awk -F: '{path = $3; gsub("`", "", path); if (path !~ /NAME/ && (getline line <path) < 0) {print; bad = 1}; close(path)} END {exit !bad}' &&
    breach "a page names a file that is not there"

# Planted bugs lie beside the program, and every record fits.
git grep -nwE 'MUTANT(_[A-Z0-9_]+)?' -- ref gpu scenes fuzz bench cmd shaders tests/hard raydiff.c && breach "a planted bug is a record in tests/planted"
sh tests/planted/plant.sh --check >/dev/null || breach "tests/planted: a record does not fit"
rm -f "$scratch"

[ "$bad" -eq 0 ] && echo "rules: kept"
exit "$bad"
