#!/bin/sh
# shadergen matrix: what it makes, what it makes again, what it removes, and what is left when it is stopped.
#
#   sh tests/cli/matrix.sh SHADERGEN
#
# A line per fault and a count at the end. Works as root, too.
set -u

if [ $# -ne 1 ] || [ ! -x "$1" ]; then
    echo "usage: sh matrix.sh SHADERGEN" >&2
    exit 2
fi
bin=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 1
mounted=
cleanup() { [ -z "$mounted" ] || umount "$mounted"; rm -rf "$work"; }
trap cleanup EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit 1

checks=0
failed=0
group=

say()  { group=$1; }
fault() { failed=$((failed + 1)); echo "FAIL  $group: $1"; }
skip() { echo "skip  $group: $1"; }
# Is the rest, a command, true?
check() # WHAT COMMAND ...
{
    what=$1
    shift
    checks=$((checks + 1))
    "$@" > check.log 2>&1 || { fault "$what"; sed 's/^/      /' check.log | head -5; }
}
# Runs shadergen matrix into out.txt and err.txt, and checks its exit code.
expect() # CODE ARGUMENT ...
{
    want=$1
    shift
    checks=$((checks + 1))
    code=0
    "$bin" matrix "$@" > out.txt 2> err.txt < /dev/null || code=$?
    [ "$code" -eq "$want" ] || { fault "exit code $code, not $want: matrix $*"; sed 's/^/      /' err.txt | head -3; }
}
says()    { check "message has: $1" grep -qF -e "$1" err.txt; }
silent()  { check "nothing on the error stream" test ! -s err.txt; }
absent()  { check "$1 is not there" test ! -e "$1"; }
same()    { check "$1 equals $2" diff -r "$1" "$2"; }
no_temporaries() { check "no temporary file left in $1" test -z "$(find "$1" -name '*.tmp*')"; }
files_of() { find "$1" -type f | LC_ALL=C sort; }
compiled() { sed -n 's/.*; \([0-9]*\) compiled, .*/\1/p' err.txt; }

say 'help and wrong usage'
for flag in -h --help; do
    expect 0 $flag
    check 'usage on the output' grep -q '^usage: shadergen matrix' out.txt
    silent
done
"$bin" --help > out.txt
check 'shadergen --help names it' grep -q 'shadergen matrix' out.txt
echo 'slices = 1, 2' > two.matrix
for arguments in '' two.matrix '-o out' 'two.matrix -o' 'two.matrix -o out --nonsense' 'two.matrix two.matrix -o out' \
    'two.matrix -o out --format hlsl' 'two.matrix -o out --jobs 0' 'two.matrix -o out --jobs 1x' \
    'two.matrix -o out --jobs 1000' 'two.matrix -o out --c --format glsl' 'two.matrix -o -'; do
    # shellcheck disable=SC2086
    expect 2 $arguments
    says 'see shadergen matrix --help'
    absent out
done

say 'a file that is wrong'
cat > wrong.matrix <<'END'
# a comment
slices  = 1, 99,x
slicse  = 1
presets = fast
preset  = fast, balnced
steps   = 1 2
bias    =
slices  = 3
depth linear
END
expect 1 wrong.matrix -o out
says 'wrong.matrix:2: slices=99: must be in [1, 64]'
says 'wrong.matrix:2: slices=x'
says 'wrong.matrix:3: slicse: no such option; did you mean slices?'
says 'wrong.matrix:4: presets: no such option; did you mean preset?'
says 'wrong.matrix:5: balnced: no such preset; did you mean balanced?'
says 'wrong.matrix:6: 2: expected name = value, value, ...'
says 'wrong.matrix:7: bias: a value is missing'
says 'wrong.matrix:8: slices has its list in line 2 already'
says 'wrong.matrix:9: depth: expected name = value'
absent out
printf 'slices = 1\0' > zero.matrix
expect 1 zero.matrix -o out
says 'zero byte'
expect 3 missing.matrix -o out
says 'missing.matrix'
list=$(seq -s, 1 64)
printf 'slices = %s\nsteps = %s\nhistory = 2,3,4,5,6,7,8\nsample = %s\n' "$list" "$list" "$(seq -s, 1 31)" > huge.matrix
expect 1 huge.matrix -o out
says '100000 combinations'
printf 'outputs = near, ao+near\nestimator = hbao, hbao_plus\n' > refused.matrix
expect 1 refused.matrix -o out -v
says 'all 4 combinations are refused; the first: near light needs an estimator'
says 'refused: outputs=near estimator=hbao_plus'
says '    near light needs an estimator'
absent out

say 'what is made'
# refused: near light of hbao, and its sweep. equal: steps mean nothing to a sweep
cat > mixed.matrix <<'END'
preset    = sampled      # the base
outputs   = ao, ao+near
estimator = horizon, hbao
march     = sampled, sweep # two
slices    = 2

steps     = 4, 6, 8
END
expect 0 mixed.matrix -o mixed
says '11 variants of 24 combinations, 9 refused, 4 equal to others'
json=mixed/manifest.json
check 'counts' grep -q '"counts": {"combinations": 24, "refused": 9, "equal": 4, "variants": 11,' $json
check 'why one was refused' grep -q '"config": "outputs=ao+near estimator=hbao.*"reasons": \["near light needs' $json
no_temporaries mixed
sed -n 's/.*"config": "\([^"]*\)", "uniform.*/\1/p' $json > configs
check 'eleven configs' test "$(wc -l < configs)" -eq 11
while read -r config; do
    rm -rf one
    # shellcheck disable=SC2086
    "$bin" --set "$(echo $config | tr ' ' ,)" --format spirv -o one/ < /dev/null
    for file in one/*.spv; do
        pass=$(basename "$file" .spv)
        made=$(grep -FA 20 "\"config\": \"$config\"," $json |
            sed -n "s,.*\"name\": \"$pass\"\, \"file\": \"\([^\"]*\)\".*,\1,p" | head -1)
        check "$pass of $config" cmp "$file" "mixed/$made"
    done
done < configs
check 'what each variant costs' test "$(grep -c '"cost": {"fetches": [1-9]' $json)" -ge 1
check 'no file that the manifest does not name' test "$(find mixed/spirv -type f | wc -l)" -eq \
    "$(grep -o 'spirv/[a-z]*-[0-9a-f]*\.spv' $json | sort -u | wc -l)"
check 'prepare is shared: one with radiance, one without' test "$(find mixed -name 'prepare-*' | wc -l)" -eq 2
expect 0 two.matrix -o quiet -q
silent
expect 0 - -o empty -q # the default alone
check 'one variant' grep -q '"variants": 1,' empty/manifest.json
check 'no path of this machine' sh -c "! grep -rq -e '$work' -e 20[0-9][0-9]-[0-9][0-9]- mixed"
printf 'slices=2 steps=4,depth=device # a config is a matrix of one\nreach=2.5\n' > config
expect 0 config -o config.made -q
check 'as one config' grep -q '"config": "slices=2 steps=4 reach=2.5 depth=device"' config.made/manifest.json
printf 'outputs = far\nenvironment = sh, hook\n' > hook.matrix
expect 0 hook.matrix -o hook -v
says 'environment=hook: its text would be yours'

say 'the same bytes'
cat > many.matrix <<'END'
outputs = ao, ao+near
slices  = 1, 2, 4
steps   = 4, 8
depth   = linear, device
END
expect 0 many.matrix -o many --c
says '24 variants'
all=$(compiled)
expect 0 many.matrix -o jobs1 --jobs 1 --c
same many jobs1
expect 0 many.matrix -o jobs7 --jobs 7 --c
same many jobs7
locale=$(locale -a 2> /dev/null | grep -iE '^de_DE\.utf-?8$' | head -1)
if [ -z "$locale" ] && localedef --no-archive -i de_DE -f UTF-8 "$work/de_DE.UTF-8" > /dev/null 2>&1; then
    LOCPATH=$work
    export LOCPATH
    locale=de_DE.UTF-8
fi
if [ -n "$locale" ]; then
    check 'a decimal comma' test "$(LC_ALL=$locale locale decimal_point)" = ,
    LC_ALL=$locale
    export LC_ALL
    expect 0 many.matrix -o comma --c
    unset LC_ALL LOCPATH
    same many comma
else
    skip 'no German locale, and none can be made'
fi

say 'a second run'
touch -t 200101020000 reference
untouched() { check "$1 has no new file" test -z "$(find "$1" -newer reference)"; }
age() { find "$1" -exec touch -h -t 200101010000 {} +; }
age many
expect 0 many.matrix -o many --c
says ' 0 compiled, 0 removed'
untouched many
expect 0 many.matrix -o many --c --check -q
silent
untouched many
rm -rf unstated && cp -r many unstated && rm unstated/matrix.state # as from version control
expect 0 many.matrix -o unstated --c --check
check 'all was compiled for the check' test "$(compiled)" -eq "$all"

say 'damage'
cp -r many before
first=$(files_of many/spirv | sed -n 3p)
second=$(files_of many/spirv | sed -n 7p)
third=$(files_of many/spirv | sed -n 9p)
printf X | dd of="$first" bs=1 seek=40 conv=notrunc 2> /dev/null
: > "$second"
rm "$third" many/hbil_variants.c
expect 5 many.matrix -o many --c --check
says "$first is not up to date"
says '3 files in many/ are not up to date'
expect 0 many.matrix -o many --c
check 'three were compiled' test "$(compiled)" -eq 3
same many before
echo '{}' > many/manifest.json
expect 5 many.matrix -o many --c --check
says 'many/manifest.json is not up to date'
expect 0 many.matrix -o many --c
says ' 0 compiled'
same many before
sed -i 's/^[0-9a-f]\{16\} /0123456789abcdef /' many/matrix.state # of another program
expect 0 many.matrix -o many --c
check 'all was compiled' test "$(compiled)" -eq "$all"
same many before

say 'a changed matrix'
mkdir many/mine
echo mine > many/spirv/mine.spv
echo mine > many/spirv/march-0123456789abcdef.spv # looks like ours, but no manifest lists it
echo mine > many/notes.tmp
sed 's/1, 2, 4/2, 4, 5/' many.matrix > changed.matrix
expect 5 changed.matrix -o many --check
expect 0 changed.matrix -o many
check 'what is new was compiled, no more' test "$(compiled)" -eq 8
says ' 10 removed' # 8 and the C
absent many/hbil_variants.c
for file in mine spirv/mine.spv spirv/march-0123456789abcdef.spv notes.tmp; do
    check "$file stays" test -e many/$file
    rm -r many/$file
done
expect 0 changed.matrix -o changed
same many changed
expect 0 many.matrix -o many --c
same many before

say 'stopped in the middle'
# Runs until there are so many files.
kill_at() # FILES
{
    "$bin" matrix many.matrix -o killed --jobs 1 -q 2> /dev/null &
    pid=$!
    while [ "$(find killed -name '*.spv' 2> /dev/null | wc -l)" -lt "$1" ]; do
        kill -0 $pid 2> /dev/null || break
    done
    kill -9 $pid 2> /dev/null
    code=0
    wait $pid 2> /dev/null || code=$?
    check 'it was killed' test $code -eq 137 -a ! -e killed/manifest.json
}
kill_at 6
head -c -2 killed/matrix.state > torn && mv torn killed/matrix.state
kill_at 12
check 'lines of the journal' test "$(wc -l < killed/matrix.state)" -ge 8
: > killed/spirv/march-0123456789abcdef.spv.tmp
: > killed/manifest.json.tmp
: > killed/spirv/mine.tmp
head -c -2 killed/matrix.state > torn && mv torn killed/matrix.state
expect 0 many.matrix -o killed --c
check 'it went on where it was' test "$(compiled)" -lt "$all" -a "$(compiled)" -gt 0
check 'a temporary file of somebody else stays' rm killed/spirv/mine.tmp
no_temporaries killed
same killed before
rm -rf killed
code=0
timeout -s INT 0.15 "$bin" matrix many.matrix -o killed --jobs 1 -q 2> /dev/null || code=$?
[ $code -eq 124 ] || skip 'it was done before SIGINT came'
expect 0 many.matrix -o killed --c
no_temporaries killed
same killed before

say 'two at a time'
if command -v flock > /dev/null; then
    checks=$((checks + 1))
    code=0
    flock many "$bin" matrix many.matrix -o many 2> err.txt || code=$?
    [ $code -eq 3 ] || fault "exit code $code, not 3, beside another one"
    says 'another shadergen matrix is at work'
else
    skip 'no flock'
fi

say 'other languages'
printf 'target = vulkan, gl, gles\nstage = compute, fragment\noutputs = ao\nslices = 1, 2\n' > dialects.matrix
expect 0 dialects.matrix -o dialects --format glsl
says '10 variants of 12 combinations, 2 refused'
check 'fragment shaders' sh -c "grep -q 'version 300 es' dialects/glsl/march-*.frag"
check 'one vertex shader for each of two dialects' test "$(find dialects -name 'vertex-*.vert' | wc -l)" -eq 2
check 'shared texts name no config' sh -c "! grep -rq rebuild dialects/glsl"
check 'prepare once for each dialect' test "$(find dialects -name 'prepare-*' | wc -l)" -eq 5
"$bin" --set outputs=ao,slices=2,target=gl --pass march | grep -v '^// rebuild' > text
made=$(grep -A 3 '"config": "target=gl outputs=ao slices=2"' dialects/manifest.json |
    sed -n 's/.*"\(glsl.march-[0-9a-f]*\.comp\)".*/\1/p')
check 'as shadergen writes it' cmp text "dialects/$made"
expect 0 dialects.matrix -o dialects -v
says '8 variants of 12 combinations, 4 refused'
says 'ESSL 3.00 has no SPIR-V'
absent dialects/glsl

say 'the words as C'
cc=${CC:-cc}
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wundef -Wdouble-promotion -Werror'
for compiler in "$cc -std=c99 -Wstrict-prototypes" 'clang -std=c99' 'c++ -std=c++11 -x c++' \
    'clang++ -std=c++11 -x c++'; do
    command -v "${compiler%% *}" > /dev/null || { skip "no ${compiler%% *}"; continue; }
    # shellcheck disable=SC2086
    check "$compiler" $compiler $warnings -c many/hbil_variants.c -o variants.o
done
# shellcheck disable=SC2086
check 'a program' $cc -std=c99 -O1 $warnings -Imany -I"$here/../.." "$here/variants.c" many/hbil_variants.c -o variants
for config in outputs=ao,slices=1,steps=4 outputs=ao+near,slices=4,steps=8,depth=device \
    outputs=near+ao,slices=2,steps=8,bias=0.001; do
    rm -rf one
    "$bin" --set "$config" --format spirv -o one/
    check "words of $config" ./variants "$config" one
done
check 'no words of another' ./variants outputs=ao,slices=3

say 'progress'
if command -v script > /dev/null && script -qec true /dev/null > /dev/null 2>&1; then
    rm -rf shown
    script -qec "'$bin' matrix many.matrix -o shown --jobs 1" /dev/null > shown.txt < /dev/null
    check 'a bar on a terminal' grep -q 'variants \[#*\.*\] [0-9]* of 24' shown.txt
else
    skip 'no script'
fi

say 'what cannot be written'
echo 'a file' > file
expect 3 two.matrix -o file/out
check 'the file in the way is as it was' grep -qx 'a file' file
expect 3 two.matrix -o file
mkdir -p way/manifest.json.tmp way/manifest.json
expect 3 two.matrix -o way
says 'way/manifest.json'
mkdir disk
if mount -t tmpfs -o size=160k tmpfs disk 2> /dev/null; then
    mounted=$work/disk
    expect 3 many.matrix -o disk/out
    check 'says it once' test "$(grep -c 'cannot write' err.txt)" -eq 1
    no_temporaries disk
    absent disk/out/manifest.json
    mount -o remount,size=8m disk
    expect 0 many.matrix -o disk/out --c
    check 'it went on where it was' test "$(compiled)" -lt "$all"
    same disk/out before
    if mount -o remount,ro disk 2> /dev/null; then
        expect 0 many.matrix -o disk/out --c
        expect 3 changed.matrix -o disk/out
        same disk/out before
    else
        skip 'a folder that is read-only'
    fi
    umount disk && mounted=
else
    skip 'a full disk: no tmpfs can be mounted here'
    if [ "$(id -u)" -ne 0 ]; then
        chmod -R a-w many
        expect 0 many.matrix -o many --c
        expect 3 changed.matrix -o many
        chmod -R u+w many
    fi
fi

echo "matrix: $checks checks, $failed failed"
[ $failed -eq 0 ]
