# Lines of the product that no suite ran, after suites were played by a build of config=coverage:
#   perl tests/mutation/uncovered.pl BUILD [ROOM]
# For each file "FILE: N of M lines" and those lines, then a line for each room and the sum. What was ended by a signal
# has told nothing of what it ran.
# Exit codes: 0, or 1 where BUILD has no such data.
use strict;
use warnings;

my ($build, $room) = (@ARGV, '');
my %line; # of a file: by number, whether it ran, and its text
open my $found, '-|', 'find', "$build/obj", '-name', '*.gcda', '-not', '-path', "$build/obj/tests/*" or die $!;
chomp(my @data = <$found>);
while (my @some = splice @data, 0, 50) {
    open my $gcov, '-|', 'gcov', '-t', '-r', @some or die $!;
    my $file;
    while (<$gcov>) {
        my ($ran, $number, $text) = /^ *([^ :]+?)\*?: *(\d+):(.*)/ or next;
        $file = $text =~ s/^Source://r if $number == 0 && $text =~ /^Source:/;
        next if $number == 0 || $ran eq '-' || $file =~ m{^/};
        my $known = $line{$file}{$number} //= [0, $text];
        $known->[0] ||= $ran =~ /^\d/;
    }
}
%line or do { print STDERR "uncovered: no suite was played by $build: make uncovered\n"; exit 1 };
my (%of, %not);
for my $file (sort keys %line) {
    my ($in) = $file =~ m{^(.*)/} ? $1 : '.';
    next if $room && index("$in/", "$room/") != 0;
    my @not = grep { !$line{$file}{$_}[0] } sort { $a <=> $b } keys %{ $line{$file} };
    my $all = keys %{ $line{$file} };
    $of{$in} += $all;
    $not{$in} += @not;
    next unless @not;
    print "$file: ", scalar @not, " of $all lines\n";
    print "$_:$line{$file}{$_}[1]\n" for @not;
}
my ($sum, $all) = (0, 0);
for my $in (sort keys %of) {
    printf "%5d of %5d lines of %s are run by no suite\n", $not{$in}, $of{$in}, $in;
    $sum += $not{$in};
    $all += $of{$in};
}
print "$sum of $all lines are run by no suite\n";
