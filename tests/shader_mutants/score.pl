#!/usr/bin/perl
# The score of played mutants: perl tests/shader_mutants/score.pl EQUIVALENT FILE.csv...
# A line a shader, in per cent of those that are not equivalent, all and by kind; then who killed how many, and the
# survivors. EQUIVALENT (tests/shader_mutants/equivalent.txt) says which are proven to be equivalent, and why.
# So is what no pipeline reaches, whatever its tests, query, storage and layout (tests/shader_mutants/spirv_live.h):
# cwbvh80 and half4 refuse the storages that their shaders could read.
# Exit code 1: a shader's score is below 95, or a proof is of a mutant that was killed.
use strict;
use warnings;

my @kinds = qw(decoration contraction operands comparison literal operation store branch index conversion barrier);
my ($equivalents, @files) = @ARGV;
my (@proof, $bad, %by, @survivors, %why);

# Patterns as the shell has them: * ? and {a,b}.
sub pattern {
    my $text = quotemeta shift;
    $text =~ s/\\\*/.*/g;
    $text =~ s/\\\?/./g;
    1 while $text =~ s/\\\{([^{}]*)\\\}/'(?:' . join('|', split(m{\\,}, $1)) . ')'/e;
    qr/^$text$/;
}

open my $in, '<', $equivalents or die "$equivalents: $!\n";
while (<$in>) {
    next if /^#/ || !/\S/;
    /^(\S+) (\S+) "([^"]*)" (\S.*)$/ or die "$equivalents:$.: SHADERS NAME \"TEXT\" REASON\n";
    push @proof, { shaders => pattern($1), name => pattern($2), text => pattern($3), reason => $4, line => $. };
}
close $in;

sub proof_of {
    my ($shader, $name, $text) = @_;
    for my $proof (@proof) {
        return $proof if $shader =~ $proof->{shaders} && $name =~ $proof->{name} && $text =~ $proof->{text};
    }
    return undef;
}

sub rate {
    my ($count) = @_;
    my $of = ($count->{killed} // 0) + ($count->{survived} // 0);
    return $of ? sprintf('%.0f', int(100 * ($count->{killed} // 0) / $of)) : '-';
}

my (%total, @rows);
for my $file (@files) {
    (my $shader = $file) =~ s{.*/|\.csv$}{}g;
    my (%count, %of, %line, @order);
    open my $csv, '<', $file or die "$file: $!\n";
    while (<$csv>) {
        /^([^,]+),/ or next;
        push @order, $1 unless exists $line{$1};
        $line{$1} = $_; # the last counts
    }
    for (@line{@order}) {
        /^([^,]+),([^,]+),([^,]+),([^,]*),(\d+),([\d.]+),"(.*)"$/ or next;
        my ($name, $kind, $word, $by, $played, $text) = ($1, $2, $3, $4, $5, $7);
        next if $word eq 'invalid';
        my $proof = proof_of($shader, $name, $text);
        if ($proof && $word eq 'killed' && $proof->{reason} !~ /^(wider|broken|loop)/) {
            print STDERR "$shader $name ($text) stands among the equivalent, and $by kills it\n";
            $bad = 1;
        }
        if ($word eq 'survived' && ($proof || $played == 0)) {
            $word = 'equivalent';
            $why{$played == 0 ? 'unreached' : 'proven'}++;
        }
        $count{$word}++;
        $of{$kind}{$word}++;
        $total{$kind}{$word}++;
        if ($word eq 'killed') {
            my $how = $by =~ s/ (hangs|crashes)$// ? " $1" : '';
            my $who = $by =~ /^hard\./ ? 'hard cases' : $by =~ /^test_/ ? $by : 'conform';
            $by{"$who$how"}++;
        }
        push @survivors, "$shader $name: $text" if $word eq 'survived';
    }
    close $csv;
    my $of = ($count{killed} // 0) + ($count{survived} // 0);
    my $rate = $of ? 100 * ($count{killed} // 0) / $of : 0;
    $bad = 1 if $rate < 95;
    push @rows, [$shader, $of, $count{equivalent} // 0, $rate, \%of];
    $total{all}{$_} += $count{$_} // 0 for qw(killed survived equivalent);
}
my $all = delete $total{all};
my $of = $all->{killed} + $all->{survived};
push @rows, ['all', $of, $all->{equivalent}, $of ? 100 * $all->{killed} / $of : 0, \%total];
my @met = grep { $total{$_} } @kinds;
printf "%-23s %4s %3s %5s %s\n", 'shader', 'of', 'eq.', '%', join ' ', map { substr $_, 0, 3 } @met;
for my $row (@rows) {
    my ($shader, $count, $equivalent, $rate, $kind) = @$row;
    printf "%-23s %4d %3d %5.1f %s\n", $shader, $count, $equivalent, $rate, join ' ', map { sprintf '%3s', rate($kind->{$_} // {}) } @met;
}
my $line = 'killed by';
for my $who (sort { $by{$b} <=> $by{$a} || $a cmp $b } keys %by) {
    my $next = "$who $by{$who}";
    if (length("$line $next") > 78) {
        print "$line\n";
        $line = '   ';
    }
    $line .= " $next,";
}
$line =~ s/,$//;
print "$line\n";
printf "equivalent: %d that no pipeline reaches, %d proven\n", $why{unreached} // 0, $why{proven} // 0;
print "survived: $_\n" for @survivors;
exit($bad ? 1 : 0);
