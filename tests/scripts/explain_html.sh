#!/bin/sh
# Pages and pictures of raydiff explain: numbers and bits against the JSON, shapes within their cube, nothing fetched,
# and the picture of README.md as it is.
#   sh tests/scripts/explain_html.sh RAYDIFF
set -u
raydiff=$1
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
}
# exit code, arguments of explain: both files and the JSON
page() {
    want=$1
    shift
    rm -f "$dir/page.html" "$dir/page.svg" "$dir/json"
    "$raydiff" explain "$@" --html "$dir/page.html" --svg "$dir/page.svg" --json "$dir/json" >"$dir/out" 2>"$dir/err"
    code=$?
    [ "$code" -eq "$want" ] || { bad "explain $*: exit $code, not $want"; cat "$dir/err"; }
}

# The bits of the node: those of the floats, and marked exactly where they differ.
bits() {
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    tr -d '\n' <"$dir/page.html" | sed 's/<tr/\n<tr/g' | sed -n 's/^<tr[^>]*><td>\([xyz] [a-z]*\)<\/td>/\1 /p' >"$dir/rows"
    awk '
        function binary(hex,  i, k, d, out) {
            for (i = 1; i <= length(hex); i++) {
                d = index("0123456789abcdef", substr(hex, i, 1)) - 1
                for (k = 8; k >= 1; k /= 2) { out = out (d >= k ? "1" : "0"); if (d >= k) d -= k }
            }
            return substr(out, 1, 1) " " substr(out, 2, 8) " " substr(out, 10)
        }
        FNR == NR { at = index($0, "="); v[substr($0, 1, at - 1)] = substr($0, at + 1); next }
        {
            axis = index("xyz", substr($0, 1, 1)) - 1
            p = "way." v["last"] "." substr($0, 3, 2) "." axis
            n = 0
            text = $0
            while (match(text, /<td class="bits">[^\/]*(<\/b>[^\/]*)*<\/td>/)) {
                cell[++n] = substr(text, RSTART + 17, RLENGTH - 22)
                text = substr(text, RSTART + RLENGTH)
            }
            if (n != 2) { print "not two cells of bits: " $0; bad = 1; next }
            plain = cell[1]; gsub(/<\/?b>/, "", plain)
            other = cell[2]; gsub(/<\/?b>/, "", other)
            if (plain != binary(substr(v[p ".exact.bits"], 3))) { print p ": exact " plain; bad = 1 }
            if (other != binary(substr(v[p ".decoded.bits"], 3))) { print p ": decoded " other; bad = 1 }
            marked = ""
            for (i = 1; i <= length(plain); i++) {
                a = substr(plain, i, 1)
                marked = marked (a == substr(other, i, 1) ? a : "<b>" a "</b>")
            }
            if (marked != cell[1]) { print p ": marked " cell[1] ", not " marked; bad = 1 }
            rows++
        }
        END { if (rows != 6) { print rows + 0 " bounds, not 6"; bad = 1 } exit bad }' "$dir/flat" "$dir/rows" || bad "bits of $1"
}

# Whatever is drawn lies in its picture, lines with their width and texts with theirs, on every side.
uncut() { # file, least number of elements
    perl -ne '
        while (/<(\/?)(svg|polygon|polyline|circle|rect|text)\b([^>]*)>([^<]*)/g) {
            my ($end, $kind, $has, $text) = ($1, $2, $3, $4);
            my %of = $has =~ /([a-z0-9]+|viewBox)="([^"]*)"/g;
            if ($kind eq "svg") {
                if ($end) { pop @box; next }
                my ($x, $y, $w, $h) = split / /, $of{viewBox} // "0 0 $of{width} $of{height}";
                bad("$kind is larger than what it lies in") if @box && ($of{x} // 0) + $of{width} > $box[-1][0];
                push @box, [$w, $h];
                next;
            }
            next if $end || !@box || ($of{width} // "") eq "100%";
            my @at = map { [split /,/] } split / /, $of{points} // "";
            my $line = $kind eq "polyline" ? 1.25 : 0.75;
            @at = ([$of{cx}, $of{cy}]), $line = $of{r} if $kind eq "circle";
            @at = ([$of{x}, $of{y}], [$of{x} + $of{width}, $of{y} + $of{height}]) if $kind eq "rect";
            @at = ([$of{x}, $of{y} - 11], [$of{x} + 8 * length $text, $of{y} + 4]), $line = 0 if $kind eq "text";
            for (@at) {
                bad("$kind at $_->[0],$_->[1]") if $_->[0] < $line || $_->[1] < $line ||
                    $_->[0] > $box[-1][0] - $line || $_->[1] > $box[-1][1] - $line;
            }
            $seen++;
        }
        sub bad { print "$ARGV: cut off: $_[0]\n"; $bad = 1 }
        END { exit($bad || $seen < '"$2"') }' "$1" || bad "$1: something is cut off"
}

