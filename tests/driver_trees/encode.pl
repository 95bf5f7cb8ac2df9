# Writes acceleration structures as lavapipe of Mesa 25.0 serialises them, from lines; an encoder of our own, from the
# description in ref/dump/lavapipe.h.
#   perl tests/driver_trees/encode.pl <LINES >FILE
#   uuid TEXT                        of the structures that follow; 25.0.7-1 at first
#   handles H...                     begins a structure; a top level if there are any
#   head X0 Y0 Z0 X1 Y1 Z1           its bounds
#   box A X0 Y0 Z0 X1 Y1 Z1 B ...    a box with its two children: bN a box, lN a leaf, - none, =N the word itself
#   tri G N X0 Y0 Z0 X1 .. Z2        a leaf: triangle N of geometry G
#   instance N H MASK CUSTOM M00 .. M23
#   room N                           N bytes of room behind the leaves
use strict;
use warnings;
binmode STDOUT;
my ($uuid, @levels) = ('25.0.7-1');
while (<STDIN>) {
    my ($word, @rest) = split;
    next unless defined $word;
    if ($word eq 'uuid') { $uuid = $rest[0]; next }
    if ($word eq 'handles') { push @levels, {uuid => $uuid, handles => [map { hex } @rest], box => [], leaf => [], room => 0}; next }
    my $level = $levels[-1];
    if ($word eq 'head') { $level->{head} = [@rest] }
    elsif ($word eq 'box') { push @{$level->{box}}, [@rest] }
    elsif ($word eq 'room') { $level->{room} = $rest[0] }
    elsif ($word eq 'tri') { push @{$level->{leaf}}, pack 'f<9 V3', @rest[2 .. 10], 0, $rest[1], $rest[0] | 1 << 31 }
    elsif ($word eq 'instance') {
        my ($number, $handle, $mask, $custom, @m) = @rest;
        # The way back is not checked: zeros.
        push @{$level->{leaf}}, pack 'Q< V2 f<12 V2 f<12', hex $handle, $custom | $mask << 24, 1 << 30, (0) x 12, 0, $number, @m;
    } else { die "line $.: $word\n" }
}
for my $level (@levels) {
    my $top = @{$level->{handles}} > 0;
    my $leaves = 40 + 56 * @{$level->{box}};
    my $child = sub {
        my $name = shift;
        return 0xFFFFFFFF if $name eq '-';
        return $1 if $name =~ /^=(\d+)$/;
        return 40 + 56 * $1 | 1 if $name =~ /^b(\d+)$/;
        return $leaves + ($top ? 120 : 48) * $1 | ($top ? 2 : 0) if $name =~ /^l(\d+)$/;
        die "child $name\n";
    };
    my $boxes = join '', map { pack 'f<12 V2', @{$_}[1 .. 6, 8 .. 13], $child->($_->[0]), $child->($_->[7]) } @{$level->{box}};
    my $body = $boxes . join('', @{$level->{leaf}}) . "\0" x $level->{room};
    my $handles = pack 'Q<*', @{$level->{handles}};
    my $size = 56 + length($handles) + 40 + length $body;
    print pack('a16 a16 Q<3', $level->{uuid}, $level->{uuid}, $size, 40 + length $body, scalar @{$level->{handles}}), $handles,
        pack('f<6 V4', @{$level->{head}}, $size, scalar @{$level->{handles}}, $leaves, 0), $body;
}
