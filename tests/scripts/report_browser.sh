#!/bin/sh
# A report in a real browser, headless Chromium: no console message, no request, every figure to be
# seen in a screenshot of the whole page. Broken reports that are planted must be caught.
#   sh tests/scripts/report_browser.sh RAYDIFF [quick|FOLDER]
# FOLDER: where report.html and its screenshot are kept. quick: one report and a planted one.
# Exit 77 without Chromium.
set -u
raydiff=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
mode=${2:-}
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
command -v chromium >/dev/null || { echo "SKIPPED report_browser: no chromium (make report-check)"; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
dir=$(mktemp -d "${TMPDIR:-/tmp}/raydiff-browser-XXXXXX") || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
width=1400

# Nothing leaves the machine, whatever a page asks for.
browse() {
    rm -rf "$dir/profile"
    timeout 120 chromium --headless=new --no-sandbox --disable-gpu --hide-scrollbars \
        --force-device-scale-factor=1 --no-first-run --disable-background-networking \
        --disable-component-update --disable-sync '--host-resolver-rules=MAP * ~NOTFOUND' \
        --user-data-dir="$dir/profile" --enable-logging=stderr --v=0 "$@"
}

# Looks at a report with so many figures; what is wrong goes to $dir/faults.
look() { # file, figures
    : >"$dir/faults"
    rm -f "$dir/shot.png" "$dir/page.html"
    cp "$1" "$dir/page.html"
    cp "$here/report_look.html" "$dir/look.html"
    [ "$(wc -c <"$1")" -lt 3000000 ] || echo "BAD 3 MB or more" >>"$dir/faults"
    at="file://$dir/look.html?page=page.html&width=$width"
    browse --allow-file-access-from-files --dump-dom "$at&measure" >"$dir/dom" 2>"$dir/log"
    height=$(sed -n 's/^.*height \([0-9][0-9]*\)$/\1/p' "$dir/dom" | head -n 1)
    [ -n "$height" ] || { echo "BAD the page could not be measured" >>"$dir/faults"; return; }
    # The report by itself: what its console says counts.
    browse --window-size="$width,$height" --screenshot="$dir/shot.png" "file://$dir/page.html" \
        >"$dir/out" 2>"$dir/log"
    grep -a 'CONSOLE' "$dir/log" | sed 's/^[^"]*/BAD the console: /' >>"$dir/faults"
    [ -s "$dir/shot.png" ] || { echo "BAD no screenshot" >>"$dir/faults"; return; }
    browse --allow-file-access-from-files --dump-dom "$at&height=$height&figures=$2" >"$dir/dom" 2>"$dir/log"
    grep '^BAD\|<pre id="said">BAD' "$dir/dom" | sed 's/^<pre id="said">//' >>"$dir/faults"
    grep -q '^looked' "$dir/dom" || echo "BAD the look did not end" >>"$dir/faults"
}

# A sound report.
sound() { # name, file, figures
    look "$2" "$3"
    if [ -s "$dir/faults" ]; then
        echo "FAILED  $1"
        head -n 12 "$dir/faults" | sed 's/^/        /'
        failed=$((failed + 1))
    else
        echo "passed  $1: $3 figures in $width x $height pixels, $(wc -c <"$2") bytes"
    fi
}

# A planted fault, and the pattern of what must be said of it.
planted() { # name, pattern
    look "$dir/planted.html" "$figures"
    if grep -qE "$2" "$dir/faults"; then
        echo "caught  $1: $(grep -m 1 -E "$2" "$dir/faults" | cut -c 1-100)"
    else
        echo "MISSED  $1; said: $(head -c 300 "$dir/faults")"
        failed=$((failed + 1))
    fi
}

# Findings need something wrong: a layout as published.
"$raydiff" fuzz --trials 60 --engine cpu --layout rtrs_rf --faithful --dir "$dir/found" --jobs 1 --until 1 \
    --no-shrink --corpus none >/dev/null 2>&1
"$raydiff" bench frames --scene sphere:n=3 --frames 4 --size 32x24 --engine cpu --out "$dir/frames" \
    >"$dir/out" 2>&1 || { echo "FAILED  bench frames"; cat "$dir/out"; exit 1; }
few=
[ "$mode" = quick ] && few='--count 1000 --engine cpu,embree_robust'
"$raydiff" report cornell sphere:n=8 --quick $few --findings "$dir/found" \
    --benchmark "$dir/frames.json" --out "$dir/report.html" --json "$dir/report.json" \
    >"$dir/out" 2>&1
code=$?
[ "$code" -eq 1 ] || { echo "FAILED  raydiff report: exit $code"; cat "$dir/out"; exit 1; }
number() { sed -n "s/.*\"$1\": \([0-9]*\).*/\1/p" "$dir/report.json" | head -n 1; }
figures=$(number figures)
[ "$(number pictures)" -ge 3 ] && [ "$figures" -ge 8 ] || { echo "FAILED  the report has too few figures"; exit 1; }
sound 'the report' "$dir/report.html" "$figures"
case $mode in
'' | quick) ;;
*)
    mkdir -p "$mode" && cp "$dir/report.html" "$dir/shot.png" "$mode" &&
        echo "        kept in $mode: report.html, shot.png"
    ;;
