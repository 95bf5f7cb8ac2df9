#!/bin/sh
# raydiff report as a user meets it, without a browser: one well-formed file that asks for nothing,
# whatever the names in it; parts that fail stand in it; nothing is left behind.
#   sh tests/scripts/report.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh
mkdir "$dir/tmp"
export TMPDIR="$dir/tmp"
few="--count 200 --rounds 1 --quick --engine cpu --layout f32,rf16"

# Nothing from outside: no source, link or style but data:, fragments and the names of namespaces.
asks_for_nothing() {
    sed 's/xmlns="http:\/\/www.w3.org\/2000\/svg"//g' "$1" >"$dir/page"
    ! grep -qiE '<(script|link|iframe|object|embed|base)|[a-z]+://|@import|url\(' "$dir/page" &&
        ! grep -oiE '(src|href|poster|data|srcset)="[^"]*"' "$dir/page" |
            grep -qvE '^(src="data:image/png;base64,|href="#)'
}
# Each link leads to an element of the page, and no two elements have the same name.
links_lead() {
    grep -oE ' (id|href)="#?[^"]*"' "$1" | grep -vE 'href="[^#]' | sed 's/^ //; s/"//g' |
        awk -F= '$1 == "id" { if (name[$2]++) bad = 1 } $1 == "href" { sub(/^#/, "", $2); to[$2] = 1; links++ }
            END { for (id in to) if (!(id in name)) bad = 1; exit bad || links < 7 }'
}
sound() { # file
    if command -v xmllint >/dev/null; then
        xmllint --noout "$1" 2>"$dir/err" || bad "$1 is not well-formed"
    fi
    asks_for_nothing "$1" || bad "$1 asks for something outside of it"
    links_lead "$1" || bad "$1 has a link that leads nowhere, or a name twice"
    [ "$(wc -c <"$1")" -lt 3000000 ] || bad "$1 is too large"
    [ -z "$(ls -A "$dir/tmp")" ] || bad "a temporary folder is left: $(ls "$dir/tmp")"
}
# The check itself can fail.
for planted in '<script>1</script>' '<img src="x.png"/>' '<a href="other.html">x</a>' \
    '<p style="background:url(x)">' 'see http://example.org' '<img src="//example.org/x"/>'; do
    echo "<html>$planted</html>" >"$dir/planted.html"
    asks_for_nothing "$dir/planted.html" && bad "asks_for_nothing lets through: $planted"
done

for planted in 's/ id="speed"//' 's/ id="speed"/ id="machine"/' 's/href="#speed"/href="#seed"/'; do
    sed "$planted" >"$dir/planted.html" <<'END'
<nav> <a href="#summary"> <a href="#agreement"> <a href="#speed"> <a href="#pictures"> <a href="#findings">
<a href="#machine"> <a href="#commands"> </nav> <h2 id="summary"/> <h2 id="agreement"/> <h2 id="speed"/>
<h2 id="pictures"/> <h2 id="findings"/> <h2 id="machine"/> <h2 id="commands"/>
END
    links_lead "$dir/planted.html" && bad "links_lead lets through: $planted"
done

# Every part, on a scene, a finding and a picture whose names are markup.
hostile='<script>alert(1)</script>&"'"'"'.obj'
mkdir "$dir/<b>"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >"$dir/<b>/x.obj"
cp "$dir/<b>/x.obj" "$dir/$(echo "$hostile" | tr -d /)"
scene="$dir/$(echo "$hostile" | tr -d /)"
expect 0 . report "$scene" "$dir/<b>/x.obj" $few --title '<i>&amp;' --out "$dir/a.html" --json "$dir/a.json"
sound "$dir/a.html"
grep -q '&lt;i&gt;&amp;amp;' "$dir/a.html" || bad "the title is escaped"
grep -q '&lt;script&gt;alert(1)&lt;script&gt;' "$dir/a.html" || bad "a scene's name is escaped"
for name in '"figures": [1-9]' '"answers": [1-9]' '"name": "bench error"' '"name": "doctor"'; do
    grep -q "$name" "$dir/a.json" || bad "report --json has no $name"
