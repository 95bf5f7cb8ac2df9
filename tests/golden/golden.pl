# The work of tests/golden/golden.sh, where its use is told.
use strict;
use warnings;
use Cwd 'abs_path';
use Digest::MD5 'md5_base64', 'md5_hex';
use File::Path 'remove_tree';
use File::Temp 'tempdir';
use IO::Handle;
use POSIX ();
use Time::HiRes 'time';
BEGIN { require './tests/golden/pairs.pl'; require './tests/golden/drawn.pl'; require './tests/golden/edits.pl';
        require './tests/golden/normal.pl'; require './tests/golden/covered.pl' }

my ($program, @words) = @ARGV;
$program = abs_path($program) // die "golden: $program is not there\n";
my %word = (write => 0, case => undef, list => 0, times => 0, twice => 0, first => 0, only => '', drawn => 0);
while (defined(my $word = shift @words)) {
    $word =~ s/^--// && exists $word{$word} or die "golden: what is '$word'? see the head of tests/golden/golden.sh\n";
    $word{$word} = $word =~ /^(case|only)$/ ? shift @words : 1;
}
my $home = 'tests/golden';
our $LONG = $word{drawn}; # of normal.pl
my $records = "$home/" . ($word{drawn} ? 'drawn' : 'record');
my $work = tempdir('raydiff-golden-XXXXXX', TMPDIR => 1, CLEANUP => 0);
my $owner = $$;
END { remove_tree($work) if $work && $$ == $owner }
$SIG{$_} = sub { exit 4 } for 'INT', 'TERM', 'HUP';

# Nothing of who runs this shows in what is compared.
delete @ENV{grep { /^(RAYDIFF_|NO_COLOR|COLUMNS|LINES|LC_|LANG|XDG_|DISPLAY|WAYLAND|SOURCE_DATE)/ } keys %ENV};
@ENV{'LC_ALL', 'TERM', 'OMP_WAIT_POLICY', 'HOME'} = ('C', 'dumb', 'passive', "$work/home");
mkdir "$work/$_" for 'bin', 'in', 'home', 'case';
symlink $program, "$work/bin/raydiff";
$ENV{PATH} = "$work/bin:$ENV{PATH}";

sub slurp {
    my ($file) = @_;
    open my $in, '<:raw', $file or return '';
    local $/;
    return <$in> // '';
}

# A shell that runs scripts, one after the other: [process, its input, its answers]. It begins them faster than this
# program, which is larger, would.
my $runner;
sub start_runner {
    pipe my $from, my $input or die;
    pipe my $answers, my $to or die;
    my $child = fork // die "golden: fork: $!\n";
    if (!$child) {
        open STDIN, '<&', $from;
        POSIX::dup2(fileno $to, 3);
        setpgrp;
        exec 'sh';
        die;
    }
    $input->autoflush;
    return [$child, $input, $answers];
}
END {
    local $?;
    kill 'KILL', -$runner->[0] and waitpid $runner->[0], 0 if $runner;
}

sub shell { # folder, script, output
    my ($folder, $script, $said) = @_;
    $runner //= start_runner();
    my ($child, $input, $answers) = @$runner;
    local $SIG{ALRM} = sub { kill 'KILL', -$child };
    alarm 120;
    print $input "(cd '$folder' || exit 4\n$script\n) >'$said.out' 2>'$said.err' </dev/null 3>&-\necho \$? >&3\n";
    my $status = <$answers>;
    alarm 0;
    return $status >> 7 ? $status & 127 : $status << 8 if defined $status;
    waitpid $child, 0;
    undef $runner;
    return 9;
}

# What every case may read: in/.
my ($samples) = $program =~ m{^(.*)/};
my $built = "$samples/samples";
$built = "$samples/../samples" if !-d $built;
for my $from (glob("$home/input/*"), 'fuzz/corpus', 'fuzz/baseline.txt', 'fuzz/samples/tracer.awk') {
    system 'cp', '-r', $from, "$work/in/" and die "golden: cp $from\n";
}
for my $sample ('tracer', 'tracer_bug1', 'refuser', 'guest_brute.so') {
    symlink abs_path("$built/$sample"), "$work/in/$sample" if -e "$built/$sample";
}
shell("$work/in", slurp("$home/ready.txt"), "$work/ready") == 0
    or die "golden: ready.txt ended with an error:\n", slurp("$work/ready.err");

