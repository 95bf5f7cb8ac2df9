# Tracers for suites of commands, made of fuzz/samples/sample_tracer.c; read with `.` after compare.sh or alike.
# tracer NAME: $dir/NAME. sees: as it is; blind: finds nothing; careless: finds no any-hit; refuser: refuses everything;
# ender: ends at the first rays.
tracer() {
    case $1 in
    sees) edit= ;;
    blind) edit='s/size > 0\.0f/size > 1e30f/' ;;
    careless) edit='s/if (meets(/if (q.query == 0 \&\& meets(/' ;;
    refuser) edit='s/"RDRA", 1, 0, q.rays/"RDRA", 1, q.rays > 0, 0/; s/i < q.rays/i < 0/' ;;
    ender) edit='s/^        struct ray \*ray = /        if (q.rays > 0) exit(9);&/' ;;
    esac
    sed "$edit" fuzz/samples/sample_tracer.c >"$dir/$1.c"
    [ "$1" = sees ] || ! cmp -s "$dir/$1.c" fuzz/samples/sample_tracer.c || bad "$1 is the sample as it is"
    cc -O1 -o "$dir/$1" "$dir/$1.c" || bad "$1 is not compiled"
}
