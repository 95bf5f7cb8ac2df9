#!/usr/bin/perl
# The mutations of files in an order that depends on the seed and on each mutation itself, so that a change
# elsewhere in a file neither draws others nor forgets what is known:
#   perl tests/mutation/order.pl MUTATE EQUIVALENT SEED FILE...
# MUTATE: the mutator. A line each: KEY FILE NUMBER INVARIANT; INVARIANT is - if EQUIVALENT does not have it.
# EQUIVALENT has lines of three kinds, # begins a comment:
#   invariant NAME ;; SUITE ;; what holds, so that no answer can differ
#   NAME ;; FILE ;; the line of code ;; MUTATION [#K]        the K-th of that text on that line
#   NAME ;; * ;; PATTERN ;; PATTERN        of any file: Perl's, of the whole line and of the whole mutation
# SEED is check: prints nothing, and names each line that fits no mutation, or several, or has no invariant.
# Exit codes: 0; 1: EQUIVALENT does not fit; 2: a file cannot be read.
use strict;
use warnings;
no warnings 'portable'; # 64 bits are there

my ($mutate, $equivalent, $seed, @files) = @ARGV;

sub hash_of {
    my ($text) = @_;
    my $hash = 0xcbf29ce484222325; # FNV-1a
    for my $byte (unpack 'C*', $text) {
        $hash ^= $byte;
        use integer;
        $hash *= 0x100000001b3;
    }
    # Its high bits are weak in the last bytes: one more turn.
    $hash ^= $hash >> 29;
    { use integer; $hash *= 0x94d049bb133111eb; }
    return sprintf '%016x', $hash ^ ($hash >> 31);
}

sub flat { my ($text) = @_; $text =~ s/\s+/ /g; $text =~ s/^ | $//g; return $text }

my (%name_of, %used, %suite_of, @pattern, $bad);
sub complain { print STDERR "@_\n"; $bad = 1 }

open my $table, '<', $equivalent or die_of($equivalent);
while (my $row = <$table>) {
    next if $row =~ /^\s*(#|$)/;
    my @part = map { flat($_) } split / ;; /, $row;
    if ($part[0] =~ s/^invariant //) {
        @part == 3 or complain("$equivalent:$.: an invariant is NAME ;; SUITE ;; what holds");
        $suite_of{$part[0]} = $part[1];
    } elsif (@part != 4 || !exists $suite_of{$part[0]}) {
        complain("$equivalent:$.: NAME ;; FILE ;; CODE ;; MUTATION, and the invariant before it");
    } elsif ($part[1] eq '*') {
        push @pattern, {name => $part[0], row => $., is => qr/^(?:$part[2]) ;; (?:$part[3])$/};
    } else {
        my $number = $part[3] =~ s/ #(\d+)$// ? $1 : 0;
        my $text = "$part[1] ;; $part[2] ;; $part[3]";
        $name_of{"$text ;; $number"} = [$part[0], $.];
    }
}
close $table;

sub die_of { my ($file) = @_; print STDERR "order: $file: $!\n"; exit 2 }

my @row;
for my $file (@files) {
    open my $source, '<', $file or die_of($file);
    my @line = ('', map { flat($_) } <$source>);
    my (%count, @here);
    open my $list, '-|', $mutate, 'list', $file or die_of($mutate);
    while (<$list>) {
        chomp;
        my ($number, $line, $text) = /^(\d+) (\d+) (.*?) ?$/ or exit 2;
        my $mutation = "$file ;; $line[$line] ;; " . flat($text);
        push @here, [$mutation, $number, ++$count{$mutation}];
    }
    close $list or exit 2;
    for (@here) {
        my ($mutation, $number, $at) = @$_;
        my $of = $count{$mutation} > 1 ? $at : 0;
        my $known = $name_of{"$mutation ;; $of"};
        my $code = substr $mutation, length("$file ;; ");
        for (grep { $code =~ $_->{is} } @pattern) {
            $known ||= [$_->{name}, $_->{row}];
            $_->{used} = 1;
        }
        $used{"$mutation ;; $of"} = 1;
        my $key = hash_of("$mutation ;; $at");
        push @row, [hash_of("$seed $key"), "$key $file $number " . ($known ? $known->[0] : '-')];
    }
}
if ($seed eq 'check') {
    for (sort { $name_of{$a}[1] <=> $name_of{$b}[1] } grep { !$used{$_} } keys %name_of) {
        complain("$equivalent:$name_of{$_}[1]: no mutation, or several and no #K: $_");
    }
    complain("$equivalent:$_->{row}: no mutation fits") for grep { !$_->{used} } @pattern;
    print map { "$_ $suite_of{$_}\n" } sort keys %suite_of;
} else {
    print map { "$_->[1]\n" } sort { $a->[0] cmp $b->[0] } @row;
}
exit($bad ? 1 : 0);
