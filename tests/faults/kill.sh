#!/bin/sh
# Programs that are killed while they write, whose disk fills up, whose files may not grow, whose libraries are missing: no output is ever
# half there, what is left over is named *.tmp, errors say what to do, and the next run mends all.
#
#   sh tests/faults/kill.sh BIN PRELOAD      folder of the programs, the library of preload.c
#
# A line per fault and a count at the end. HBIL_LONG=1: every step of every program; else a slice of them, seeded by HBIL_SEED
# (default 1). 77 where this system preloads no libraries; programs without a driver, or that were not built, are left out and said so.
set -u
if [ $# -ne 2 ] || [ ! -x "$1/shadergen" ] || [ ! -f "$2" ]; then
    echo "usage: sh kill.sh BIN PRELOAD" >&2
    exit 2
fi
bin=$(cd "$1" && pwd)
preload=$(cd "$(dirname "$2")" && pwd)/$(basename "$2")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit 1
export LP_NUM_THREADS="${LP_NUM_THREADS:-16}"
ulimit -c 0
exec 2> /dev/null # the shell tells of each process that is killed; all that matters goes to the standard output
failed=0 faults=0 seed=${HBIL_SEED:-1}
echo "seed $seed"

fault() { failed=$((failed + 1)); echo "FAIL  $name, step $n, $how: $*"; sed 's/^/      /' err.txt | head -3; }
# Is this step one of the slice, of which one in $1 is taken?
in_slice()
{
    [ -z "${HBIL_LONG:-}" ] || return 0
    seed=$(((seed * 1103515245 + 12345) % 2147483648))
    [ $((seed / 65536 % $1)) -eq 0 ]
}
# Runs the program with a fault: under AT HOW COMMAND ...; its exit code in $code
under()
{
    code=0
    at=$1 as=$2
    shift 2
    { (exec timeout 120 env HBIL_FAULT_UNDER="$work/out" HBIL_FAULT_AT="$at" HBIL_FAULT="$as" HBIL_FAULT_COUNT="$work/count" \
        LD_PRELOAD="$preload" ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0 "$@" > out.txt 2> err.txt < /dev/null); } || code=$?
}
plain() { code=0; timeout 120 "$@" > out.txt 2> err.txt < /dev/null || code=$?; }

# Times aside, which differ from run to run.
figures() { sed 's/[-+0-9.e]*[0-9]/N/g' "$1"; }
# Has a file that grows line by line nothing but whole lines, but for the last, where $2 says that it may be torn?
whole_lines()
{
    cells=$(head -1 "want/$1" | awk -F"$3" '{ print NF }')
    [ "$2" -eq 1 ] || [ ! -s "out/$1" ] || [ -z "$(tail -c 1 "out/$1")" ] || return 1
    head -n "$(wc -l < "out/$1")" "out/$1" | awk -F"$3" -v n="$cells" '$0 !~ /^#/ && n > 1 && NF != n { bad = 1 } END { exit bad }'
}
# Is out/$1 as it was, or as it will be? $2: torn last lines are fine
whole()
{
    if [ "$(cat "out/$1" 2> /dev/null)" = old ]; then return 0; fi
    case $1 in
        *.csv)        whole_lines "$1" "$2" , ;;
        matrix.state) whole_lines "$1" "$2" '\n' ;;
        *.json)       figures "out/$1" > a.txt; figures "want/$1" > b.txt; cmp -s a.txt b.txt ;;
        *)            cmp -s "out/$1" "want/$1" ;;
    esac
}
# All of out/ after a fault; $1: torn last lines are fine, $2: temporary files are
inspect()
{
    (cd out && find . -type f | sed 's|^\./||') > files.txt
    while read -r file; do
        case $file in
            *.tmp) [ "$2" -eq 1 ] || fault "leaves $file" ;;
            *)     if [ ! -e "want/$file" ]; then fault "strange file $file"
                   elif ! whole "$file" "$1"; then fault "half written: $file"; fi ;;
        esac
    done < files.txt
}
# The same command once more, undisturbed, makes all whole.
mend()
{
    plain "$@"
    [ "$code" -eq 0 ] || fault "exit code $code, the next time"
    inspect 0 0
    for file in $(cd want && find . -type f | sed 's|^\./||'); do [ -s "out/$file" ] || fault "no $file, the next time"; done
}
begin()
{
    rm -rf out
    mkdir out
    [ "$old" -eq 1 ] || return 0
    for file in $(cd want && find . -type f | sed 's|^\./||'); do
        mkdir -p "$(dirname "out/$file")"
        echo old > "out/$file"
    done
}
# sweep NAME OLD ONE_OF COMMAND ...: OLD 1: with outputs of before in place. Every step, killed before it, in it, and with a full disk
sweep()
{
    name=$1 old=$2 one_of=$3 n=0 how=nothing
    shift 3
    rm -rf out want
    mkdir out
    under 0 none "$@"
    if [ "$code" -eq 5 ]; then echo "skip  $name: $(head -1 err.txt)"; return 0; fi
    [ "$code" -eq 0 ] || { fault "exit code $code"; return 0; }
    steps=$(cat count)
    mv out want
    [ "$steps" -gt 3 ] || fault "only $steps steps are seen"
    before=$faults
    n=1
    while [ "$n" -le "$steps" ]; do
        for how in kill torn full; do
            in_slice "$one_of" || continue
            begin
            under "$n" "$how" "$@"
            faults=$((faults + 1))
            if [ "$how" = full ]; then
                inspect 0 0
                if [ "$code" -eq 0 ]; then mended "$n"; elif [ "$code" -ne 3 ]; then fault "exit code $code, not 3"; fi
                [ "$code" -eq 0 ] || grep -q 'out/\|out:\|results' err.txt || fault "no error names the file"
            else
                [ "$code" -eq 137 ] || fault "exit code $code, not killed"
                inspect 1 1
            fi
            mend "$@"
        done
        n=$((n + 1))
    done
    # by the clock, without the library
    for n in 1 2 3; do
        how='kill by the clock'
        begin
        "$@" > out.txt 2> err.txt < /dev/null &
        process=$!
        seed=$(((seed * 1103515245 + 12345) % 2147483648))
        sleep "0.$(printf %03d $((seed / 65536 % 300)))"
        { kill -9 $process; wait $process; } 2> /dev/null
        faults=$((faults + 1))
        inspect 1 1
        mend "$@"
    done
    # files that may not grow beyond 512 bytes: the system kills, or refuses
    for how in XFSZ EFBIG; do
        n=0
        begin
        code=0
        { (ulimit -f 1; [ $how = XFSZ ] || trap '' XFSZ; exec "$@" > /dev/null 2> err.txt < /dev/null); } 2> /dev/null || code=$?
        faults=$((faults + 1))
        if [ $how = XFSZ ]; then inspect 1 1; else inspect 1 0; fi
        [ "$code" -ne 0 ] || mended 0
        mend "$@"
    done
    echo "$name: $steps steps, $((faults - before)) faults"
}
# The program says that all went well: then it has.
mended()
{
    for file in $(cd want && find . -type f | sed 's|^\./||'); do
        { [ -s "out/$file" ] && [ "$(cat "out/$file" 2> /dev/null)" != old ]; } || fault "claims success without $file"
    done
}

