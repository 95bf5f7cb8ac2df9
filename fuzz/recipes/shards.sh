# What the recipes share; sourced, with $here the recipes' folder.
n=8 jobs=1 retries=3 dir=findings-shards raydiff=raydiff

# Takes our options off; what is left in $rest are options of `raydiff fuzz`, quoted for eval.
take_options() {
    rest=
    while [ $# -gt 0 ]; do
        case $1 in
        -n | -j | -r | -d | -x | -S)
            [ $# -gt 1 ] || { echo "$name: $1 needs a value" >&2; exit 2; }
            case $1 in
            -n) n=$2 ;;
            -j) jobs=$2 ;;
            -r) retries=$2 ;;
            -d) dir=$2 ;;
            -x) raydiff=$2 ;;
            -S) machines=$2 ;;
            esac
            shift 2
            ;;
        -h | --help)
            sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$here/$name"
            exit 0
            ;;
        --shard | --dir | --shard=* | --dir=* | --time | --time=*)
            echo "$name: $1 is the recipe's own; see --help" >&2
            exit 2
            ;;
        *)
            rest="$rest $(quoted "$1")"
            shift
            ;;
        esac
    done
    for number in "$n" "$jobs" "$retries"; do
        case $number in
        '' | *[!0-9]* | 0?*) echo "$name: '$number' is no whole number" >&2; exit 2 ;;
        esac
    done
    case " $rest " in
    *"'--trials"*) ;;
    *) echo "$name: --trials N is needed: shards are shares of so many trials" >&2; exit 2 ;;
    esac
    raydiff=$(command -v "$raydiff") || { echo "$name: no raydiff here; name one with -x" >&2; exit 2; }
    case $raydiff in /*) ;; *) raydiff=$PWD/$raydiff ;; esac
    mkdir -p "$dir" && dir=$(cd "$dir" && pwd) || exit 2
}

quoted() { printf "'%s'" "$(printf '%s' "$1" | sed "s/'/'\\\\''/g")"; }

# The shards that have not been played to their end, with blanks between.
lost_shards() {
    lost= i=1
    while [ "$i" -le "$n" ]; do
        [ -e "$dir/shard-$i.code" ] || lost="$lost $i"
        i=$((i + 1))
    done
    echo $lost
}

# Joins all shards into DIR/merged and exits as one `raydiff fuzz` would.
join_shards() {
    lost=$(lost_shards)
    if [ -n "$lost" ]; then
        echo "$name: not played to their end: shards $lost of $n (logs: $dir/shard-*.log)" >&2
        exit 3
    fi
    folders= i=1 worst=0
    while [ "$i" -le "$n" ]; do
        folders="$folders $(quoted "$dir/shard-$i")"
        [ "$(cat "$dir/shard-$i.code")" = 0 ] || worst=1
        i=$((i + 1))
    done
    rm -rf "$dir/merged"
    eval "\"\$raydiff\" merge --to \"\$dir/merged\" $folders" || exit $?
    exit "$worst"
}
