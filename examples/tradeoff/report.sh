#!/bin/sh
# report.sh - the whole report by one command: a sweep, what it recommends held against frames that it has not seen, the
# articles' statements, how cost grows, what four scenes require, and the peers.
#
#   examples/tradeoff/report.sh [BIN [OUT]]     default: build/bin out/report
#
# HBIL_CAPTURES: a folder of captures, whose frames come on top of the built-in scenes. About an hour on two cores;
# leave the machine alone meanwhile. Stopped, it goes on where it was: a part that is in OUT is not made again. Remove
# OUT to begin anew. OUT/README.md leads to all parts. The sweep alone: REPORT_PARTS=sweep.
set -eu

bin=${1:-build/bin}
out=${2:-out/report}
tool=$bin/hbil-tradeoff
scenes="--scene cornell,fence,metals,terrain"
frames=$scenes
[ -z "${HBIL_CAPTURES:-}" ] || frames="$scenes --frames $HBIL_CAPTURES"
size="--size 480x270"        # of the built-in scenes
truth="--converged 16x128x1" # a quarter of the default's samples: up to a tenth of rmse_sampling is its own noise
# LP_NUM_THREADS balances Mesa's software rasterisers; GPUs do not read it.
export LP_NUM_THREADS="${LP_NUM_THREADS:-16}"

# part NAME COMMAND...: what it prints becomes OUT/NAME.md once it is whole. Exit code 1 is an answer, too.
part()
{
    name=$1; shift
    if [ -e "$out/$name.md" ]; then return 0; fi
    echo "report: $name" >&2
    code=0
    "$@" > "$out/$name.tmp" || code=$?
    if [ "$code" -gt 1 ]; then
        echo "report: $name ended with code $code. What is done stays; start again to go on" >&2
        exit "$code"
    fi
    mv "$out/$name.tmp" "$out/$name.md"
}

# Presets of articles; sweeps and samples of the whole screen, slices against steps, with the presets among them.
# hbil_paper and hbil_screen are left out: with all bounces, a converged estimator is seven frames of thousands of
# samples.
sweep()
{
    commit=$(git -C "$(dirname "$0")" describe --always --dirty 2>/dev/null || true)
    # shellcheck disable=SC2086 # words
    set -- "$tool" sweep $frames $size $truth --repeat 15 --seconds 3 --out "$out/results.csv" \
        ${commit:+--commit "$commit"}
    "$@" --preset hbao,hbao_plus,gtao,bitmask
    "$@" --preset fast,balanced,quality --options 'march=sweep slices=1,2,4,6,8,12 sweep_stride=1,2,3 filter=none,3x3'
    "$@" --options 'march=sweep slices=2,4,8 sweep_stride=3 filter=5x5 downscale=1,2'
    "$@" --preset sampled --options 'preset=sampled slices=1,2,4,8 steps=4,8,16'
}

# What a budget gets, and whether that is honest: each frame in turn as one that was not seen, but for runs of presets.
recommendations()
{
    echo '# Recommended, and held against frames that the choice has not seen'
    for output in ao near; do
        for error in rmse_hf rmse_model; do
            for preset in fast balanced quality; do
                set -- "$tool" recommend --csv "$out/results.csv" --output $output --error $error --as-fast-as $preset
                printf '\n## %s of %s, as fast as `%s`\n\n```text\n' $error $output $preset
                "$@" || return 2
                "$@" --holdout all --anchor fast,balanced,quality,sampled || [ $? -eq 1 ] || return 2
                echo '```'
            done
        done
    done
}

peers()
{
    set -- --scene cornell --size 480x270
    [ -z "${HBIL_CAPTURES:-}" ] || set -- --frames "$HBIL_CAPTURES"
    code=0
    "$bin/hbil-peers" "$@" --csv "$out/peers.csv" || code=$?
    [ "$code" -ne 4 ] || echo 'Left out: node, npm or the registry is missing. Remove this file and start again for it.'
    [ "$code" -eq 4 ] || return "$code"
}

index()
{
    awk -v date="$(date +%F)" -v cores="$(getconf _NPROCESSORS_ONLN)" -v threads="$LP_NUM_THREADS" \
        -v cpu="$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1)" -F, '
        NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
        $column["output"] == "ao" && !seen[$column["frame"]]++ {
            frames = frames (frames ? ", " : "") $column["frame"] " (" $column["width"] "x" $column["height"] ")" }
        !configs[$column["config_hash"]]++ { ++count }
        { if (column["commit"]) commit = ", commit " $column["commit"] }
        { device = $column["device"]; driver = $column["driver"]; version = $column["version"] }
        END {
            print "# Report\n"
            print "By `make report`, " date ": hbil " version commit ", " device ", " driver "; " cpu ", " cores \
                " cores, LP_NUM_THREADS=" threads "."
            print count " configs on " frames ".\n"
            print "![Error of ao over time, the Pareto front, presets](ao-front.svg)"
            print "![Error of near light over time, the Pareto front, presets](near-front.svg)\n"
            print "- [The sweep](report.md): fronts, each option alone, slices against steps, distance from the centre"
            print "- [Recommendations](recommendations.md), held against frames that they have not seen"
            print "- [Statements](statements.md) of the source articles, checked"
            print "- [Growth](growth.md): cost against slices, steps and pixels, and against memory accesses alone"
            print "- [Ablation](ablation.md): what four scenes require"
            print "- [Peers](peers.md): three.js and n8ao, all rows"
        }' "$out/results.csv"
}

mkdir -p "$out"
sweep
"$tool" report --csv "$out/results.csv" -o "$out"
[ "${REPORT_PARTS:-all}" = all ] || exit 0
part recommendations recommendations
# shellcheck disable=SC2086 # words
{
    part growth "$tool" growth --scene terrain --size 640x360 --rays 1
    part ablation "$tool" ablate $scenes --size 320x180 --repeat 5 --seconds 1
    part statements "$tool" statements $frames $size $truth --repeat 3 --seconds 0.5
}
part peers peers
rm -f "$out/README.md"
part README index
echo "$out/README.md"
