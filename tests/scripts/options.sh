#!/bin/sh
# Every command with every option that any command knows: what a run uses it takes, and its output
# shows so; all else is refused by one line that names the option, before anything is played.
#   sh tests/scripts/options.sh BUILD/raydiff [COMMAND]     only the walks of one command
set -u
raydiff=$1
walked=${2-}
. tests/scripts/expect.sh
files=$dir/files
mkdir "$files"
runs=0 pairs=0 done= input=/dev/null

commands=$("$raydiff" help --commands)
for command in $commands; do
    "$raydiff" $command --help >"$dir/help"
    [ $command != diff ] || "$raydiff" diff a.png --help >>"$dir/help"
    grep -oE -- '--[a-z][a-z-]*[a-z]' "$dir/help" | sed 's/^--//' | sort -u |
        grep -vx 'help\|matrix\|self-test' | tr '\n' ' ' | sed 's/^/ /' >"$dir/knows.$command"
done
every=$(cat "$dir"/knows.* | tr ' ' '\n' | sort -u)

# A value that the option would take; "" for those without.
value_of() {
    case $1 in
    all | as-expected | brief | camera-fixed | camera-orbit | decimal | faithful | feedback | fill-normals | force | \
        general | handler-* | hard | list | no-shrink | quick | summary | verbose | waves | wide | window | worlds | \
        shaders) value= ;;
    color) value=always ;;
    engine | require) value=cpu ;;
    layout) value=f32 ;; builder) value=median ;; box) value=robust ;; tri) value=mt ;; store) value=compact ;;
    query) value=any ;; modes) value=all ;; rays) value=random ;; profile) value=rtrs ;; optimize) value=reinsert ;; handler) value=bvh ;;
    show) value=t ;; form) value=text ;; plan) value=steps ;; parts) value=machine ;; size) value=8x8 ;;
    pixel) value=1,1 ;; shard) value=1/2 ;; show-range) value=0:1 ;; triangles) value=8-16 ;; driver) value=stock ;;
    format) value=raydiff ;; compiler) value=opt ;; decorate) value=final ;; buffers) value=texel ;;
    ray) value='0,0,0 1,0,0' ;; cause) value=sentinel ;; scene) value=soup:n=9 ;; path) value=soup:n=9 ;;
    baseline) value=fuzz/baseline.txt ;; steps) value=refit ;;
    bvh | shader | waivers | check | bench | benchmark | doctor | findings | corpus | verify | picture)
        value=$dir/nothing ;;
    out | json | csv | svg | junit | jsonl | tap | markdown | html | log | paths | to | dir | save | benchmark-out)
        value=$files/x.$1 ;;
    *) value=3 ;;
    esac
}

