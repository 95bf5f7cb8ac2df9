#!/usr/bin/perl
# The section of `raydiff report` on the machine: what it says of engines and drivers is what the JSON of raydiff doctor has.
#   perl machine.pl --two JSON          prints that JSON with a second card, every number of both another
#   perl machine.pl JSON PAGE VERSION   compares; exit 1 where they differ
use strict;
use warnings;
use JSON::PP;

sub slurp {
    my ($path) = @_;
    open my $in, '<:raw', $path or die "$path: $!\n";
    local $/;
    return <$in>;
}

my $number = 0;

# The same value, each number another one, each text too.
sub changed {
    my ($value, $mark) = @_;
    return { map { $_ => $_ eq 'op' ? $value->{$_} : changed($value->{$_}, $mark) } sort keys %$value } if ref $value eq 'HASH';
    return [map { changed($_, $mark) } @$value] if ref $value eq 'ARRAY';
    return $value if !defined $value || JSON::PP::is_bool($value);
    return 1000 + 7 * $number++ if $value =~ /^[0-9.]+$/;
    return "$value $mark";
}

if ($ARGV[0] eq '--two') {
    my $doctor = decode_json(slurp($ARGV[1]));
    my @drivers = @{ $doctor->{drivers} };
    my ($runs) = grep { $_->{card} } @drivers or exit 77;
    my ($none) = grep { !$_->{card} } @drivers or exit 77;
    my @two = map { my $mark = $_; { name => "driver$mark", runs => JSON::PP::true, why => undef, packages => "package-$mark", card => changed($runs->{card}, $mark) } } 1, 2;
    @{ $two[1]{card}{ops} } = reverse @{ $two[1]{card}{ops} };
    # One operation as in C, one with ordinary values alone, one with special ones alone.
    my @ops = @{ $two[0]{card}{ops} };
    $ops[0]{$_} = 0 for qw(ordinary_differs special_differs);
    $ops[1]{special_differs} = 0;
    $ops[2]{ordinary_differs} = 0;
    $doctor->{drivers} = [$two[0], $none, $two[1]];
    print JSON::PP->new->canonical->indent->encode($doctor);
    exit 0;
}

my ($json, $page, $version) = @ARGV;
my $doctor = decode_json(slurp($json));
my (@wrong, $checked);
my $text = slurp($page);
$text =~ s/.*<h2>6 Machine and drivers//s;
$text =~ s/<\/section>.*//s;
my @rows;
for my $row ($text =~ /<tr[^>]*>(.*?)<\/tr>/gs) {
    my @cells = $row =~ /<t[hd][^>]*>(.*?)<\/t[hd]>/gs;
    my ($class) = $row =~ /<td class="(good|none)"/;
    for (@cells) { s/&#10;/\n/g; s/&lt;/</g; s/&gt;/>/g; s/&quot;/"/g; s/&#39;/'/g; s/&amp;/&/g }
    push @rows, { cells => \@cells, class => $class // '' };
}

sub want {
    my ($class, @cells) = @_;
    my $row = shift @rows // { cells => [], class => '' };
    my ($is, $wanted) = map { join ' | ', @$_ } $row->{cells}, \@cells;
    $checked++;
    push @wrong, "'$is' ($row->{class}), not '$wanted' ($class)" if $is ne $wanted || $row->{class} ne $class;
}

sub scalar_text {
    my ($value) = @_;
    return $value ? 'yes' : 'no' if JSON::PP::is_bool($value);
    return $value =~ /\.|e/ && $value =~ /^[-+0-9.e]+$/ ? sprintf('%.6g', $value) : $value;
}

sub card_text {
    my ($value) = @_;
    return join ', ', map { card_text($_) } @$value if ref $value eq 'ARRAY';
    return scalar_text($value) if ref $value ne 'HASH';
    return join ', ', map { (tr/_/ /r) . (ref $value->{$_} eq 'HASH' ? ' (' . card_text($value->{$_}) . ')' : ' ' . card_text($value->{$_})) } sort keys %$value;
}

sub operation {
    my ($op) = @_;
    return 'as in C to the bit' if $op->{ordinary_differs} + $op->{special_differs} == 0;
    my $text = '';
    $text .= "$op->{ordinary_differs} of $op->{ordinary} differ, by at most $op->{worst_ulp} ulp " if $op->{ordinary_differs};
    $text .= "$op->{special_differs} of $op->{special} special values differ, $op->{flushed} of them subnormals made 0" if $op->{special_differs};
    return $text;
}

my ($processor) = slurp('/proc/cpuinfo') =~ /^model name\s*: *(.*)$/m;
want('', 'processor', $processor // 'unknown');
my $system = `uname -s` . `uname -r` . `uname -m`;
my @system = split /\n/, $system;
want('', 'system', "$system[0] $system[1], $system[2]");
want('', 'raydiff', $version);
want('', 'engine', 'runs', 'what it is, or why not');
want($_->{runs} ? 'good' : 'none', $_->{name}, $_->{runs} ? 'yes' : 'no', $_->{runs} ? $_->{text} : $_->{why}) for @{ $doctor->{engines} };
my @running = grep { $_->{card} } @{ $doctor->{drivers} };
for my $other (grep { !$_->{card} } @{ $doctor->{drivers} }) {
    $checked++;
    (my $plain = $text) =~ s/&#39;/'/g;
    $plain =~ s/&quot;/"/g;
    push @wrong, "driver $other->{name} is not told" if index($plain, "Driver $other->{name} does not run: $other->{why}") < 0;
}
if (@running) {
    want('', 'driver', map { $_->{name} } @running);
    # The file that --two makes has its members in this order.
    for my $name (sort keys %{ $running[0]{card} }) {
        if ($name eq 'ops') {
            for my $op (@{ $running[0]{card}{ops} }) {
                want('', $op->{op}, map { my ($mine) = grep { $_->{op} eq $op->{op} } @{ $_->{card}{ops} }; operation($mine) } @running);
            }
        } else {
            want('', $name =~ tr/_/ /r, map { card_text($_->{card}{$name}) } @running);
        }
    }
    want('', 'packages', map { $_->{packages} } @running);
}
push @wrong, scalar(@rows) . ' rows more' if @rows;
print "WRONG   $_\n" for @wrong > 10 ? @wrong[0 .. 9] : @wrong;
print "machine: $checked values, " . @wrong . " wrong\n";
exit(@wrong > 0 || $checked < 20);
