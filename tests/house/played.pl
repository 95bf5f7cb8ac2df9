# Scripts of the tests that nothing plays: perl tests/house/played.pl
# A script is played if the Makefile, *.mk, .ci, tests/run.sh or a program names it by its path, or a script that is
# played does so, or by its name in the same folder, in a line that is no comment. Prints each that is not.
# Exit codes: 0 there is none, 1 there is one.
use strict;
use warnings;

chomp(my @files = `git ls-files -- Makefile .ci .github debian tests '*.mk'`);
my (%script, %text);
for my $file (@files) {
    next if $file =~ /\.(?:txt|md|json|svg|png)$/ || !-f $file;
    $script{$file} = 1 if $file =~ m{^tests/.*\.(?:sh|pl)$} && $file ne 'tests/run.sh';
    open my $in, '<', $file or die "$file: $!";
    $text{$file} = join '', grep { !m{^\s*(?:#|//|\*|/\*)} } <$in>;
}
my @ways = grep { !$script{$_} } keys %text;
my %played = ('tests/house/tokens.sh' => 1); # a tool for hands: CONTRIBUTING.md
while (defined(my $file = shift @ways)) {
    my ($folder) = $file =~ m{^(.*)/};
    for my $name ($text{$file} =~ m{([\w.\$\{\}/-]*[\w-]\.(?:sh|pl))\b}g) {
        my $other = $script{$name} ? $name : ($folder // '.') . '/' . $name =~ s{.*/}{}r;
        push @ways, $other if $script{$other} && !$played{$other}++;
    }
}
my @not = grep { !$played{$_} } sort keys %script;
print "$_\n" for @not;
exit(@not > 0);
