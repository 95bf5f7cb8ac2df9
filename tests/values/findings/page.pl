#!/usr/bin/perl
# Tables of a page of `raydiff report` against the JSON that it was made of, cell by cell: the rows of raydiff check with what
# is told of each scene, the rows of raydiff bench.
#   perl page.pl PAGE CHECK.json|BENCH.json...        exit 1 where they differ
use strict;
use warnings;
use JSON::PP;

my ($page, @json) = @ARGV;
my (@wrong, $checked);

sub slurp {
    my ($path) = @_;
    open my $in, '<:raw', $path or die "$path: $!\n";
    local $/;
    return <$in>;
}

sub plain {
    my ($text) = @_;
    $text =~ s/<[^>]*>//g;
    for ($text) { s/&#10;/\n/g; s/&lt;/</g; s/&gt;/>/g; s/&quot;/"/g; s/&#39;/'/g; s/&amp;/&/g }
    return $text;
}

sub same {
    my ($what, $is, $wanted) = @_;
    $checked++;
    push @wrong, "$what: '$is', not '$wanted'" if $is ne $wanted;
}

# Cells of each row in the body of a table: text and class.
sub rows_of {
    my ($table) = @_;
    my ($body) = $table =~ /<tbody>(.*?)<\/tbody>/s;
    return map { [map { my ($class, $text) = /^<t[hd](?: class="([^"]*)")?[^>]*>(.*)$/s; [plain($text), $class // ''] } /(<t[hd][^>]*>.*?)<\/t[hd]>/gs] }
        ($body // '') =~ /<tr[^>]*>(.*?)<\/tr>/gs;
}

sub counted {
    my ($n, $one, $many) = @_;
    return "$n " . ($n == 1 ? $one : $many // "${one}s");
}

my $none = "\xE2\x80\x93";
my @classes = qw(tie near_tie boundary border in_plane slab noise out_of_contract);

# A row of check as its cells; with their classes where those tell something.
sub check_row {
    my ($name, $cells, $row) = @_;
    my $counts = $row->{counts};
    my @wanted = map { defined $row->{$_} ? $row->{$_} : $none } qw(layout engine builder tri box query);
    push @wanted, $row->{rays}, $row->{hits}, map { $counts->{$_} } @classes;
    push @wanted, defined $row->{err_over_bound} ? sprintf('%.2f', $row->{err_over_bound}) : '', $counts->{wrong};
    my %kinds = map { $_ => 1 } grep { $row->{wrong}{$_} } keys %{ $row->{wrong} };
    my $kinds = @$cells > @wanted ? $cells->[@wanted][0] : '';
    same("$name kinds", join(', ', sort split /, /, $kinds), join(', ', sort map { "$_ $row->{wrong}{$_}" } keys %kinds));
    push @wanted, $kinds, $row->{bit_differences} // 0, map { sprintf '%.3f', $row->{mrays_per_s}{$_} } qw(median min max);
    push @wanted, map { defined $row->{$_} ? sprintf('%.1f', $row->{$_} / 1000) : '' } qw(node_bytes item_bytes);
    same("$name cells", join(' | ', map { $_->[0] } @$cells), join(' | ', @wanted));
    same("$name WRONG", $cells->[17][1], !$counts->{wrong} ? 'n z' : $row->{differences} ? 'n bad' : 'n pub');
    same("$name bits", $cells->[19][1], $row->{bit_differences} ? 'n bad' : 'n z');
}

# What a cell of the matrix has of a row: its class and its text.
sub cell_of {
    my ($row) = @_;
    my $counts = $row->{counts};
    return ('none', $row->{status}) if $row->{status} =~ /^(refused|skipped)$/;
    return ('bad', $row->{status}) if $row->{status} !~ /^(ok|vacuous)$/;
    my $allowed = 0;
    $allowed += $counts->{$_} for @classes;
    my $bits = $row->{bit_differences} // 0;
    my $after = "$allowed allowed" . ($bits && $counts->{wrong} ? ", $bits bits" : '');
    return ('bad', ($counts->{wrong} ? "$counts->{wrong} WRONG" : $bits ? "$bits other bits" : 'proves nothing') . $after)
        if $row->{differences} || $row->{status} ne 'ok';
    return ('pub', "$counts->{wrong} wrong$after") if $counts->{wrong};
    return ('good', "agrees$after");
}

# Every row stands in its line and column: of an engine without a tree in all columns of its test and query.
sub matrix {
    my ($name, $table, @all) = @_;
    my ($head, $body) = $table =~ /<thead>(.*?)<\/thead>.*?<tbody>(.*?)<\/tbody>/s;
    my @columns = map { /^(\w+) hit<br\/>triangle (\S+)<br\/>box (\S+)$/ ? { query => $1, tri => $2, box => $3 } : () } $head =~ /<th>(.*?)<\/th>/gs;
    my $builders = $head =~ /<th>builder<\/th>/;
    my %met;
    for my $line ($body =~ /<tr>(.*?)<\/tr>/gs) {
        my @of = map { plain($_) } $line =~ /<th>(.*?)<\/th>/gs;
        my @cells;
        while ($line =~ /<td class="(\w+)"(?: colspan="(\d+)")?(?: title="([^"]*)")?>(.*?)<\/td>/gs) {
            my ($class, $wide, $title, $text) = ($1, $2 // 1, $3 // '', $4);
            push @cells, [$class, plain($text), plain($title)] for 1 .. $wide;
        }
        same("$name line @of: columns", scalar @cells, scalar @columns);
        for my $c (0 .. ($#cells < $#columns ? $#cells : $#columns)) {
            my ($row) = grep {
                ($_->{layout} // $none) eq $of[0] && $_->{engine} eq $of[1] && (!$builders || ($_->{builder} // '') eq $of[2]) &&
                    $_->{query} eq $columns[$c]{query} && ($_->{tri} // '-') eq $columns[$c]{tri} &&
                    (!defined $_->{box} || $_->{box} eq $columns[$c]{box})
            } @all;
            my ($class, $text) = $row ? cell_of($row) : ('none', '');
            same("$name line @of column $c", "$cells[$c][0] $cells[$c][1]", "$class $text");
            same("$name line @of column $c: reason", $cells[$c][2], $row && $row->{reason} ? $row->{reason} : '');
            $met{$row}++ if $row;
        }
    }
    # An engine with tests of its own may have several rows of one name, of which the first is shown.
    my %names = map { (join ' ', map { $_ // '-' } @{$_}{qw(layout engine builder box tri query)}) => 1 } @all;
    same("$name rows in the matrix", scalar(keys %met), scalar(keys %names));
}

sub check {
    my ($text, $json) = @_;
    my %seen;
    for my $scene (grep { !$seen{ $_->{scene} }++ } @{ $json->{scenes} }) {
        my $name = $scene->{scene};
        my ($part) = $text =~ /<div class="scene">\s*<h3>\Q$name\E<\/h3>(.*?)<\/details>/s;
        my @all = grep { $_->{scene} eq $name } @{ $json->{rows} };
        if (!defined $part) { push @wrong, "$name has no part"; next }
        my ($facts) = $part =~ /<p class="dim">(.*?)<\/p>/s;
        my $wanted = counted($scene->{triangles}, 'triangle') . ', ' . counted($scene->{vertices}, 'vertex', 'vertices') . '; ' .
            counted($scene->{count}, 'ray') . " of set $scene->{rays}";
        my ($first) = grep { defined $_->{layout} && $_->{tree}{nodes} } @all;
        $wanted .= "; tree by builder $first->{builder}: " . counted($first->{tree}{nodes}, 'node') . ', ' .
            counted($first->{tree}{leaves}, 'leaf', 'leaves') . ", depth $first->{tree}{depth}" if $first;
        same("$name facts", plain($facts // ''), $wanted);
        my (%told, @reasons);
        for my $row (grep { $_->{reason} } @all) {
            push @reasons, ($row->{engine} // $row->{layout}) . " $row->{status}: $row->{reason}" if !$told{ $row->{reason} }++;
        }
        same("$name reasons", join("\n", map { plain($_) } $part =~ /<p class="note">(.*?)<\/p>/gs), join("\n", @reasons));
        matrix($name, $part =~ /<table class="matrix">(.*?)<\/table>/s, @all);
        my @ran = grep { $_->{status} eq 'ok' || $_->{status} eq 'vacuous' } @all;
        my ($table) = $part =~ /<details>(.*)/s;
        my @rows = rows_of($table);
        same("$name rows", scalar @rows, scalar @ran);
        check_row("$name row $_", $rows[$_], $ran[$_]) for 0 .. ($#rows < $#ran ? $#rows : $#ran);
    }
}

sub value_is {
    my ($name, $is, $value) = @_;
    return same($name, $is, $none) if !defined $value;
    return same($name, $is, $value ? 'yes' : 'no') if JSON::PP::is_bool($value);
    return same($name, $is, $value) if $value !~ /^-?[0-9.]+(e[-+]?[0-9]+)?$/;
    $checked++;
    push @wrong, "$name: $is, not $value" if $is ne $value && $is ne sprintf('%.4g', $value);
}

sub bench {
    my ($text, $json) = @_;
    my %of;
    push @{ $of{ $_->{benchmark} } }, $_ for @{ $json->{rows} };
    for my $name (sort keys %of) {
        my @all = @{ $of{$name} };
        my ($part) = $text =~ /<summary>all \d+ rows of $name<\/summary>(.*?)<\/details>/s;
        if (!defined $part) { push @wrong, "$name has no table"; next }
        my ($head) = $part =~ /<thead>(.*?)<\/thead>/s;
        my @heads = map { plain($_) } ($head // '') =~ /<th[^>]*>(.*?)<\/th>/gs;
        same("$name columns", join(' ', sort @heads), join(' ', sort grep { $_ ne 'benchmark' } keys %{ $all[0] }));
        my @rows = rows_of($part);
        same("$name rows", scalar @rows, scalar @all);
        for my $r (0 .. ($#rows < $#all ? $#rows : $#all)) {
            value_is("$name row $r $heads[$_]", $rows[$r][$_][0], $all[$r]{ $heads[$_] }) for 0 .. $#heads;
        }
    }
}

my $text = slurp($page);
for my $path (@json) {
    my $json = decode_json(slurp($path));
    $json->{scenes} && !$json->{rows}[0]{benchmark} ? check($text, $json) : bench($text, $json);
}
print "WRONG   $_\n" for @wrong > 10 ? @wrong[0 .. 9] : @wrong;
print 'page: ' . ($checked // 0) . ' values, ' . @wrong . " wrong\n";
exit(@wrong > 0 || $checked < 50);
