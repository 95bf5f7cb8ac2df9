#!/bin/sh
# raydiff build as a user meets it, and builders on a device where there is none.
#   sh tests/build/build.sh PROGRAM
set -u
. tests/scripts/expect.sh
raydiff=$(realpath "$1")

# Where no device can be opened, whatever asks for one is skipped, and nothing else is played in its place.
export RAYDIFF_VULKAN_LIBRARY=/nowhere/libvulkan.so
expect 77 'no loader' build sphere:n=4
expect 77 'no loader' check sphere:n=4 --engine cpu --builder gpu_hploc --layout f32 --count 100 --repeat 1
expect 77 'no loader' check sphere:n=4 --engine cpu --builder median,gpu_hploc --layout f32 --count 100 --repeat 1
expect 77 'no loader' precompute --scene sphere:n=4 --builder gpu_lbvh30 --out "$dir/tree"
[ -e "$dir/tree" ] && bad 'a tree that was not built is written'
expect 77 'no loader' fuzz --builder gpu_hploc --engine cpu --trials 10 --dir "$dir/campaign"
expect 1 . conform 'closest.cpu.f32.gpu_lbvh63.robust.mt.cornell.axis.1'
has 'trials without a device are skipped' ', 1 skipped$'
unset RAYDIFF_VULKAN_LIBRARY

for builders in median median,gpu_hploc gpu_hploc,median gpu_lbvh30,median,gpu_hploc; do
    expect 2 '^raydiff build: --builder: median is no builder on a device' build sphere:n=4 --builder $builders
done
expect 2 'no scene given' build
expect 2 'an engine or a builder on Vulkan' check sphere:n=4 --engine cpu --builder hploc --driver stock

"$raydiff" build sphere:n=4 >"$dir/out" 2>"$dir/err"
[ $? -ne 77 ] || { echo "SKIP $(tail -n 1 "$dir/err")"; echo "build: $failed failed"; [ "$failed" -eq 0 ] && exit 77; exit 1; }
expect 0 . check sphere:n=4 --engine cpu --builder gpu_hploc --layout f32 --count 100 --repeat 1 --driver stock --device 0

# Text and JSON are the same, and both are what the parts add up to.
for rounds in 1 3; do
    expect 0 . build sphere:n=12 soup:n=0 soup:n=1 'soup:n=777,seed=3' --rounds $rounds --json "$dir/rows.json"
    cp "$dir/out" "$dir/text"
    grep -q "\"rounds\": $rounds," "$dir/rows.json" || bad "not $rounds rounds"
    perl tests/build/rows.pl "$dir/rows.json" "$dir/text" >"$dir/out" 2>&1 || bad "numbers of $rounds rounds"
done
expect 0 . build sphere:n=12 --builder gpu_lbvh30 --rounds 1 --json "$dir/rows.json"
[ "$(grep -c 'gpu_.* all ' "$dir/out")" -eq 1 ] || bad 'one builder was named'

# A scene that cannot be read ends it with 2, wherever it stands; the others are told.
for of in "$dir/none.obj sphere:n=3" "sphere:n=3 $dir/none.obj" "sphere:n=2 $dir/none.obj sphere:n=3"; do
    expect 2 'none.obj: No such file' build $of --builder gpu_lbvh30 --rounds 1 --layout tiny8 --json "$dir/rows.json"
    has "of $of those that can be read" '^sphere:n=3: 72 triangles'
    grep -q '"exit": 2,' "$dir/rows.json" || bad "build $of: its JSON has another exit code"
done

# Layouts: those that were named, all that a device encodes, and why not. A bound beyond 2^100 is refused on both sides.
for layouts in tiny8:1 tiny8,cwbvh80:2 'tiny8*:3' all:4 every:4; do
    expect 0 . build sphere:n=3 --builder gpu_lbvh63 --rounds 1 --layout "${layouts%:*}"
    [ "$(grep -c ' wide ' "$dir/out") $(grep -c ' words ' "$dir/out")" = "${layouts#*:} ${layouts#*:}" ] || bad "layouts $layouts"