done
figures=$(sed -n 's/.*"figures": \([0-9]*\).*/\1/p' "$dir/a.json")
[ "$(grep -c '<figure>' "$dir/a.html")" -eq "$figures" ] || bad "the figures are as many as it says"

# From results that are there: the same page for the same results.
"$raydiff" check sphere:n=3 --engine cpu --layout rtrs_rf,f32 --count 300 --repeat 1 --json "$dir/c.json" >/dev/null
"$raydiff" bench builders --scene sphere:n=4 --rounds 1 --json "$dir/b.json" >/dev/null
"$raydiff" doctor --json "$dir/d.json" >/dev/null
export SOURCE_DATE_EPOCH=1700000000
for name in 1 2; do
    expect 0 . report --check "$dir/c.json" --bench "$dir/b.json" --doctor "$dir/d.json" --out "$dir/same.html"
    mv "$dir/same.html" "$dir/$name.html"
done
sound "$dir/1.html"
cmp -s "$dir/1.html" "$dir/2.html" || bad "the same results give the same page"
grep -q '2023-11-14 22:13 UTC' "$dir/1.html" || bad "SOURCE_DATE_EPOCH is its date"
grep -q 'td class="pub"' "$dir/1.html" || bad "what is wrong as published is marked"
grep -q 'nodes_per_tri\|ns_per_tri\|<summary>all [0-9]* rows of builders' "$dir/1.html" || bad "other benchmarks are tables"

# A row that is wrong stands out, with its explain line.
sed 's/"differences": 0/"differences": 3/;s/"wrong": 0,/"wrong": 3,/;s/"wrong": 0$/"wrong": 3/' "$dir/c.json" >"$dir/w.json"
expect 0 . report --check "$dir/w.json" --out "$dir/w.html" --parts check
grep -q 'td class="bad".*WRONG' "$dir/w.html" || bad "a row that is wrong stands out"

# Findings: played again, explained, with the line that does it. From the second report on no Vulkan is started for each.
"$raydiff" fuzz --trials 100 --engine cpu --layout rtrs_rf --faithful --dir "$dir/found" --jobs 1 --until 2 \
    --no-shrink --corpus none >/dev/null 2>&1
expect 1 . report --findings "$dir/found" --out "$dir/f.html" --json "$dir/f.json" --parts machine
sound "$dir/f.html"
grep -q '<pre class="line">raydiff replay .*first.trial\|<pre class="line">raydiff replay .*smallest.trial' "$dir/f.html" ||
    bad "a finding has its replay line"
grep -q '<summary>explanation</summary>' "$dir/f.html" || bad "a finding is explained"
# A finding about a ray has the picture that explain draws of it, as many as the page has figures; all are listed.
drawings=0
for name in $(sed -n 's/.*"name": "\(cpu\.[^"]*\)".*/\1/p' "$dir/f.json"); do
    trial=$dir/found/$name/smallest.trial
    [ -e "$trial" ] || trial=$dir/found/$name/first.trial
    rm -f "$dir/f.svg"
    "$raydiff" explain "$trial" --svg "$dir/f.svg" >"$dir/out" 2>"$dir/err"
    if [ -e "$dir/f.svg" ]; then
        drawings=$((drawings + 1))
        [ "$(grep -cF "$(sed -n '/<polyline class="ray"/{p;q;}' "$dir/f.svg")" "$dir/f.html")" -ge 1 ] ||
            bad "$name has no picture of its ray"
    fi
    grep -qE "<li><a href=\"#finding-[0-9]+\">$name</a>" "$dir/f.html" || bad "$name is not in the contents"
