#!/bin/sh
# The limits and defaults that help tells, by value: tests/values/limits.txt has a line for each option of each
# command that has some, "COMMAND --OPTION (LEAST to MOST) [DEFAULT]". A change of one is a change for users, and
# goes there, too. That commands keep them: tests/scripts/options.sh.
#   sh tests/values/values_limits.sh RAYDIFF [write]      write: make the list anew
set -u
raydiff=$1
. tests/scripts/expect.sh
"$raydiff" help --commands >"$dir/commands"
while read -r command; do
    "$raydiff" $command --help | awk -v command="$command" '
        function done() {
            gsub(/ +/, " ", text)
            if (!match(text, /--[a-z-]+/)) return
            row = substr(text, RSTART, RLENGTH)
            kept = ""
            while (match(text, /\([0-9][^()]* to [^()]*\)|\[[^][]*\]/)) {
                kept = kept " " substr(text, RSTART, RLENGTH)
                text = substr(text, RSTART + RLENGTH)
            }
            if (kept != "") print command, row kept
        }
        /^$/ { body = 1 }
        !body { next }
        /^  (-[a-z], )?--[a-z]/ { done(); text = $0; next }
        /^$/ || /^[^ ]/ { done(); text = ""; next }
        { text = text " " $0 }
        END { done() }'
done <"$dir/commands" >"$dir/limits"
[ "${2:-}" != write ] || cp "$dir/limits" tests/values/limits.txt
[ "$(grep -c . "$dir/limits")" -ge 150 ] || bad "help tells of too few limits and defaults"
diff tests/values/limits.txt "$dir/limits" >"$dir/out" || bad "help tells other limits or defaults than tests/values/limits.txt"
echo "limits: $failed failed"
[ "$failed" -eq 0 ]