# The cases of all tables: [name, commands...].
my (@cases, %help);
my (%shared, %from);
for my $file ("$home/words.txt", sort glob("$home/tables/*.txt")) {
    my $first = @cases;
    for my $table (read_tables($file, \%shared)) {
        if ($word{drawn} && !$table->{edits}) {
            push @cases, map { [$_->[0], @$_] } drawn_cases($table, 4) if $table->{axes};
        } elsif ($table->{limits}) {
            my ($command) = $table->{limits} =~ /^raydiff (\S+)/;
            $help{$command} //= `'$program' $command --help`;
            push @cases, limits_cases($table->{limits}, $help{$command});
        } elsif ($table->{edits}) {
            push @cases, edits_cases($work, $table->{edits}, $table->{run}, $word{drawn} ? 600 : 24);
        } elsif ($table->{chain}) {
            push @cases, ["chain $table->{chain}", @{$table->{steps}}];
        } else {
            push @cases, map { [$_->[0], @$_] } table_cases($table);
        }
    }
    $from{$_->[0]} //= $file =~ s{^.*/|\.txt$}{}gr for @cases[$first .. $#cases];
}
my %number;
length "@$_" < 5000 or die "golden: a case is too long\n" for @cases;
@cases = grep { !$number{$_->[0]}++ } @cases;
$number{$cases[$_][0]} = $_ + 1 for 0 .. $#cases;

# The files in a folder and below, without what is linked.
sub files_of {
    my ($folder) = @_;
    opendir my $in, $folder or return ();
    return map { -l $_ ? () : -d _ ? files_of($_) : -f _ ? $_ : () } map {"$folder/$_"} grep { !/^(?:\.\.?|in)$/ } readdir $in;
}

# Runs a case; returns its streams: [name, what it reads].
sub play {
    my ($n) = @_;
    my (undef, @commands) = @{$cases[$n]};
    my $folder = "$work/case/$n";
    mkdir $folder;
    symlink '../../in', "$folder/in";
    my $script = join "\n", map { "{ $_\n}\necho \"[exit \$?]\"" } @commands;
    my $status = shell($folder, $script, "$work/case/said$n");
    my @streams = (['out', slurp("$work/case/said$n.out") . ($status & 127 ? "[signal $status]\n" : '')],
                   ['err', slurp("$work/case/said$n.err")]);
    my @files = files_of($folder);
    push @streams, [$_, slurp("$folder/$_")] for sort map { s{^\Q$folder\E/}{}r } @files;
    unlink "$folder/in", @files;
    rmdir $folder or remove_tree($folder);
    unlink "$work/case/said$n.out", "$work/case/said$n.err";
    return map { [$_->[0], [readable($_->[0], $_->[1], $work)]] } @streams;
}

# Of a longer output, or file, several lines have one hash.
sub step_of {
    my ($name, $lines) = @_;
    my $most = mark($name) eq $name ? 160 : 40;
    return int((@$lines + $most - 1) / $most) || 1;
}
sub hashes {
    my ($name, $lines) = @_;
    my $step = step_of($name, $lines);
    my $text = $step > 1 ? "$step," : '';
    for (my $i = 0; $i < @$lines; $i += $step) {
        my $last = $i + $step > @$lines ? $#$lines : $i + $step - 1;
        $text .= substr md5_base64(join "\n", @$lines[$i .. $last]), 0, 3;
    }
    return $text;
}

# A case's name in the record: what it runs, in five letters.
sub key { my ($n) = @_; return substr md5_base64(join "\n", @{$cases[$n]}), 0, 5 }

# A file's name in the record.
sub mark { my ($name) = @_; return $name =~ /^(?:out|err)$/ ? $name : substr md5_base64($name), 0, 3 }

