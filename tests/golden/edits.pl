# Files that differ from a sound one in one place, so that every rule of a reader is met by something.
use strict;
use warnings;

# What may stand in the place of a number, a word or a sign.
sub other_words {
    my ($word) = @_;
    return (gone => '', twice => "$word$word") if $word !~ /^[\w.+-]/;
    my %other = (gone => '', twice => "$word $word", x => "${word}x");
    return %other if $word !~ /^[-+]?\d/;
    %other = (%other, zero => 0, huge => '1e39', nan => 'nan', minus => $word =~ /^-/ ? substr $word, 1 : "-$word", half => "$word.5",
              wide => '4294967296');
    %other = (%other, more => $word + 1, less => $word - 1) if $word =~ /^-?\d{1,9}$/;
    return %other;
}

# Texts: each word, and each line. Returns pairs: a name, LINE.PLACE.WHAT, and the whole text.
sub edits_of_text {
    my ($text) = @_;
    my @line = split /(?<=\n)/, $text;
    my @edits;
    for my $n (0 .. $#line) {
        my ($before, $after) = (join('', @line[0 .. $n - 1]), join('', @line[$n + 1 .. $#line]));
        my $place = 0;
        my $at = $n + 1;
        push @edits, ["$at.gone", $before . $after], ["$at.twice", "$before$line[$n]" =~ s/(?<!\n)\z/\n/r . $line[$n] . $after],
            ["$at.cut", $before . substr $line[$n], 0, length($line[$n]) / 2];
        push @edits, ["$at.late", $before . $line[$n + 1] =~ s/\n?\z/\n/r . $line[$n] . join '', @line[$n + 2 .. $#line]] if $n < $#line;
        while ($line[$n] =~ /[-+]?(?:0x[\da-f.]+p[-+]?\d+|\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\w*|\w+|[^\s\w]/g) {
            my ($from, $to) = ($-[0], $+[0]);
            my %other = other_words(substr $line[$n], $from, $to - $from);
            $place++;
            for (sort keys %other) {
                push @edits, ["$at.$place.$_", $before . substr($line[$n], 0, $from) . $other{$_} . substr($line[$n], $to) . $after];
            }
        }
    }
    return @edits;
}

# Bytes: all of the head, and some of the rest.
sub edits_of_bytes {
    my ($bytes) = @_;
    my ($size, @edits) = length $bytes;
    my $step = int(($size - 96) / 64) + 1;
    for (my $i = 0; $i < $size; $i += $i < 96 ? 1 : $step) {
        my $byte = ord substr $bytes, $i, 1;
        my %other = (more => ($byte + 1) & 255, less => ($byte - 1) & 255, sign => $byte ^ 128, zero => 0, most => 255);
        for (grep { $other{$_} != $byte } sort keys %other) {
            push @edits, ["$i.$_", substr($bytes, 0, $i) . chr($other{$_}) . substr $bytes, $i + 1];
        }
        push @edits, ["$i.cut", substr $bytes, 0, $i];
    }
    return (@edits, ['end.more', "$bytes\0"]);
}

# Cases of a file and a command that reads it, in which {} stands for the file, and of its edits at most MOST, drawn by
# their names. Edited files stand in in/edits of the folder WORK.
sub edits_cases {
    my ($work, $file, $command, $most) = @_;
    my $text = slurp("$work/$file");
    my $folder = "$work/case/sound"; # of a file that is refused as it is, every edit would say the same
    mkdir $folder and symlink '../../in', "$folder/in";
    my $status = shell($folder, $command =~ s/\{\}/$file/gr, "$work/sound");
    length $text && ($status == 0 || $status == 256) or die "golden: $file is no sound one: $command:\n", slurp("$work/sound.err");
    remove_tree($folder);
    my ($name, $end) = $file =~ m{^in/(.*?)((?:\.[a-z]+)*)$};
    my @edits = $text =~ /[\0\x80-\xff]/ ? edits_of_bytes($text) : edits_of_text($text);
    my %drawn = map { $_->[0] => drawn(0xffffffff, $file, $_->[0]) } @edits;
    my @kept = (sort { $drawn{$a->[0]} <=> $drawn{$b->[0]} } @edits)[0 .. ($most < @edits ? $most : @edits) - 1];
    my %kept = map { $_->[0] => 1 } @kept;
    @edits = grep { $kept{$_->[0]} } @edits;
    my (@cases, @files);
    mkdir "$work/in/edits" and symlink '../shapes.obj', "$work/in/edits/shapes.obj"; # of which a world speaks
    for (@edits) {
        my ($what, $edited) = @$_;
        push @files, "in/edits/$name.$what$end" =~ s{(?<=edits/)(.*)}{$1 =~ tr{/}{-}r}er;
        open my $out, '>:raw', "$work/$files[-1]" or die "golden: $files[-1]: $!\n";
        print $out $edited;
        close $out or die "golden: $files[-1]: $!\n";
    }
    my $run = $command =~ s/\{\}/\$f/gr;
    while (my @some = splice @files, 0, 30) {
        push @cases, ["edits $file: $some[0] and so on: $command",
                      "for f in @some; do echo \$f; { $run; }; echo \"[\$?]\"; done"];
    }
    return @cases;
}

1;
