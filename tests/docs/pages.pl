# Follows pages as a reader would: every command is run in the order of the page, and what it prints is
# held against what the page shows.
#   perl tests/docs/pages.pl BUILD PAGE...      SLOW=1: blocks marked slow, too
# A code block is one of these:
#   ```console     "$ COMMAND" and its output. A line "..." stands for any number of lines, "..." at the
#                  end of a line for the rest of it. "# exit N" at the end of a command is its exit code, 0 else.
#   ```sh          commands that must end with 0
#   any, after a line <!-- file: NAME -->      is written to NAME
#   any, after a line <!-- shown: REASON -->   is not played; nor after <!-- tutorial: ... -->, which
#                  tests/house/tutorial.sh follows
# <!-- slow --> before a block: it is played with SLOW=1 alone. <!-- needs: COMMAND -->: only where that ends
# with 0. A block of another kind, without a mark, is an error: nothing is shown that nothing checks.
# Where BUILD has the shared library (make lib) it is installed in a folder that pkg-config, the loader and Python
# search, as they do that of a user.
# Times, speeds, versions of others and the width of gaps are masked. Each line of a page is also held against the
# output with a letter of it changed: that must be noticed.
# No two of the pages given have a campaign in the same folder.
# Exit codes: 0 all as the page says; 1 not; 77 a block was skipped for what it needs.
use strict;
use warnings;
use Cwd qw(abs_path getcwd);
use File::Temp qw(tempdir);

my ($build, @pages) = @ARGV;
$build = abs_path($build);
my $root = getcwd();
my $copy;
# numpy is a package of the system's Python, where another comes first in PATH.
my $other_python = -e '/usr/bin/python3' && system("python3 -c 'import numpy' 2>/dev/null") != 0;
my ($bad, $skipped, $commands, $lines, $slow) = (0, 0, 0, 0, 0);

sub breach {
    print "$_[0]\n";
    return if ++$bad < 10;
    print "$bad breaches, the rest is left out\n";
    exit 1;
}

sub masked {
    my ($line) = @_;
    $line =~ s/\b\d+(\.\d+)?(e[-+]?\d+)? ?(ns|us|ms|s|min|h)\b/# time/g;
    $line =~ s/\b\d+(\.\d+)?(e[-+]?\d+)? ?([MkG]?ray|trials|rays|frames)?\/s\b/# speed/g;
    $line =~ s/\b\d+\.\d+ \(\d+\.\d+-\d+\.\d+\)/# of runs/g;
    $line =~ s/\b(Mesa|LLVM|Embree|Vulkan|SwiftShader) \d[\w.]*/$1 #/g;
    $line =~ s/\s+/ /g;
    $line =~ s/ $//;
    return $line;
}

