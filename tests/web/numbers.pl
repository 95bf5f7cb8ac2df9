#!/usr/bin/perl
# A second reading of a page of raydiff web, against the file of the finding and against the page itself: rays and
# triangles to the bit, the words that the browser's graphics card gets, what C answers on them, what is right, and every
# number that is shown. Prints what differs; exit 1 if there is anything.
#   perl tests/web/numbers.pl PAGE.html [FILE.trial]      without a file, of a scene: the page against itself
use strict;
use warnings;
use JSON::PP;
use MIME::Base64;
use POSIX ();

my ($page, $file) = @ARGV;
my $bad = 0;
sub bad { print "$page: $_[0]\n"; $bad = 1 }
sub same { my ($what, $got, $want) = @_; bad("$what is $got, not $want") if $got ne $want }

sub slurp { local $/; open my $in, '<', $_[0] or die "$_[0]: $!\n"; <$in> }
sub bits { unpack 'V', pack 'f<', $_[0] }
sub float { unpack 'f<', pack 'V', $_[0] }
sub words { unpack 'V*', decode_base64($_[0]) }

# --- the file ---------------------------------------------------------------------------------------------------------
sub number { # of the file, as bits
    my $text = shift;
    return hex $1 if $text =~ /^nan:0x([0-9a-f]+)$/i;
    return bits($text eq 'inf' ? 9**9**9 : -9**9**9) if $text =~ /^-?inf$/;
    my ($value) = POSIX::strtod($text);
    return bits($value);
}
my (@vertex, @triangle, @ray, %line, $list, $left);
for (split /\n/, defined $file ? slurp($file) : '') {
    s/#.*// unless /^(recipe|with) /;
    next unless /\S/;
    my @word = split;
    if ($left) {
        push @$list, [@word];
        $left--;
    } elsif ($word[0] =~ /^(vertices|triangles|rays)$/) {
        ($list, $left) = ({ vertices => \@vertex, triangles => \@triangle, rays => \@ray }->{$1}, $word[1]);
    } else {
        $line{$word[0]} = join ' ', @word[1 .. $#word];
    }
}
my @corners = map { map { map { number($_) } @{ $vertex[$_] } } @$_ } @triangle;
# In memory tmin stands behind the origin and tmax behind the direction.
my @rays = map { my @n = map { number($_) } @$_; @n[0, 1, 2, 6, 3, 4, 5, 7] } @ray;

# --- the page ---------------------------------------------------------------------------------------------------------
my $html = slurp($page);
my ($text) = $html =~ m{<script type="application/json" id="data">\s*(.*?)\s*</script>}s or die "$page: no data\n";
my $data = JSON::PP->new->allow_nonref->decode($text);
my $e = $data->{explained};
bad('data have characters of HTML') if $text =~ /[<>&]/;
my @shown_rays = words($data->{rays});
my $index = $e->{subject}{index};
if (!defined $file) {
    @rays = ((0) x (8 * $data->{first}), @shown_rays);
    @corners = words($data->{triangles});
    @triangle = (1) x (@corners / 9);
    %line = (expect => 'clean', tri => $e->{subject}{tri}, query => $e->{subject}{query}, builder => $e->{subject}{builder});
    @ray = (1) x ($html =~ m{; ray \d+ of (\d+), })[0];
}
same('number of the ray', $data->{first} + $data->{shown}, $index);
same('rays', "@shown_rays", join ' ', @rays[8 * $data->{first} .. 8 * $data->{first} + $#shown_rays]);
same('triangles', join(' ', words($data->{triangles})), "@corners");
same('ray of the explanation', join(' ', map { hex $_->{bits} } @{ $e->{origin} }, $e->{tmin}, @{ $e->{direction} }, $e->{tmax}),
    "@rays[8 * $index .. 8 * $index + 7]");
if ($line{expect} ne 'clean') {
    same('signature', ($html =~ m{<code id="signature">(.*?)</code>})[0] // '', $line{expect});
    my ($engine, $layout) = split /\./, $line{expect};
    same('engine', $e->{subject}{engine}, $engine);
    same('layout', $e->{subject}{layout} // '-', $layout);
}
same('triangle test', $e->{subject}{tri}, $line{tri});
same('query', $e->{subject}{query}, $line{query});

# --- what is shown ----------------------------------------------------------------------------------------------------
sub shown { my ($what, $want) = @_; bad("no $what: $want") if index($html, $want) < 0 }
sub g9 { my $x = float($_[0]); my $t = sprintf '%.9g', $x; $t =~ s/^Inf/inf/; $t =~ s/^-Inf/-inf/; $t = ($_[0] >> 31 ? '-' : '') . 'nan' if $x != $x; $t }
my @r = @rays[8 * $index .. 8 * $index + 7];
my $nan = grep { my $x = float($_); $x != $x } @r;
shown('ray', sprintf 'from (%s, %s, %s) along (%s, %s, %s), t from %s to %s', map { g9($_) } @r[0, 1, 2, 4, 5, 6, 3, 7]) unless $nan;
shown('number of triangles', sprintf '; ray %d of %d, %d triangles', $index, scalar @ray, scalar @triangle);
my $answer = $e->{answer};
if ($e->{finished} && defined $answer->{prim}) {
    shown('answer', sprintf 'Answer: triangle %d at t = %s (', $answer->{prim}, g9(hex $answer->{t}{bits}));
} elsif ($e->{finished}) {
    shown('answer', 'Answer: a miss');
}
if ($e->{judgement}{verdict} eq 'wrong') { shown('verdict', "WRONG: $e->{judgement}{wrong}") }
shown('cause', "Cause: $e->{cause}, ") if $e->{cause} ne 'none';
shown('exact hit', sprintf 'Truth: triangle %d at t in [%.17g, %.17g]', @{ $e->{truth} }{qw(prim t_lo t_hi)})
    if defined $e->{truth}{prim};

# --- what is right ----------------------------------------------------------------------------------------------------
my @rights = map { { ray => $_->[0], prim => $_->[1], range => [map { float($_) } @{$_}[2 .. 7]] } } do {
    my @w = words($data->{rights});
    map { [@w[8 * $_ .. 8 * $_ + 7]] } 0 .. @w / 8 - 1;
};
sub is_right {
    my ($ray, $prim, @v) = @_; # v: t, u, v
    my @of = grep { $_->{ray} == $ray } @rights;
    return 1 unless @of;
    for my $right (grep { $_->{prim} == $prim } @of) {
        return 1 if $prim == 0xFFFFFFFF;
        return 1 unless grep { !($v[$_] >= $right->{range}[2 * $_] && $v[$_] <= $right->{range}[2 * $_ + 1]) } 0 .. 2; # NaN is none
    }
    return 0;
}
# An exact hit is right. What the judge allows of an engine, WGSL's bounds, which are wider than C's, allow too; what is
# WRONG is wrong by them but for a hit so near an edge that WGSL may miss it, which is told.
my ($exact) = grep { $_->{ray} == $data->{shown} && $_->{prim} == ($e->{truth}{prim} // -1) } @rights;
bad('the exact hit is not right') if defined $e->{truth}{prim} && grep({ $_->{ray} == $data->{shown} } @rights) &&
    !($exact && $exact->{range}[0] <= $e->{truth}{t_hi} && $exact->{range}[1] >= $e->{truth}{t_lo});
if ($e->{finished} && $e->{subject}{engine} =~ /^(cpu|embree)/) {
    my $prim = $answer->{prim} // 0xFFFFFFFF;
    my $right = is_right($data->{shown}, $prim, map { float(hex($answer->{$_}{bits} // '0x0')) } qw(t u v));
    my $wrong = $e->{judgement}{verdict} eq 'wrong';
    bad('the judge allows what the list does not') if !$wrong && !$right;
    print "looser $page\n" if $wrong && $right;
}

# --- what the graphics card gets --------------------------------------------------------------------------------------
my %file_of = (f32 => 'layout_f32', rf16 => 'layout_rf16', cwbvh80 => 'layout_cwbvh80', rtrs_direct => 'layout_rtrs_direct',
    rtrs_rf => 'layout_rtrs_rf', rtrs_rf_paper => 'layout_rtrs_rf_paper');
my %quads = (f32 => 2, rf16 => 1, cwbvh80 => 5, rtrs_direct => 3, rtrs_rf => 1, rtrs_rf_paper => 1);
same('the first layout', $data->{jobs}[0]{layout}, defined $e->{subject}{layout} ?
    $e->{subject}{layout} . (($e->{subject}{store} // 'indexed') eq 'indexed' ? '' : ":$e->{subject}{store}") : 'f32');
my $last = $data->{jobs}[-1];
same('the last layout', $last->{layout}, 'f32');
for my $job (@{ $data->{jobs} }) {
    my $layout = $job->{layout};
    if (!defined $job->{words}) {
        bad("$layout: neither words nor a reason") unless $job->{why};
        next;
    }
    my @w = words($job->{words});
    my ($bytes, $nodes, $items, $floats, $into, $out, undef, undef, undef, $root, $refs, $item_count, $tris) = @w;
    my $code = substr decode_base64($job->{words}), 64, $bytes;
    same("$layout: words of a ray and of an answer", "$into $out", '8 5');
    same("$layout: triangles", $tris, scalar @triangle);
    same("$layout: items", $item_count, $items);
    bad("$layout: not the text of its layout") if index($code, slurp("shaders/wgsl/$file_of{$layout}.wgsl")) < 0;
    same("$layout: const QUERY", ($code =~ /const QUERY = (\d)u;/)[0], $line{query} eq 'any' ? 1 : 0);
    my $at = 16 + int(($bytes + 3) / 4);
    my @node = @w[$at .. $at + $nodes - 1];
    same("$layout: corners", join(' ', @w[$at + $nodes + $items .. $#w]), "@corners");
    # The records on the way are those of the explanation, where that is about this layout.
    if (($e->{subject}{layout} // '') eq $layout && ($e->{subject}{store} // 'indexed') eq 'indexed') {
        for my $step (@{ $e->{way} }) {
            next unless defined $step->{record};
            my $from = 4 * $quads{$layout} * $step->{record};
            my $want = join ' ', @{ $step->{words} };
            my $got = join ' ', map { sprintf '%08x', $_ } @node[$from .. $from + $#{ $step->{words} }];
            same("$layout: record $step->{record}", $got, $want);
        }
    }
    # The root of f32 holds every triangle, and its items are all of them.
    if ($layout eq 'f32' && $nodes && $line{builder} !~ /^rtrs /) { # that one cuts boxes
        for my $k (0 .. 2) {
            my @x = map { float($corners[3 * $_ + $k]) } 0 .. @corners / 3 - 1;
            my ($lo, $hi) = (float($node[8 * $root + $k]), float($node[8 * $root + 4 + $k]));
            bad("f32: a triangle is outside of the root") if grep { $_ < $lo || $_ > $hi } @x;
        }
        my %in = map { $_ => 1 } @w[$at + $nodes .. $at + $nodes + $items - 1];
        bad('f32: a triangle is no item') if grep { !$in{$_} } 0 .. $#triangle;
    }
    # C's answer to the ray, where the page explains C's on this layout.
    if (defined $job->{answers} && $e->{finished} && $e->{subject}{engine} eq 'cpu' && ($e->{subject}{layout} // '') eq $layout) {
        my @c = (words($job->{answers}))[4 * $data->{shown} .. 4 * $data->{shown} + 3];
        my @want = defined $answer->{prim} ? ((map { hex $answer->{$_}{bits} } qw(t u v)), $answer->{prim}) : (0, 0, 0, 0xFFFFFFFF);
        same("$layout: C's answer", "@c", "@want");
    }
}
exit $bad;