# Shapes lie in the cube; a box has at most six sides; the place is the exact hit; pictures are those of the page.
shapes() {
    sed -n 's/<.*//; s/.*"corners"://p' "$dir/page.html" | tr -d '[]}' | tr ',' '\n' |
        awk 'NF && ($1 > 1.00001 || $1 < -1.00001) { bad = 1 } END { exit bad || NR < 9 }' || bad "$1: a corner outside of the cube"
    [ "$(grep -c '"role":"hit","corners":\[\[-\{0,1\}0,-\{0,1\}0,-\{0,1\}0\]\]' "$dir/page.html")" -ge 1 ] ||
        bad "$1: the place is not the exact hit"
    sed -n '/<title>the node</,$p' "$dir/page.html" >"$dir/two" # the views that the picture has, too
    [ "$(grep -c '"role":"bytes"' "$dir/two")" -le 12 ] || bad "$1: a box of more than six sides"
    for role in expected exact bytes ray hit; do
        [ "$(grep -c "\"role\":\"$role\"" "$dir/page.html")" -eq "$(grep -cE "^<(polygon|polyline|circle) class=\"$role\"" "$dir/page.html")" ] ||
            bad "$1: shapes of $role in the picture and for the script"
        [ "$(grep -cE "^<(polygon|polyline|circle) class=\"$role\"" "$dir/two")" -eq "$(grep -cE "^<(polygon|polyline|circle) class=\"$role\"" "$dir/page.svg")" ] ||
            bad "$1: shapes of $role in both files"
    done
    grep -oE '(src|href|url|@import)[=( ][^> ]*|https?://[a-z./0-9]*' "$dir/page.html" "$dir/page.svg" | grep -v 'http://www.w3.org/2000/svg$' &&
        bad "$1: something is fetched"
    uncut "$dir/page.svg" 9
    uncut "$dir/page.html" 9
    grep -q "<script" "$dir/page.svg" && bad "$1: a script in a picture"
}

# The boxes on the way: those of every node above the last, side by side as the JSON has them, and the node within.
way() {
    last=$(sed -n 's/^last=//p' "$dir/flat")
    [ "$last" -gt 0 ] || { bad "$1: there is no way"; return; }
    sed '/<title>the node</,$d' "$dir/page.html" | tee "$dir/first" | sed -n 's/.*"role":"\([a-z]*\)","corners":/\1 /p' | tr -d '[]}' >"$dir/sides"
    for role in way bytes ray; do
        [ "$(grep -c "^$role " "$dir/sides")" -eq "$(grep -cE "^<(polygon|polyline|circle) class=\"$role\"" "$dir/first")" ] ||
            bad "$1: shapes of $role on the way in the picture and for the script"
    done
    [ "$(grep -c '^way ' "$dir/sides")" -eq "$((6 * last))" ] || bad "$1: $(grep -c '^way ' "$dir/sides") sides of $last boxes"
    # The lengths of all boxes, and where they lie, by the scale of the root's longest edge.
    awk -v last="$last" '
        FNR == NR { at = index($0, "="); v[substr($0, 1, at - 1)] = substr($0, at + 1); next }
        $1 == "way" {
            split($2, corner, ",")
            step = int(sides / 6); side = sides % 6; axis = int(side / 2)
            c[step, axis, side % 2] = corner[1 + axis]
            b[step, axis, side % 2] = v["way." step (side % 2 ? ".hi." : ".lo.") axis ".decoded.value"]
            sides++
        }
        END {
            for (k = 0; k < 3; k++) if (b[0, k, 1] - b[0, k, 0] > long) { long = b[0, k, 1] - b[0, k, 0]; cube = c[0, k, 1] - c[0, k, 0] }
            for (i = 0; i < last; i++) for (k = 0; k < 3; k++) for (h = 0; h < 2; h++) {
                far = (c[i, k, h] - c[0, k, 0]) - (b[i, k, h] - b[0, k, 0]) * cube / long
                if (far > 3e-5 || far < -3e-5) { print "node " i ", axis " k ": off by " far; bad = 1 }
                checked++
            }
            exit bad || checked < 6 || cube < 1.59 || cube > 1.61 # the root takes four fifths of the cube
        }' "$dir/flat" "$dir/sides" || bad "$1: boxes on the way"
}

