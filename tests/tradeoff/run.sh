#!/bin/sh
# The command line of hbil-tradeoff: exit codes, a sweep that is killed and goes on, a pair, an ablation, two
# runs compared, statements.
#   run.sh HBIL_TRADEOFF SHADERGEN TRADEOFF_FRAMES
set -eu
tool=$1 shadergen=$2 frames=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
common="--converged 4x32x1 --seconds 0.5 --cache $work/cache -q"
frame="--scene fence --size 48x28 --rays 16 $common"

fail() { echo "FAILED: $*"; exit 1; }
# code WANTED ARGUMENTS...: runs the program, output in $work/log
code() {
    wanted=$1; shift
    got=0; "$tool" "$@" >"$work/log" 2>&1 || got=$?
    [ "$got" -eq "$wanted" ] || { cat "$work/log"; fail "exit $got instead of $wanted: $*"; }
}
says() { grep -q -- "$1" "$work/log" || { cat "$work/log"; fail "does not say: $1"; }; }

got=0; "$tool" pair fast fast $frame --repeat 3 >"$work/log" 2>&1 || got=$?
if [ "$got" -eq 5 ]; then cat "$work/log"; echo "skipped: no Vulkan device"; exit 77; fi

# ---- usage
code 0 --help; says 'sweep'; says 'ablate'; says 'exit:'
code 0 --version
for command in sweep pair ablate growth statements; do code 0 $command --help; says -- '--cache'; done
code 2; says 'must be sweep'
code 2 swoop
code 2 sweep --scene fence; says '--out'
code 2 sweep --out "$work/x.csv"; says '--scene'
code 2 sweep --out "$work/x.csv" --scene nowhere
code 2 sweep --out "$work/x.csv" --scene fence --options 'slice=1'; says 'slices'
code 2 sweep --out "$work/x.csv" --scene fence --repeat 2
code 2 sweep --out "$work/x.csv" --scene fence --backend d3d
code 2 sweep --out "$work/x.csv" --scene fence --preset slow
code 2 pair fast --scene fence; says 'two configs'
code 2 ablate --scene fence --tolerance x
code 3 sweep --out "$work/x.csv" --frames "$work"; says 'frame-NNN.exr'
code 3 sweep --out "$work/no/x.csv" $frame
code 1 sweep --out "$work/x.csv" $frame --options 'occluder=thick'; says '1 refused'
code 1 pair fast 'occluder=thick' $frame; says 'bitmask'

# ---- a sweep, whole; and one that is killed, torn, and goes on
options='slices=1,4 steps=2..8*2 occluder=height_field,thick'
code 0 sweep $frame --options "$options" --preset fast,hbao --out "$work/whole.csv"
says '8 configs run, 0 were there, 0 equal to others, 6 refused'
"$tool" sweep $frame --options "$options" --preset fast,hbao --out "$work/killed.csv" >"$work/log" 2>&1 &
pid=$! tries=0
while [ "$(cat "$work/killed.csv" 2>/dev/null | wc -l)" -lt 6 ] && [ $tries -lt 200 ]; do sleep 0.05; tries=$((tries + 1)); done
kill -9 $pid 2>/dev/null || true
wait $pid 2>/dev/null || true
rows=$(wc -l <"$work/killed.csv")
[ "$rows" -ge 6 ] && [ "$rows" -lt 16 ] || fail "killed too late or too early: $rows lines"
printf '0.1.0,0123456789abcdef,slices=9' >>"$work/killed.csv"
code 0 sweep $frame --options "$options" --preset fast,hbao --out "$work/killed.csv"
says 'torn'
# everything but times is the same
columns() { sed 's/,[^,]*$//' "$1" | cut -d, -f1-11,16- | sort; }
columns "$work/whole.csv" >"$work/a"; columns "$work/killed.csv" >"$work/b"
diff "$work/a" "$work/b" || fail "a sweep that went on has other rows"
[ "$(wc -l <"$work/whole.csv")" -eq 16 ] || fail "16 lines expected: header, 7 configs of two outputs, one of one"
grep -q ',fast,' "$work/whole.csv" || fail "the preset has no name"
code 0 sweep $frame --options "$options" --preset fast,hbao --out "$work/killed.csv"; says '0 configs run, 8 were there'
code 0 sweep $frame --options "$options" --budget 2 --commit 'v1,2' --out "$work/some.csv"
grep -q ',v1;2,' "$work/some.csv" || fail "the rows do not say the commit"
[ "$(awk -F, 'NR == 1 { n = NF } NF != n' "$work/whole.csv" "$work/some.csv" | wc -l)" -eq 0 ] || fail "a row has not the header's cells"
# psnr of ao follows from its error; the rings' errors lie around the whole's
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { low = 9; high = 0; e = $at["rmse_model"]
      for (i = 1; i <= 5; i++) { v = $at["ring" i "_model"] + 0; if (v < low) low = v; if (v > high) high = v }
      off = $at["psnr"] + 20 * log(e) / log(10)
      if (low > e || high < e || low == high || ($at["output"] == "ao" && off * off > 1e-6)) bad++
      if (!($at["flip"] > 0 && $at["flip"] < 1 && $at["edge_rmse"] > 0 && $at["relative"] > 0 && $at["ring5_hf"] > 0)) bad++ }
    END { exit bad > 0 }' "$work/whole.csv" || { cat "$work/whole.csv"; fail "a measure against the scene"; }