# Whether what was printed is what the page shows; else a line that says where not.
sub differs {
    my ($printed, $wanted) = @_;
    my ($at, $loose) = (0, 0);
    for my $line (map { masked($_) } @$printed) {
        while ($at < @$wanted && $wanted->[$at] eq '...') { $at++; $loose = 1 }
        if ($at < @$wanted) {
            my $want = masked($wanted->[$at]);
            my $cut = $want =~ s/ ?\.\.\.$//;
            if ($cut ? index($line, $want) == 0 : $line eq $want) { $at++; $loose = 0; next }
        }
        return "printed: $line\nthe page: " . ($wanted->[$at] // '(nothing)') unless $loose;
    }
    $at++ while $at < @$wanted && $wanted->[$at] eq '...';
    return $at < @$wanted ? "never printed: $wanted->[$at]" : '';
}

# A letter of one line changed must be noticed.
sub notices {
    my ($where, $printed, $wanted) = @_;
    for my $i (0 .. $#$wanted) {
        next if $wanted->[$i] eq '...' || masked($wanted->[$i]) !~ /[a-z]/;
        my @other = @$wanted;
        $other[$i] =~ s/([a-z])/$1 eq 'q' ? 'z' : 'q'/e;
        $lines++;
        breach("$where: a changed line is not noticed: $other[$i]") if !differs($printed, \@other);
    }
}

sub run { # where, command, wanted lines or nothing
    my ($where, $command, $wanted) = @_;
    my $code = $command =~ s/\s+# exit (\d+)\s*$// ? $1 : 0;
    $commands++;
    open my $script, '>', '.step.sh' or die;
    print $script "$command\n";
    close $script;
    my @printed = split /\n/, `timeout 300 sh .step.sh 2>&1`;
    my $got = $? >> 8;
    # How far a command is: lines that come after 10 s, where a machine is slow.
    @printed = grep { !/^raydiff \w+: \d+ s(, about \d+ s left.*?)?: / } @printed;
    if ($got != $code) {
        breach("$where: $command: exit $got, not $code");
        print map { "  $_\n" } @printed > 15 ? @printed[-15 .. -1] : @printed;
        return;
    }
    return if !$wanted;
    my $why = differs(\@printed, $wanted);
    return breach("$where: $command\n$why") if $why;
    notices($where, \@printed, $wanted);
}

sub console {
    my ($where, @text) = @_;
    my ($command, @wanted);
    my $end = sub { run($where, $command, \@wanted) if defined $command; @wanted = () };
    while (@text) {
        my $line = shift @text;
        if ($line =~ s/^\$ //) {
            $end->();
            $line .= shift @text while $line =~ s{\\$}{} && @text;
            $command = $line;
        } elsif (defined $command) {
            push @wanted, $line;
        } else {
            breach("$where: output of no command: $line");
        }
    }
    $end->();
}

sub block { # where, language, marks, lines
    my ($where, $language, $mark, @text) = @_;
    return breach("$where: shown for no reason") if exists $mark->{shown} && $mark->{shown} eq '';
    return if grep { exists $mark->{$_} } qw(shown tutorial);
    if (exists $mark->{slow} && !$ENV{SLOW}) { $slow++; return }
    if ($mark->{needs} && system("($mark->{needs}) >/dev/null 2>&1")) {
        print "SKIP $where: it needs: $mark->{needs}\n";
        $skipped = 1;
    } elsif ($mark->{file}) {
        open my $file, '>', $mark->{file} or return breach("$where: cannot write $mark->{file}");
        print $file map { "$_\n" } @text;
        close $file;
    } elsif ($language eq 'console') {
        console($where, @text);
    } elsif ($language eq 'sh') {
        run($where, join("\n", 'set -e', @text));
    } else {
        breach("$where: a block that nothing checks; mark it, or say why it is shown");
    }
}

sub follow {
    my ($page) = @_;
    open my $in, '<', "$root/$page" or die "$page: cannot read\n";
    my $dir = tempdir(CLEANUP => 1);
    chdir $dir or die;
    symlink "$copy/$_", $_ for grep { !/\./ } map { m{([^/]*)$} } glob("$copy/*");
    mkdir 'bin' and symlink "$build/raydiff", 'bin/raydiff';
    symlink '/usr/bin/python3', 'bin/python3' if $other_python;
    local $ENV{PATH} = "$dir/bin:$ENV{PATH}";
    my (%mark, @text, $language, $first);
    while (my $line = <$in>) {
        chomp $line;
        if (defined $language) {
            if ($line eq '```') {
                block("$page:$first", $language, {%mark}, @text);
                ($language, @text) = ();
                %mark = ();
            } else { push @text, $line }
        } elsif ($line =~ /^```(\S*)$/) {
            ($language, $first) = ($1, $.);
        } elsif ($line =~ /^<!-- (file|shown|slow|needs|tutorial)(?:: (.*?))? -->$/) {
            $mark{$1} = $2 // '';
        } elsif ($line ne '') { %mark = () }
    }
    breach("$page:$first: a block without an end") if defined $language;
    chdir $root;
}

# Campaigns of two pages have two folders: a reader follows both in one.
my %campaign;
for my $page (@pages) {
    open my $in, '<', $page or die "$page: cannot read\n";
    for my $dir (map { /--dir ([^\s`]+)/g } <$in>) {
        my $other = $campaign{$dir} //= $page;
        breach("$page: --dir $dir is a folder of $other, too") if $other ne $page;
    }
}

# What the pages do to the sources they do to a copy; meshes that were fetched are not copied.
$copy = tempdir(CLEANUP => 1);
system("git ls-files -z | tar --null -T - -cf - | tar -xf - -C $copy") == 0 or die "no copy of the sources\n";
symlink "$root/scenes/fetched", "$copy/scenes/fetched";
my $prefix = tempdir(CLEANUP => 1);
if (-e "$build/shared") {
    system("make -s install-library PREFIX=$prefix >&2") == 0 or die "the library cannot be installed\n";
    my %search = (PKG_CONFIG_PATH => 'lib/pkgconfig', LD_LIBRARY_PATH => 'lib', PYTHONPATH => 'share/raydiff/python');
    $ENV{$_} = join ':', "$prefix/$search{$_}", $ENV{$_} // () for keys %search;
}
follow($_) for @pages;
printf "%d pages: %d commands followed in %d s, %d lines seen to matter, %d slow blocks left out\n",
    scalar @pages, $commands, time - $^T, $lines, $slow;
exit($bad ? 1 : $skipped ? 77 : 0);
