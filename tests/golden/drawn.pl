# More cases out of tables than their pairs need: more than two values meet.
use strict;
use warnings;
use Digest::MD5 'md5';

# A number below OF that depends on the words alone.
sub drawn { my ($of, @words) = @_; return unpack('N', md5(join "\0", @words)) % $of }

# The value of an axis in a drawn case; in one case of three an axis has two values, if its option takes several.
sub drawn_value {
    my ($table, $row, $n) = @_;
    my $axis = $table->{axes}[$n];
    my $run = $table->{run};
    my $value = $axis->[drawn(scalar @$axis, $run, $row, $n)];
    return $value if drawn(3, $run, $row, 'two') || drawn(scalar @{$table->{axes}}, $run, $row, 'which') != $n;
    my $other = $axis->[drawn(scalar @$axis, $run, $row, $n, 'other')];
    return $value if $value eq '' || $other eq '' || $value eq $other;
    my ($option) = $value =~ /^(--(?:layout|engine|builder|box|tri|query|store|rays|scheduler|depths)) /;
    return "$value $other" if !defined $option;
    return $value if $other !~ s/^$option (\S+)$/$1/ || $value =~ / .* /;
    return "$value,$other";
}

# TIMES as many cases as pairs need, of values that are drawn; and so of each wrong value.
sub drawn_cases {
    my ($table, $times) = @_;
    my @axes = @{$table->{axes}};
    my $rows = $times * covering(map { scalar @$_ } @axes);
    my @cases = map { my $row = $_; [filled($table, map { drawn_value($table, $row, $_) } 0 .. $#axes)] } 1 .. $rows;
    my $row = $rows;
    for my $wrong (map { @$_ } @{$table->{wrong}}, $table->{also}) {
        my ($option) = $wrong =~ /^(\S+)/;
        for (1 .. $times) {
            $row++;
            my @values = map { drawn_value($table, $row, $_) } 0 .. $#axes;
            push @cases, [filled($table, (grep { $_ !~ /^\Q$option\E( |$)/ } @values), $wrong)];
        }
    }
    return @cases;
}

1;