# more slices, less noise: column 20 is the sampling error
noise() { awk -F, -v c="outputs=ao+near slices=$1 steps=8" '$3 == c && $11 == "ao" { print $20 }' "$work/whole.csv"; }
awk "BEGIN { exit !($(noise 4) < 0.8 * $(noise 1)) }" || fail "four slices have the noise of one"

# ---- a config against itself; against 512 times the samples
code 0 pair fast fast $frame --repeat 9 --seconds 3; says 'within noise'
code 0 pair 'outputs=ao slices=1 steps=2' 'outputs=ao slices=16 steps=64' $frame --repeat 9 --seconds 3
if grep -q 'within noise' "$work/log"; then cat "$work/log"; fail "512 times the samples within noise"; fi

# ---- what a config can do without
code 0 ablate 'outputs=ao march=sweep slices=2 filter=5x5' $frame --repeat 3 --tolerance 0.5
says '(full)'; says 'filter=3x3'; says 'downscale=2'
set=$(sed -n 's/^    shadergen --set //p' "$work/log")
[ -n "$set" ] || { cat "$work/log"; fail "no smallest config"; }
"$shadergen" --set "$set" --pass march >/dev/null || fail "the smallest config does not resolve"
if [ "$set" = 'outputs=ao,march=sweep,slices=2,filter=5x5' ]; then fail "half as much error again, and nothing was dropped"; fi

# ---- a sweep against itself, and against the one that went on: other times, the same errors
code 0 compare "$work/whole.csv" "$work/whole.csv"; says 'equal to the last digit'; says '^the same'
got=0; "$tool" compare "$work/whole.csv" "$work/killed.csv" >"$work/log" 2>&1 || got=$?
[ "$got" -le 1 ] || fail "exit $got: compare"
says '15 match, of 8 configs'; says 'equal to the last digit'
sed 's/^\(\([^,]*,\)\{19\}\)[^,]*/\19/' "$work/whole.csv" >"$work/other.csv" # rmse_sampling 9
code 1 compare "$work/whole.csv" "$work/other.csv"; says '15 rows differ, most rmse_sampling'
code 2 compare "$work/whole.csv"; says 'two runs'
code 3 compare "$work/whole.csv" "$work/none.csv"; says 'none.csv'

# ---- statements
code 2 statements $frame --only slices,nonsense; says '--only nonsense'
code 2 statements $frame -o; says 'without its value'
code 3 statements $frame --only fresnel --repeat 3 --seconds 0.1 -o "$work/no/page.md"; says '^## fresnel'
code 0 statements $frame --only slices,fresnel --repeat 3 --seconds 0.1 -o "$work/page.md"
cp "$work/page.md" "$work/log"
says '^## slices'; says '^## fresnel'; says '| 0.5 | 0.496 |'
says '^| `slices=16 steps=2` | 0'; says '^- \*\*does not hold\*\*: it is at most 0.03 %'
says '\*\*: 4 slices of 4 steps have less noise in ao than 2 of 8 (HBAO + GTAO article, GTAO: Noise): 0'
if grep -q '^## half' "$work/log"; then fail "--only shows others"; fi