under 0 none "$bin/shadergen" --version
[ -f count ] || { echo "skipped: this system preloads no libraries"; exit 77; }

sweep shadergen 1 12 "$bin/shadergen" --preset balanced -o out/text/
printf 'outputs = ao\nslices = 1, 2\n' > some.matrix
sweep 'shadergen matrix' 0 30 "$bin/shadergen" matrix some.matrix -o out/ --format glsl --jobs 1 -q
frame='--scene cornell --size 24x14 --rays 4'
# shellcheck disable=SC2086 # words
sweep hbil-frame 1 60 "$bin/hbil-frame" $frame --set slices=1,outputs=ao+near --out out/f.exr --png out/png --report out/r.json -q
if [ -x "$bin/hbil-tradeoff" ]; then
    sweep hbil-tradeoff 0 200 "$bin/hbil-tradeoff" sweep --scene fence --size 24x14 --rays 4 --converged 2x8x1 --seconds 0.1 --repeat 3 \
        --preset hbao --options 'outputs=ao slices=1,2 steps=2' --cache out/cache --out out/r.csv -q
fi
if [ -x "$bin/hbil-viewer" ]; then
    sweep hbil-viewer 1 6 "$bin/hbil-viewer" --headless --frames 1 --size 32x18 --set slices=2 --png out/
fi
# ---- what is missing
name=hbil-frame n=0
missing() # TEXT COMMAND ...
{
    text=$1
    shift
    how=$text
    plain env "$@"
    faults=$((faults + 1))
    [ "$code" -eq 5 ] || fault "exit code $code, not 5"
    grep -qF -e "$text" err.txt || fault "does not say so"
}
if [ -x "$bin/hbil-frame" ]; then
    missing 'no Vulkan loader: apt-get install libvulkan1' LD_PRELOAD="$preload" HBIL_FAULT_DLOPEN=libvulkan \
        ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0 "$bin/hbil-frame" $frame
    missing 'apt-get install mesa-vulkan-drivers' VK_ICD_FILENAMES=/nowhere VK_DRIVER_FILES=/nowhere "$bin/hbil-frame" $frame
    missing 'no validation layer: apt-get install vulkan-validationlayers' VK_LAYER_PATH=/nowhere "$bin/hbil-frame" $frame --validate
    missing 'is no part of a device name: there are' HBIL_DEVICE=nothing-like-it "$bin/hbil-frame" $frame
    missing 'install libosmesa6' LD_PRELOAD="$preload" HBIL_FAULT_DLOPEN=lib ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0 \
        "$bin/hbil-frame" $frame --backend gl
    missing 'OpenGL ES 3.1 context: in Debian, install libegl1' LD_PRELOAD="$preload" HBIL_FAULT_DLOPEN=lib \
        ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0 "$bin/hbil-frame" $frame --backend gles
fi

echo "faults of files: $faults injected, $failed checks failed"
[ "$failed" -eq 0 ]
