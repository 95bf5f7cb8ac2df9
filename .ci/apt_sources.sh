#!/bin/sh
# The machine's own package sources, a line each: "URI SUITE KEYS", of one-line and deb822 entries. KEYS is
# a file of keys, or "-". APT_ROOT: another /etc/apt.
set -u
root=${APT_ROOT:-/etc/apt}
sed -n 's/^deb[ \t]*\(.*\)$/\1/p' "$root"/sources.list "$root"/sources.list.d/*.list 2>/dev/null |
    awk '{
        keys = "-"
        if ($1 ~ /^\[/) {
            options = $0
            sub(/\].*/, "", options)
            if (match(options, /signed-by=[^] ]*/))
                keys = substr(options, RSTART + 10, RLENGTH - 10)
            sub(/^\[[^]]*\] */, "")
        }
        print $1, $2, keys
    }'
for file in "$root"/sources.list.d/*.sources; do
    [ -r "$file" ] || continue
    awk 'function flush(  i, j, u, s) {
            if (types ~ /(^| )deb( |$)/ && enabled !~ /no|false|0/)
                for (i = split(uris, u, " "); i > 0; i--)
                    for (j = split(suites, s, " "); j > 0; j--)
                        print u[i], s[j], keys
            types = uris = suites = enabled = ""
            keys = "-"
        }
        BEGIN { keys = "-" }
        /^#/ { next }
        /^[ \t]*$/ { flush(); next }
        /^[^ \t]/ { at = index($0, ":"); name = tolower(substr($0, 1, at - 1)); value = substr($0, at + 1)
                    sub(/^[ \t]*/, "", value) }
        name == "types" { types = value }
        name == "uris" { uris = value }
        name == "suites" { suites = value }
        name == "enabled" { enabled = value }
        name == "signed-by" && value ~ /^\// { keys = value; gsub(/[ \t]+/, ",", keys) }
        END { flush() }' "$file"
done
