# Suite: the table of docs/variants.md is what drivers do, and each message and exit code of a variant.
#   perl tests/accel/variants.pl RAYDIFF [--write]
# The rows of mesa25 are played again if that driver is there; --write plays all drivers and writes the page.
# Exit 77: there is no driver with ray queries, with its reason.
use strict;
use warnings;

my ($raydiff, $write) = @ARGV;
my $page = 'docs/variants.md';
my $bad = 0;

sub breach {
    print "$_[0]\n";
    $bad = 1;
}

# Runs raydiff; its exit code and the line that matters must be as told.
sub says {
    my ($code, $line, @words) = @_;
    my $out = `@{[ join ' ', $raydiff, map { "'$_'" } @words ]} 2>&1`;
    my $got = $? >> 8;
    breach("raydiff @words: exit code $got, not $code") if $got != $code;
    breach("raydiff @words: does not say '$line':\n$out") if $out !~ /$line/;
}

sub table {
    my (@drivers) = @_;
    my $text = `perl tests/accel/table.pl '$raydiff' @drivers`;
    breach('a copy has other bits than what it copies, or a driver failed') if $?;
    return $text;
}

sub read_page {
    open my $in, '<', $page or die "$page: $!\n";
    local $/;
    return scalar <$in>;
}

says(2, "'u17' is no word for a variant of rayquery", qw(check sphere:n=2 --engine rayquery:u17));
says(2, 'a stride of f32x3 is a multiple of 4 from 12 to 4096', qw(check sphere:n=2 --engine rayquery:stride10));
says(2, "no variant of rayquery is called 'rayquery:nope\\*'", 'check', 'sphere:n=2', '--engine', 'rayquery:nope*');
says(2, 'named twice', qw(check sphere:n=2 --engine), 'rayquery:u16:clone,rayquery:clone:u16');
says(77, '0 of 1 rows agree, 1 skipped', qw(check sphere:n=2 --engine rayquery:clone --driver no-such-driver --count 100));
exit 1 if $bad;

if ($write) {
    my $text = read_page();
    my $new = table();
    $text =~ s/\| variant \|.*?(?=\n## )/$new/s or die "$page has no table\n";
    open my $out, '>', $page or die "$page: $!\n";
    print $out $text;
    exit $bad;
}

my $probe = `'$raydiff' check sphere:n=2 --engine rayquery --driver mesa25 --count 100 --repeat 1 2>&1`;
if ($? >> 8 == 77) {
    my ($why) = $probe =~ /cannot run here 1: (.*)/;
    print "SKIP ", $why // 'no ray queries', "\n";
    exit 77;
}
my (%shown, %now);
for (split /\n/, read_page()) {
    my @cell = split / *\| */;
    $shown{ $cell[1] } = $cell[3] if @cell == 5 && $cell[1] =~ /^(`|rayquery)/;
}
for (split /\n/, table('mesa25')) {
    my @cell = split / *\| */;
    $now{ $cell[1] } = $cell[2] if @cell == 3 && $cell[1] =~ /^(`|rayquery)/;
}
breach('the table of mesa25 has no rows') unless keys %now > 50;
for my $name (sort keys %now) {
    my ($is, $was) = map { s/ \(\d+\)//r } $now{$name}, $shown{$name} // 'no row';
    breach("$page: $name: '$was', now '$is'") if $is ne $was;
}
says(77, 'lacks the feature accelerationStructureHostCommands',
    qw(check sphere:n=2 --engine rayquery:host --driver mesa25 --count 100));
says(0, 'conclusion: 2 of 2 rows agree', qw(check placed-turned:n=2 --engine), 'rayquery:serialise,rayquery:update_into:scaled',
    qw(--driver mesa25 --count 200 --repeat 1));
says(1, 'rayquery:first_vertex', qw(check sphere:n=2 --engine rayquery:first_vertex --driver mesa25 --count 100));
print "ok, ", scalar(keys %now), " variants are as $page says\n" unless $bad;
exit $bad;