done
[ "$drawings" -ge 1 ] || bad "no finding has a picture"
[ "$(grep -c '<svg [^>]*class="explained"' "$dir/f.html")" -eq "$drawings" ] || bad "$drawings findings have a picture"
grep -q "\"figures\": $drawings[,}]*\$" "$dir/f.json" || bad "--json counts the findings' pictures"
# Folders are given as often as files are.
of_one=$(sed -n 's/.*"findings": \([0-9]*\).*/\1/p' "$dir/f.json")
export VK_DRIVER_FILES=/dev/null VK_ICD_FILENAMES=/dev/null
expect 1 . report --findings "$dir/found" --findings "$dir/found" --out "$dir/f2.html" --json "$dir/f2.json" --parts machine --threads 1
# What is passed on stands in each line that does it again.
lines=$(grep -o '<pre class="line">raydiff replay [^<]*' "$dir/f2.html")
[ "$(echo "$lines" | grep -c -- ' --threads 1')" -eq $((2 * of_one)) ] || bad "lines of findings without --threads: $(echo "$lines" | head -n 1)"
grep -q "\"findings\": $((2 * of_one))[,}]*\$" "$dir/f2.json" || bad "--findings given twice: not the findings of both"
sound "$dir/f2.html"

# Pictures: what cannot draw has its own reason, not the note before it; captions have the numbers of diff.
expect 77 . report needles:n=2000 --quick --parts pictures --engine cpu,embree,vulkan --layout f32 --out "$dir/p.html" --json "$dir/p.json"
sound "$dir/p.html"
"$raydiff" render needles:n=2000 --engine vulkan -w 8 -h 8 --out "$dir/none.png" 2>"$dir/err"
[ "$(wc -l <"$dir/err")" -eq 2 ] || bad "a scene without light: no note before the reason"
grep -qF "\"why\": \"vulkan: $(tail -n 1 "$dir/err")\"" "$dir/p.json" || bad "an engine that cannot draw: not its reason"
"$raydiff" diff needles:n=2000 --engine cpu,embree -w 256 -h 192 --json "$dir/diff.json" >/dev/null 2>&1
of_diff() { sed -n "s/^ *\"$1\": \([0-9]*\),*\$/\1/p" "$dir/diff.json"; }
[ "$(of_diff values_different)" -gt 0 ] || bad "no two pixels differ"
caption="$(of_diff values_different) of $(of_diff paths) pixels differ, at most by $(of_diff largest) of 255; every difference is explained"
grep -qF "embree against cpu</b><br/>$caption<" "$dir/p.html" || bad "a caption of differences is not '$caption'"

# A part that cannot run, fails or takes too long is in the page and in the exit code.
expect 77 . report sphere:n=3 --count 200 --quick --engine rayquery --driver swiftshader --parts check --out "$dir/s.html"
grep -q 'something cannot run here' "$dir/s.html" || bad "a skipped part is in the page"
expect 2 . report soup:n=100000,size=0.001 --count 100 --quick --layout rf16 --engine cpu --parts check --out "$dir/l.html"
grep -q 'refused' "$dir/l.html" || bad "a layout that refuses is in the page"
expect 3 . report soup:n=2000 --count 1e7 --engine cpu --parts check --time 1 --out "$dir/t.html"
grep -q 'it took longer than 1 s' "$dir/t.html" || bad "a part that takes too long is in the page"
sound "$dir/t.html"

# Bad input: one line, nothing written.
rm -f "$dir/x.html"
expect 2 'out FILE.html is needed' report soup
expect 2 'No such file' report "$dir/none.obj" --out "$dir/x.html"
expect 2 "unknown name 'f33'" report soup --layout f33 --out "$dir/x.html"
expect 2 "unknown 'chekc'" report soup --parts chekc --out "$dir/x.html"
# A part alone takes what the commands that make it take, and nothing else.
while read -r part uses; do
    for option in '--box robust' '--query any' '--rounds 3' '--quick' '--layout f32' '--engine cpu' '--tri mt' '--rays random' '--seed 3' \
        '--count 9' '--threads 1' '--time 9' '--title T' '--driver none' '--device 0' '--workgroup 32' '--peer-time 9' '--peer-memory 9'; do
        rule="${option%% *}: not used by the parts of this report"
        case " $uses " in *" ${option%% *} "*) rule='none.obj: No such file' ;; esac
        expect 2 "$rule" report $(echo "$part" | sed "s|DIR|$dir|g; y/~/ /") $option --out "$dir/x.html"
    done
