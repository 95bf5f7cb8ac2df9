#!/bin/sh
# Rules of the house that a compiler does not check. Prints every breach; exit 1 if there is one.
set -u
bad=0
breach() {
    echo "$1"
    bad=1
}
scratch=${TMPDIR:-/tmp}/rules.$$
list() { ls $* 2>/dev/null; }

# Who may include whom: down only.
for file in $(list ref/*.[ch] ref/*/*.[ch]); do
    case $file in ref/cmd_*) continue ;; esac
    grep -nE '#include "(gpu|scenes|tests|bench|fuzz|shaders)/' "$file" /dev/null &&
        breach "$file: ref/ includes nothing outside ref/"
done
for file in $(list scenes/*.[ch] scenes/*/*.[ch] gpu/*.[ch]); do
    case $file in scenes/cmd_* | gpu/cmd_*) continue ;; esac
    grep -nE '#include "(tests|bench|fuzz|shaders)/' "$file" /dev/null &&
        breach "$file: the library includes no program"
done
grep -nE '#include "gpu/' $(list scenes/*.[ch] tests/cmd_*.[ch] bench/*.[ch]) /dev/null &&
    breach "only gpu/ and the driver's own tests include gpu/"
grep -nE '#include "(ref|scenes)/.*(engine_|layout_|build_|gen_)[a-z0-9_]*\.[ch]"' $(git ls-files '*.c' '*.h') &&
    breach "members of a table are reached through their table"
grep -lE '#include <embree[34]?/' $(git ls-files '*.c' '*.h') | grep -vE '^(ref/engines/engine_embree.c|fuzz/export/embree.c)$' &&
    breach "one file includes Embree, beside a program that is written out"

# Shaders: nothing whose result may differ between drivers, but in the probes that measure how.
for file in $(list shaders/*.comp shaders/*.glsl); do # comments may name what the code must not
    case $file in shaders/probe_card.comp | shaders/probe_pack.comp) continue ;; esac
    awk '{
        line = $0
        kept = ""
        while (line != "") {
            if (comment) {
                end = index(line, "*/")
                if (!end) break
                line = substr(line, end + 2)
                comment = 0
            }
            begin = index(line, "/*")
            if (!begin) { kept = kept line; break }
            kept = kept substr(line, 1, begin - 1)
            line = substr(line, begin + 2)
            comment = 1
        }
        print FILENAME ":" FNR ": " kept
    }' "$file"
done >"$scratch"
grep -E '\bpackHalf2x16|\bfma *\(' "$scratch" &&
    breach "packHalf2x16 and fma differ between drivers"
grep -E '\b(cross|dot|normalize|length|distance|mix|min|max) *\(' "$scratch" &&
    breach "write the operations out: these are never decorated NoContraction"

# The library prints nothing and does not exit.
for file in $(git ls-files 'ref/*.c' 'gpu/*.c' 'scenes/*.c'); do
    case $file in */cmd_*) continue ;; esac
    grep -nE '(^|[^a-z_])(printf|puts|perror|exit|abort) *\(' "$file" /dev/null &&
        breach "$file: the library neither prints nor exits"
done

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

# The project speaks of itself alone: nothing lies beside the checkout.
git grep -nE '\.\./shared/|(^|[^a-z./])shared/(scenes|design|notes)' -- . ':!tests/rules.sh' ':!tests/rules_planted.sh' &&
    breach "what is not part of the project is named by an option or a variable"

# Small rooms.
for file in $(git ls-files '*.c' '*.h' '*.glsl' '*.comp'); do
    lines=$(wc -l <"$file")
    [ "$lines" -le 450 ] || breach "$file: $lines lines; one concept a file, at most 450"
done

# A planted bug has a number of its own, beside its name, and something must find it.
defines() { awk '$1 == "#define" && $2 ~ /^MUTANT_/ && $2 != "MUTANT_H" {print $2, $3}' ref/mutant.h; }
defines | awk '{sub("MUTANT_", "", $1); print $1}' | while read -r name; do
    grep -qE "^[a-z ]+ $name " tests/mutants_list.txt || grep -q "^$name " fuzz/selftest.txt || echo "$name"
done >"$scratch"
[ -s "$scratch" ] && breach "ref/mutant.h: neither tests/mutants_list.txt nor fuzz/selftest.txt plays $(tr '\n' ' ' <"$scratch")"
defines | awk '$2 !~ /^[0-9]+$/ {print $1; bad = 1} END {exit !bad}' && breach "ref/mutant.h: a bug without a number"
defines | awk '{print $2}' | sort | uniq -d | grep . && breach "ref/mutant.h: a number that two bugs have"
rm -f "$scratch"

[ "$bad" -eq 0 ] && echo "rules: kept"
exit "$bad"