esac

if [ "$mode" != quick ]; then
    sed 's|<details>|<details open="open">|' "$dir/report.html" >"$dir/opened.html"
    sound 'the report, all opened' "$dir/opened.html" "$figures"
fi

# Planted: without the policy, which forbids the browser what the page might ask for, and with it.
free() { sed 's/<meta http-equiv="Content-Security-Policy"[^>]*>//' "$dir/report.html"; }
sed 's|image/png;base64,[A-Za-z0-9+/]\{400\}|image/png;base64,|' "$dir/report.html" >"$dir/planted.html"
planted 'a damaged picture' 'could not be decoded|shows something else'
if [ "$mode" != quick ]; then
    sed 's|</main>|<figure><img alt="x" src="missing.png" width="90" height="90"/></figure></main>|' \
        "$dir/report.html" >"$dir/planted.html"
    planted 'a picture that is not in the page' 'Content Security Policy'
    free | sed 's|</main>|<img alt="x" src="missing.png"/></main>|' >"$dir/planted.html"
    planted 'a missing picture, without the policy' 'not in the page, or broken: .*missing.png'
    free | sed 's|</main>|<script>undefined_function();</script></main>|' >"$dir/planted.html"
    planted 'a script with an error' 'undefined_function is not defined'
    free | sed 's|</head>|<link rel="stylesheet" href="http://example.org/x.css"/></head>|' >"$dir/planted.html"
    planted 'a style sheet from elsewhere' 'asked for http|ERR_NAME_NOT_RESOLVED'
    sed 's|</style>|figure svg{visibility:hidden}</style>|' "$dir/report.html" >"$dir/planted.html"
    planted 'plots that are not shown' 'are to be seen'
    sed 's|</style>|.pictures img{filter:brightness(0)}</style>|' "$dir/report.html" >"$dir/planted.html"
    planted 'pictures that are black' 'shows something else'
    sed 's|</style>|main{min-width:1900px}</style>|' "$dir/report.html" >"$dir/planted.html"
    planted 'a page that is too wide' 'wider than the window'
    awk '/<figure>/ && !cut {cut = 1; next} /<\/figure>/ && cut == 1 {cut = 2; next} {print}' "$dir/report.html" \
        >"$dir/planted.html"
    planted 'a figure that is lost' "figures, not $figures"
    { cat "$dir/report.html"; head -c 3000000 /dev/zero | tr '\0' ' '; } >"$dir/planted.html"
    planted 'a file that is too large' '3 MB or more'
fi
[ "$failed" -eq 0 ] && echo "report-check: every figure is to be seen, nothing is asked for"
exit "$failed"
