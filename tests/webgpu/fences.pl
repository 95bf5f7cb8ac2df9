# Every float operation of shaders/wgsl/ stands alone in a fence, keep() or keep3() (shaders/wgsl/job.wgsl): so no
# expression has two that a compiler could reorder or fuse.
#   perl tests/webgpu/fences.pl [FILE...]
# Exit code 1: one does not, or the rule does not see one that is planted.
use strict;
use warnings;

# What is computed with whole numbers: it has such a literal, or one of these names.
my $whole = qr/\b\d+u\b|\b0x[0-9A-Fa-f]+u\b|\b(?:slot|before|kind)\b|\+\+|--/;

# The parts of a text without parentheses that have float operations, and how many.
sub operations {
    my ($text) = @_;
    my @found;
    for my $part (split /,|[!=<>]=|<<|>>|&&|\|\||[<>&|^;{}=]|\b(?:return|let|var|const)\b/, $text) {
        next if $part =~ $whole;
        my $count = () = $part =~ m{(?<=[\w\])])\s*[-+*/]\s*(?=-?[\w(])}g;
        push @found, [$part, $count] if $count;
    }
    return @found;
}

# The faults of a shader. Parentheses become names from the inside out.
sub faults {
    my ($text) = @_;
    my @found;
    $text =~ s{//.*}{}g;
    $text =~ s/(?<=\d)e-?\d+f?//g;
    $text =~ s/@\w+(?:\([^()]*\))?//g;
    $text =~ s/\w+<[^<>;]*(?:<[^<>]*>)?[^<>;]*>(?=[({ >,;)])/name/g;
    while ($text =~ s/(\w*)\(([^()]*)\)/ \x01/) {
        my ($call, $inside) = ($1, $2);
        my $fence = $call =~ /^keep3?$/;
        # parentheses alone go on outside, with what they hold
        my @in = $call eq '' ? () : operations($inside);
        push @found, map { $_->[0] } grep { !$fence || $_->[1] > 1 } @in;
        push @found, $inside if $fence && @in > 1;
        my $name = $call eq '' ? ($inside =~ $whole ? 'slot' : (operations($inside) ? 'name * name' : 'name')) : 'name';
        $text =~ s/ \x01/ $name/;
    }
    push @found, map { $_->[0] } operations($text);
    return @found;
}

sub read_all {
    open my $file, '<', $_[0] or die "$_[0]: $!\n";
    local $/;
    return <$file>;
}

my @files = @ARGV ? @ARGV : grep { !m{/probe\.wgsl$} } glob 'shaders/wgsl/*.wgsl';
my ($bad, $fences) = (0, 0);
for my $file (@files) {
    my $text = read_all($file);
    $fences += () = $text =~ /\bkeep3?\(/g;
    for my $fault (faults($text)) {
        print "$file: no fence of its own has" . (" $fault" =~ s/\s+/ /gr) . "\n";
        $bad = 1;
    }
}
if (!@ARGV) {
    for my $planted ('let a = b + c + d;', 'let a = (b + c) * d;', 'let a = keep(b * c + d);', 'let a = b + c;',
        'return keep3(v) * a - b;', 'let a = keep((b + c) * d);', 'f(a - b, c);') {
        next if faults($planted);
        print "the rule does not see: $planted\n";
        $bad = 1;
    }
    for my $sound ('let a = keep(b * c);', 'let a = 2u * b + 1u;', 'let a = keep(keep(x + y) + z);', 'let a = -b;') {
        next if !faults($sound);
        print "the rule blames: $sound\n";
        $bad = 1;
    }
    print "$fences fences in " . @files . " files\n";
    $bad = 1 if $fences < 60;
}
exit $bad;