# The ray, the way to the triangle and the repairs are those of the JSON; what is at fault is marked, and nothing else.
facts() {
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    sed -n '/<h2>The ray</,/<h2>Again</p' "$dir/page.html" | tr -d '\n' | sed 's/<\(tr\|p\|h2\)\([ >]\)/\n<\1\2/g' |
        sed 's/&gt;/>/g; s/&lt;/</g; s/&amp;/\&/g' >"$dir/page.lines"
    awk '
        function g(path) { return sprintf("%.9g", v[path ".value"]) }
        function three(path) { return "(" g(path ".0") ", " g(path ".1") ", " g(path ".2") ")" }
        function cell(text) { return "<td>" text "</td>" }
        function number(text) { return "<td class=\"n\">" text "</td>" }
        function row(fault, text) { return "<tr" (fault ? " class=\"fault\"" : "") ">" text "</tr>" }
        function want(text) { wanted[++lines] = text }
        # The note of a box test is what its two words say, where it was tested.
        function note(p) { return v[p ".tested"] != "true" ? "" : v[p ".entered"] == "true" ? "entered" : "TURNED AWAY" }
        function hit(p, of) { return v[p ".prim"] == "null" ? "a miss" : "triangle " v[p ".prim"] " at t = " g(p ".t") of }
        FNR == NR { at = index($0, "="); v[substr($0, 1, at - 1)] = substr($0, at + 1); next }
        FNR == 1 {
            want("<p>from " three("origin") " along " three("direction") ", t from " g("tmin") " to " g("tmax") "</p>")
            if (v["way.count"] > 0)
                for (i = 0; i <= v["last"] + 0; i++) {
                    p = "way." i
                    want(row(i == v["last"], number(v[p ".node"]) number(v[p ".record"] == "null" ? "-" : v[p ".record"]) \
                        cell(v[p ".leaf"] == "true" ? "leaf" : "inner") cell(note(p))))
                }
            for (i = 0; i < v["tried.count"] + 0 && v["inside"] == "true"; i++) {
                p = "tried." i
                if (v[p ".changed"] != "true") continue
                want(row(v[p ".allowed"] == "true", cell(v[p ".repair"]) \
                    cell(v[p ".finished"] == "true" ? hit(p ".answer", "") : "not finished") cell("")))
            }
        }
        /^<p>from / || /^<tr[ >]/ {
            if (/<th/) next
            text = $0
            sub(/<\/tbody>.*/, "", text)
            is = wanted[++line]
            # The last cell of a repair, and what else a box test says, are held against the text elsewhere.
            if (is ~ /<td><\/td><\/tr>$/) { sub(/<td>[^<]*<\/td><\/tr>$/, "<td></td></tr>", text) }
            if (text != is) { print "page has " text ", not " is; bad = 1 }
        }
        END { if (line != lines) { print line + 0 " lines, not " lines; bad = 1 } exit bad }' "$dir/flat" "$dir/page.lines" || bad "facts of $1"
}

