# Writes acceleration structures as RADV of Mesa 25.0 serialises them, from lines; an encoder of our own, from the
# description in ref/dump/radv.h.
#   perl tests/driver_trees/encode_radv.pl <LINES >FILE
#   driver TEXT, build TEXT          the UUIDs of the structures that follow
#   handles H...                     begins a structure; a top level if there are any, one for each instance
#   head X0 Y0 Z0 X1 Y1 Z1           its bounds
#   box A X0 Y0 Z0 X1 Y1 Z1 B ...    a box of floats, up to four children: bN a box, lN a leaf, =N the word itself
#   half A X0 Y0 Z0 X1 Y1 Z1 B ...   a box of halves, whose bounds are 0 or powers of two with a sign
#   tri G N X0 Y0 Z0 X1 .. Z2        a leaf: triangle N of geometry G
#   instance N MASK CUSTOM M00 .. M23
use strict;
use warnings;
no warnings 'portable';
binmode STDOUT;
my ($driver, $build, @levels) = ('AMD-MESA-DRV', 'a build');
while (<STDIN>) {
    my ($word, @rest) = split;
    next unless defined $word;
    if ($word eq 'driver') { $driver = $rest[0]; next }
    if ($word eq 'build') { $build = $rest[0]; next }
    if ($word eq 'handles') {
        push @levels, {driver => $driver, build => $build, handles => [map { hex } @rest], box => [], leaf => []};
        next;
    }
    my $level = $levels[-1];
    if ($word eq 'head') { $level->{head} = [@rest] }
    elsif ($word eq 'box' || $word eq 'half') { push @{$level->{box}}, {kind => $word, words => [@rest]} }
    elsif ($word eq 'tri') { push @{$level->{leaf}}, pack 'f<9 V7', @rest[2 .. 10], 0, 0, 0, $rest[1], $rest[0] | 1 << 31, 0, 9 }
    elsif ($word eq 'instance') {
        my ($number, $mask, $custom, @m) = @rest;
        # The way back is not checked: zeros.
        push @{$level->{leaf}}, {words => pack('V2 f<12 V', $custom | $mask << 24, 1 << 30, (0) x 12, $number), m => pack 'V2 f<12', 0, 0, @m};
    } else { die "line $.: $word\n" }
}
sub half {
    my $x = shift;
    my $sign = $x =~ /^-/ ? 0x8000 : 0;
    return $sign | 0x7C00 if $x =~ /inf/;
    return 0x7E00 if $x =~ /nan/;
    return $sign if $x == 0;
    return $sign | (15 + int(log(abs $x) / log(2) + ($x * $x < 1 ? -0.5 : 0.5))) << 10;
}
for my $level (reverse @levels) {
    my $top = @{$level->{handles}} > 0;
    my $leaf = $top ? 128 : 64;
    # Structures below come in the order in which their handles first do.
    my ($below, %begins) = (1);
    for my $handle (@{$level->{handles}}) {
        $begins{$handle} //= $below < @levels ? $levels[$below++]{nodes} : 192;
    }
    my ($at, @offset) = (128 + $leaf * @{$level->{leaf}}, 0);
    for (my $i = 1; $i < @{$level->{box}}; $i++) {
        push @offset, $at;
        $at += $level->{box}[$i]{kind} eq 'box' ? 128 : 64;
    }
    my $nodes = int((104 + $at / 16 + 63) / 64) * 64;
    my $size = $nodes + $at;
    my $child = sub {
        my ($name, $from) = @_;
        return $1 if $name =~ /^=(\d+)$/;
        my $word = $name =~ /^b(\d+)$/ ? $offset[$1] >> 3 | ($level->{box}[$1]{kind} eq 'box' ? 5 : 4)
            : $name =~ /^l(\d+)$/ ? (128 + $leaf * $1) >> 3 | ($top ? 6 : 0) : die "child $name\n";
        return $word;
    };
    my @box;
    for my $box (@{$level->{box}}) {
        my @words = @{$box->{words}};
        my ($children, $bounds) = ('', '');
        for (my $k = 0; $k < 4; $k++) {
            my ($name, @b) = @words ? splice @words, 0, 7 : ('=4294967295', ('nan') x 6);
            $children .= pack 'V', $child->($name);
            $bounds .= $box->{kind} eq 'box' ? pack 'f<6', @b : pack 'v6', map { half($_) } @b;
        }
        push @box, $children . $bounds . ($box->{kind} eq 'box' ? "\0" x 16 : '');
    }
    my $leaves = '';
    for my $i (0 .. $#{$level->{leaf}}) {
        my $words = $level->{leaf}[$i];
        my $handle = $level->{handles}[$i];
        $leaves .= $top ? pack('Q<', ($handle + $begins{$handle}) >> 3 & (1 << 45) - 1) . $words->{words}
            . pack('V', $begins{$handle}) . $words->{m} : $words;
    }
    my $heads = 56 + 8 * @{$level->{handles}};
    my $all = $size + int(($heads + 127) / 128) * 128;
    my $head = pack 'V2 f<6 Q<2 V4 Q< V2 Q<2 V2', $nodes, 0, @{$level->{head}}, $size, $all, 1, 1, 1, 0, $all - $heads, 1, 0,
        $nodes + 128, scalar @{$level->{handles}}, 0, 0;
    $level->{bytes} = pack('a16 a16 Q<3 Q<*', $level->{driver}, $level->{build}, $all, $size, scalar @{$level->{handles}},
        @{$level->{handles}}) . $head . "\0" x ($nodes - length $head) . $box[0] . $leaves . join('', @box[1 .. $#box]);
    $level->{bytes} .= "\0" x ($all - length $level->{bytes});
    $level->{nodes} = $nodes;
}
print $_->{bytes} for @levels;
