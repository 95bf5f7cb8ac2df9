#!/bin/sh
# The site of the pages: every page of the repository is in it and lists all others, every link leads to a file
# of the site and to an element of that name, nothing is asked from a network.
#   sh tests/docs/site.sh
# Exit 77 without pandoc.
set -u
command -v pandoc >/dev/null || { echo "SKIPPED site: no pandoc (.ci/deps.sh site)"; exit 77; }
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $1"
    failed=$((failed + 1))
}
sh docs/site/site.sh "$dir/site" >"$dir/out" 2>&1 || { cat "$dir/out"; exit 1; }
pages="README.md CONTRIBUTING.md CHANGELOG.md SECURITY.md scenes/README.md $(ls docs/*.md)"
count=$(echo $pages | wc -w)
grep -qx "site: $count pages in $dir/site" "$dir/out" || bad "$count pages: $(cat "$dir/out")"

# A line for each fault of the site in a folder.
faults() {
    perl -e '
        use strict; use warnings;
        use File::Basename qw(dirname); use Cwd qw(realpath);
        my ($root, %text, %name) = (realpath($ARGV[0]));
        chomp(my @files = `find "$root" -name "*.html"`);
        for my $file (@files) {
            open my $in, "<", $file or die;
            local $/;
            $text{$file} = <$in>;
            $name{$file}{$1} = 1 while $text{$file} =~ / id="([^"]*)"/g;
        }
        for my $file (@files) {
            my $all = 0;
            print "$file: asks for something outside\n"
                if $text{$file} =~ /<script|\@import|url\(|<(?:link|img|iframe)[^>]*"(?:https?:)?\/\//;
            while ($text{$file} =~ / (?:href|src)="([^"]*)"/g) {
                my $to = $1;
                next if $to =~ /^(?:https?|mailto):/;
                my ($path, $anchor) = $to =~ /^([^#]*)#?(.*)$/;
                my $at = $path eq "" ? $file : dirname($file) . "/$path";
                if (!-e $at) { print "$file: $to leads nowhere\n"; next }
                $at = realpath($at);
                print "$file: $to leaves the site\n" if index($at, "$root/") != 0;
                print "$file: $to is no page\n" if $to =~ /\.md/;
                print "$file: $to has no such element\n" if $anchor ne "" && !$name{$at}{$anchor};
            }
            my ($list) = $text{$file} =~ /<nav>(.*?)<\/nav>/s;
            $all++ while ($list // "") =~ /<li><a href=/g;
            print "$file: lists $all pages\n" if $all != @files;
            print "$file: is not marked in its list\n" if 1 != (() = ($list // "") =~ /aria-current/g);
            print "$file: has no title\n" if $text{$file} !~ /<title>[^<]+<\/title>/;
        }' "$1"
}
faults "$dir/site" >"$dir/faults"
while read -r line; do bad "$line"; done <"$dir/faults"
for page in $pages; do
    html=${page%.md}.html
    [ "$page" = README.md ] && html=index.html
    [ -s "$dir/site/$html" ] || bad "$page is not in the site"
    wanted=$(sed -n 's/^# *//p' "$page" | head -n 1 | tr -d '`')
    found=$(sed -n '/<h1/{s/<[^>]*>//g;s/&lt;/</g;s/&gt;/>/g;s/&amp;/\&/g;p;q;}' "$dir/site/$html")
    [ "$found" = "$wanted" ] || bad "$html begins with '$found', not with '$wanted'"
done
[ -s "$dir/site/docs/screens/finding.svg" ] || bad 'a picture is not in the site'

# Planted: each of these must be a fault.
planted() { # PERL WHAT
    rm -rf "$dir/planted"
    cp -r "$dir/site" "$dir/planted"
    perl -pi -e "$1" "$dir/planted/index.html"
    cmp -s "$dir/site/index.html" "$dir/planted/index.html" && bad "planted: $2: nothing is changed"
    faults "$dir/planted" | grep -q . || bad "planted: $2 is not seen"
}
planted 's|docs/quickstart.html|docs/quickstart.md|' 'a link that is not rewritten'
planted 's|<main>|<main><a href="docs/faq.html#no-such-title">x</a>|' 'an anchor that is not there'
planted 's|<main>|<main><img src="https://example.org/x.png"/>|' 'a picture from elsewhere'
planted 's|<li><a href="docs/faq.html">faq</a></li>||' 'a page that is not listed'
planted 's|<title>[^<]*</title>||' 'a page without a title'

# A link that the site has to rewrite, and one that it must not.
printf '[a](README.md#b) [c](docs/x.md) [d](https://example.org/y.md) [e](x.svg) [f](s/README.md)\n' >"$dir/x.md"
pandoc -f gfm -t html5 --lua-filter docs/site/links.lua "$dir/x.md" | grep -o 'href="[^"]*"' | tr '\n' ' ' >"$dir/out"
[ "$(cat "$dir/out")" = 'href="index.html#b" href="docs/x.html" href="https://example.org/y.md" href="x.svg" href="s/README.html" ' ] ||
    bad "links are rewritten: $(cat "$dir/out")"
echo "site: $failed failed"
[ "$failed" -eq 0 ]
