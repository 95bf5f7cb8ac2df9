#!/usr/bin/perl
# Stands for Node in tests/webgpu/webgpu.sh: answers as gpu/webgpu/peer.js does, or in the wrong way that $FAKE_NODE
# names. Its hits are what $FAKE_WORDS says, five words a ray; with $FAKE_AT that of one ray alone, all others miss.
# It writes what it is told to $FAKE_TOLD, and a sum of each program that it is given behind what is in $FAKE_GIVEN.
use strict;
use warnings;
my $way = $ENV{FAKE_NODE} // 'well';
binmode $_ for *STDIN, *STDOUT;
$| = 1;

sub take {
    my ($bytes) = @_;
    return '' if !$bytes;
    (read(STDIN, my $got, $bytes) // 0) == $bytes or exit 0;
    return $got;
}
sub answer {
    my ($version, $refused, $count, $body) = @_;
    print pack('a4 V7', $way eq 'magic' ? 'RDRX' : 'RDRA', $version, $refused, $count, 0, 2, 0, 0), $body;
}

# What stands behind the path of Dawn, and the driver's file in both variables of the loader.
if (defined $ENV{FAKE_TOLD}) {
    my @told = @ARGV;
    shift @told while @told && $told[0] ne '--';
    my ($file, $older) = map { $ENV{$_} || '-' } qw(VK_DRIVER_FILES VK_ICD_FILENAMES);
    open my $to, '>', $ENV{FAKE_TOLD} or die;
    print $to join(' ', @told[2 .. $#told]), " of $file", $file eq $older ? '' : " and $older", "\n";
    close $to;
}

exit 9 if $way eq 'ends';
kill 'SEGV', $$ if $way eq 'crashes';
my $done = 0; # rays
for (;;) {
    my ($magic, $version, undef, $words, undef, $records, $same) = unpack 'a4 V7', take(32);
    exit 4 if $magic ne 'RDRQ';
    if ($version == 1) {
        print STDERR "a line of the driver\n" if $way =~ /noisy|refuses/;
        $way eq 'refuses' ? answer(1, 1, 16, 'no device for me') : answer(1, 0, 0, '');
        next;
    }
    if (!$same) {
        my $program = take(4 * $words);
        if (defined $ENV{FAKE_GIVEN}) {
            open my $to, '>>', $ENV{FAKE_GIVEN} or die;
            print $to unpack('%32V*', $program), "\n";
            close $to;
        }
    }
    if (!$records) {
        $way eq 'refuses a tree' ? answer(3, 1, 9, 'too large') : answer(3, 0, 0, '');
        next;
    }
    take(32 * $records);
    sleep 60 if $way eq 'hangs';
    kill 'ABRT', $$ if $way eq 'aborts';
    my $miss = pack 'V5', 0, 0, 0, 4294967295, 1;
    my $one = defined $ENV{FAKE_WORDS} ? pack 'V5', split / /, $ENV{FAKE_WORDS} : $miss;
    my $body = (defined $ENV{FAKE_AT} ? $miss : $one) x ($way eq 'short' ? $records - 1 : $records);
    my $at = ($ENV{FAKE_AT} // -1) - $done;
    substr($body, 20 * $at, 20) = $one if $at >= 0 && $at < $records;
    $done += $records;
    answer(3, 0, $way eq 'counts' ? $records + 1 : $records, $body);
    exit 0 if $way eq 'short';
    print 'x' if $way eq 'long';
}
