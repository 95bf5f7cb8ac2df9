#!/bin/sh
# raydiff web, without a browser: what it refuses, that a folder appears whole or not at all, that pages fetch nothing,
# every number on them against the findings' files (tests/web/numbers.pl), and the report's links to them.
#   sh tests/web/web.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
web=$dir/web
mkdir "$web"

# Nothing is left beside what was asked for.
only() { # what, names
    what=$1
    shift
    [ "$(ls -A "$web" | tr '\n' ' ')" = "$(printf '%s ' "$@" | sed 's/^ $//')" ] || bad "$what: $(ls -A "$web" | tr '\n' ' ')"
}

# --- what is refused leaves nothing -----------------------------------------------------------------------------------
world=fuzz/corpus/inactive-instance.trial trial=fuzz/corpus/rounded-inward.trial
expect 2 '^raydiff web: --out DIR is needed ' web $trial
expect 2 '^raydiff web: no finding or scene given ' web --out "$web/pages"
expect 77 . web $world --out "$web/pages"
expect 77 . web $trial $world --out "$web/pages"
expect 2 . web $trial "$dir/none.trial" --out "$web/pages"
expect 2 'cannot be made' web $trial --out "$web/none/pages"
expect 2 "cannot be a folder's name" web $trial --out ''
expect 2 "cannot be a folder's name" web $trial --out /
expect 2 'brings its own' web $trial --tri woop --out "$web/pages"
expect 2 'is no ray here' web $trial --index 99 --out "$web/pages"
only 'what was refused'
: >"$web/pages"
expect 2 'exists and is no folder' web $trial --out "$web/pages" --force
rm "$web/pages"
mkdir "$web/pages" && echo mine >"$web/pages/mine"
expect 2 'exists; --force replaces it' web $trial --out "$web/pages"
expect 2 'holds mine, which is no page' web $trial --out "$web/pages" --force
[ "$(cat "$web/pages/mine")" = mine ] || bad 'a file that is no page is gone'
only 'a folder of others' pages
rm -r "$web/pages"

# --- pages ------------------------------------------------------------------------------------------------------------
scenes= worlds=0
for file in fuzz/corpus/*.trial; do
    if grep -q '^raydiff trial 1' "$file"; then scenes="$scenes $file"; else worlds=$((worlds + 1)); fi
done
expect 0 . web $scenes --out "$web/pages"
only 'pages' pages
[ "$(ls "$web/pages" | grep -c 'html$')" -eq "$(($(echo $scenes | wc -w) + 1))" ] || bad "$(ls "$web/pages" | wc -l) files of $(echo $scenes | wc -w) findings"
[ "$(ls "$web/pages" | grep -vc 'html$')" -eq 0 ] || bad 'something else than pages is written'
[ "$worlds" -gt 0 ] || bad 'no world in the corpus'
for file in $scenes; do
    page=$(grep -lF " id=\"subject\">$file" "$web"/pages/*.html)
    [ "$(echo "$page" | wc -w)" -eq 1 ] || { bad "$file: no page, or several"; continue; }
    perl tests/web/numbers.pl "$page" "$file" >"$dir/out" 2>&1 || bad "$file: numbers"
    cat "$dir/out" >>"$dir/looser"
    grep -qF "href=\"$(basename "$page")\"" "$web/pages/index.html" || bad "$page is not in the list"
done
[ "$(grep -c '^looser ' "$dir/looser")" -le 2 ] || { cp "$dir/looser" "$dir/out"; bad 'WRONG answers are right by the lists'; }
# Nothing is fetched; a name in a page is its own.
grep -oE '(src|url|@import)[=(][^> ]*|https?://[a-z./0-9]*|fetch\(|XMLHttpRequest|import\(' "$web"/pages/*.html && bad 'something is fetched'
for page in "$web"/pages/*.html; do
    grep -q "content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'\"" "$page" || bad "$page: no policy"
done
# The text that traces is what Node's process has, too.
sed -n '/\/\/<!\[CDATA\[$/,/^\/\/ The view of a page/p' "$web/pages/$(sed -n 's/^expect //p' $trial).html" | sed '1d;$d' |
    cmp -s - gpu/webgpu/core.js || bad 'the page has another core.js'

# The same again gives the same bytes; --force replaces.
cp -r "$web/pages" "$dir/before"
expect 2 . web $scenes --out "$web/pages"
expect 0 . web $trial --out "$web/pages" --force
[ "$(ls "$web/pages" | wc -l)" -eq 2 ] || bad '--force leaves pages of before'
expect 0 . web $scenes --out "$web/pages" --force
diff -r "$dir/before" "$web/pages" >"$dir/out" || bad 'pages are not the same again'
# A folder of a name like those that are made beside is the user's.
mkdir "$web/new.backup" && : >"$web/new.backup/mine.html"
expect 0 . web $trial --out "$web/new/" --force
only 'after --force' new new.backup pages
[ -e "$web/new.backup/mine.html" ] || bad "a folder of the user's is swept"
[ "$(stat -c %a "$web/new")" = "$(umask 022; mkdir "$dir/mode"; stat -c %a "$dir/mode")" ] || bad 'the folder has other rights than a new one'

# Scenes, an answer that is right, one name for two pages, Embree's.
expect 0 . web sphere:n=4 sphere:n=4 cornell --layout f32 --out "$web/scenes"
[ "$(ls "$web/scenes" | tr '\n' ' ')" = 'cornell.html index.html sphere-n-4-2.html sphere-n-4.html ' ] || bad "names: $(ls "$web/scenes")"
grep -q '<p>right</p>' "$web/scenes/sphere-n-4.html" || bad 'an answer that is right has no page'
perl tests/web/numbers.pl "$web/scenes/sphere-n-4.html" >"$dir/out" 2>&1 || bad 'numbers of a scene'
# The ray that is shown is among the 256 of a page, wherever it stands in its set.
for index in 255 256 300; do
    expect 0 . web sphere:n=4 --index $index --layout rf16 --out "$web/later$index"
    perl tests/web/numbers.pl "$web/later$index/sphere-n-4.html" >"$dir/out" 2>&1 || bad "numbers of ray $index"
    grep -q "^\"first\":$((index - 255)),\$" "$web/later$index/sphere-n-4.html" || bad "ray $index is not the last of its page"
done
expect 0 . web 'sphere:n=4' --ray '0,0,-9 0,0,1' --out "$web/ray"
expect 0 . web sphere:n=8 --layout rtrs_rf --rays edges --out "$web/published"
grep -q 'class="bad">WRONG' "$web"/published/sphere-n-8.html || bad 'a layout as published loses nothing'

"$raydiff" web tests/web/embree.trial tests/web/embree_robust.trial --out "$web/embree" >"$dir/out" 2>"$dir/err"
case $? in
0)
    for name in embree embree_robust; do
        perl tests/web/numbers.pl "$web/embree/$(sed -n 's/^expect //p' tests/web/$name.trial).html" tests/web/$name.trial \
            >"$dir/out" 2>&1 || bad "$name: numbers"
    done ;;
77) cat "$dir/err" ;; # built without it
*) bad 'no page of a finding of Embree' ;;
esac
expect 0 . web tests/web/published.trial --out "$web/index-shifted"
perl tests/web/numbers.pl "$web"/index-shifted/cpu*.html tests/web/published.trial >"$dir/out" 2>&1 || bad 'numbers of published'

# --- folders of findings, and the report ------------------------------------------------------------------------------
"$raydiff" fuzz --trials 60 --engine cpu --layout rtrs_rf --faithful --dir "$dir/found" --jobs 1 --until 1 --no-shrink \
    --corpus none >"$dir/out" 2>&1
expect 0 . web "$dir/found" --out "$dir/found-pages"
for finding in "$dir"/found/*/; do
    name=$(basename "$finding" | tr '=' '-')
    file=$finding/smallest.trial
    [ -e "$file" ] || file=$finding/first.trial
    if grep -q '^raydiff trial 1' "$file" && [ -e "$dir/found-pages/$name.html" ]; then
        perl tests/web/numbers.pl "$dir/found-pages/$name.html" "$file" >"$dir/out" 2>&1 || bad "$name: numbers"
    else
        grep -q "no page: " "$dir/found-pages/index.html" || bad "$name: neither a page nor a reason"
    fi
