#!/bin/sh
# Keeps docs/numerics.md, true: every row of its tables names files
# that have its constant with that value, and every power of two, or of ten below 1, in the code of
# ref/ and shaders/ (commands left out) stands in a row with its file. Prints every breach; exit 1
# if there is one.
#   sh tests/house/constants.sh [PAGE]
set -u
page=${1:-docs/numerics.md}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
: >"$work/breaches"

# "file literal" of every row: the first column's names, the second's values and the third's files
# are in backticks. A name is defined as one of the values in each file that it is in.
awk '/^\| [^-]/' "$page" >"$work/rows"
[ -s "$work/rows" ] || { echo "$page: no table of constants"; exit 1; }
in_ticks() { echo "$1" | grep -o '`[^`]*`' | tr -d '`'; }
while IFS='|' read -r _ names values files _; do
    in_ticks "$files" >"$work/files"
    in_ticks "$values" >"$work/values"
    [ -s "$work/files" ] || continue # a heading
    for name in $(in_ticks "$names"); do
        cat $(cat "$work/files") 2>/dev/null | grep -E "#define $name[ (]" |
            grep -qFf "$work/values" || echo "$page: $name is not as the page says" >>"$work/breaches"
    done
    while read -r file; do
        [ -r "$file" ] || { echo "$page: no file $file" >>"$work/breaches"; continue; }
        while read -r value; do
            echo "$file $value"
        done <"$work/values"
    done <"$work/files"
done <"$work/rows" >"$work/said"

# Each file without comments and strings, held against its rows by one process.
for file in $(git ls-files 'ref/*.[ch]' 'ref/*/*.[ch]' 'shaders/*.glsl' 'shaders/*.comp'); do
    case $file in ref/outside/* | ref/base/decimal.c) continue ;; esac
    echo "$file"
done >"$work/sources"
[ -s "$work/sources" ] || { echo "no sources"; exit 1; }
awk -v empty=1 -v placed=1 -f tests/house/code.awk $(cat "$work/sources") | perl -e '
    use strict;
    use warnings;
    my ($page, $said, $sources) = @ARGV;
    my $literal = qr/0x[0-9a-fA-F.]+p[-+]?[0-9]+|[0-9]+(?:\.[0-9]+)?e-[0-9]+/;
    my (%bare, %row);
    while (<STDIN>) { $bare{$1} .= $2 if /^([^:]*):[0-9]+: (.*\n)/ }
    open my $rows, "<", $said or die;
    while (<$rows>) { chomp; $row{$1}{$2} = 1 if /^(\S+) (.*)/ }
    open my $in, "<", $sources or die;
    while (my $file = <$in>) {
        chomp $file;
        my @values = sort keys %{$row{$file}};
        # 0x1p-2 is not in a row that says 0x1p-20
        my %known = map { $_ => 1 } map { /$literal/g } @values;
        my %found;
        for (split /\n/, $bare{$file} // "") { $found{$2} = 1 while /(^|[^0-9A-Za-z_.])($literal)/g }
        print "$file: $_ is on no row of $page\n" for grep { !$known{$_} } sort keys %found;
        # perhaps another file of the row
        print "$file $_\n" for grep { index($bare{$file} // "", $_) < 0 } @values;
    }' "$page" "$work/said" "$work/sources" >"$work/found" || exit 1
grep -F ' is on no row of ' "$work/found" >>"$work/breaches"
# A value must be in each of its row's files.
grep -vF ' is on no row of ' "$work/found" | while read -r file said; do
    echo "$page: $said is not in $file"
done >>"$work/breaches"
cat "$work/breaches"
[ -s "$work/breaches" ] && exit 1
echo "constants: $(wc -l <"$work/rows") rows, all true"
