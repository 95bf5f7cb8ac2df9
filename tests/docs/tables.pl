#!/usr/bin/perl
# Tables of measurements in the documents against the recorded files of bench/results, cell by cell: a number is what
# is recorded, in as many digits as it is shown. perl tests/docs/tables.pl [--each]
# --each: with a changed digit in each row in turn, too, which must be noticed.
use strict;
use warnings;
my $docs = 'docs';
my $each = @ARGV && $ARGV[0] eq '--each';
my %changed = (page => '', row => 0); # its last digit is another
my $results = 'bench/results/lavapipe-22.3.6';
my ($cells, $wrong, %table) = (0, 0);

sub bad { print "FAILED  @_\n" if ++$wrong <= 20 }

my %csv;
# Rows of a CSV as hashes; a head begins with "benchmark".
sub csv {
    my ($name) = @_;
    my (@rows, @head);
    return @{$csv{$name}} if $csv{$name};
    open my $in, '<', "$results/$name" or die "$name: $!\n";
    while (<$in>) {
        chomp;
        my @field;
        while (/\G(?:"((?:[^"]|"")*)"|([^,]*))(?:,|$)/g) {
            push @field, $1 // $2;
            last if pos == length;
        }
        if ($field[0] eq 'benchmark') { @head = @field; next }
        my %row;
        @row{@head} = @field;
        push @rows, \%row;
    }
    $csv{$name} = \@rows;
    return @rows;
}
# The one row that has these values.
sub one {
    my ($rows, %want) = @_;
    my @found = @$rows;
    for my $key (keys %want) {
        @found = grep { ($_->{$key} // '') eq $want{$key} } @found;
    }
    bad(scalar(@found) . ' rows of ' . join(', ', map {"$_=$want{$_}"} sort keys %want)) if @found != 1;
    return $found[0] // {};
}
# Rows of the table below a head in a page, cells without markup; the first is the key.
sub rows_of {
    my ($page, $head) = @_;
    my (@rows, $on);
    open my $in, '<', "$docs/$page" or die "$docs/$page: $!\n";
    while (<$in>) {
        s/(\d)(?=\D*$)/($1 + 5) % 10/e if $page eq $changed{page} && $. == $changed{row};
        if (index($_, $head) == 0) { $on = 1; next }
        next if !$on || /^\|[-|: ]+$/;
        last if !/^\|/;
        s/`//g;
        my @cell = map { s/^\s+|\s+$//gr } split /\|/;
        shift @cell;
        pop @cell if $cell[-1] eq '';
        push @rows, \@cell;
    }
    bad("docs/$page: no table '$head'") if !@rows;
    return @rows;
}
# Each row with a fraction, but that of frames of two lines, which is not recorded.
sub rows_with_fractions {
    my ($page) = @_;
    open my $in, '<', "$docs/$page" or die "$docs/$page: $!\n";
    my @rows;
    while (<$in>) { push @rows, $. if /^\| .*[0-9]\.[0-9]/ && !/another look/ }
    return @rows;
}
# Returns in a process for each such row, with its digit changed, and at last in this one, with none.
sub in_turn {
    my ($count, $missed) = (0, 0);
    csv(s{.*/}{}r) for glob "$results/*.csv";
    for my $page ('results.md', 'errors.md', 'paper.md') {
        for my $row (rows_with_fractions($page)) {
            my $child = fork // die "tables: fork: $!\n";
            if (!$child) {
                %changed = (page => $page, row => $row);
                open STDOUT, '>', '/dev/null';
                return;
            }
            waitpid $child, 0;
            $count++;
            next if $? == 256; # told, not dead
            print "FAILED  $docs/$page:$row: a changed digit is not noticed\n";
            $missed++;
        }
    }
    print "tables: $count rows changed by a digit\n";
    exit 1 if $missed || $count < 90;
}
in_turn() if $each;

# A number as it is shown.
sub shown {
    my ($place, $text, $is) = @_;
    $cells++;
    (my $plain = $text // '') =~ tr/,//d;
    return bad("$place: nothing recorded, shown $plain") if !defined $is || $is eq '';
    my $good = 0;
    if ($plain =~ /^<?(\d+)\.?(\d*)$/) {
        my $digits = length $2;
        $good = grep { sprintf("%.${digits}f", $is * $_) eq $plain =~ s/<//r } 1, 1 + 2e-9, 1 - 2e-9;
    } elsif ($plain =~ /^\d(\.\d+)?e/ || $plain =~ /^0?\.\d+$/) {
        my $digits = length($1 // '') ? length($1) : 1;
        $good = sprintf("%.${digits}g", $is) == $plain;
    }
    $good ||= abs($is) < 1e-3 && $plain =~ /^\d/ && sprintf('%.2g', $is) == $plain;
    bad("$place: shown $text, recorded $is") if !$good;
}
# "1.32 (0.97-1.88)"
sub spread {
    my ($place, $text, $median, $least, $most) = @_;
    my ($m, $l, $h) = $text =~ /^([\d.]+) \(([\d.]+)-([\d.]+)\)$/ or return bad("$place: no spread: $text");
    shown("$place, median", $m, $median);
    shown("$place, least", $l, $least);
    shown("$place, most", $h, $most);
}
# Per million of so many; "<91.6" is none.
sub per_million {
    my ($place, $text, $events, $of) = @_;
    return bad("$place: of nothing") if !$of;
    my $rate = 1e6 * ($events > 0 ? $events : 3) / $of;
    bad("$place: shown $text, of $events events") if ($text =~ /^</ ? 1 : 0) != ($events == 0 ? 1 : 0);
    shown($place, $text =~ s/^<//r, $text =~ /\./ || $rate >= 999.5 ? $rate : sprintf '%.3g', $rate);
}

my @matrix = csv('matrix.csv');
sub scene { return "scenes/fetched/$_[0].ply.gz" }
my @kinds = qw(prim rand diff o-shad o-rand);
for my $row (rows_of('results.md', '| contestant | dragon-11k')) {
    my ($name, @cell) = @$row;
    my $col = 0;
    for my $mesh (qw(dragon-11k dragon-203k dragon-871k)) {
        my @two = split /, /, $cell[$col++];
        my $is = sub { one(\@matrix, name => $name, scene => scene($mesh), threads => $_[0]) };
        shown("$name, $mesh, $_ of one thread", shift @two, $is->(1)->{$_}) for qw(mean_ratio mean_warm);
        shown("$name, $mesh, $_ of two threads", shift @two, $is->(2)->{$_}) for qw(mean_ratio mean_warm);
    }
    my $is = one(\@matrix, name => $name, scene => scene('dragon-203k'), threads => 1);
    shown("$name, $_", $cell[$col++], $is->{$_}) for qw(bytes_per_triangle lost leaks);
}
for my $row (rows_of('results.md', '| contestant | `prim`')) {
    my ($name, @cell) = @$row;
    my $is = one(\@matrix, name => $name, scene => scene('dragon-203k'), threads => 1);
    spread("$name, $_", shift @cell, @$is{"${_}_ratio", "${_}_ratio_min", "${_}_ratio_max"}) for @kinds;
}
for my $row (rows_of('results.md', '| contestant | nodes')) {
    my ($name, @cell) = @$row;
    my $is = one(\@matrix, name => $name, scene => scene('dragon-203k'), threads => 1);
    shown("$name, $_ a triangle", shift @cell, $is->{"${_}_bytes"} / ($is->{triangles} || 1)) for qw(node item scene);
    for my $kind (qw(prim diff)) {
        shown("$name, $kind $_", shift @cell, $is->{"${kind}_$_"}) for qw(line_bytes beyond_l1 beyond_l2);
    }
}
my @gpu = csv('matrix-vulkan.csv');
for my $row (rows_of('results.md', '| layout | dragon-11k')) {
    my ($name, @cell) = @$row;
    my $is = one(\@gpu, name => "vulkan $name", scene => scene('dragon-11k'));
    shown("$name, dragon-11k", $cell[0], $is->{mean_ratio});
    if ($cell[1] ne '-') {
        $is = one(\@gpu, name => "vulkan $name", scene => scene('dragon-203k'));
        shown("$name, dragon-203k", $cell[1], $is->{mean_ratio});
    }
    spread("$name, prim", $cell[2], @$is{qw(prim_ratio prim_ratio_min prim_ratio_max)});
    shown("$name, nodes", $cell[3], $is->{node_bytes} / ($is->{triangles} || 1));
    shown("$name, prim reads", $cell[4], $is->{prim_line_bytes});
    shown("$name, diff reads", $cell[5], $is->{diff_line_bytes});
    bad("$name loses rays") if $is->{lost} || $is->{leaks};
}
# The text of bench fast: one thread, then two. Of a kind [ratio, least, most]; of a mean [in turns, warm].
my (%fast, $mesh, $threads);
open my $in, '<', "$results/fast.txt" or die "fast.txt: $!\n";
while (<$in>) {
    my $spread = qr/([\d.]+) \(([\d.]+)-([\d.]+)\)/;
    $threads = $1 if /^fast: (\d) thread/;
    $mesh = $1 if m{^scenes/fetched/(\S+)\.ply};
    my $name = length > 26 ? substr($_, 10, 16) =~ s/ +$//r : '';
    $fast{$threads, $mesh, $1, $name} = [$2, $3, $4] if /^  (primary|random|bounce|shadow) .{17} +[\d.]+ +$spread +[\d.]+ +$spread$/;
    $fast{$threads, $mesh, 'mean', $name} = [$1, $2] if /^  mean    .{16} +([\d.]+) +([\d.]+)$/;
    $fast{$threads, $mesh, 'bytes', $1} = $2 if /^  (\S+(?: \S+)?) +([\d.]+) +\d+  \S/;
}
for my $row (rows_of('results.md', '| scene | engine | primary')) {
    my ($of, $name, @cell) = @$row;
    for my $kind (qw(primary random bounce shadow)) {
        my $is = $fast{1, $of, $kind, $name} or bad("$of, $name, $kind is not recorded"), next;
        my $text = shift @cell;
        $cells += 3;
        $text eq "$is->[0] ($is->[1]-$is->[2])" or bad("$of, $name, $kind: shown $text, recorded @$is");
    }
    for ([1, 0], [1, 1], [2, 0], [2, 1]) {
        my ($text, $is) = (shift @cell, $fast{$_->[0], $of, 'mean', $name}[$_->[1]] // 'nothing');
        $cells++;
        $text eq $is or bad("$of, $name, mean of $_->[0] threads: shown $text, recorded $is");
    }
    shown("$of, $name, bytes", shift @cell, $fast{1, $of, 'bytes', $name});
}

my @error = csv('error.csv');
for my $row (rows_of('errors.md', '| contestant | speed')) {
    my ($name, @cell) = @$row;
    my ($engine, $layout, $tri) = split / /, $name;
    my $is = one(\@error, scene => scene('dragon-11k'), rays => 'edges', engine => $engine, $tri ? (layout => $layout, tri => $tri) : ());
    spread("$name, speed", shift @cell, @$is{qw(ratio_median ratio_min ratio_max)});
    per_million("$name, $_", shift @cell, $is->{$_}, $is->{compared}) for qw(lost phantom wrong_id);
    per_million("$name, $_ leaks", shift @cell, $is->{"${_}_leaks"}, $is->{"${_}_rays"}) for qw(edge vertex);
    shown("$name, $_", shift @cell, $is->{$_}) for qw(named wrong err_over_bound);
}
my @spawn = csv('spawn.csv');
for my $row (rows_of('errors.md', '| point and rule')) {
    my ($name, @cell) = @$row;
    my ($point, $rule) = split / /, $name;
    my $is = sub { one(\@spawn, scene => 'soup:n=400,size=0.7', scale => '0.001', far => 0, point => $point, rule => $rule, engine => $_[0]) };
    shown("$name, $_", shift @cell, $is->('exact')->{$_}) for qw(moved_p50 moved_max);
    per_million("$name, self of $_", shift @cell, $is->($_)->{self}, $is->($_)->{hits}) for 'exact', 'cpu mt', 'cpu woop', 'embree_robust';
    per_million("$name, skip", shift @cell, $is->('exact')->{skipped}, $is->('exact')->{hits});
}
# What a row of the paper's table has: the median of lines, the ratio of one, or its inverse.
my %paper = (
    'published: direct, leaf 2' => [ms => 'direct, leaf 2'],
    'published: RF, leaf 4' => [ms => 'RF, leaf 4'],
    'direct to RF (the paper: 1.217, 1.205)' => [ratio => 'direct, leaf 2'],
    'the layout alone: direct to RF on the same tree, leaf 4' => [ratio => 'direct, leaf 4'],
    'the naive handler, which the paper does not time' => [ms => 'naive'],
    'naive to RF' => [ratio => 'naive'],
    'blank frame' => [ms => 'blank'],
    'Embree, published look, rays alone' => [ms => 'embree, published look'],
    'pixels of 110,592 that the box test that culls alone gets wrong, direct and RF' => [pixels => 'direct, leaf 2, culling', 'RF, leaf 4, culling'],
    'repaired: f32, leaf 2; rf16, leaf 4' => [ms => 'f32, leaf 2', 'rf16, leaf 4'],
    'their ratio' => [ratio => 'f32, leaf 2'],
    'the layout alone: f32 to rf16 on the same tree, leaf 4' => [ratio => 'f32, leaf 4'],
    'the same in whole paths, leaf 2' => [inverse => 'rf16, leaf 2, whole'],
    'Embree, repaired look, rays alone' => [ms => 'embree, repaired look'],
);
my @paper = grep { $_->{benchmark} eq 'paper_frames' } csv('paper.csv');
for my $row (rows_of('paper.md', '| | default scene')) {
    my ($name, @cell) = @$row;
    my $what = delete $paper{$name} or next; # the last row is of frames of two lines, which are not recorded
    my ($kind, @line) = @$what;
    for my $scene ('rtrs', 'scenes/fetched/utah-teapot.obj') {
        my $text = shift @cell;
        my @is = map { one(\@paper, scene => $scene, line => $_) } @line;
        my @ratio = @{$is[0]}{qw(ratio_median ratio_min ratio_max)};
        @ratio = map { 1 / $_ } @ratio[0, 2, 1] if $kind eq 'inverse';
        if ($kind =~ /ratio|inverse/) { spread("$name, $scene", $text, @ratio); next }
        my @part = split /[;,] /, $text;
        shown("$name, $scene", $part[$_], $is[$_]{$kind eq 'ms' ? 'median_ms' : 'pixels_wrong'}) for 0 .. $#line;
    }
}
bad("docs/paper.md has no row '$_'") for sort keys %paper;
my @special = csv('special.csv');
for my $row (rows_of('paper.md', '| scene | special ms')) {
    my ($name, @cell) = @$row;
    my $is = one(\@special, what => $name =~ s/ \(.*\)//r);
    shown("$name, special", $cell[0], $is->{special_ms});
    shown("$name, general", $cell[1], $is->{general_ms});
    spread($name, $cell[2], @$is{qw(ratio_median ratio_min ratio_max)});
}
print "tables: $cells cells, $wrong wrong\n";
exit($wrong > 0 || $cells < 500);