done
pages=$(ls "$dir/found-pages" | grep -vc '^index.html$')
[ "$pages" -ge 1 ] || bad 'no page of a folder of findings'
# The pages that are told are those that are there, none, one or two, beside findings that have none.
for trials in 1 4 16; do
    "$raydiff" fuzz --trials $trials --rays 30 --engine cpu --layout rtrs_rf --faithful --dir "$dir/few$trials" --jobs 1 --no-shrink \
        --corpus none >"$dir/out" 2>&1
    expect 0 . web "$dir/few$trials" --out "$dir/pages$trials"
    pages=$(ls "$dir/pages$trials" | grep -vc '^index.html$')
    grep -qx "$dir/pages$trials: $pages page$([ "$pages" -eq 1 ] || echo s) and index.html" "$dir/out" || bad "$pages pages are told as others"
    grep -q '^  no page of ' "$dir/out" && echo "$pages" >>"$dir/counts"
done
[ "$(tr '\n' ' ' <"$dir/counts")" = '0 1 2 ' ] || bad 'folders of none, one and two pages'
export VK_DRIVER_FILES=/dev/null VK_ICD_FILENAMES=/dev/null # which each finding would start
cp -r "$dir/found-pages" "$dir/found \\a#%\"&?" # names of folders as addresses have them
"$raydiff" report --findings "$dir/found" --web "found \\a#%\"&?" --out "$dir/report.html" --parts check >"$dir/out" 2>&1
grep -o '<a class="page" href="[^"]*"' "$dir/report.html" | sed 's/.*href="//; s/"$//' | sort >"$dir/links"
ls "$dir/found-pages" | grep -v '^index.html$' | sed 's|^|found%20%5Ca%23%25%22%26%3F/|' | sort | cmp -s - "$dir/links" || bad "the report links to $(tr '\n' ' ' <"$dir/links")"
"$raydiff" report --findings "$dir/found" --web nowhere --out "$dir/report.html" --parts check >"$dir/out" 2>&1
grep -q '<a class="page"' "$dir/report.html" && bad 'the report links to a page that is not there'
expect 2 -- report sphere:n=4 --web found-pages --out "$dir/x.html"
echo "web: $failed failed"
[ "$failed" -eq 0 ]
