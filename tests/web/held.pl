#!/usr/bin/perl
# Holds what tests/web/browse.js saw against raydiff explain by engine webgpu in Node. Prints what differs.
#   perl tests/web/held.pl SEEN.json STATE FOLDER LAYOUT...      FOLDER/node.LAYOUT.json, c.LAYOUT.json: the explanations
use strict;
use warnings;
use JSON::PP;

my ($file, $state, $folder, @layouts) = @ARGV;
my $bad = 0;
sub bad { print "$_[0]\n"; $bad = 1 }
sub same { my ($what, $got, $want) = @_; bad("$what is $got, not $want") if $got ne $want }
sub json { local $/; open my $in, '<', $_[0] or die "$_[0]: $!\n"; JSON::PP->new->allow_nonref->decode(<$in>) }

my $seen = json($file);
same('state', $seen->{gpu}{state} // 'waiting', $state);
same('layouts', join(' ', map { $_->{layout} } @{ $seen->{jobs} }), "@layouts");
my $wrong = 0;
for my $job (@{ $seen->{jobs} }) {
    my $node = json("$folder/node.$job->{layout}.json");
    my $answer = $node->{answer};
    my $want = defined $answer->{prim} ? join ' ', $answer->{prim}, map { $answer->{$_}{bits} } qw(t u v)
        : 'none 0x00000000 0x00000000 0x00000000';
    same("$job->{layout}: the browser's answer", join(' ', @{$job}{qw(prim t u v)}), $want);
    same("$job->{layout}: finished", $job->{flag}, $node->{finished} ? 1 : 0);
    same("$job->{layout}: the verdict", $job->{verdict}, $node->{judgement}{verdict} eq 'wrong' ? 'WRONG' : 'right');
    # SwiftShader flushes subnormals, and only these: told of a single ray by C's answer.
    my $c = json("$folder/c.$job->{layout}.json")->{answer};
    my $same = !grep { JSON::PP->new->canonical->encode([$c->{$_}]) ne JSON::PP->new->canonical->encode([$answer->{$_}]) } qw(prim t u v);
    same("$job->{layout}: other bits than C's", $job->{other}, $job->{rays} == 1 && !$same ? 1 : 0);
    $wrong++ if $node->{judgement}{verdict} eq 'wrong';
    bad("$job->{layout}: no rays") unless $job->{rays} > 0;
    # Five words a ray, in the line's data.
    same("$job->{layout}: words", scalar(split ' ', $job->{words}), 5 * $job->{rays});
}
same('whether the finding shows', $seen->{gpu}{state}, $wrong ? 'shows' : 'right') if @layouts;
bad("the page does not say so: $seen->{says}") if $state eq 'shows' && $seen->{says} !~ /answers WRONG: it shows the finding/;
bad("the page does not say so: $seen->{says}") if $state eq 'right' && $seen->{says} !~ /does not show/;
if ($state eq 'none') {
    bad("no reason: $seen->{says}") unless $seen->{says} =~ /^Nothing is traced here: .*WebGPU/ && $seen->{gpu}{reason};
} else {
    bad("another card: $seen->{gpu}{adapter}") unless $seen->{gpu}{adapter} =~ /swiftshader/i;
}

# The view: the hit and the corners of the node's box are where they should be.
my $view = $seen->{seen};
bad("the exact hit is not to be seen: $view->{exact} pixels") if defined $view->{exact} && $view->{exact} < 20;
bad("the node is not to be seen: $view->{away} of $view->{corners} corners")
    if defined $view->{corners} && ($view->{corners} < 2 || $view->{away} < $view->{corners});
bad('neither a hit nor a node') unless defined $view->{exact} || defined $view->{corners};
# Keys: a box up, a turn, nearer, as at first.
my ($first, $keys) = @{$seen}{qw(view keys)};
same('boxes chosen by [', $keys->{'['}{chosen}, $first->{chosen} > 0 ? $first->{chosen} - 1 : $first->{chosen});
bad('an arrow turns nothing') if $keys->{ArrowLeft}{turn} eq $first->{turn};
same('zoom after +', $keys->{'+'}{zoom}, 1.25);
same('turn after 0', $keys->{0}{turn}, $first->{turn});

# The browser asks for the page alone, and its console stays empty.
same('requests', scalar(@{ $seen->{requests} }), 1);
bad("console: $_") for grep { $state ne 'none' || !/No available adapters/ } @{ $seen->{console} };
exit $bad;
