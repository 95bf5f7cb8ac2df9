#!/bin/sh
# Pages of raydiff web in headless Chromium, by SwiftShader's WebGPU: a finding of Embree, one of a layout as published,
# one of a rounded box and a right answer. What the browser's graphics card answers is, to the bit, what Node's Dawn
# answers to the same ray; what the page says of it is what raydiff explain says; the view is in the screenshot; keys
# turn it; the browser asks for nothing else, and its console stays empty. And a browser without WebGPU.
#   sh tests/web/browser.sh BUILD/raydiff [FOLDER]      FOLDER: where the screenshots are kept
# Exit 77 without Chromium, Node, Dawn or SwiftShader.
set -u
raydiff=$1
keep=${2-}
. tests/scripts/expect.sh
export RAYDIFF_WEBGPU="${RAYDIFF_WEBGPU:-$(pwd)/build/webgpu}" RAYDIFF_DRIVERS="${RAYDIFF_DRIVERS:-$(pwd)/build/drivers}"

# --- findings ---------------------------------------------------------------------------------------------------------
pages=$dir/pages
embree=tests/web/embree.trial
embree_robust=tests/web/embree_robust.trial
published=tests/web/published.trial
rounded=fuzz/corpus/rounded-inward.trial
expect 0 . web $published $rounded --out "$pages"
expect 0 . web cornell --layout f32 --out "$dir/right"
expect 0 . web sphere:n=8 --rays random --layout rtrs_rf --out "$dir/deep"
"$raydiff" web $embree $embree_robust --out "$dir/embree" >"$dir/out" 2>"$dir/err"
case $? in
0) mv "$dir"/embree/embree*.html "$pages" ;;
77) embree= && cat "$dir/err" ;; # built without it
*) bad 'no page of a finding of Embree' ;;
esac
[ -s "$dir/right/cornell.html" ] || bad 'no pages'
[ "$failed" -eq 0 ] || exit 1
missing=$("$raydiff" check soup:n=9 --count 9 --engine webgpu --layout f32 --driver swiftshader 2>&1 |
    sed -n 's/^skipped f32  *webgpu *//p')
[ -z "$missing" ] || { echo "SKIP web_browser: $missing"; exit 77; }
command -v node >/dev/null || { echo "SKIP web_browser: no node"; exit 77; }
command -v chromium >/dev/null || { echo "SKIP web_browser: no chromium (make report-check)"; exit 77; }

browse() { # page, name, more
    timeout 120 node tests/web/browse.js "$1" "$dir/$2.png" "$dir/profile" ${3-} >"$dir/$2.json" 2>"$dir/err"
    code=$?
    cp "$dir/$2.json" "$dir/out"
    cp "$1" "$dir/$2.html"
    rm -rf "$dir/profile" 2>/dev/null
    [ "$code" -eq 0 ] || bad "$2: the browser ended with $code"
    [ -z "$keep" ] || { mkdir -p "$keep" && cp "$dir/$2.png" "$keep/$2.png"; }
}

# Compares what the browser says with raydiff explain by engine webgpu, and the view with what should be seen.
held() { # name, file or scene, state, layouts
    name=$1 subject=$2 state=$3
    shift 3
    for layout; do
        index=$(awk -F'[:,]' '/^"(first|shown)":/ {sum += $2} END {print sum}' "$dir/$name.html")
        for engine in 'webgpu --driver swiftshader' cpu; do
            "$raydiff" explain $subject --index $index --engine $engine --layout $layout --json "$dir/told.json" >"$dir/out" 2>&1 ||
                [ $? -eq 1 ] || bad "$name: no answer of $engine on $layout"
            [ "$engine" = cpu ] && mv "$dir/told.json" "$dir/c.$layout.json" || mv "$dir/told.json" "$dir/node.$layout.json"
        done
    done
    perl tests/web/held.pl "$dir/$name.json" "$state" "$dir" "$@" >"$dir/out" 2>&1 || bad "$name"
}

[ -z "$embree" ] || for name in embree embree_robust; do
    browse "$pages/$(sed -n 's/^expect //p' tests/web/$name.trial).html" $name
    held $name tests/web/$name.trial right f32
done
browse "$pages/$(sed -n 's/^expect //p' $published).html" published
held published $published shows rtrs_rf f32
browse "$pages/$(sed -n 's/^expect //p' $rounded).html" rounded
held rounded $rounded shows rtrs_rf_paper f32
browse "$dir/right/cornell.html" right
held right "cornell --count 20000" right f32
browse "$dir/deep/sphere-n-8.html" deep
held deep "sphere:n=8 --rays random --count 20000" shows rtrs_rf f32
# A card that says of each ray that it was not finished, whatever it hits: no answer is right.
sed 's/const bytes = await runner.run(rays, count);/&for (let i = 0; i < count; i++) new Uint32Array(bytes.buffer, bytes.byteOffset)[ANSWER * i + HIT] |= 2;/' \
    "$dir/right/cornell.html" >"$dir/right/unfinished.html"
browse "$dir/right/unfinished.html" unfinished
grep -q '"flag": *"3"' "$dir/unfinished.json" || bad 'unfinished: the planted flag is not there'
grep -qE '"state": *"shows"' "$dir/unfinished.json" || bad 'unfinished: is taken for finished'
grep -qE '"verdict": *"right"' "$dir/unfinished.json" && bad 'unfinished: an answer is right'
grep -qE '"boxes": "([2-9]|1[0-9])' "$dir/deep.json" || bad 'no boxes on the way'

# --- without WebGPU the numbers and the view are there, and the page says why nothing is traced -----------------------
browse "$pages/$(sed -n 's/^expect //p' $rounded).html" none none
perl tests/web/held.pl "$dir/none.json" none "$dir" >"$dir/out" 2>&1 || bad 'without WebGPU'
cmp -s "$dir/none.png" "$dir/rounded.png" || echo 'note: the view is drawn otherwise without WebGPU'
echo "web_browser: $failed failed"
[ "$failed" -eq 0 ]