# What a run says and writes, without the digits of times; a file that it made is part of it.
look() { # name, command line
    rm -rf "$files"
    mkdir "$files"
    "$raydiff" "$@" >"$dir/out" 2>"$dir/err" <"$input"
    code=$?
    runs=$((runs + 1))
    { echo "$code"; cat "$dir/out" "$dir/err"; cd "$files" && find . -type f -size +0 && cat tree* w/*.html 2>/dev/null | cksum; } |
        sed -E 's/[0-9]+\.[0-9]+(e[+-]?[0-9]+)?/#/g' >"$dir/seen"
}

# The last run was refused by one line that names the option.
is_refused() { # option
    [ "$code" -eq 2 ] || return 1
    { IFS= read -r said && ! read -r more; } <"$dir/err" || return 1
    case "$said " in *"--$1"[!a-z-]* | *"--handler ${1#handler-} "*) return 0 ;; esac
    return 1
}

# No two outputs of $base are one file, by the same name or by another: the second would take the first one's place.
apart() {
    outputs=$(echo "$uses" | tr ' ' '\n' | sed -n 's/^~\{0,1\}\([a-z]*\)=@$/\1/p' | grep -vx 'dir\|to')
    for first in $outputs; do
        for second in $outputs; do
            [ "$first" != "$second" ] || continue
            others=$(echo " $base " | sed -E "s# --($first|$second) [^- ][^ ]* # #g")
            for other in x.png link.png; do
                pairs=$((pairs + 1))
                rm -rf "$files"
                mkdir "$files"
                [ $other = x.png ] || { : >"$files/x.png"; ln -s x.png "$files/$other"; }
                find "$files" -exec ls -ld {} + | sort >"$dir/before"
                "$raydiff" $others --$first "$files/x.png" --$second "$files/$other" >"$dir/out" 2>"$dir/err" <"$input"
                code=$?
                is_refused "$first" && is_refused "$second" || bad "raydiff $base: --$first and --$second are one file: exit $code"
                find "$files" -exec ls -ld {} + | sort | cmp -s - "$dir/before" || bad "raydiff $base: --$first and --$second: written"
            done
        done
    done
}

# walk 'COMMAND WORDS' 'OPTION=VALUE ...': these are used, all others that any command knows refused. A
# '~' before an option: nothing of the output can show it. A '%': it is used, and another walk tries it. '@' as value: a
# file that it writes.
walk() {
    base=$1
    command=${base%% *}
    case ${walked:-$command} in "$command") ;; *) return ;; esac
    uses=" $(echo $2) "
    knows=$(cat "$dir/knows.$command")
    look $base
    mv "$dir/seen" "$dir/plain"
    for use in $uses; do
        case $use in %*) continue ;; esac
        name=${use#\~}
        option=${name%%=*}
        given=${name#*=}
        pairs=$((pairs + 1))
        case "$knows " in *" $option "*) ;; *) bad "$command --help has no --$option" ;; esac
        [ "$given" != @ ] || given=$files/y.$option
        [ "$given" != "$files/y.out" ] || given=$files/y.png
        # No option is given twice: the base has its own value.
        others=$(echo " $base " | sed -E "s# --$option( [^- ][^ ]*)? # #")
        if [ "$given" = "$name" ]; then
            look $others --$option
        else
            look $others --$option "$given"
        fi
        if is_refused "$option" && grep -q 'not used' "$dir/err"; then
            bad "raydiff $base --$option: refused"
        elif [ "$code" -gt 1 ] && [ "$code" -ne 77 ]; then
            bad "raydiff $base --$option $given: exit $code"
        elif [ "${use#\~}" = "$use" ] && cmp -s "$dir/seen" "$dir/plain"; then
            bad "raydiff $base --$option $given: is taken, and changes nothing"
        fi
    done
    apart
    for option in $every; do
        case $uses in *" $option "* | *" ~$option "* | *" %$option "* | *" $option="* | *" ~$option="*) continue ;; esac
        # What the command knows nothing of is tried once.
        case " $done $knows " in *" $command "*" $option "*) ;; *" $command "*) continue ;; esac
        pairs=$((pairs + 1))
        value_of "$option"
        case $option,$command in tap,conform | benchmark,render | turns,fuzz | steps,fuzz) value= ;; esac
        "$raydiff" $base --$option ${value:+"$value"} >"$dir/out" 2>"$dir/err" <"$input"
        code=$?
        is_refused "$option" || bad "raydiff $base --$option $value: exit $code, and it is not used"
    done
    done="$done $command"
}

"$raydiff" precompute --scene soup:n=40,seed=2 --out "$dir/soup.json" 2>/dev/null
"$raydiff" precompute --scene rtrs --out "$dir/rtrs.json" 2>/dev/null
"$raydiff" precompute --scene cornell --out "$dir/cornell.json" 2>/dev/null
echo "closest.* it is known https://example.org" >"$dir/waivers"

# What trees are played on, and by whom.
walk 'check soup:n=40,seed=2 --count 64 --repeat 1 --engine cpu --rays primary' \
    "layout=f32 store=compact engine=fast builder=sah_sweep leaf=1 ~bvh=$dir/soup.json optimize=reinsert presplit=3 move=0.1 steps=refit:one:2 box=watertight
    tri=woop query=any rays=random count=70 ~repeat=2 brute=300 brute-rays=3 ~require=watertight
    json=@ ~threads=1 wide color=always"
walk 'check soup:n=40,seed=2 --count 64 --repeat 1 --engine vulkan_brute --rays primary --compiler size' \
    'engine=vulkan move=0.1 steps=refit:one:2 tri=woop query=any rays=random count=70 ~repeat=2 brute=300 brute-rays=3 ~require=watertight
    json=@ compiler=opt decorate=final buffers=texel ~driver=stock ~device=0 ~workgroup=32 wide color=always'
walk 'check soup:n=40 --count 64 --repeat 1 --engine brute' \
    'engine=cpu tri=woop move=0.1 steps=refit:one:2 query=any rays=random count=70 seed=3 ~repeat=2 brute=300 brute-rays=3
    ~require=watertight json=@ ~threads=1 wide color=always'
walk 'check crowd:n=6,seed=2 --count 64 --repeat 1 --engine cpu --layout f32 --rays primary' \
    'layout=rf16 store=compact engine=cpu_stackless builder=sah_sweep leaf=1 optimize=reinsert presplit=3 braid=4 steps=refit:one:2 box=watertight tri=woop
    query=any rays=random modes=all count=70 ~repeat=2 brute=300 brute-rays=3 ~require=watertight json=@ ~threads=1 wide color=always'
walk 'explain soup:n=40 --index 3 --engine cpu --builder ploc --layout f32' \
    'rays=random count=70 index=4 seed=3 engine=fast layout=rf16 store=compact builder=lbvh leaf=1 ~radius=1
    optimize=reinsert presplit=3 box=watertight tri=woop query=any json=@ html=@ svg=@ ~threads=1 ~wide ~color=always'
# A compiler that loses all decorations, whatever version of spirv-opt is here.
cat >"$dir/bare" <<'END'
#!/usr/bin/perl
binmode STDIN, ':raw'; binmode STDOUT, ':raw'; local $/; my @word = unpack 'V*', <STDIN>; my @out = @word[0 .. 4];
for (my $i = 5; $i < @word; $i += $word[$i] >> 16) {
    push @out, @word[$i .. $i + ($word[$i] >> 16) - 1] unless $word[$i] == (3 << 16 | 71) && $word[$i + 2] == 42;
}
print pack 'V*', @out;
END
chmod +x "$dir/bare"
walk "bisect soup:n=40,seed=2 --count 64 --rays primary --tries 1 --compiler passes:$dir/bare" 'compiler=size:final ~good=size symptom=bits
    ~tries=3 ~time=9 layout=rf16 ~store=compact engine=vulkan_stackless ~builder=sah_sweep ~leaf=1 ~box=watertight ~tri=woop
    ~query=any ~rays=random count=70 json=@ ~driver=stock ~device=0 ~workgroup=32 ~wide ~color=always'
# A finding brings its own.
walk 'explain fuzz/corpus/rounded-inward.trial --index 0 --engine cpu' \
    '~index=0 ~cause=rounded_inward engine=fast layout=f32 json=@ html=@ svg=@ ~threads=1 ~wide ~color=always'
walk 'explain crowd:n=6,seed=2 --count 64' \
    'rays=random modes=all count=70 ~seed=3 ~braid=4 engine=fast layout=f32 ~builder=lbvh ~leaf=1
    ~optimize=reinsert ~presplit=3 ~box=watertight ~tri=woop query=any json=@ ~threads=1 ~wide ~color=always'
walk 'leaks sphere:n=4 --count 100 --engine cpu --builder sah_binned' \
    'layout=f32 store=compact engine=fast ~bins=2 ~leaf=1 ~optimize=reinsert ~presplit=3 ~builder=sah_binned box=robust tri=mt count=70
    ~seed=3 profile=dxr json=@ ~threads=1 wide color=always'
walk 'leaks wall:n=2 --count 100 --engine cpu --builder sah_binned' \
    'layout=f32 engine=cpu_stackless ~bins=2 ~leaf=1 ~optimize=reinsert ~presplit=3 ~braid=4 ~builder=sah_binned box=robust tri=mt count=70
    ~seed=3 profile=dxr json=@ ~threads=1 wide color=always'
# Files and formats.
walk 'gen soup:n=9 --count 5' 'rays=vertices count=6 seed=3 query=any decimal out=@'
"$raydiff" gen sphere:n=2 --count 5 >"$dir/rays"
{ echo 'formula unknown ieee'; for i in 1 2 3 4 5; do echo m; done; } >"$dir/hits"
walk "judge sphere:n=2 $dir/rays $dir/hits" 'brute=1 ~displacement=3 ~require=watertight json=@ wide color=always'
walk "precompute --scene soup:n=40 --builder median --out $files/tree" 'scene=sphere:n=2 out=@ layout=f32 builder=lbvh
    item-count=1 seed=3 ~optimize=reinsert presplit=3'
walk 'tree tests/golden/input/faulty.tree' '~format=raydiff faults=1 json=@ ~wide color=always'
walk 'tree soup:n=9 --from rayquery --driver none' '~from=rayquery:clone ~driver=stock ~device=0 ~aim=9 ~save=@
    ~format=lavapipe ~faults=1 ~json=@ ~wide ~color=always'
walk 'scene list' ''
walk 'scene info soup:n=9' 'json seed=3'
walk 'list builders' ''
walk 'build soup:n=40 --builder gpu_lbvh63 --rounds 1' "builder=gpu_lbvh30 ~driver=stock ~device=0 ~rounds=2 move=0.1 ~seed=3 json=@ ~wide color=always"
walk 'build soup:n=40 --builder median --same 1' "builder=lbvh layout=f32 ~same=2 ~seed=3 json=@ ~wide color=always"
trial=fuzz/corpus/slot-not-read.trial
walk "export $trial --form text" 'to=@ ~form=text engine=embree ~ray=0'
walk "web $trial --out $files/w" '~index=0 engine=brute layout=f32 out=@ ~threads=1 ~force'
walk "web soup:n=40 --index 3 --engine cpu --layout f32 --out $files/w" 'rays=random index=4 engine=fast layout=rf16 box=watertight tri=woop out=@
    ~threads=1 ~force'
walk "replay $trial --engine cpu" 'engine=brute layout=f32 ~time=9 brief as-expected json=@ ~threads=1 ~wide color=always'
walk "min $trial --asks 5 --out $files/m.trial" \
    'out=@ asks=6 ~time=9 ~trial-time=9 ~memory=999 ~engine=cpu json=@ ~threads=1'
# Suites, campaigns, measurements, pictures.
walk 'conform closest.cpu.f32.median.robust.mt.soup.random.1' "list count=70 ~brute=300 ~waivers=$dir/waivers ~require=cpu verbose tap junit=@
    ~threads=1 ~wide color=always"
walk 'conform hard.01-* --list --engine cpu' 'engine=brute layout=rf16 builder=ploc box=watertight tri=woop ~list ~hard
    ~quick'
walk 'conform world.*.identity.*.1.1 --list --engine cpu' 'engine=brute layout=rf16 builder=ploc box=watertight tri=woop ~list
    ~worlds'
walk 'bench builders --scene soup:n=40 --rounds 1 --threads 1' 'scene=soup:n=41 ~rounds=2 csv=@ json=@ threads=2 wide color=always'
walk 'bench layouts --scene soup:n=40,seed=2 --count 64 --rounds 1 --layout f32 --engine vulkan --compiler size' "%scene %layout
    engine=vulkan_stackless %count %rounds %csv %json %seed %bvh compiler=opt decorate=final buffers=reference ~driver=stock
    ~device=0 ~workgroup=32 %wide %color"
walk 'bench layouts --scene soup:n=40,seed=2 --count 64 --rounds 1 --layout f32 --engine cpu' "scene=soup:n=41 layout=rf16
    engine=cpu_stackless ~count=70 ~rounds=2 csv=@ json=@ ~seed=3 ~bvh=$dir/soup.json ~threads=1 wide color=always"
walk 'bench fuzz --count 3 --rounds 1 --engine cpu --layout f32' '~count=4 ~rounds=2 csv=@ ~seed=3 json=@ engine=cpu_stackless
    layout=f32,rf16'
bench='--scene cornell --count 64 --rounds 1'
walk "bench error $bench --engine cpu --layout f32 --tri mt --rays random" "scene=sphere:n=2 ~count=70 ~rounds=2 csv=@ json=@ svg=@
    ~seed=3 engine=cpu_stackless layout=rf16 ~tri=woop ~box=watertight rays=vertices ~bvh=$dir/cornell.json ~threads=1 wide color=always"
walk "bench spawn $bench --engine cpu --layout f32 --tri mt --rays random" 'scene=sphere:n=2 count=70 ~rounds=2 csv=@ json=@
    seed=3 ~engine=cpu_stackless ~layout=f32 tri=woop ~box=watertight rays=vertices ~threads=1 wide color=always'
walk "bench matrix $bench --engine cpu --layout f32" 'scene=sphere:n=2 ~count=70 ~rounds=2 csv=@ json=@ svg=@
    ~seed=3 engine=cpu_stackless layout=rf16 store=compact ~threads=1 wide color=always'
walk "bench fast $bench" 'scene=sphere:n=2 ~count=70 ~rounds=2 csv=@ json=@ ~seed=3 engine=cpu ~threads=2'
walk 'bench tightness --scene cornell --count 64' 'scene=sphere:n=2 count=70 csv=@ json=@ seed=3 wide color=always'
walk 'bench traffic --scene cornell --count 64 --depths 2' "scene=sphere:n=2 count=70 csv=@ json=@ svg=@ ~seed=3
    ~bvh=$dir/cornell.json layout=cwbvh80 ~store=gathered scheduler=depth_first depths=1,2 units=2 lanes=2 ~packet=2 treelet=1k
    queue=7 private=1k:2:64 shared=2k:2:64 ~row=64 wide color=always"
walk "bench worlds $bench --instances 9" 'scene=sphere:n=2 ~count=70 ~rounds=2 csv=@ json=@ ~seed=3 threads=2 instances=10'
# Frames draw no rays: there is no seed but of a scene that is drawn by chance.
walk "bench frames --scene cornell --engine cpu --layout f32 --frames 2 --size 16x12 --out $files/f" "scene=sphere:n=2 ~engine=cpu layout=rf16
    ~tri=woop ~box=watertight ~bvh=$dir/cornell.json frames=3 ~size=8x8 ~out=@ turns=2 ~warm-up=3 bounces=2 ~profile=rtrs ~threads=1 ~wide"
walk 'bench oracle --scene soup:n=40 --count 64 --rounds 1' 'scene=soup:n=41 count=70 ~rounds=2 csv=@ ~seed=3 json=@'
walk "render --path rtrs --width 8 --height 8 --engine cpu --out $files/tree.png" \
    "out=@ frames=2 ~camera-orbit json=@ show=t path=cornell width=9 height=9 ~workgroup-size=4 profile=rtrs bounces=0
    ~ambience=0.5 ~camera-light-strength=0.5 ~camera-fixed handler=bvh-rf ~handler-naive ~handler-bvh handler-bvh-rf
    ~handler-blank engine=brute layout=rf16 ~builder=ploc ~box=watertight ~tri=woop ~leaf=1 ~waves ~optimize=reinsert ~presplit=3
    ~threads=1 ~paths=$files/y.csv ~window ~bvh=$dir/rtrs.json"

# Whole answers, machines, made scenes, pictures that differ, campaigns, reports.
"$raydiff" gen sphere:n=2 --count 5 --decimal | awk -f fuzz/samples/tracer.awk >"$dir/answers"
input=$dir/answers
walk verify 'brute=1 ~displacement=3 ~require=watertight json=@ wide color=always'
input=/dev/null
walk 'doctor --driver stock' '~driver=stock ~device=0 json=@ ~threads=1 ~workgroup=32'
walk "construct --out $files/made.json --model soup:n=9 0 --camera-pos 0 1 -8 0 0 0 --camera-fixed" \
    '~seed=3 json ~fill-normals ~camera-fixed ~scale=2'
walk 'diff --path cornell --engine cpu,fast --width 24 --height 18' "pixel=3,3 angle=30 ~list=1 out=@ json=@ path=sphere:n=4
    width=25 height=19
    ~workgroup-size=3 profile=rtrs bounces=0 ~ambience=0.5 camera-light-strength=0.5 engine=cpu,brute ~threads=1
    ~layout=rf16 leaf=1 builder=ploc box=watertight ~tri=woop optimize=reinsert ~presplit=3 ~waves ~bvh=$dir/cornell.json
    handler=bvh-rf handler-bvh-rf ~handler-bvh handler-blank"
walk "fuzz --trials 20 --jobs 1 --engine cpu --layout f32 --corpus none --dir $files/d" 'trials=40 ~time=60 ~until=1 seed=3
    ~jobs=2 ~shard=1/1 engine=cpu,fast layout=f32,rf16 builder=ploc faithful worlds steps rays=9 triangles=4-8 ~feedback
    pairs=1
    ~no-shrink ~trial-time=9 ~memory=999 json=@ junit=@ tap=@ jsonl=@ dir=@ ~baseline=fuzz/baseline.txt'
"$raydiff" check soup:n=40 --count 64 --repeat 1 --engine cpu --layout f32 --json "$dir/check.json" >/dev/null
"$raydiff" bench builders --scene soup:n=40 --rounds 1 --threads 1 --json "$dir/bench.json" >/dev/null 2>&1
"$raydiff" doctor --driver stock --json "$dir/doctor.json" >/dev/null
"$raydiff" render --path rtrs -w 8 -h 8 --engine cpu --out "$dir/p.png" >/dev/null 2>&1
"$raydiff" render --path rtrs -w 8 -h 8 --engine cpu --benchmark --benchmark-frames 2 \
    --benchmark-out "$dir/benchmark" >/dev/null 2>&1
"$raydiff" fuzz --trials 2 --jobs 1 --engine cpu --layout f32 --corpus none --dir "$dir/found" >/dev/null 2>&1
walk "merge --to $files/all $dir/found" 'to=@'
walk "report soup:n=40 --out $files/r.html --parts machine" "~title=T parts=check ~threads=1 json=@ out=@ ~driver=stock
    ~device=0 ~workgroup=32 ~time=99 check=$dir/check.json bench=$dir/bench.json benchmark=$dir/benchmark.json
    ~picture=P=$dir/p.png ~doctor=$dir/doctor.json ~findings=$dir/found"
walk "report --findings $dir/found --out $files/r.html" "~title=T ~peer-memory=999 ~peer-time=9 ~parts=machine json=@ out=@
    ~driver=stock ~device=0 ~workgroup=32 ~threads=1 ~time=99 check=$dir/check.json bench=$dir/bench.json benchmark=$dir/benchmark.json
    ~picture=P=$dir/p.png ~doctor=$dir/doctor.json ~findings=$dir/found ~baseline=fuzz/baseline.txt
    ~web=pages"

for command in ${walked:-$commands}; do
    case " $done " in *" $command "*) ;; *) bad "no run of $command" ;; esac
done
echo "options: $pairs pairs of run and option, $runs runs, $failed failed"
[ "$failed" -eq 0 ]
