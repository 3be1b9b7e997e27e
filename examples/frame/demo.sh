#!/bin/sh
# demo.sh - lights the built-in scene on Vulkan and on GL, and compares times and errors. From the repository's folder:
#
#   examples/frame/demo.sh [HBIL-FRAME [FOLDER]]     default: build/bin/hbil-frame out/demo
#
# A backend without a driver is left out and said so; exit 1 if neither runs, or one fails.
set -eu

frame=${1:-build/bin/hbil-frame}
out=${2:-out/demo}

# Reports of hbil-frame, one after the other, to a table. They are printed JSON: one member a line.
table()
{
    awk '
        !match($0, /"[a-z_]+":/) { next }
        {
            key = substr($0, RSTART + 1, RLENGTH - 3)
            value = substr($0, RSTART + RLENGTH)
            gsub(/^[ \t"]+|[",]+$/, "", value)
        }
        key == "backend" { backend[++n] = value }
        key == "device" { device[n] = value; if (length(value) > wide) wide = length(value) }
        key == "name" { pass = value; if (!(pass in known)) { known[pass]; passes[++pass_count] = pass } }
        key == "median" { ms[n, pass] = value }
        value == "{" { output = key }
        key == "rmse" || key == "bias" { error[n, output, key] = value }
        END {
            printf "%-8s %-*s", "backend", wide, "device"
            for (p = 1; p <= pass_count; ++p) printf " %9s", passes[p]
            printf "   ao rmse    bias   near rmse    bias\n"
            for (i = 1; i <= n; ++i) {
                printf "%-8s %-*s", backend[i], wide, device[i]
                for (p = 1; p <= pass_count; ++p) printf " %9.2f", ms[i, passes[p]]
                printf "   %7.4f %+7.4f     %7.4f %+7.4f\n", error[i, "ao", "rmse"], error[i, "ao", "bias"],
                    error[i, "near", "rmse"], error[i, "near", "bias"]
                if (!((i, "total") in ms) || !((i, "ao", "rmse") in error)) bad = 1
            }
            if (bad || !n) { print "demo: a report lacks times or errors" > "/dev/stderr"; exit 1 }
            print "\nms: median of five runs after one that warms up. Errors: against rays traced through the whole scene,"
            print "so also against what the camera does not see."
        }'
}

no_driver=5 # exit code of hbil-frame
ran=
failed=0
mkdir -p "$out"
for backend in vulkan gl; do
    echo "demo: the Cornell box on $backend"
    rm -rf "${out:?}/$backend" "$out/$backend.json"
    code=0
    # LP_NUM_THREADS balances Mesa's software rasterisers; GPUs do not read it.
    LP_NUM_THREADS=${LP_NUM_THREADS:-16} "$frame" --scene cornell --size 640x360 --rays 128 --backend "$backend" \
        --preset quality --set outputs=ao+near+bent+composite --repeat 5 \
        --png "$out/$backend" --report "$out/$backend.json" -q || code=$?
    if [ "$code" -eq 0 ]; then
        ran="$ran $backend"
    else
        echo "demo: $backend left out, hbil-frame ended with code $code"
        [ "$code" -eq "$no_driver" ] || failed=1
    fi
done
[ -n "$ran" ] || { echo "demo: no backend runs" >&2; exit 1; }

echo
for backend in $ran; do cat "$out/$backend.json"; done | table
echo
echo "pictures: before.png (direct light), after.png (and one bounce), ao.png, near.png, bent.png in"
for backend in $ran; do echo "  $out/$backend/"; done
exit "$failed"
