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
input=/dev/null

# walk 'COMMAND WORDS' 'OPTION=VALUE ...': these are used, all others that any command knows refused. A
# '~' before an option: nothing of the output can show it. A '%': it is used, and another walk tries it. '@' as value: a
# file that it writes. tests/options/walks.pl plays it.
walk() {
    printf '%s\t%s\t%s\n' "$input" "$1" "$(echo $2)" >>"$dir/walks"
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
walk 'check soup:n=40,seed=2 --count 64 --repeat 1 --engine vulkan_brute --rays primary --compiler passes:strip-debug' \
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
walk 'bench layouts --scene soup:n=40,seed=2 --count 64 --rounds 1 --layout f32 --engine vulkan --compiler passes:strip-debug' "%scene %layout
    engine=vulkan_stackless %count %rounds %csv %json %seed %bvh compiler=opt decorate=final buffers=reference ~driver=stock
    ~device=0 ~workgroup=32 %wide %color"
walk 'bench layouts --scene soup:n=40,seed=2 --count 64 --rounds 1 --layout f32 --engine cpu' "scene=soup:n=41 layout=rf16
    engine=cpu_stackless ~count=70 ~rounds=2 csv=@ json=@ ~seed=3 ~bvh=$dir/soup.json ~threads=1 wide color=always"
walk 'bench fuzz --count 1 --rounds 1 --engine cpu --layout f32' '~count=2 ~rounds=2 csv=@ ~seed=3 json=@ engine=cpu_stackless
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
walk "bench frames --scene cornell --engine cpu --layout f32 --frames 2 --turns 1 --warm-up 0 --size 16x12 --out $files/f" "scene=sphere:n=2 ~engine=cpu layout=rf16
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
walk "report soup:n=40 --out $files/r.html --parts machine" "~title=T parts=pictures ~threads=1 json=@ out=@ ~driver=stock
    ~device=0 ~workgroup=32 ~time=99 check=$dir/check.json bench=$dir/bench.json benchmark=$dir/benchmark.json
    ~picture=P=$dir/p.png ~doctor=$dir/doctor.json ~findings=$dir/found"
walk "report --findings $dir/found --out $files/r.html --parts check" "~title=T ~peer-memory=999 ~peer-time=9 ~parts=machine json=@ out=@
    ~driver=stock ~device=0 ~workgroup=32 ~threads=1 ~time=99 check=$dir/check.json bench=$dir/bench.json benchmark=$dir/benchmark.json
    ~picture=P=$dir/p.png ~doctor=$dir/doctor.json ~findings=$dir/found ~baseline=fuzz/baseline.txt
    ~web=pages"

perl tests/options/walks.pl "$raydiff" "$dir" ${walked:+"$walked"} <"$dir/walks"
