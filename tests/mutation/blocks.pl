# Which lines of the product stand in which basic blocks of a program, and which of them were run:
#   perl tests/mutation/blocks.pl table PROGRAM >TABLE      PROGRAM: of config=coverage, or its shared object
#   perl tests/mutation/blocks.pl ran TABLE RAN             RAN: what tests/mutation/ran.c wrote of that program
# TABLE has a line for each block: the address that its RAN has a byte for, and FILE:LINE of each line in it. The second
# prints FILE LINE of each line that stands in a block that was run. Exit codes: 0; 1: no blocks; 2: a file cannot be read.
use strict;
use warnings;

my ($what, @file) = @ARGV;

# No two sources have the same name, so that a program's own table of lines, which has names alone, tells the file.
sub sources {
    my %path;
    for (split /\0/, `git ls-files -z -- '*.c' '*.h'`) {
        $path{s{.*/}{}r} = $_ if m{^(?:[a-z]+\.c$|(?:ref|gpu|scenes|fuzz|bench|cmd|tests/hard)/)} && !m{^fuzz/(?:templates|samples)/};
    }
    return \%path;
}

# Where blocks begin, upwards: [address of its byte, first address, first of what is not its own].
sub blocks {
    my ($program) = @_;
    my (@block, $start, $from);
    open my $code, '-|', 'objdump', '-d', '--no-show-raw-insn', $program or exit 2;
    while (<$code>) {
        if (/^([0-9a-f]+) </) {
            ($start, $from) = (hex $1, undef);
            $block[-1][2] //= $start if @block;
        } elsif (defined $from) { # the instruction behind a call
            my ($at) = /^ *([0-9a-f]+):/ or next;
            push @block, [hex $at, $from, undef];
            $from = undef;
        }
        if (/^ *([0-9a-f]+):\s+call.*<__sanitizer_cov_trace_pc(?:\@plt)?>/) {
            $from = $start // hex $1; # what stands before the first is of its block
            $start = undef;
            $block[-1][2] //= $from if @block;
        }
    }
    close $code or exit 2;
    $block[-1][2] //= ~0 if @block;
    return \@block;
}

# [address, FILE:LINE] of the program's table of lines, upwards.
sub rows {
    my ($program, $path) = @_;
    my @row;
    open my $lines, '-|', 'objdump', '--dwarf=decodedline', $program or exit 2;
    while (<$lines>) {
        my ($file, $line, $at) = /^(\S+) +(\d+) +0x([0-9a-f]+)/ or next;
        push @row, [hex $at, "$path->{$file}:$line"] if $line > 0 && $path->{$file};
    }
    close $lines or exit 2;
    return [sort { $a->[0] <=> $b->[0] } @row];
}

if ($what eq 'table') {
    my ($blocks, $rows) = (blocks($file[0]), rows($file[0], sources()));
    my $next = 0;
    for my $block (@$blocks) {
        my ($byte, $from, $end) = @$block;
        $next++ while $next < @$rows && $rows->[$next][0] < $from;
        my %line;
        for (my $row = $next; $row < @$rows && $rows->[$row][0] < $end; $row++) { $line{ $rows->[$row][1] } = 1 }
        # A block that begins amid a line has that line's row before it.
        $line{ $rows->[$next - 1][1] } = 1 if $next > 0 && !%line;
        print join(' ', $byte, sort keys %line), "\n" if %line;
    }
    exit(@$blocks ? 0 : 1);
}

open my $in, '<:raw', $file[1] or exit 2;
my $ran = do { local $/; <$in> } // '';
open my $table, '<', $file[0] or exit 2;
my %line;
while (<$table>) {
    chomp;
    my ($byte, @line) = split / /;
    @line{@line} = () if $byte < length $ran && substr($ran, $byte, 1) ne "\0";
}
print map { s/:/ /r . "\n" } sort keys %line;
