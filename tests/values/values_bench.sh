#!/bin/sh
# The numbers of `raydiff bench` by value: the text against JSON and CSV, ratios, sums and shares made anew from what
# they are made of, bytes and counts against other commands. sh tests/values/values_bench.sh RAYDIFF [BENCHMARK...]
# No speed is expected. Of one round a ratio is that of two speeds, and of two a median is the mean.
set -u
raydiff=$1
shift
. tests/values/compare.sh
known= # what a check is told, as awk's variables

# benchmark, least number of values, rounds, arguments: bench_NAME.awk and rows.awk
bench() {
    name=$1 least=$2 rounds=$3
    shift 3
    case $name in
    layouts | error | matrix | builders)
        run bench "$name" "$@" --rounds "$rounds" --json "$dir/json" && fits "$name"
        wide=--wide
        ;;
    *) wide= ;;
    esac
    run bench "$name" "$@" $wide --rounds "$rounds" --json "$dir/json" --csv "$dir/csv" && rows "$name" "$rounds" &&
        values "bench_$name" "$least" $(ls "$dir"/other.flat 2>/dev/null) rounds="$rounds" $known "$dir/text"
}
# benchmark: the tables in 80 columns
fits() {
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    awk -v bench="$1" -f tests/values/lib.awk -f tests/values/bench/fits.awk "$dir/flat" "$dir/text" || bad "$ran: in 80 columns"
}
# benchmark, rounds: CSV against JSON
rows() {
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" &&
        awk -v rounds="$2" -v least=10 -f tests/values/lib.awk -f tests/values/bench/rows.awk "$dir/flat" "$dir/csv" || bad "$1: rows of CSV"
}
# Another command's JSON for the checks that follow.
other() {
    run "$@" --json "$dir/other.json" && awk -f tests/values/flat.awk "$dir/other.json" >"$dir/other.flat"
}

# Engines of the GPU where there is one; the rest is the processor's.
play_layouts() {
    scenes='sphere:n=6;soup:n=150'
    other check sphere:n=6 soup:n=150 --layout f32,rf16 --engine cpu --rays bounce --count 1000 --repeat 3 --threads 1
    for rounds in 1 2; do
        bench layouts 300 "$rounds" --scene "$scenes" --count 1000 --threads 1 --driver hardware
    done
}

