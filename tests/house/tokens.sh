#!/bin/sh
# C tokens of what is linked into raydiff and libraydiff, room by room:
#   sh tests/house/tokens.sh [-a] [COMMIT]
# Of the checked-out tree, or of COMMIT. The largest four rooms are listed; -a: all. Comments and white space do
# not count. Left out is what is not linked: generated code, tests (but the hard cases, which `conform --hard`
# runs), templates and samples. Exit code 2: no such commit.
set -u
rooms=4
[ "${1:-}" != -a ] || { rooms=1000 && shift; }
if [ $# -gt 0 ]; then
    git rev-parse -q --verify "$1^{commit}" >/dev/null || { echo "tokens: $1 is no commit" >&2 && exit 2; }
    tree=$(mktemp -d) || exit 4
    trap 'rm -rf "$tree"' EXIT
    git archive "$1" | tar -x -C "$tree" && cd "$tree" || exit 4
    list='find . -type f'
else
    list='git ls-files'
fi
$list | sed 's|^\./||' | grep '\.[ch]$' | awk '/^tests\// ? /^tests\/hard/ : !/^fuzz\/(templates|samples)\//' | perl -e '
    my ($keep, %room, $all, $files) = shift;
    while (my $file = <STDIN>) {
        chomp $file;
        open my $in, "<", $file or next; # removed, and git does not know it yet
        my $text = do { local $/; <$in> };
        my $count = 0;
        while ($text =~ m{/\*.*?\*/|//[^\n]*|("(?:\\.|[^"\\])*"|\x27(?:\\.|[^\x27\\])*\x27|[A-Za-z_]\w*
            |\.?\d(?:[eEpP][+-]|[\w.])*|<<=|>>=|\.\.\.|->|\+\+|--|[-+*/%&|^!=<>]=|<<|>>|&&|\|\||\#\#|\S)}gsx) {
            $count++ if defined $1;
        }
        my $room = $file =~ m{^(.*)/} ? $1 : ".";
        $room{$room} += $count;
        $all += $count;
        $files++;
    }
    my @order = sort { $room{$b} <=> $room{$a} || $a cmp $b } keys %room;
    printf "%7d %s\n", $room{$_}, $_ for grep { defined } @order[0 .. $keep - 1];
    printf "%7d in %d files\n", $all, $files;
' "$rooms"
