# What the value checks share; read with `.`. Needs $raydiff; sets $dir, a temporary folder, and counts in $failed.
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
: >"$dir/seen"

bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
    [ "$failed" -lt 10 ] || { echo "$failed failed, the rest is left out"; exit 1; }
}

# What NAME.awk needs beside lib.awk.
libraries() {
    case $1 in
    diff_images) echo -f tests/values/pictures/pixels.awk ;;
    show) echo -f tests/values/pictures/pixels.awk -f tests/values/pictures/paths.awk -f tests/values/floats.awk ;;
    bench_frames | bench_paper | bench_special) echo -f tests/values/bench/cells.awk ;;
    bench_builders) echo -f tests/values/bench/tree.awk ;;
    scene_info) echo -f tests/values/scenes/obj.awk ;;
    diff_pixel) echo -f tests/values/pictures/pixels.awk -f tests/values/floats.awk ;;
    diff_engines | render) echo -f tests/values/pictures/pixels.awk -f tests/values/pictures/paths.awk ;;
    esac
}

# name, least number of values, files and variables of awk: $dir/json by the fields of tests/values/fields.*.txt, then
# with the files by NAME.awk of tests/values or a folder in it, which has in took how many nanoseconds the command ran.
values() {
    name=$1 least=$2
    shift 2
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" || { bad "$name: no JSON"; return; }
    told=$(sed -n 's/^exit=//p' "$dir/flat")
    [ "${told:-$code}" -eq "$code" ] || bad "$name: the JSON tells exit code $told, it was $code"
    sh tests/values/fields.sh "$name" "$dir/flat" "$dir/seen" "$ran" || bad "$name: not as fields.*.txt have it: $ran"
    case $ran in
    'raydiff bench '* | 'bench '*) [ "$code" -gt 1 ] || tail -n 1 "$dir/text" | grep -qE "^bench ${name#bench_}: [0-9]+ rows?: " || bad "$ran: no conclusion" ;;
    esac
    laws=$(ls "tests/values/$name.awk" tests/values/*/"$name.awk" 2>/dev/null)
    awk -v least="$least" -v took="$took" -f tests/values/lib.awk $(libraries "$name") -f "$laws" "$dir/flat" "$@" || bad "$name: $ran"
}

# arguments of raydiff; exit code 0 or 1; took: nanoseconds
run() {
    ran="raydiff $*"
    took=$(date +%s%N)
    "$raydiff" "$@" >"$dir/text" 2>"$dir/err"
    code=$?
    took=$(($(date +%s%N) - took))
    [ "$code" -le 1 ] && return
    bad "$ran: exit $code"
    tail -n 3 "$dir/err"
    return 1
}

# name, least number of values, what to run with --json FILE
compare() {
    name=$1 least=$2
    shift 2
    run "$@" --json "$dir/json" && values "$name" "$least" "$dir/text"
}

# names: every line that fields.*.txt has of them was printed, but for those marked with '?'
all_seen() {
    for name in "$@"; do
        sh tests/values/fields.sh --unseen "$name" "$dir/seen" || bad "$name: lines of fields.*.txt that nothing prints"
    done
}
