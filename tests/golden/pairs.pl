# Cases out of tables: every two values of different axes stand together in a case of the table.
use strict;
use warnings;

# A covering array of pairs, by a greedy choice that draws nothing: the same tables give the same cases. Takes the
# number of values of each axis; returns rows of numbers of values. The first row has the first value of each axis.
sub covering {
    my @size = @_;
    return map { [$_] } 0 .. $size[0] - 1 if @size == 1;
    my (@open, @pairs, @rows, @used);
    for my $a (0 .. $#size) {
        for my $b ($a + 1 .. $#size) {
            for my $i (0 .. $size[$a] - 1) {
                for my $j (0 .. $size[$b] - 1) {
                    $open[$a][$i][$b][$j] = $open[$b][$j][$a][$i] = 1;
                    push @pairs, [$a, $i, $b, $j];
                }
            }
        }
    }
    my @order = sort { $size[$b] <=> $size[$a] || $a <=> $b } 0 .. $#size;
    my $row = [(0) x @size];
    while (1) {
        for my $a (0 .. $#size) {
            $used[$a][$row->[$a]]++;
            $open[$a][$row->[$a]][$_][$row->[$_]] = 0 for grep { $_ != $a } 0 .. $#size;
        }
        push @rows, $row;
        shift @pairs while @pairs && !$open[$pairs[0][0]][$pairs[0][1]][$pairs[0][2]][$pairs[0][3]];
        last if !@pairs;
        $row = [];
        @$row[$pairs[0][0], $pairs[0][2]] = ($pairs[0][1], $pairs[0][3]);
        for my $axis (grep { !defined $row->[$_] } @order) {
            my @there = grep { defined $row->[$_] } 0 .. $#size;
            my ($best, $most) = (0, -1e9);
            for my $value (0 .. $size[$axis] - 1) {
                my ($with, $worth) = ($open[$axis][$value], -($used[$axis][$value] // 0));
                $with->[$_][$row->[$_]] and $worth += 1000 for @there;
                ($best, $most) = ($value, $worth) if $worth > $most;
            }
            $row->[$axis] = $best;
        }
    }
    return @rows;
}

# The tables of a file: see the head of tests/golden/golden.sh for the form.
sub read_tables {
    my ($file, $words) = @_;
    open my $in, '<', $file or die "$file: $!\n";
    my (@lines, @tables);
    while (<$in>) {
        chomp;
        next if /^\s*(#|$)/;
        if (/^\s/ && @lines) { s/^\s+/ /; $lines[-1] .= $_ }
        else { push @lines, $_ }
    }
    for (@lines) {
        s/\@(\w+)\@/$words->{$1} \/\/ die "$file: no word $1\n"/ge;
        if (/^table (.*)/) { push @tables, {run => $1, axes => [], also => [], wrong => []} }
        elsif (/^axis ?(.*)/) {
            my ($all, $option) = ($1, "");
            $option = "$1 " if $all =~ s/^(--\S+) = //;
            push @{$tables[-1]{axes}}, [map { s/^ +| +$//gr } split /\|/, $all, -1];
            $_ = $_ eq "" ? "" : $option . $_ for @{$tables[-1]{axes}[-1]};
        }
        elsif (/^word (\w+) (.*)/) { $words->{$1} = $2 }
        elsif (/^also (.*)/) { push @{$tables[-1]{also}}, $1 }
        elsif (/^(wrong|each) (.*)/) { push @{$tables[-1]{wrong}}, [map { s/^ +| +$//gr } split /\|/, $2, -1] }
        elsif (/^limits (.*)/) { push @tables, {limits => $1} }
        elsif (/^edits (\S+) (.*)/) { push @tables, {edits => $1, run => $2} }
        elsif (/^chain (.*)/) { push @tables, {chain => $1, steps => []} }
        elsif (/^step (.*)/) { push @{$tables[-1]{steps}}, $1 }
        else { die "$file: what is this? $_\n" }
    }
    return @tables;
}

# Commands of a case: the table's own with a value of each axis at the place of {}, or behind it. An option of a value
# takes the place of the same option of the table and of earlier values: twice it would be refused, and nothing run.
sub filled {
    my ($table, @values) = @_;
    my $run = $table->{run};
    for my $n (0 .. $#values) {
        next if $run =~ /^raydiff report /; # whose options may be given twice
        for my $option ($values[$n] =~ /(?<!\S)(--[a-z][a-z-]*)/g) {
            s/(?:^| )\Q$option\E(?: (?!-)(?:'[^']*'|[^ {]+))?(?= |$)// for $run, @values[0 .. $n - 1];
        }
    }
    my $text = join ' ', grep { $_ ne '' } @values;
    $run =~ s/\{\}/$text/ or $run .= " $text";
    return $run =~ s/ +$//r;
}

sub table_cases {
    my ($table) = @_;
    my @axes = @{$table->{axes}};
    my @cases;
    for my $row (covering(map { scalar @$_ } @axes)) {
        push @cases, filled($table, map { $axes[$_][$row->[$_]] } 0 .. $#axes);
    }
    my @first = map { $_->[0] } @axes;
    # A wrong value, or one of which one case is enough, takes the place of what the first case has of that option.
    for my $wrong (map { @$_ } @{$table->{wrong}}) {
        my ($option) = $wrong =~ /^(\S+)/;
        push @cases, filled($table, (grep { $_ !~ /^\Q$option\E( |$)/ } @first), $wrong);
    }
    push @cases, map { filled($table, @first, $_) } @{$table->{also}};
    return map { [$_] } @cases;
}

# Of every option that the help of a command has: no value, and values beside and beyond its range.
sub limits_cases {
    my ($base, $help) = @_;
    my ($text, @cases, %seen) = ($help, ());
    while ($text =~ /^  (?:-\w, )?(--[a-z][a-z-]*)((?: +\S.*)?(?:\n {10,}\S.*)*)/mg) {
        my ($option, $told) = ($1, $2);
        next if $seen{$option}++ || $option =~ /^--(list|help)$/;
        my $others = $base =~ s/ \Q$option\E( [^-]\S*)?(?= |$)//r;
        my @values = ('', '-1x');
        push @values, '0', '1e30' if $told =~ /^ [NSXUFE]\b/;
        if ($told =~ /\(([\d.]+)\s+to\s+([\d.]+)\)/s) {
            pop @values;
            push @values, $2 + 1, $1;
            push @values, $1 - 1 if $1 > 0;
        }
        push @cases, ["limits $base: $option", map { "raydiff $others $option" . ($_ eq '' ? '' : " $_") } @values];
    }
    return @cases;
}

1;
