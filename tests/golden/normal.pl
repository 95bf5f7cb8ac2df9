# What an output is compared by: its lines, without times, speeds and versions. A picture is its pixels.
use strict;
use warnings;
use Compress::Zlib ();
use Digest::MD5 'md5_hex';
use MIME::Base64 'decode_base64';

# Whether cases may take so long that a log has more checkpoints on a slower machine.
our $LONG;
# Fields of JSON and columns of CSV that docs/schemas and tests/values tell as times or speeds, or as what follows
# from them, and the version.
our $TIMED = qr/; speeds cannot|f32's speed|times its|its speed|times the|refitted in| packed in|Mray/;
our @TIMES = (
    [qr{\b\d+ threads, }, '# threads, '],
    [qr{\bkernel (avx2|avx512|portable)\b}, 'kernel #'],
    [qr{(?<= rays judged, )[\d.]+ s\b}, '# s'],
    [qr{\b\d{4}-\d\d-\d\d \d\d:\d\d UTC}, 'DATE'],
    [qr{^builder +threads +ns/tri}, 'builder threads ns/tri'],
    [qr{(?<=\.html: )[\d.]+ kB}, '# kB'],
    [qr{(?<=^  seconds: )[\d.]+$}, '#'],
    [qr{\.\d+\.tmp\b}, '.PID.tmp'],
    [qr{^ *(?:median|rtrs|sah_\w+|lbvh|ploc|sbvh|trbvh|ploctree|lbvh30|lbvh63|hploc)(?: (?:reinsert|rotate|presplit|split-budget)=[\d.]+)? +\d+\K +[\d.]+ \([\d.]+-[\d.]+\) +}, ' # '],
    [qr{(?<= )\([\d.e+]+/s\)}, '(#/s)'],
    [qr{harness \d+ % of the time}, 'harness #'],
    [qr{(?<= time=")[\d.]+(?=")}, '#'],
    [qr{(?<= in )[\d.]+ s\b}, '# s'],
    [qr{(?<=\|turnout=)[\d,]+}, '#'],
    [qr{ MiB, and \d+ are left}, ' MiB, and # are left'],

    [qr/[\d.]+ ms (?=tracing by|tracing each|in all|a frame)/, '# ms '],
    [qr/[\d.]+ times its speed(, within noise)?/, '# times its speed'],
    [qr/[\d.]+ times the speed of/, '# times the speed of'],
    [qr/refitted in [\d.]+ ns a triangle/, 'refitted in # ns a triangle'],
    [qr/built in [\d.]+/, 'built in #'], [qr/packed in [\d.]+/, 'packed in #'],
    [qr/; (?:speeds cannot be told apart|\S+ on \S+ has [\d.]+ times f32's speed)/, '; # which is fastest'],
    [qr/: [\d.]+ times as long/, ': # times as long'],
);
# What a line has that any of them matches.
our $ANY_TIME = qr/threads|kernel |judged, | UTC|\.html: |  seconds: |\.tmp| \(|harness| time="| in |turnout=| MiB, and| ms | times |speed/;
our $FIELD = qr/\b(?:ns|\w+_ns|ns_per_\w+|mrays_\w+|\w*ratio_\w+|\w*_per_s|harness_\w+|\w*ms|\w*seconds|mray_s\w*|speed\w*|version|built|processor)\b/;

# Bytes of a row of a PNG file, of which the filter took away what it guessed from those before and above.
sub unfiltered {
    my ($filter, $pixel, $bytes, $above) = @_;
    return $above if $filter == 2 && $bytes !~ /[^\0]/;
    my @row = unpack 'C*', $bytes;
    my @up = unpack 'C*', $above;
    if ($filter == 1) {
        $row[$_] = ($row[$_] + $row[$_ - $pixel]) & 255 for $pixel .. $#row;
    } elsif ($filter == 2) {
        $row[$_] = ($row[$_] + $up[$_]) & 255 for 0 .. $#row;
    } elsif ($filter == 3) {
        $row[$_] = ($row[$_] + (($_ >= $pixel ? $row[$_ - $pixel] : 0) + $up[$_] >> 1)) & 255 for 0 .. $#row;
    } else {
        for my $i (0 .. $#row) {
            my ($a, $b, $c) = $i >= $pixel ? ($row[$i - $pixel], $up[$i], $up[$i - $pixel]) : (0, $up[$i], 0);
            my ($pa, $pb, $pc) = (abs($b - $c), abs($a - $c), abs($a + $b - 2 * $c));
            $row[$i] = ($row[$i] + ($pa <= $pb && $pa <= $pc ? $a : $pb <= $pc ? $b : $c)) & 255;
        }
    }
    return pack 'C*', @row;
}

# A PNG file's pixels, a line each row: how they were deflated is a matter of zlib's version.
sub png_lines {
    my ($bytes) = @_;
    my ($at, $data, @lines, $row) = (8, '');
    my ($width, $height, $depth, $kind) = unpack 'NNCC', substr $bytes, 16, 10;
    while ($at + 8 <= length $bytes) {
        my ($size, $name) = unpack 'Na4', substr $bytes, $at, 8;
        $data .= substr $bytes, $at + 8, $size if $name eq 'IDAT';
        push @lines, "$name " . unpack 'H*', substr $bytes, $at + 8, $size if $name !~ /^(IDAT|IHDR|IEND)$/;
        $at += 12 + $size;
    }
    $data = Compress::Zlib::uncompress($data) // return "a PNG file that is broken";
    my $pixel = ({0 => 1, 2 => 3, 3 => 1, 4 => 2, 6 => 4}->{$kind} // 1) * $depth / 8;
    my $stride = int(($width * $pixel * 8 + 7) / 8);
    my ($above, $text) = ("\0" x $stride, '');
    for my $y (0 .. $height - 1) {
        my $filter = ord substr $data, $y * ($stride + 1), 1;
        my $row = substr $data, $y * ($stride + 1) + 1, $stride;
        $row = unfiltered($filter, $pixel, $row, $above) if $filter;
        $text = join ' ', unpack '(H2)*', $row if $y == 0 || $row ne $above;
        push @lines, "row $y: $text";
        $above = $row;
    }
    return ("$width x $height, $depth bits, kind $kind", @lines);
}

sub readable {
    my ($name, $bytes, $work) = @_;
    return png_lines($bytes) if $bytes =~ /^\x89PNG/;
    return readable($name, Compress::Zlib::memGunzip($bytes) // 'a gz file that is broken', $work) if $bytes =~ /^\x1f\x8b/;
    if ($bytes =~ /\x00/) {
        my @chunks = unpack '(a4096)*', $bytes;
        return map { "bytes " . 4096 * $_ . ' to ' . (4096 * $_ + length($chunks[$_]) - 1) . ': ' . md5_hex($chunks[$_]) } 0 .. $#chunks;
    }
    $bytes =~ s{data:image/png;base64,([A-Za-z0-9+/=]+)}{'png ' . md5_hex(join "\n", png_lines(decode_base64($1)))}ge;
    $bytes =~ s/\Q$work\E/WORK/g;
    return without_times($name, $bytes);
}

# A paragraph of several lines in one, if it tells a time: where it is broken depends on that.
sub unbroken {
    my ($line, $next) = @_;
    my $more = 0;
    $more++ while $more < @$next && $next->[$more] =~ /^    +\S/;
    my $whole = join ' ', $line, map { s/^ +//r } @$next[0 .. $more - 1];
    return $line if !$more || $whole !~ $TIMED;
    splice @$next, 0, $more;
    return $whole;
}

# A cell of a table in HTML, whose column may tell speeds; of each table @$timed has the place of the cell and those.
sub html_cell {
    my ($line, $timed) = @_;
    @$timed = (0, {}) if $line =~ /<thead>|<table/ || !@$timed;
    $timed->[0] = 0 if $line =~ /<tr>/;
    return $line if $line !~ /^<t[hd]/;
    my ($place, $columns) = ($timed->[0]++, $timed->[1]);
    $columns->{$place} = $1 if $line =~ m{>(Mrays?/s|s)</th>};
    $columns->{$place} = $1 if $line =~ m{>(least|most)</th>} && $columns->{$place - 1};
    return $line =~ s{(<td[^>]*>)[\d.]+(</td>)}{$1#$2}r if $columns->{$place};
    return $line;
}

sub without_times {
    my ($name, $text) = @_;
    $text =~ s/raydiff(": "| )\d+\.\d+\.\d+/raydiff$1VERSION/g;
    my (@lines, @next, $columns, $speeds, $shares, @timed);
    $text =~ s/^raydiff [a-z]+: \d+ s[,:] .*\n//mg; # tells every ten seconds how far it is, and keeps that in a log
    my $log = $name =~ /findings\.jsonl$/;
    my $checkpoints = () = $text =~ /^\{"checkpoint"/mg;
    my $at = 0;
    $text =~ s/^(\{"checkpoint".*\n)/++$at > 1 && $at < $checkpoints ? '' : $1/mge if $log && $LONG;
    $text =~ s{(<th>(?:processor|system)</th>\n<td class="wrap">)[^\n]*}{$1#}g;
    $text =~ s{(^```\n|<pre>)brute: .*?(?=^```|</pre>)}{$1#}gms; # the machine
    my @head = $name =~ /\.csv$/ && $text =~ /^(.*)\n/ ? split(/,/, $1) : ();
    my @left_out = grep { $head[$_] =~ /^$FIELD$/ } 0 .. $#head;
    @next = split /\n/, $text, -1;
    pop @next if @next && $next[-1] eq '';
    while (@next) {
        my $line = shift @next;
        $line = unbroken($line, \@next) if $line =~ /^(?:  )?\S.*:/;
        $line =~ s/("$FIELD": )-?\d[-\d.e+]*/$1#/g;
        $speeds = 1 if $line =~ /"mrays_per_s": /;
        $line =~ s/("(?:median|min|max)": )-?\d[-\d.e+]*/$1#/ if $speeds;
        $speeds = 0 if $line =~ /\}/;
        $shares = 1 if $line =~ /"core_seconds": /;
        $line =~ s/: [\d.e-]+(,?)$/: #$1/ if $shares;
        $shares = 0 if $line =~ /\}/;
        if (@left_out && @lines) {
            my @cell = split /,/, $line, -1;
            $_ = '#' for @cell[grep { $_ < @cell } @left_out];
            $line = join ',', @cell;
        }
        $line =~ s/^ "bytes": \d+,$/ "bytes": #,/ if @next && $next[0] =~ /^ "figures": /; # of a report, which has times
        $line = html_cell($line, \@timed) if $name =~ /\.html$/;
        # Speeds are the last columns of a table.
        $columns = scalar(split ' ', $1) if $line =~ / +(Mray\/s\b.*)$/;
        $columns = 0 if $line !~ /\S/ || $line =~ /^what it means/;
        if ($columns && $line !~ /^\s*(refused|skipped|failed)\b/) {
            $line =~ s/ +[\d.]+ \([\d.]+-[\d.]+\)/ #/ or $line =~ s/(?: +\S+){$columns}$//;
        }
        if ($line =~ $ANY_TIME) { $line =~ s/$_->[0]/$_->[1]/g for @TIMES }
        push @lines, $line;
    }
    return @lines;
}

1;
