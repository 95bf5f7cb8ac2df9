# Plays the walks of tests/scripts/options.sh, where they are told.
#   perl tests/options/walks.pl RAYDIFF DIR [COMMAND] <WALKS     DIR has room for files; a line of WALKS: input, base, uses,
#                                                              with tabs between them
use strict;
use warnings;
use Digest::MD5 'md5_hex';
use File::Find 'find';
use File::Path 'remove_tree';

my ($raydiff, $dir, $walked) = @ARGV;
my $files = "$dir/files";
my ($runs, $pairs, $failed, $code, $said, $input) = (0, 0, 0);

sub text_of {
    my ($file) = @_;
    open my $in, '<:raw', $file or return '';
    local $/;
    return <$in> // '';
}

# Runs it: $code, and $said, its standard error.
sub run { # words
    open my $in, '<', $input or die "options: $input: $!\n";
    my $child = fork // die "options: fork: $!\n";
    if (!$child) {
        open STDIN, '<&', $in;
        open STDOUT, '>', "$dir/out";
        open STDERR, '>', "$dir/err";
        exec $raydiff, @_;
        exit 4;
    }
    waitpid $child, 0;
    $code = $? & 127 ? 128 + ($? & 127) : $? >> 8;
    $said = text_of("$dir/err");
}

sub bad {
    my ($what) = @_;
    my @last = split /\n/, text_of("$dir/out") . text_of("$dir/err");
    print "FAILED  $what\n", map { "        $_\n" } @last[(@last > 8 ? -8 : -@last) .. -1];
    return if ++$failed < 10;
    print "$failed failed, the rest is left out\n";
    exit 1;
}

# The last run was refused by one line that names the option.
sub is_refused {
    my ($option) = @_;
    return 0 if $code != 2 || $said !~ /\A[^\n]*\n?\z/;
    return 1 if "$said " =~ /--\Q$option\E[^a-z-]/;
    return $option =~ /^handler-(.*)/ && "$said " =~ /--handler \Q$1\E /;
}

sub fresh {
    remove_tree($files);
    mkdir $files or die "options: $files: $!\n";
}

# What is below $files: names, kinds, sizes, times.
sub listed {
    my @list;
    find({no_chdir => 1, wanted => sub { push @list, join ' ', $_, (lstat $_)[1, 2, 7, 9], -l $_ ? readlink $_ : () }}, $files);
    return join "\n", sort @list;
}

# What a run says and writes, without the digits of times; a file that it made is part of it.
sub look { # words
    fresh();
    run(@_);
    $runs++;
    my @made;
    find({no_chdir => 1, wanted => sub { push @made, $_ if -f $_ && !-l $_ && -s _ }}, $files);
    my $bytes = join '', map { text_of($_) } glob("$files/tree*"), glob("$files/w/*.html");
    my $seen = join "\n", $code, text_of("$dir/out"), $said, sort(@made), md5_hex($bytes);
    return $seen =~ s/[0-9]+\.[0-9]+(e[+-]?[0-9]+)?/#/gr;
}

# A command line without an option.
sub without {
    my ($base, $option) = @_;
    return " $base " =~ s/ --$option( [^- ][^ ]*)? / /r;
}

# No two outputs of a walk are one file, by the same name or by another: the second would take the first one's place.
sub apart {
    my ($base, @uses) = @_;
    my @outputs = grep { !/^(?:dir|to)$/ } map { /^~?([a-z]*)=\@$/ ? $1 : () } @uses;
    for my $first (@outputs) {
        for my $second (grep { $_ ne $first } @outputs) {
            my $others = " $base " =~ s/ --(?:$first|$second) [^- ][^ ]* / /gr;
            for my $other ('x.png', 'link.png') {
                $pairs++;
                fresh();
                if ($other ne 'x.png') {
                    open my $empty, '>', "$files/x.png" or die;
                    symlink 'x.png', "$files/$other" or die;
                }
                my $before = listed();
                run(split(' ', $others), "--$first", "$files/x.png", "--$second", "$files/$other");
                is_refused($first) && is_refused($second) or bad("raydiff $base: --$first and --$second are one file: exit $code");
                listed() eq $before or bad("raydiff $base: --$first and --$second: written");
            }
        }
    }
}