sub recorded { # a line of the record; of a drawn case it is short
    my ($n, @streams) = @_;
    return key($n) . ' ' . substr md5_base64(map {; "$_->[0]\n", map { "$_\n" } @{$_->[1]} } @streams), 0, 4 if $word{drawn};
    return join ' ', key($n), map { mark($_->[0]) . ':' . hashes(@$_) } grep { @{$_->[1]} } @streams;
}

if ($word{list}) {
    print "$number{$_->[0]} $_->[0]\n" for @cases;
    exit 0;
}
my @missing = $word{drawn} ? () : uncovered($program, map { my ($name, @run) = @$_; $name =~ /^limits/ ? () : @run } @cases);
if (@missing) {
    print "no case of tests/golden/tables has $_\n" for @missing;
    exit 1 if !$word{write};
}
if (defined $word{case}) {
    my ($n) = grep { $word{case} =~ /^\d+$/ ? $_ == $word{case} - 1 : index($cases[$_][0], $word{case}) >= 0 } 0 .. $#cases;
    die "golden: no such case\n" if !defined $n || !$cases[$n];
    print "$_\n" for "# case " . ($n + 1) . ": $cases[$n][0]", @{$cases[$n]}[1 .. $#{$cases[$n]}];
    for (play($n)) {
        my ($name, $lines) = @$_;
        print "--- $name\n";
        print "$_\n" for @$lines;
    }
    exit 0;
}

my %was;
for my $file (glob "$records/*.txt") {
    /^(\S+)/ and $was{$1} = $_ for split /\n/, slurp($file);
}

# Workers take the next case's number out of a pipe. With --first all end when one has met a case that differs.
sub play_all {
    my @chosen = grep { index($cases[$_][0], $word{only}) >= 0 } 0 .. $#cases;
    my $jobs = $ENV{JOBS} // (`env -u OMP_NUM_THREADS nproc 2>/dev/null` || 2);
    chomp $jobs;
    pipe my $next, my $feed or die;
    my @child;
    for my $job (1 .. $jobs) {
        push @child, fork // die;
        next if $child[-1];
        undef $runner; # that of the parent
        close $feed;
        open my $told, '>', "$work/told.$job";
        while (sysread($next, my $text, 4) // 0) {
            last if -e "$work/stop";
            my $n = unpack 'N', $text;
            my $start = time;
            my $line = recorded($n, play($n));
            if ($word{first} && $line ne ($was{key($n)} // '')) { open my $stop, '>', "$work/stop" }
            printf $told "%d %.0f %s\n", $n, 1000 * (time - $start), $line;
        }
        close $told;
        exit 0;
    }
    close $next;
    syswrite $feed, pack 'N', $_ for sort { key($a) cmp key($b) } @chosen;
    close $feed;
    waitpid $_, 0 for @child;
    my (%line, %ms);
    for my $job (1 .. $jobs) {
        /^(\d+) (\d+) (.*)$/s and ($line{$1}, $ms{$1}) = ($3, $2) for split /\n/, slurp("$work/told.$job");
    }
    @chosen = grep { defined $line{$_} } @chosen if $word{first};
    return (\@chosen, \%line, \%ms);
}

sub record_of { my ($n) = @_; return $from{$cases[$n][0]} }

my $begun = time;
my ($chosen, $line, $ms) = play_all();
my $seconds = time - $begun;
if ($word{times}) {
    my (%of, %count);
    for (@$chosen) { $of{record_of($_)} += $ms->{$_}; $count{record_of($_)}++ }
    printf "%6d ms  %d cases of %s\n", $of{$_}, $count{$_}, $_ for sort keys %of;
    printf "%6d ms  case %d: %s\n", $ms->{$_}, $_ + 1, $cases[$_][0] for (sort { $ms->{$b} <=> $ms->{$a} } @$chosen)[0 .. 39];
}
if ($word{twice}) {
    my ($again_chosen, $again) = play_all();
    my @other = grep { $line->{$_} ne $again->{$_} } @$chosen;
    print "differs: case ", $_ + 1, ": $cases[$_][0]\n" for @other;
    my %kind;
    for my $n (@other) {
        my ($first, $second) = map { [map { my $s = $_; map { "$s->[0]: $_" } @{$s->[1]} } play($n)] } 1, 2;
        for (grep { $first->[$_] ne ($second->[$_] // '') } 0 .. $#$first) {
            print "  case ", $n + 1, " < $first->[$_]\n          > ", $second->[$_] // '', "\n" if !$kind{$first->[$_] =~ s/\d+|\w+ *://gr}++;
        }
    }
    print scalar(@other), " cases differ from run to run\n";
    exit(@other ? 1 : 0);
}

if ($word{write}) {
    my %text;
    $text{record_of($_)} .= ($line->{$_} // die "golden: case $cases[$_][0] was not played\n") . "\n" for @$chosen;
    unlink glob "$records/*.txt";
    for (keys %text) {
        open my $out, '>', "$records/$_.txt" or die;
        print $out $text{$_};
        close $out or die;
    }
    printf "golden: %d cases recorded in %.1f s\n", scalar @$chosen, $seconds;
    exit 0;
}

# Compares.
my ($failed, $shown) = (0, 0);
sub differ {
    my ($n) = @_;
    print "case ", $n + 1, ": $cases[$n][0]\n";
    if ($word{drawn}) {
        for (play($n)) {
            my ($name, $lines) = @$_;
            print "  $name:\n", map { '    ' . substr($_, 0, 160) . "\n" } @$lines[0 .. (@$lines < 12 ? $#$lines : 11)];
        }
        return;
    }
    my (undef, @old) = split / /, $was{key($n)};
    my %old = map { /^(.*):([^:]*)$/ } @old;
    my @lines;
    for (play($n)) {
        my ($name, $lines) = @$_;
        my $old = delete($old{mark($name)}) // '';
        my $new = hashes($name, $lines);
        next if $old eq $new;
        my $step = step_of($name, $lines);
        s/^\d+,// for $old, $new;
        my @was = $old =~ /(...)/g;
        my %left;
        $left{$_}++ for @was;
        my @now = $new =~ /(...)/g;
        my @changed = grep { ($left{$now[$_]} // 0) < 1 || $left{$now[$_]}-- < 1 } 0 .. $#now;
        push @lines, sprintf '  %s: %d of %d lines are other, %d there were', $name, @changed * $step, scalar @$lines, @was * $step;
        for my $at (@changed ? @changed[0 .. ($#changed < 9 ? $#changed : 9)] : ()) {
            my $last = ($at + 1) * $step;
            $last = @$lines if $last > @$lines;
            push @lines, map { "    $_: " . substr $lines->[$_ - 1], 0, 160 } $at * $step + 1 .. $last;
        }
    }
    push @lines, '  ' . (/^(?:out|err)$/ ? "$_: nothing is written" : 'a file is not written any more') for sort keys %old;
    @lines = (@lines[0 .. 12], '  ...') if @lines > 14;
    print "$_\n" for @lines, '';
}
my ($gone, %here) = (0);
$here{key($_)} = 1 for 0 .. $#cases;
for my $n (@$chosen) {
    my $old = $was{key($n)};
    next if defined $old && defined $line->{$n} && $old eq $line->{$n};
    $failed++;
    next if $shown++ >= 8;
    if (!defined $old) { print "case ", $n + 1, " is new: $cases[$n][0]\n" }
    elsif (!defined $line->{$n}) { print "case ", $n + 1, " was not played to its end: $cases[$n][0]\n" }
    else { differ($n) }
}
$gone = grep { !$here{$_} } keys %was;
print "$gone cases of the record are not there any more\n" if $gone;
$failed += $gone;
printf "golden: %d cases, %d failed, in %.1f s\n", scalar @$chosen, $failed, $seconds;
if ($failed) {
    print <<"END";
A line of `sh tests/golden/golden.sh BUILD/raydiff --case N` is what it reads now; the same command on the last
commit is what it read. If it should read so now: `sh tests/golden/golden.sh BUILD/raydiff --write`, and a line in
CHANGELOG.md if a user sees it.
END
}
exit($failed ? 1 : 0);