# ---- a shader of somebody else's, the example's
example=$(dirname "$0")/../../examples/tradeoff/external.comp
external="--external spv=$work/ssao.spv,depth=0,normal=1,ao=2,uniforms=3"
"$frames" --compile "$example" "$work/ssao.spv" || fail "the example does not compile"
code 0 sweep $frame --preset fast $external --out "$work/external.csv"; says '2 configs run'
grep -q ',external:ssao,,' "$work/external.csv" || { cat "$work/external.csv"; fail "no row of the external"; }
code 0 sweep $frame --preset fast $external --out "$work/external.csv"; says '0 configs run, 2 were there'
sed 's/RADIUS = 2.0/RADIUS = 1.0/' "$example" >"$work/other.comp"
"$frames" --compile "$work/other.comp" "$work/ssao.spv"
code 0 sweep $frame --preset fast $external --out "$work/external.csv"; says '1 configs run, 1 were there'
code 0 pair fast external:ssao $external $frame --repeat 3; says '18.0 fetches, 76.0 bytes read, 4.0 written'
code 2 pair fast external:other $external $frame; says 'no --external has this name'
code 2 sweep $frame --external "spv=$work/ssao.spv,depth=0,ao=2,uniforms=3" --out "$work/x.csv"
says 'u_normal at set 0, binding 1'
code 3 sweep $frame --external "spv=$work/none.spv,ao=2" --out "$work/x.csv"; says 'cannot be read'
code 2 sweep $frame $external --backend gl --out "$work/x.csv"; says 'vulkan'
code 0 report --csv "$work/external.csv" -o "$work/report" --no-plots
grep -q '`external:ssao`' "$work/report/report.md" || fail "the report lacks the external"
code 0 recommend --csv "$work/external.csv" --max-rmse 10; says 'best .*(fast)'
if grep -q 'external:' "$work/log"; then cat "$work/log"; fail "an external is recommended"; fi

# ---- captures in folders: a sequence with its history; metals
mkdir "$work/captures"
"$frames" "$work/captures" || fail "no captures were written"
code 0 sweep --frames "$work/captures" $common --options 'temporal=no,yes reproject=gather' --out "$work/frames.csv"
[ "$(cut -d, -f8 "$work/frames.csv" | sort | uniq -c | tr -s ' ' | tr '\n' ';')" = ' 1 frame; 4 metal; 4 move;' ] || {
    cat "$work/frames.csv"; fail "other frames"; }
noise() { awk -F, -v c="$1" '$8 == "move" && $11 == "ao" && (index($3, "temporal=yes") > 0) == c { print $20 }' "$work/frames.csv"; }
awk "BEGIN { exit !($(noise 1) < $(noise 0)) }" || fail "a history of three frames takes no noise away"
code 0 ablate 'f0=scalar march=sweep slices=2 outputs=near' --frames "$work/captures/metal" $common --repeat 3
awk -F'|' '/f0=none/ { found = $6 + 0 } END { exit !(found > 5) }' "$work/log" || { cat "$work/log"; fail "metals lose nothing without f0"; }

# ---- how cost grows: at this size it may well be off
code 2 growth --scene fence --part all; says 'fit or bound'
code 1 growth --part bound --preset slow $frame; says 'slow'
got=0
"$tool" growth --frames "$work/captures/metal" $common --repeat 3 --preset fast,sampled -o "$work/growth.md" >"$work/log" 2>&1 || got=$?
[ "$got" -le 1 ] || { cat "$work/log"; fail "exit $got of growth"; }
[ "$(grep -c '^ns a pixel = ' "$work/growth.md")" -eq 2 ] || { cat "$work/growth.md"; fail "two laws expected"; }
grep -q 'not\*\* within' "$work/growth.md" && law=1 || law=0
[ "$got" -eq "$law" ] || { cat "$work/growth.md"; fail "exit $got does not say what the page says"; }
[ "$(grep -c '^| fast\|^| sampled' "$work/growth.md")" -eq 3 ] || { cat "$work/growth.md"; fail "three passes expected"; }
echo "all passed"
