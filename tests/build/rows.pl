# Checks what raydiff build wrote as JSON by value, and what it printed against that.
#   perl tests/build/rows.pl ROWS.json TEXT
use strict;
use warnings;
use JSON::PP;

my ($json, $text) = map { local $/; open(my $in, '<', $_) or die "$_: $!\n"; <$in> } @ARGV;
my $root = decode_json($json);
my @row = @{$root->{rows}};
my $failed = 0;
sub bad { print "FAILED  @_\n"; $failed++ }

my @builders = ('gpu_lbvh30', 'gpu_lbvh63', 'gpu_hploc');
my %triangles = ('sphere:n=12' => 8 * 12 ** 2, 'soup:n=0' => 0, 'soup:n=1' => 1, 'soup:n=777,seed=3' => 777);
bad(scalar(@row) . ' rows') if @row != @builders * keys %triangles;
bad("exit $root->{exit}") if $root->{exit} != 0;
bad('the device is not the one printed') if index($text, "device: $root->{device}") != 0;
my @lines = grep { /^(equal|DIFFERS) / } split /\n/, $text;
my @printed = grep { !/ (wide|words) / } @lines;
bad(scalar(@printed) . ' lines of ' . 4 * @row) if @printed != 4 * @row;
for my $i (0 .. $#row) {
    my $row = $row[$i];
    my $name = "$row->{scene}, $row->{builder}";
    bad("$name: $row->{triangles} triangles") if $row->{triangles} != $triangles{$row->{scene}};
    bad("$name: not in order") if $row->{builder} ne $builders[$i % 3];
    bad("$name: twin $row->{twin}") if "gpu_$row->{twin}" ne $row->{builder};
    bad("$name: differs") if !$row->{equal} || defined $row->{differs};
    my ($n, $blocks) = ($row->{triangles}, int(($row->{triangles} + 1023) / 1024));
    # Vertices and indices; keys twice; digits of blocks, or two links a node; six words a node and a parent a leaf;
    # boxes; the state.
    my $vertices = $row->{scene} =~ /^sphere/ ? 4 * 12 ** 2 + 2 : 3 * $n;
    my $digits = 16 * $blocks > 2 * $n ? 16 * $blocks : 2 * $n;
    my $bytes = $n ? 4 * (3 * $vertices + 3 * $n + 8 * $n + $digits + 6 * ($n - 1) + $n + 6 * (2 * $n - 1) + 19) : 0;
    bad("$name: $row->{device_bytes} bytes, not $bytes") if $row->{device_bytes} != $bytes;
    my @stage = @{$row->{stages}};
    bad("$name: stages") if join(' ', map { $_->{stage} } @stage) ne 'codes order nodes all';
    for my $k (0 .. 3) {
        my $s = $stage[$k];
        my ($verdict, $builder, $stage, $device, $c, $ratio, $span) = split ' ', $printed[4 * $i + $k];
        bad("$name, $s->{stage}: printed '$printed[4 * $i + $k]'")
            if $verdict ne 'equal' || $builder ne $row->{builder} || $stage ne $s->{stage} ||
            $device ne sprintf('%.3f', $s->{device_ms}) || $c ne sprintf('%.3f', $s->{c_ms}) || $ratio ne sprintf('%.2f', $s->{ratio}) ||
            $span ne sprintf('%.2f-%.2f', $s->{ratio_least}, $s->{ratio_most});
        bad("$name, $s->{stage}: the median is not between its ends")
            if $s->{ratio} < $s->{ratio_least} || $s->{ratio} > $s->{ratio_most};
        if ($root->{rounds} == 1) { # of one round all is known
            my $sum = sub { my $sum = 0; $sum += $_->{$_[0]} for @stage[0 .. 2]; $sum };
            for my $side ('device_ms', 'c_ms') {
                bad("$name: all is not the sum of $side") if $k == 3 && abs($s->{$side} - $sum->($side)) > 1e-9;
            }
            my $of = $s->{c_ms} > 0 ? $s->{device_ms} / $s->{c_ms} : 0;
            bad("$name, $s->{stage}: ratio $s->{ratio} of $of") if abs($s->{ratio} - $of) > 1e-9 * $of;
        }
        next if $n < 700;
        bad("$name, $s->{stage}: no time") if $s->{device_ms} <= 0 || $s->{c_ms} <= 0;
        # Of three rounds the median of ratios lies between the ratios of the ends, which are not known; the ratio of the
        # medians is at most as far off as the rounds are from each other.
        my $of = $s->{device_ms} / $s->{c_ms};
        bad("$name, $s->{stage}: ratio $s->{ratio} of $of") if $of < 0.2 * $s->{ratio_least} || $of > 5 * $s->{ratio_most};
    }
}