# A value that the option would take; none for those without.
my %value = (
    (map { $_ => undef } qw(all as-expected brief camera-fixed camera-orbit decimal faithful feedback fill-normals force
        general hard list no-shrink quick summary verbose waves wide window worlds shaders)),
    color => 'always', engine => 'cpu', require => 'cpu', layout => 'f32', builder => 'median', box => 'robust', tri => 'mt',
    store => 'compact', query => 'any', modes => 'all', rays => 'random', profile => 'rtrs', optimize => 'reinsert',
    handler => 'bvh', show => 't', form => 'text', plan => 'steps', parts => 'machine', size => '8x8', pixel => '1,1',
    shard => '1/2', 'show-range' => '0:1', triangles => '8-16', driver => 'stock', format => 'raydiff', compiler => 'opt',
    decorate => 'final', buffers => 'texel', ray => '0,0,0 1,0,0', cause => 'sentinel', scene => 'soup:n=9',
    path => 'soup:n=9', baseline => 'fuzz/baseline.txt', steps => 'refit',
    (map { $_ => "$dir/nothing" } qw(bvh shader waivers check bench benchmark doctor findings corpus verify picture)),
    (map { $_ => "$files/x.$_" } qw(out json csv svg junit jsonl tap markdown html log paths to dir save benchmark-out)),
);
my %without = map { $_ => 1 } 'tap conform', 'benchmark render', 'turns fuzz', 'steps fuzz';
sub value_of {
    my ($option, $command) = @_;
    return undef if $option =~ /^handler-/ || $without{"$option $command"};
    return exists $value{$option} ? $value{$option} : '3';
}

# The options of each command, as its help tells them.
my (%knows, %every, %done);
my @commands = split ' ', `'$raydiff' help --commands`;
for my $command (@commands) {
    my $help = `'$raydiff' $command --help` . ($command eq 'diff' ? `'$raydiff' diff a.png --help` : '');
    my %own = map { $_ => 1 } grep { !/^(?:help|matrix|self-test)$/ } $help =~ /--([a-z][a-z-]*[a-z])/g;
    $knows{$command} = \%own;
    $every{$_} = 1 for keys %own;
}

# An option that the walk uses.
sub used {
    my ($base, $command, $plain, $use) = @_;
    return if $use =~ /^%/;
    my ($unseen, $option, $given) = $use =~ /^(~?)([^=]*)(?:=(.*))?$/;
    $pairs++;
    $knows{$command}{$option} or bad("$command --help has no --$option");
    $given = $option eq 'out' ? "$files/y.png" : "$files/y.$option" if ($given // '') eq '@';
    # No option is given twice: the base has its own value.
    my $seen = look(split(' ', without($base, $option)), "--$option", $given // ());
    if (is_refused($option) && $said =~ /not used/) {
        bad("raydiff $base --$option: refused");
    } elsif ($code > 1 && $code != 77) {
        bad("raydiff $base --$option " . ($given // '') . ": exit $code");
    } elsif (!$unseen && $seen eq $plain) {
        bad("raydiff $base --$option " . ($given // '') . ': is taken, and changes nothing');
    }
}

while (my $line = <STDIN>) {
    chomp $line;
    my ($base, $uses);
    ($input, $base, $uses) = split /\t/, $line, -1;
    my ($command) = $base =~ /^(\S+)/;
    next if $walked && $command ne $walked;
    my @uses = split ' ', $uses;
    my $plain = look(split ' ', $base);
    used($base, $command, $plain, $_) for @uses;
    apart($base, @uses);
    my %named = map { s/^[~%]|=.*//gr => 1 } @uses;
    for my $option (grep { !$named{$_} } sort keys %every) {
        # What the command knows nothing of is tried once.
        next if $done{$command} && !$knows{$command}{$option};
        $pairs++;
        my $value = value_of($option, $command);
        run(split(' ', $base), "--$option", $value // ());
        is_refused($option) or bad("raydiff $base --$option " . ($value // '') . ": exit $code, and it is not used");
    }
    $done{$command} = 1;
}
for my $command ($walked || @commands) {
    $done{$command} or bad("no run of $command");
}
print "options: $pairs pairs of run and option, $runs runs, $failed failed\n";
exit($failed ? 1 : 0);
