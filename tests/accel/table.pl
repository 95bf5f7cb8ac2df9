# What drivers do with every variant of rayquery: a table in Markdown, driver by variant.
#   perl tests/accel/table.pl RAYDIFF [DRIVER...]        by default stock, mesa25 and swiftshader
# A cell is WRONG if the judge calls an answer of any scene so, "allowed" with the scenes and worlds that were
# traced if all are, else why none was, as a note below. Copies whose bits differ are "other bits".
# Exit 1: a copy has other bits, or a driver failed.
use strict;
use warnings;
use File::Temp qw(tempfile);
use JSON::PP;

my ($raydiff, @drivers) = @ARGV;
die "usage: perl tests/accel/table.pl RAYDIFF [DRIVER...]\n" unless $raydiff;
@drivers = qw(stock mesa25 swiftshader) unless @drivers;
my @scenes = ('grid:n=8,height=2', 'soup:n=300', 'tests/accel/cube.obj', 'tests/accel/square.obj', 'placed-turned',
    'placed-scaled');
my (@order, %cell, @notes, %note);
my $bad = 0;

# The number of a note, the same for the same reason.
sub note {
    my ($text) = @_;
    $text =~ s/ matches driver .*//;
    unless ($note{$text}) {
        push @notes, $text;
        $note{$text} = @notes;
    }
    return $note{$text};
}

sub cell {
    my (@rows) = @_;
    my ($scenes, $wrong, $rays, $other, $why) = (0, 0, 0, 0, '');
    for my $row (@rows) {
        if ($row->{status} eq 'ok' && $row->{rays}) {
            $scenes++;
            $wrong += $row->{counts}{wrong};
            $rays += $row->{rays};
            $other += $row->{bit_differences};
        } elsif ($row->{status} eq 'failed') {
            $bad = 1;
            return 'failed (' . note($row->{reason}) . ')';
        } elsif (!$why || $row->{reason} !~ /traces scenes/) {
            $why ||= $row->{reason};
        }
    }
    $bad = 1 if $other;
    return "other bits, $other of $rays" if $other;
    return "**WRONG**, $wrong of $rays" if $wrong;
    return "allowed in $scenes" if $scenes;
    $why =~ s/^rayquery: vertex \d+ of the mesh, \(.*?\), would be rounded/each scene has a vertex that would be rounded/;
    return 'refused (' . note($why) . ')';
}

for my $driver (@drivers) {
    my (undef, $file) = tempfile(UNLINK => 1);
    my @ask = ($raydiff, 'check', @scenes, '--engine', 'rayquery,rayquery:*', '--driver', $driver,
        '--count', 500, '--repeat', 1, '--json', $file);
    my $code = system(join(' ', map { "'$_'" } @ask) . ' >/dev/null 2>&1') >> 8;
    die "table.pl: raydiff check --driver $driver ends with $code\n" if $code != 0 && $code != 1 && $code != 77;
    local $/;
    open my $in, '<', $file or die "table.pl: $file: $!\n"; # another file by now
    my $report = decode_json(<$in>);
    my %rows;
    for my $row (@{ $report->{rows} }) {
        my $name = $row->{engine} // next;
        push @order, $name unless $rows{$name} || exists $cell{$name};
        push @{ $rows{$name} }, $row;
    }
    $cell{$_}{$driver} = cell(@{ $rows{$_} }) for grep { $rows{$_} } @order;
}

print '| variant | ', join(' | ', @drivers), " |\n|---|", '---|' x @drivers, "\n";
for my $name (@order) {
    my $short = $name eq 'rayquery' ? 'rayquery itself' : '`' . substr($name, 9) . '`';
    print "| $short | ", join(' | ', map { $cell{$name}{$_} // '-' } @drivers), " |\n";
}
print "\n| reason | |\n|---|---|\n";
print '| ', $_ + 1, " | $notes[$_] |\n" for 0 .. $#notes;
exit $bad;
