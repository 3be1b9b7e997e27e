#!/bin/sh
# run.sh BIN CORPUS WORK SECONDS [TARGET...] - libFuzzer on each target in turn, for so many seconds each. What it learns stays in
# WORK/TARGET, for the next run; what it finds goes to CORPUS/TARGET/found. Paths are absolute: the programs go to folders of
# their own.
set -u
bin=$1 corpus=$2 work=$3 budget=$4
shift 4
[ $# -gt 0 ] || set -- $(ls "$corpus")
failed=0
for target; do
    [ -x "$bin/search_$target" ] || { echo "fuzz: no program $bin/search_$target" >&2; exit 2; }
    found=$corpus/$target/found
    mkdir -p "$work/$target" "$found" || exit 2
    echo "fuzz $target: $budget s"
    "$bin/search_$target" -max_total_time="$budget" -timeout=20 -rss_limit_mb=4096 -max_len=8192 -close_fd_mask=3 \
        -print_final_stats=1 -reload=0 -artifact_prefix="$found/" "$work/$target" "$corpus/$target" 2> "$work/$target.log" &
    pid=$!
    while sleep 10; kill -0 $pid 2>/dev/null; do grep '^#[0-9]' "$work/$target.log" | tail -n 1 | cut -c 1-78; done
    if ! wait $pid; then
        failed=1
        echo "fuzz $target: FAULT, see $work/$target.log:"
        grep -E 'ERROR|runtime error|does not hold|Test unit written' "$work/$target.log"
    fi
    grep '^#[0-9]' "$work/$target.log" | tail -n 1 | cut -c 1-78
    rmdir "$found" 2>/dev/null
done
if [ $failed -ne 0 ]; then
    echo
    echo 'Mend what was found, then make each input a regression: tests/fuzz/README.md, "A case that was found"'
fi
exit $failed