# Wide trees: of each scene, builder and layout.
my @printed_wide = grep { / (wide|words) / } @lines;
my @wide = @{$root->{wide}};
my %of = (cwbvh80 => [3, 20], tiny8 => [4, 16]); # triangles of a leaf, words of a record
my @layouts = ('cwbvh80', 'tiny8');
bad(scalar(@wide) . ' wide trees') if @wide != 2 * @row;
bad(scalar(@printed_wide) . ' lines of ' . 2 * @wide) if @printed_wide != 2 * @wide;
for my $i (0 .. $#wide) {
    my $wide = $wide[$i];
    my $row = $row[$i / 2];
    my $n = $row->{triangles};
    my $name = "$wide->{scene}, $wide->{builder}, $wide->{layout}";
    bad("$name: not in order") if "$wide->{scene} $wide->{builder} $wide->{layout}" ne "$row->{scene} $row->{builder} $layouts[$i % 2]";
    bad("$name: $wide->{triangles} triangles") if $wide->{triangles} != $n;
    bad("$name: differs") if !$wide->{equal} || defined $wide->{differs} || defined $wide->{refused};
    # At most so many nodes of more triangles than a leaf has, and full ones above them.
    my ($leaf, $words) = @{$of{$wide->{layout}}};
    my $lowest = int($n / ($leaf + 1));
    my $most = $n == 0 ? 0 : $lowest + int(($n - 1 - $leaf * $lowest) / 7);
    $most = 1 if $most < 1 && $n > 0;
    bad("$name: $wide->{nodes} nodes of $most") if $wide->{nodes} > $most || $wide->{nodes} < $n / (8 * $leaf);
    my $bytes = 4 * (($words + 16) * $most + $n);
    bad("$name: $wide->{device_bytes} bytes, not $bytes") if $wide->{device_bytes} != $bytes;
    my @stage = @{$wide->{stages}};
    bad("$name: stages") if join(' ', map { $_->{stage} } @stage) ne 'wide words';
    for my $k (0 .. 1) {
        my $s = $stage[$k];
        my @want = ('equal', $wide->{builder}, $wide->{layout}, $s->{stage}, sprintf('%.3f', $s->{device_ms}),
            sprintf('%.3f', $s->{c_ms}), sprintf('%.2f', $s->{ratio}), sprintf('%.2f-%.2f', $s->{ratio_least}, $s->{ratio_most}));
        bad("$name, $s->{stage}: printed '$printed_wide[2 * $i + $k]'") if join(' ', split ' ', $printed_wide[2 * $i + $k]) ne "@want";
        bad("$name, $s->{stage}: the median is not between its ends") if $s->{ratio} < $s->{ratio_least} || $s->{ratio} > $s->{ratio_most};
        my $ratio = $s->{c_ms} > 0 ? $s->{device_ms} / $s->{c_ms} : 0;
        bad("$name, $s->{stage}: ratio $s->{ratio} of $ratio") if $root->{rounds} == 1 && abs($s->{ratio} - $ratio) > 1e-9 * $ratio;
        bad("$name, $s->{stage}: no time") if $n >= 700 && ($s->{device_ms} <= 0 || $s->{c_ms} <= 0);
    }
}
print "build rows: $failed failed\n";
exit($failed > 0);
