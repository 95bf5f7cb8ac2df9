# Whether the cases have every option of every command, and every value of those that are one of a few.
use strict;
use warnings;

# Options without which a run is not the same everywhere, or ends by a clock: of a Vulkan device and its compilers, a
# window, a benchmark.
my $elsewhere = qr/^--(driver|device|workgroup|compiler|decorate|buffers|shader|window|seconds|pictures|log|fps|benchmark\S*|peer-\S+|help|self-test)$/;

# Those of one command that no case can have: what they measure is times, or an engine that is not here.
my %left_out = map { $_ => 1 } 'bench --instances', 'bench --warm-up', 'bench --frames', 'bench --turns', 'bench --size', 'bench --out',
    'bench --bounces', 'bench --profile', 'bench --quick', 'bench --store', 'bench --bvh', 'bench --svg', 'report --bench', 'min --layout';

my %values = (
    '--rays' => 'ray', '--layout' => 'layouts', '--builder' => 'builders', '--store' => 'storages', '--box' => 'box', '--tri' => 'triangle',
    '--query' => 'queries', '--engine' => 'engines');
my %named = (
    '--modes' => 'all mixed drawn', '--form' => 'c amber text', '--profile' => 'repaired rtrs vulkan dxr', '--color' => 'auto always never',
    '--handler' => 'naive bvh bvh-rf blank', '--plan' => 'paths steps auto', '--optimize' => 'reinsert reinsert=1', '--parts' => 'check',
    '--show' => 't prim normal boxes triangles depth overlap overlap-all inflation error class', '--require' => 'watertight cpu');

# Takes the program and every command of the cases; returns what is missing.
sub uncovered {
    my ($program, @commands) = @_;
    my (%has, %given, @missing);
    for my $line (map { split /;|&&|\|\|?|\n|\bdo\b/ } @commands) {
        my ($command, $rest) = $line =~ /raydiff (?:fuzz (?=merge|replay)|scene (?=list))?(\S+)(.*)/ or next;
        while ($rest =~ /(?<= )(--?[a-z][a-z-]*)(?:[ =]('[^']*'|[^ ]*))?/g) {
            my ($option, $value) = ($1, $2 // '');
            pos($rest) -= length($value) + 1 if $value =~ /^-/;
            $option = {'-w' => '--width', '-h' => '--height'}->{$option} // $option;
            $has{"$command $option"} = 1;
            $given{$option}{$_} = 1 for split /,/, $value =~ tr/'//dr;
        }
    }
    chomp(my @overview = `'$program' --help`);
    for my $command (map { /^ {2,4}([a-z]+)  +\S/ ? $1 : () } @overview) {
        my $help = `'$program' $command --help`;
        $help .= `'$program' diff a.png --help` if $command eq 'diff';
        for my $option ($help =~ /^  (?:-\w, )?(--[a-z][a-z-]*[a-z])/mg) {
            next if $option =~ $elsewhere || $left_out{"$command $option"} || $command =~ /^(doctor|bisect|build)$/;
            push @missing, "raydiff $command $option" if !$has{"$command $option"};
        }
    }
    $named{$_} = join ' ', map { /^  (\S+) / ? $1 : () } split /\n/, `'$program' list $values{$_}` for keys %values;
    for my $option (sort keys %named) {
        for my $value (split / /, $named{$option}) {
            next if $option eq '--engine' && $value =~ /vulkan|embree|rayquery|webgpu/;
            next if $option eq '--builder' && $value =~ /^gpu_/;
            push @missing, "$option $value" if !grep { my $p = quotemeta($_) =~ s/\\\*/.*/gr; $value =~ /^$p$/ } keys %{$given{$option}};
        }
    }
    my %seen;
    return grep { !$seen{$_}++ } @missing;
}

1;
