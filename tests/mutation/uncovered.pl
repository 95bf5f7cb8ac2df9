# Lines of the product that no suite ran, after suites were played by a build of config=coverage (make uncovered):
#   perl tests/mutation/uncovered.pl BUILD [ROOM]
# BUILD/table has its blocks, BUILD/ran which of them were run (tests/mutation/blocks.pl). For each file
# "FILE: N of M lines" and those lines, then a line for each room and the sum.
# Exit codes: 0, or 1 where BUILD has no such data.
use strict;
use warnings;

my ($build, $room) = (@ARGV, '');
my (%line, %ran); # of a file: by number
open my $table, '<', "$build/table" or nothing();
while (<$table>) {
    chomp;
    my (undef, @here) = split / /;
    for (@here) { /^(.*):(\d+)$/ and $line{$1}{$2} = 1 }
}
for my $data (glob "$build/ran/*") {
    my ($name) = $data =~ m{([^/]*)$};
    my $blocks = "$build/table";
    if ($name ne 'libraydiff.so') { # a test that is linked with all objects
        $blocks = "$data.table";
        next if $name =~ /\.table$/ || system "perl tests/mutation/blocks.pl table '$build/tests/$name' >'$blocks'";
    }
    open my $lines, '-|', 'perl', 'tests/mutation/blocks.pl', 'ran', $blocks, $data or die $!;
    while (<$lines>) { /^(\S+) (\d+)$/ and $ran{$1}{$2} = 1 }
}
%ran or nothing();
sub nothing { print STDERR "uncovered: no suite was played by $build: make uncovered\n"; exit 1 }

my (%of, %not);
for my $file (sort keys %line) {
    my ($in) = $file =~ m{^(.*)/} ? $1 : '.';
    next if $room && index("$in/", "$room/") != 0;
    my @not = grep { !$ran{$file}{$_} } sort { $a <=> $b } keys %{ $line{$file} };
    my $all = keys %{ $line{$file} };
    $of{$in} += $all;
    $not{$in} += @not;
    next unless @not;
    print "$file: ", scalar @not, " of $all lines\n";
    open my $source, '<', $file or die "$file: $!\n";
    my @text = ('', <$source>);
    print "$_:$text[$_]" for @not;
}
my ($sum, $all) = (0, 0);
for my $in (sort keys %of) {
    printf "%5d of %5d lines of %s are run by no suite\n", $not{$in}, $of{$in}, $in;
    $sum += $not{$in};
    $all += $of{$in};
}
print "$sum of $all lines are run by no suite\n";
