# Every link of a page leads somewhere: a file of the repository, a title of a page, or a web address.
# Every page is linked from another, and has one title.
#   perl tests/docs/links.pl PAGE...
use strict;
use warnings;
use File::Basename qw(dirname);

my %titles; # page => {anchor => 1}
my ($bad, $links, %linked) = (0, 0);

# What a Markdown viewer makes of a title.
sub anchor {
    my ($title) = @_;
    $title = lc $title;
    $title =~ s/[^\w\- ]//g;
    $title =~ s/ /-/g;
    return $title;
}

sub prose { # page: its lines outside of code, with their numbers
    my ($page) = @_;
    open my $in, '<', $page or die "$page: cannot read\n";
    my ($code, @lines) = (0);
    while (<$in>) {
        chomp;
        if (/^```/) { $code = !$code; next }
        push @lines, [$., $_] unless $code;
    }
    return @lines;
}

for my $page (@ARGV) {
    my $first = 0;
    for (prose($page)) {
        my ($number, $line) = @$_;
        next unless $line =~ /^(#+) (.*)/;
        $first++ if $1 eq '#';
        $titles{$page}{anchor($2)} = 1;
    }
    if ($first != 1) { print "$page: $first titles of the page, not one\n"; $bad = 1 }
}

sub clean { # a path without . and ..
    my @parts;
    for (split m{/}, $_[0]) {
        if ($_ eq '..') { pop @parts } elsif ($_ ne '.') { push @parts, $_ }
    }
    return join '/', @parts;
}

for my $page (@ARGV) {
    for (prose($page)) {
        my ($number, $line) = @$_;
        $line =~ s/`[^`]*`//g;
        while ($line =~ /\]\(([^)\s]+)\)/g) {
            my $link = $1;
            $links++;
            next if $link =~ m{^https?://[\w.-]+\.[a-z]+(/\S*)?$};
            my ($path, $title) = $link =~ /^([^#]*)#?(.*)$/;
            my $to = $path eq '' ? $page : clean(dirname($page) . "/$path");
            $linked{$to} = 1 if $to ne $page;
            if (!-e $to) { print "$page:$number: no file $to\n"; $bad = 1 }
            elsif ($title ne '' && !$titles{$to}{$title}) { print "$page:$number: $to has no title '$title'\n"; $bad = 1 }
        }
    }
}
for my $page (grep { $_ ne 'README.md' && !$linked{$_} } @ARGV) {
    print "$page: no page leads here\n";
    $bad = 1;
}
printf "%d pages, %d links\n", scalar @ARGV, $links;
exit $bad;