# Members as published lose hits and make triangles up; mt leaks on a closed mesh.
play_error() {
    members='--engine cpu,embree_robust --layout f32,rtrs_rf,rf16 --tri mt,woop --threads 1'
    other check sphere:n=6 soup:n=150,size=0.5 --layout f32,rf16,rtrs_rf --engine cpu --rays edges --count 401 --repeat 1 --brute 0 \
        --threads 1
    bench error 1200 1 --scene 'sphere:n=6;soup:n=150,size=0.5' --count 401 $members
    rm "$dir/other.flat"
    bench error 200 2 --scene 'soup:n=150,size=0.5' --count 300 $members --box rtrs,robust
    # Nothing is hit: exit code 1, also in the JSON.
    bench error 30 1 --scene needles:n=1 --count 1 --rays random --engine cpu --layout f32 --tri mt --threads 1
    [ "$code" -eq 1 ] || bad "a run that proves nothing ends with $code"
    for layouts in f32,rf16 rf16,half4; do
        bench error 80 1 --scene sphere:n=6 --count 100 --engine vulkan,embree --layout $layouts --tri mt
    done
}
play_spawn() {
    run bench spawn --scene soup:n=100,size=0.5 --count 100 --tri mt --threads 1 --json "$dir/json" && fits spawn
    run bench spawn --wide --scene soup:n=100,size=0.5 --count 800 --tri mt --threads 1 --json "$dir/json" --csv "$dir/csv" &&
        rows spawn 0 && values bench_spawn 2000 "$dir/text"
    # Neighbours touch.
    run bench spawn --wide --scene sphere:n=4 --count 150 --threads 1 --engine cpu --tri mt --json "$dir/json" --csv "$dir/csv" &&
        values bench_spawn 1000 "$dir/text"
    # Far is by the largest of its sides, whichever it is: points are moved by as many floats of numbers as large.
    "$raydiff" scene convert sphere:n=4 "$dir/round.obj" >"$dir/text"
    for axis in 2 3 4; do
        awk -v axis=$axis '$1 == "v" { $axis *= 64 } { print }' "$dir/round.obj" >"$dir/long.obj"
        run bench spawn --scene "$dir/long.obj" --rays edges --count 60 --threads 1 --engine cpu --tri mt --json "$dir/json" && awk -f tests/values/flat.awk "$dir/json" |
            awk -F '[.=]' '$3 == "far" { far[$2] = $4 } $3 == "rule" { rule[$2] = $4 } /moved_max=/ { sub(/.*=/, ""); moved[n++] = $0 + 0 }
                END { for (i = 0; i < n; i++) if (far[i] == 1000 && rule[i] == "integer" && moved[i] > most) most = moved[i]; print most + 0 }'
    done >"$dir/of_axes"
    sort -g "$dir/of_axes" | awk 'NR == 1 { least = $1 } END { exit !(NR == 3 && least > 0.1 && $1 < 3 * least) }' ||
        bad "bench spawn: moved by $(echo $(cat "$dir/of_axes")) in a scene that is long on another axis"
}
# The third scene has far more triangles than vertices: a time of one is none of the other.
play_builders() {
    for scene in cornell:n=4 sphere:n=5; do
        trees "$scene" >"$dir/other.flat"
        for rounds in 1 2; do
            bench builders 400 "$rounds" --scene "$scene"
        done
    done
    rm "$dir/other.flat"
    awk 'BEGIN {
        n = 12
        for (i = 0; i < n; i++) print "v", cos(i), sin(i), cos(3 * i)
        for (a = 1; a <= n; a++) for (b = a + 1; b <= n; b++) for (c = b + 1; c <= n; c++) print "f", a, b, c
    }' >"$dir/few.obj"
    bench builders 300 3 --scene "$dir/few.obj"
}
# A tree by each builder, as precompute writes it.
trees() {
    for builder in median rtrs sah_binned sah_sweep lbvh ploc sbvh trbvh ploctree 'sah_binned --optimize reinsert=4' \
        'lbvh --optimize rotate=4' 'lbvh --presplit 0.3' 'trbvh --presplit 0.3'; do
        "$raydiff" precompute --scene "$1" --out "$dir/tree" --builder $builder 2>"$dir/err" || bad "precompute $builder" >&2
        name=${builder%% *}$(case $builder in *=4) echo "_${builder##* }" ;; *presplit*) echo "_presplit=${builder##* }" ;; esac)
        awk -f tests/values/flat.awk "$dir/tree" | sed "s/^/$name./"
        echo "$name.loose=$(sed -n 's/.* \([0-9]*\) inner boxes too small/\1/p' "$dir/err")"
    done
}
# Three triangles are points: every pair with one is left to integers. No time is longer than the whole command's.
play_oracle() {
    "$raydiff" scene convert sphere:n=4 "$dir/points.obj" >"$dir/text" && printf 'f 1 1 1\nf 3 3 3\nf 5 5 5\n' >>"$dir/points.obj"
    for rounds in 1 2; do
        run bench oracle --scene "soup:n=60;$dir/points.obj" --count 1100 --rounds "$rounds" --json "$dir/json" --csv "$dir/csv" &&
            rows oracle "$rounds" &&
            values bench_oracle 30 rounds="$rounds" points=3 "$dir/text"
    done
}
play_fuzz() {
    for rounds in 1 2; do
        known='trials=3' bench fuzz 40 "$rounds" --count 3 --engine cpu,embree_robust
    done
    # All trials of all numbers of workers are those of a campaign, each once: as many answers at fault, as many refusals.
    run bench fuzz --engine cpu --layout rtrs_rf --count 40 --rounds 2 --seed 9 --json "$dir/json"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/other.flat"
    sum() { awk -F = -v key="^$2\$" '$1 ~ key { sum += $2 } END { print sum + 0 }' "$dir/$1.flat"; }
    run fuzz --engine cpu --layout rtrs_rf --trials "$(sum other 'rows.*.trials')" --rays 500 --corpus none --seed 9 --no-shrink \
        --dir "$dir/campaign" --json "$dir/json"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/campaign.flat"
    for pair in rows.*.at_fault=at_fault rows.*.refused=contestants.*.refused_in_this_run; do
        of=$(sum other "${pair%=*}") is=$(sum campaign "${pair#*=}")
        [ "$of" -gt 0 ] && [ "$of" -eq "$is" ] || bad "bench fuzz: ${pair%=*} are $of, of a campaign $is"
    done
    rm -f "$dir/other.flat"
    known='trials=5 alone=1' bench fuzz 40 1 --count 5 --engine cpu --layout f32
}
play_frames() {
    other check sphere:n=6 --layout f32,rf16 --engine cpu --count 50 --repeat 1 --brute 0 --threads 1
    for frames in 5 4; do
        run bench frames --scene sphere:n=6 --engine cpu --layout f32,rf16 --frames "$frames" --turns 2 --warm-up 1 --size 16x12 \
            --out "$dir/frames" --threads 1 --wide && cp "$dir/frames.json" "$dir/json" &&
            values bench_frames 120 wide=1 "$dir/other.flat" "$dir/text" "$dir/frames.csv"
    done
    run bench frames --scene sphere:n=6 --engine cpu --layout f32,rf16,cwbvh80 --frames 1 --size 16x12 --out "$dir/frames" &&
        cp "$dir/frames.json" "$dir/json" && values bench_frames 60 "$dir/other.flat" "$dir/text" "$dir/frames.csv"
    # The versions are those of every engine that draws, wherever it stands.
    for engines in cpu,fast fast,cpu fast; do
        run bench frames --scene sphere:n=3 --engine $engines --layout f32 --frames 1 --size 8x6 --out "$dir/frames"
        grep -q '"versions": ".*fast: [0-9]* thread' "$dir/frames.json" || bad "$ran: no version of engine fast"
    done
    # One handler alone: no ratio.
    rm "$dir/other.flat"
    run render sphere:n=6 --benchmark --benchmark-frames 3 --benchmark-turns 1 --benchmark-warm-up 2 -w 16 -h 12 --camera-orbit \
        --benchmark-out "$dir/frames" && cp "$dir/frames.json" "$dir/json" && values bench_frames 50 "$dir/text" "$dir/frames.csv"
    # Frames of an engine that draws on its own, where it is not told to trace rays; of others the rays alone.
    for engine in embree vulkan 'vulkan --waves'; do
        [ "$engine" = embree ] || "$raydiff" render sphere:n=6 --engine ${engine%% *} -w 8 -h 6 --out "$dir/one.png" >"$dir/text" 2>&1 || continue
        run render sphere:n=6 --benchmark --benchmark-frames 2 --benchmark-turns 1 -w 16 -h 12 --benchmark-out "$dir/frames" \
            --engine $engine && cp "$dir/frames.json" "$dir/json" &&
            values bench_frames 40 waves="$(case $engine in *waves) echo 1 ;; *) echo 0 ;; esac)" "$dir/text" "$dir/frames.csv"
    done
    run bench frames --scene sphere:n=3 --engine cpu,vulkan,brute --layout f32 --frames 2 --size 8x6 --out "$dir/frames" --wide &&
        cp "$dir/frames.json" "$dir/json" && values bench_frames 60 wide=1 "$dir/text" "$dir/frames.csv"
}
play_fast() { for rounds in 1 2; do bench fast 200 "$rounds" --scene sphere:n=6 --count 200; done; }
play_worlds() {
    for rounds in 1 2; do
        known='mesh=288 count=2200' bench worlds 120 "$rounds" --scene sphere:n=6 --count 2200 --instances 50
    done
    # Of duplicates engines choose one or another: these rays are judged, too, however late they come.
    known='mesh=160 count=2600 differ=1' bench worlds 120 1 --scene stack:n=40 --count 2600 --instances 20
}
play_matrix() {
    for rounds in 1 2; do
        bench matrix 200 "$rounds" --scene sphere:n=5 --count 160 --threads 1 --engine cpu,fast --layout f32,rf16,half4
    done
    # Larger than the caches.
    bench matrix 150 1 --scene sphere:n=32 --count 400 --threads 1 --engine cpu,fast --layout f32,rf16
    bench matrix 80 1 --scene soup:n=100 --count 100 --threads 1 --engine embree_robust
    play_leak_rays
    play_sample
    # Members as published are not judged; one of them loses nothing here and yet takes a wrong triangle.
    "$raydiff" scene convert sphere:n=5 "$dir/closed.obj" >"$dir/text" && sed '$d' "$dir/closed.obj" >"$dir/open.obj"
    bench matrix 100 1 --scene "$dir/open.obj" --count 200 --threads 1 --engine cpu --layout rtrs_rf_paper
    lost=$(sed -n 's/^rows\.1\.lost=//p' "$dir/flat") wrong=$(sed -n 's/^rows\.1\.judged_wrong=//p' "$dir/flat")
    [ "$code" -eq 0 ] && [ "$lost" -eq 0 ] && [ "$wrong" -gt 0 ] || bad "bench matrix: rtrs_rf_paper: lost $lost, WRONG $wrong, exit $code"
}
# Errors are of so many rays of each kind, evenly spread over all: of many rays nearly as many are wrong.
play_sample() {
    for count in 4095 4096 4097 40000; do
        run bench matrix --scene sphere:n=6 --engine cpu --layout rtrs_rf --rounds 1 --threads 1 --count $count --json "$dir/json" &&
            awk -f tests/values/flat.awk "$dir/json" | awk -F= -v count=$count '/^rows\..*\.(lost|wrong)=/ { wrong += $2 } /\.asked=/ { asked = $2 }
                END { print count, asked, wrong }'
    done >"$dir/of_counts"
    awk 'NR == 1 { wrong = $3 } $2 != ($1 < 4096 ? 2 * $1 : 8192) || $3 < 0.9 * wrong || $3 > 1.1 * wrong { bad = 1 }
        END { exit bad || NR != 4 || wrong < 900 }' "$dir/of_counts" || bad "bench matrix: rays, asked, wrong: $(echo $(cat "$dir/of_counts"))"
}
# The rays that look for leaks are those of bench error, of every seed.
play_leak_rays() {
    leaked() { sed -n "s/^rows\.$1\.\($2\)=//p" "$dir/flat" | awk '{ sum += $1 } END { print sum + 0 }'; }
    for seed in 1 3; do
        shared="--scene sphere:n=6 --engine cpu,embree --rounds 1 --threads 1 --seed $seed"
        run bench error $shared --count 800 --layout rtrs_rf --tri woop --box watertight --json "$dir/json" && awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
        want=$(leaked "$(sed -n 's/^rows\.\([0-9]*\)\.engine=embree$/\1/p' "$dir/flat" | head -n 1)" 'edge_leaks\|vertex_leaks')
        run bench matrix $shared --count 400 --layout rtrs_rf --json "$dir/json" && awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
        if grep -q 'engine=embree$' "$dir/flat"; then
            [ "$(leaked 0 leaks)" -eq "$want" ] && [ "$want" -gt 9 ] || bad "$ran: embree leaks $(leaked 0 leaks) times, not $want as bench error has it"
        else
            echo 'SKIP leaks of Embree: it is not installed'
        fi
        sed -n 's/^rows\..*\.leaks=/leaks /p' "$dir/flat" | tail -n 1 >>"$dir/of_seeds"
    done
    [ "$(sort -u "$dir/of_seeds" | wc -l)" -eq 2 ] || bad 'bench matrix: another seed has the same leaks'
}
play_tightness() {
    for count in 1100 2200; do # one group, and two
        run bench tightness --scene 'soup:n=50' --count $count --json "$dir/json" && fits tightness
        run bench tightness --wide --scene 'soup:n=50' --count $count --json "$dir/json" --csv "$dir/csv" && rows tightness 0 &&
            values bench_tightness 310 "$dir/text"
    done
}
play_traffic() {
    for wide in '' --wide; do
        for machine in '' '--units 1 --private 1k:2:128 --shared 4k:4:32 --queue 40 --treelet 1024'; do
            run bench traffic $wide --scene 'sphere:n=6;cornell' --count 300 --depths 1,4 --layout f32,cwbvh80 $machine \
                --json "$dir/json" --csv "$dir/csv" && rows traffic 0 && values bench_traffic 900 "$dir/text"
        done
    done
    run bench traffic --scene soup:n=300,size=0.5 --count 300 --scheduler dual,raycore --store gathered --json "$dir/json" --csv "$dir/csv" &&
        rows traffic 0 && values bench_traffic 40 "$dir/text"
    run bench traffic --scene soup:n=300,size=0.5 --count 200 --scheduler packets,depth_first,sorted --layout f32,rf16 \
        --json "$dir/json" --csv "$dir/csv" && rows traffic 0 && values bench_traffic 100 "$dir/text"
}
# All in one run: each has heads of its own in the CSV, and the rows told at its end are those of the files.
play_together() {
    run bench --scene sphere:n=3 --count 60 --rounds 1 --threads 1 --engine cpu,fast --layout f32 --json "$dir/json" \
        --csv "$dir/csv" && rows together 1
    for name in $(sed -n 's/^bench \([a-z]*\): [0-9]* rows*: .*/\1/p' "$dir/text"); do
        told=$(sed -n "s/^bench $name: \([0-9]*\) rows*: .*/\1/p" "$dir/text")
        heads=$(grep -A 1 '^benchmark,' "$dir/csv" | grep -c "^$name,") of=$(grep -c "^$name," "$dir/csv")
        [ "$told" -eq "$of" ] && [ "$heads" -eq 1 ] || bad "bench $name: $told rows told, $of in the CSV, under $heads lines of heads"
    done
    [ "$(grep -c '^benchmark,' "$dir/csv")" -ge 4 ] || bad "bench: fewer than four benchmarks in one CSV"
}

for part in ${*:-layouts error spawn builders oracle fuzz frames fast worlds matrix tightness traffic together}; do
    rm -f "$dir/other.flat"
    "play_$part"
    [ "$part" = together ] || all_seen "bench_$part"
done
echo "values_bench: $failed failed"
[ "$failed" -eq 0 ]
