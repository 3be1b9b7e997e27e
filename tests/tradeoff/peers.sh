#!/bin/sh
# peers.sh BIN ROOT CACHE - hbil-peers on a small built-in scene: both peers give an ao that goes with the truth, ours
# are nearer to it, none of the peers' text is in the repository at ROOT, and exit codes. CACHE is filled over the
# network if need be, and left.
set -u
bin=$1
root=$2
cache=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
faults=0

fault() {
    echo "peers: $*"
    faults=$((faults + 1))
}
exits() { # CODE ARGUMENT...
    code=$1
    shift
    "$bin" "$@" >"$work/out" 2>"$work/err"
    got=$?
    [ "$got" -eq "$code" ] || fault "$*: exit $got, not $code: $(tail -n 1 "$work/err")"
}

exits 0 --help
exits 2
exits 2 --scene cornell --frames "$work"
exits 2 --scene cornell --size 8x8
exits 2 --scene cornell --repeat none
exits 3 --frames "$work" --cache "$work/none"
exits 3 --scene nowhere --cache "$work/none"

# Without node: PATH has no program at all.
PATH=$work exits 4 --scene cornell --size 32x18 --rays 1 --cache "$work/none"
grep -q 'packages.sh peers' "$work/err" || fault "without node: the message names no fix: $(cat "$work/err")"
[ "$faults" -eq 0 ] || exit 1

command -v node >/dev/null || { echo "peers: skipped, node is missing: sh packages.sh peers"; exit 77; }
mkdir -p "$cache"
"$bin" --scene cornell --size 128x72 --rays 32 --repeat 1 --cache "$cache" --csv "$work/rows.csv" >"$work/page.md" \
    2>"$work/err"
code=$?
if [ "$code" -eq 4 ]; then
    echo "peers: skipped, the packages cannot be had: $(grep -a extract: "$work/err" | tail -n 1)"
    exit 77
fi
[ "$code" -eq 0 ] || { cat "$work/err"; fault "exit $code"; exit 1; }

# Fields: 5 who, 6 convention, 7 chosen by, 13 rmse, 15 correlation with the scene's truth. The device's name may have a
# comma in it, and goes.
sed 's/"[^"]*"/device/' "$work/rows.csv" >"$work/rows"
best() {
    awk -F, -v who="$1" '$5 == who && $6 == "best" && $7 == "scene" && $15 > m { m = $15 }
        END { print m + 0 }' "$work/rows"
}
for peer in three n8ao; do
    correlation=$(best $peer)
    echo "$peer: correlation with the path-traced truth $correlation"
    awk -v c="$correlation" 'BEGIN { exit !(c > 0.5) }' || fault "$peer: correlation $correlation is not above 0.5"
done
for preset in balanced quality; do
    awk -F, -v who=$preset '$5 == who && $6 == "as shipped" { own = $13 }
        ($5 == "three" || $5 == "n8ao") && (!least || $13 < least) { least = $13 }
        END { printf "%s: rmse %s, least of the peers %s\n", who, own, least
              exit !(own > 0 && own < least) }' "$work/rows" ||
        fault "$preset is not nearer to the truth than all rows of the peers"
done
grep -q '^| `balanced` | scene | three | equal taps |' "$work/page.md" || fault "the page compares nothing"

# Any line of their sources of 40 letters and more.
sources="three/examples/jsm/shaders/GTAOShader.js three/examples/jsm/shaders/PoissonDenoiseShader.js
         three/examples/jsm/postprocessing/GTAOPass.js n8ao/dist/N8AO.js"
for file in $sources; do cat "$cache/node_modules/$file" || fault "$file is not in the package"; done |
    sed 's/^[[:space:]]*//; s/[[:space:]]*$//' | grep -E '.{40}' | sort -u >"$work/lines"
[ "$(wc -l <"$work/lines")" -gt 500 ] || fault "the packages have only $(wc -l <"$work/lines") lines to look for"
if grep -rnFIf "$work/lines" --exclude-dir=node_modules "$root/examples" "$root/tests" "$root/hbil.h" "$root/backends" \
    "$root/shadergen" >"$work/found"; then
    fault "text of a package is in the repository: $(head -n 3 "$work/found")"
fi
[ "$faults" -eq 0 ] || exit 1
