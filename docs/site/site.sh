#!/bin/sh
# The pages as a site that works without network: README.md is index.html, every page has a list of all.
#   sh docs/site/site.sh FOLDER      (make site: build/site)
# Exit 77 without pandoc.
set -u
LC_ALL=C.UTF-8
export LC_ALL
out=${1?the folder}
command -v pandoc >/dev/null || { echo "SKIPPED site: no pandoc (.ci/deps.sh site)"; exit 77; }
pages="README.md CONTRIBUTING.md CHANGELOG.md SECURITY.md scenes/README.md $(ls docs/*.md)"
rm -rf "$out"
mkdir -p "$out/docs" "$out/scenes" || exit 2
cp docs/site/site.css "$out/" || exit 2

title_of() { sed -n 's/^# *//p' "$1" | head -n 1 | sed 's/`//g; s/&/\&amp;/g; s/</\&lt;/g'; }
html_of() { # PAGE
    case $1 in
    README.md) echo index.html ;;
    *) echo "${1%.md}.html" ;;
    esac
}
# A page's way up to the top: docs/x.md is one folder down.
up_of() { case $1 in */*) echo ../ ;; esac; }
# The list of pages as PAGE sees it; the name of a page is its file's.
list() {
    echo '<nav><ul>'
    for each in $pages; do
        name=$(basename "$each" .md)
        [ "$each" = README.md ] && name=raydiff
        [ "$each" = scenes/README.md ] && name=meshes
        here=
        [ "$each" = "$1" ] && here=' aria-current="page"'
        echo "<li><a href=\"$(up_of "$1")$(html_of "$each")\"$here>$name</a></li>"
    done
    echo '</ul></nav>'
}
for page in $pages; do
    {
        echo '<!DOCTYPE html>'
        echo '<html lang="en"><head><meta charset="utf-8"/>'
        echo '<meta name="viewport" content="width=device-width, initial-scale=1"/>'
        echo "<title>$(title_of "$page")</title>"
        echo "<link rel=\"stylesheet\" href=\"$(up_of "$page")site.css\"/></head><body>"
        list "$page"
        echo '<main>'
        pandoc -f gfm -t html5 --no-highlight --wrap=none --lua-filter docs/site/links.lua "$page" || exit 2
        echo '</main></body></html>'
    } >"$out/$(html_of "$page")" || exit 2
    # Files that are no pages, such as pictures, lie where they lie here.
    for file in $(perl -ne 'print "$1\n" while /\]\(([^)#:]+)\)/g' "$page" | grep -v '\.md$'); do
        from=$(dirname "$page")/$file
        mkdir -p "$out/$(dirname "$from")" && cp -r "$from" "$out/$from" || exit 2
    done
done
echo "site: $(find "$out" -name '*.html' | wc -l) pages in $out"
