# What the tests of the recipes for many machines share; sourced with $build and $dir (absolute) set.
# The campaign has findings by construction: a layout as published takes part.
options="--trials 16384 --rays 100 --engine cpu --layout rtrs_rf,rf16 --no-shrink --seed 5"
failed=0
bad() {
    echo "FAILED  $1"
    failed=1
}

# Dies once in shard 3 of 8, by a signal that nothing can catch, while it plays; $dir/died then says
# how much it had played. So does a machine that loses power.
cat >"$dir/raydiff" <<END
#!/bin/sh
if [ "\$1 \$3" = "fuzz 3/8" ] && [ ! -e '$dir/died' ]; then
    '$build/raydiff' "\$@" &
    pid=\$!
    tries=0
    until [ -s '$dir/shards/shard-3/findings.jsonl' ] || [ "\$tries" -gt 200 ]; do
        sleep 0.05
        tries=\$((tries + 1))
    done
    kill -9 \$pid || { echo 0 >'$dir/died'; exit 4; } # it was too fast
    wait \$pid
    grep -c . '$dir/shards/shard-3/findings.jsonl' >'$dir/died'
    exit 137
fi
exec '$build/raydiff' "\$@"
END
chmod +x "$dir/raydiff"

# The same trials in one run, and what the recipe left, which must be the same.
compare() {
    "$build/raydiff" fuzz $options --dir "$dir/one" >"$dir/one.log" 2>&1
    code=$?
    [ "$code" -eq 1 ] || bad "one run has findings (exit $code)"
    "$build/raydiff" merge --to "$dir/one-merged" "$dir/one" >>"$dir/one.log" 2>&1 || bad "merge"
    diff -r "$dir/one-merged" "$dir/shards/merged" >"$dir/diff" ||
        bad "eight shards are one run: $(head -n 3 "$dir/diff")"
    [ "$(cat "$dir/died")" -gt 0 ] || bad "a shard died while it played"
    # The comparison sees what is lost.
    rm -rf "$dir/seven"
    set -- "$dir"/shards/shard-[1-7]
    "$build/raydiff" merge --to "$dir/seven" "$@" >/dev/null 2>&1 || bad "merge of seven"
    diff -r "$dir/one-merged" "$dir/seven" >/dev/null && bad "seven shards are not one run"
}