done <<'END'
DIR/none.obj~--parts~check --box --query --quick --layout --engine --tri --rays --seed --count --threads --time --title --driver --device --workgroup --peer-time --peer-memory
DIR/none.obj~--parts~bench --box --rounds --quick --layout --engine --tri --rays --seed --count --threads --time --title --driver --device --workgroup --peer-time --peer-memory
DIR/none.obj~--parts~pictures --box --quick --layout --engine --tri --seed --threads --time --title --driver --device --workgroup --peer-time --peer-memory
DIR/none.obj~--parts~machine --threads --time --title --driver --device --workgroup
--check~DIR/none.obj~--parts~machine --threads --time --title --driver --device --workgroup
--check~DIR/none.obj~--parts~machine~--doctor~DIR/d.json --time --title
--check~DIR/none.obj~--doctor~DIR/d.json --time --title
END
# All parts are all of them, whatever else is named; a list is no longer than it can be.
expect 2 'none.obj: No such file' report "$dir/none.obj" --parts machine,all --query any --rounds 3 --box robust --out "$dir/x.html"
while read -r most given rule; do
    for count in "$most" $((most + 1)); do
        expect 2 "$([ "$count" -eq "$most" ] && echo 'none[.a-z]*: No such file' || echo "^raydiff report: $rule ")" \
            report $(awk -v n="$count" -v given="$given" 'BEGIN { sub(/~/, " ", given); while (n--) print given }') --out "$dir/x.html"
    done
done <<'END'
16 --check~none.json --check: at most 16 files
16 --bench~none.json --bench: at most 16 files
16 --findings~none --findings: at most 16 folders
64 --picture~t=none.png --picture: at most 64 pictures
16 none.obj at most 16 scenes
END
for picture in x.png =x.png title= = ''; do expect 2 'is not TITLE=FILE' report --picture "$picture" --out "$dir/x.html"; done
expect 2 'is no JSON of raydiff check' report --check "$dir/d.json" --out "$dir/x.html"
expect 2 'is no JSON of raydiff doctor' report --doctor "$dir/c.json" --out "$dir/x.html"
expect 2 'No such file' report --bench "$dir/none.json" --out "$dir/x.html"
expect 2 'none' report --findings "$dir/none" --out "$dir/x.html"
echo 'not a picture' >"$dir/not.png"
expect 2 'not.png' report --picture "title=$dir/not.png" --out "$dir/x.html"
expect 2 "may not hold ';'" report 'a;b' --out "$dir/x.html"
expect 2 'is a directory' report --check "$dir/c.json" --out "$dir"
expect 2 "needs a file, not '-'" report soup --out -
[ ! -e "$dir/x.html" ] || bad "an error leaves no report"
[ -z "$(ls "$dir" | grep 'tmp$' | grep -v '^tmp$')" ] || bad "a temporary file is left"

# Ended by a signal: nothing half-written, nothing left, no child lives on.
"$raydiff" report soup:n=2000 --count 1e7 --engine cpu --parts check --out "$dir/x.html" >"$dir/out" 2>"$dir/err" &
pid=$!
sleep 1
children=$(pgrep -P $pid 2>/dev/null)
kill -TERM $pid
wait $pid
code=$?
[ "$code" -eq 143 ] || bad "ended by SIGTERM: exit $code"
[ ! -e "$dir/x.html" ] || bad "ended by SIGTERM: a report is written"
[ -z "$(ls -A "$dir/tmp")" ] || bad "ended by SIGTERM: a temporary folder is left"
for child in $children; do
    kill -0 "$child" 2>/dev/null && bad "ended by SIGTERM: a child lives on"
done
[ -n "$children" ] || command -v pgrep >/dev/null || echo "SKIP no pgrep: children were not looked for"

[ "$failed" -eq 0 ] && echo "report: well-formed, alone, and honest about its parts"
[ "$failed" -eq 0 ]