done
for layouts in f32 f32,tiny8 tiny8,f32; do
    expect 2 '^raydiff build: --layout: f32 is not encoded on a device' build sphere:n=3 --layout $layouts
done
printf 'v %s\n' '0 0 0' '2e30 0 0' '0 2e30 0' >"$dir/far.obj"
echo 'f 1 2 3' >>"$dir/far.obj"
expect 0 . build "$dir/far.obj" --builder gpu_hploc --rounds 1 --json "$dir/rows.json"
[ "$(grep -cE '^gpu_hploc refused: (cwbvh80|tiny8): a bound is at most 1.26765' "$dir/out")" -eq 2 ] || bad 'two layouts refuse'
grep -qE ' (wide|words) ' "$dir/out" && bad 'what was refused has no times'
[ "$(grep -c '"refused": "' "$dir/rows.json") $(grep -c '"equal": false' "$dir/rows.json")" = '2 2' ] || bad 'refusals as JSON'

# Refits: each layout, or why not; without --move none.
expect 0 . build sphere:n=12 soup:n=0 'soup:n=50,offset=1e5' --builder gpu_lbvh63 --rounds 2 --move 0.05 --json "$dir/rows.json"
has 'a layout that refuses' '^refit rf16 refused: rf16: a bound is at most 65504'
perl -MJSON::PP -0777 -e 'open my $json, "<", shift; open my $text, "<", shift;
    my $r = decode_json(<$json>)->{refits}; my ($bad, @told) = 0; my $n = @$r / 3;
    for (split /\n/, <$text>) { push @told, $1 . ($2 || " equal") if /^equal +(?!gpu_)(\w+)/ || /^refit (\w+)( refused)/ }
    for (@$r) { my $refused = defined $_->{refused};
        $bad++ if $_->{equal} == $refused || defined $_->{differs} || $_->{rounds} != 0;
        $bad++ if !$refused && $_->{triangles} > 50 && !($_->{ratio_least} <= $_->{ratio} && $_->{ratio} <= $_->{ratio_most} && $_->{device_ms} > 0 && $_->{c_ms} > 0); }
    $bad++ if grep { $r->[$_]{layout} ne $r->[$_ % $n]{layout} } 0 .. $#$r;
    my %first = map { $_->{layout} => defined $_->{refused} } @$r[0 .. $n - 1];
    $bad++ if $n != 56 || grep { !exists $first{$_} } qw(f32 rf16 cwbvh80 tiny8 tiny8_l8 tiny8_l14 half4 hpb64 amd64 amd64_g1 gfx12_mesa bvh4_f32_world bvh8_u12_node);
    $bad++ if grep { $first{$_} && !/_scene$/ } keys %first;
    $bad++ if join("|", sort @told) ne join "|", sort map { "$_->{layout} " . (defined $_->{refused} ? "refused" : "equal") } @$r;
    exit $bad;' "$dir/rows.json" "$dir/out" || bad 'refits as JSON and as text'
expect 0 . build sphere:n=3 --builder gpu_lbvh63 --rounds 1
grep -q refit "$dir/out" && bad 'a refit without --move'
expect 2 'move' build sphere:n=3 --move 0

# The same trees as their twins' in C, and another than each other's.
for kind in lbvh30 lbvh63 hploc; do
    for builder in $kind gpu_$kind; do
        expect 0 . precompute --scene 'soup:n=500,seed=7' --builder $builder --item-count 2 --out "$dir/$builder"
    done
    cmp -s "$dir/$kind" "$dir/gpu_$kind" || bad "gpu_$kind is not $kind"
done
cmp -s "$dir/hploc" "$dir/lbvh63" && bad 'hploc is lbvh63'

echo "build: $failed failed"
[ "$failed" -eq 0 ]