page 1 sphere:n=8 --layout rtrs_rf_paper --tri woop --rays edges --count 20000 --cause rounded_inward
facts sphere
bits sphere
shapes sphere
way sphere
cmp -s "$dir/page.svg" docs/screens/finding.svg || bad 'docs/screens/finding.svg is another picture: explain ... --svg docs/screens/finding.svg'
grep -q 'Cause: rounded_inward, ' "$dir/page.html" || bad 'no cause'
page 1 fuzz/corpus/rounded-inward.trial
facts rounded-inward
bits rounded-inward
shapes rounded-inward
grep -q '<title>the way</title>' "$dir/page.html" && bad 'a root alone has a way'
page 1 fuzz/corpus/strict-comparison.trial # its cause has "<" in its text
grep -q '<title>the box test has &lt; where' "$dir/page.svg" || bad 'a text is not escaped'
# All causes of the corpus, and answers that are right.
for file in fuzz/corpus/*.trial; do
    rm -f "$dir/x.svg"
    [ "$(head -n 1 "$file")" = 'raydiff trial 1' ] || continue # of a world, which explain refuses
    "$raydiff" explain "$file" --html "$dir/x.html" --svg "$dir/x.svg" --json "$dir/json" >"$dir/out" 2>"$dir/err"
    [ $? -le 1 ] || bad "$file: $(cat "$dir/err")"
    [ ! -e "$dir/x.html" ] || { mv "$dir/x.html" "$dir/page.html"; facts "$file"; }
    [ ! -e "$dir/x.svg" ] || uncut "$dir/x.svg" 3
    grep -qiE '[^a-z](nan|inf)[^a-z]' "$dir/x.svg" 2>/dev/null && bad "$file: a corner that is no number"
done
# Triangles that are not drawn are counted.
page 1 sphere:n=20 --layout rtrs_rf_paper --tri woop --rays edges --count 20000 --cause rounded_inward
drawn=$(sed '/<title>the node</,$d' "$dir/page.html" | grep -cE '"role":"(other|expected|answered)"')
left=$(sed -n 's/.*the way: .*; \([0-9]*\) other triangles are left out.*/\1/p' "$dir/page.html")
[ "$((drawn + ${left:-0}))" -eq 3200 ] && [ "$drawn" -ge 1001 ] || bad "$drawn triangles drawn, ${left:-none} left out, of 3200"
page 0 sphere:n=8 --engine cpu --rays vertices --count 10 --index 4
grep -q '<p>right</p>' "$dir/page.html" || bad 'an answer that is right has no page'
# An answer is drawn whatever its size, also if it is one point, through which the ray goes.
sed 's/struct hit best = {0, 0, 0, 0xFFFFFFFFu}, h;/struct hit best = {1, 0, 0, 0}, h;/; s/t < q.triangles; t++/t < 0; t++/' \
    fuzz/samples/sample_tracer.c >"$dir/liar.c"
cc -O1 -w -o "$dir/liar" "$dir/liar.c" || bad 'a tracer that answers triangle 0'
for size in 0 0.001 1 1e6; do
    awk -v s=$size 'BEGIN { print "v " s " 0 1\nv 0 " s " 1\nv 0 0 1\nv " 5 * s " 5 5\nv 5 6 5\nv 6 5 5\nf 1 2 3\nf 4 5 6" }' >"$dir/point.obj"
    page 1 "$dir/point.obj" --engine "pipe:$dir/liar" --ray "-$size,-$size,0 0,0,1"
    for role in answered ray; do
        grep -qE "^<(polygon|polyline) class=\"$role\"" "$dir/page.svg" || bad "an answer of size $size: no $role is drawn"
    done
    grep -qiE '[^a-z](nan|inf)[^a-z]' "$dir/page.svg" && bad "size $size: a corner that is no number"
done
# Nothing to draw.
"$raydiff" explain sphere:n=8 --ray 'nan,0,0 1,0,0' --svg "$dir/none.svg" >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] && grep -q 'none.svg: there is nothing to draw' "$dir/err" && [ ! -e "$dir/none.svg" ] || bad 'a picture of nothing'
"$raydiff" explain sphere:n=8 --layout f32 --rays primary --count 10 --html "$dir/none.html" >"$dir/out"
[ $? -eq 0 ] && grep -q 'none.html is not written: there is nothing to draw' "$dir/out" && [ ! -e "$dir/none.html" ] ||
    bad 'a page of nothing'
echo "explain_html: $failed failed"
[ "$failed" -eq 0 ]
