#!/bin/sh
# The command line of shadergen: exit codes, messages, and which files it touches.
#
#   sh tests/cli/shadergen.sh SHADERGEN
#
# A line per fault and a count at the end. Works as root, too: where a path must not be writable, a file is in its way.
set -u

command=
# shellcheck source=tests/cli/lib.sh
. "$(dirname "$0")/lib.sh"

say 'help'
for arguments in '' -h --help; do
    # shellcheck disable=SC2086
    expect 0 $arguments
    check 'usage on the output' grep -q '^usage: shadergen' out.txt
    silent
done
expect 0 --version
check 'version' grep -Eq '^shadergen [0-9]+\.[0-9]+\.[0-9]+$' out.txt
expect 0 --list-options
check 'lists an option' grep -q '^  slices ' out.txt
check 'lists a preset' grep -q '^  fast ' out.txt
expect 0 --explain reach
check 'explains it' grep -q '^  unit *m$' out.txt
expect 0 --list-presets
check 'lists what a preset sets' grep -q '^ *march=sweep slices=2 sweep_stride=3 filter=3x3$' out.txt
presets=$(sed -n 's/^  \([a-z_][a-z_]*\) .*/\1/p' out.txt)
check 'lists all the presets of --list-options' test "$("$bin" --list-options | sed -n '/^presets:/,$s/^  \([a-z_][a-z_]*\) .*/\1/p')" = "$presets"
for preset in $presets; do
    expect 0 --explain "$preset"
    check "explains $preset" grep -q '^  meaning ' out.txt
    # each value has a source, and what the preset sets is among the values
    for value in $("$bin" --preset "$preset" --print-config | sort > all.txt; "$bin" --print-config | sort | comm -13 - all.txt); do
        check "the source of $value in $preset" grep -Eq "^  $(echo "$value" | sed 's/[+.]/\\&/g') +[^ ]" out.txt
    done
done

say 'a config that is refused'
expect 1 --set slices=99
says 'slices=99: must be in [1, 64]'
no_data
expect 1 --set slices=99,reach=-1,no_such_option=1
says 'slices=99'
says 'reach=-1'
says 'no_such_option'
expect 1 --set slicse=4
says 'did you mean slices?'
expect 1 --preset balnced
says 'did you mean balanced?'
expect 1 --target vulcan
says 'target=vulcan'
expect 1 --set width=640
says 'width and height'
# combinations: the message says why, and ends with config text that mends it
refused() # CONFIG MESSAGE FIX
{
    expect 1 --set "$1"
    says "$2"
    says "; set $3"
    no_data
    expect 0 --set "$1,$3" --print-config
}
refused estimator=hbao_plus,outputs=near 'near light needs an estimator of cosine-weighted arcs' outputs=ao
refused estimator=hbao,outputs=sh 'sh of near light needs estimator horizon or bitmask' outputs=ao
refused estimator=hbao,outputs=composite 'nothing to add up' outputs=ao
refused estimator=hbao,outputs=uniform_ao 'uniform already' outputs=ao
refused estimator=hbao_plus,outputs=ao+cone 'need estimator horizon or bitmask' outputs=ao
refused outputs=multi_bounce+near 'counts the same energy twice' outputs=ao+multi_bounce
refused outputs=far 'outputs=far without an environment' environment=sh
refused occluder=thick 'behind a thin occluder' estimator=bitmask
refused occluder=heuristic,estimator=bitmask 'sectors do not sink' occluder=thick
refused outputs=ao+far,environment=sh,estimator=hbao 'have no bent vector' far_visibility=ao
refused outputs=far,environment=sh,far_visibility=free_bits 'only the bitmask has sectors' far_visibility=bent
refused outputs=bent,estimator=bitmask,seed_compat=uniform_bent 'arithmetic of horizons' seed_compat=none
refused outputs=far,environment=sh,seed_compat=uniform_bent 'wants it cosine-weighted' far_visibility=direction
refused outputs=far,environment=cube,far_visibility=cone 'closed form for a cone' far_visibility=bent
refused normals=world,normal_encoding=xy 'hold no sign of z' normal_encoding=octahedral
printf 'slices=3\nsteps=99999\n' > bad.hbil
expect 1 -c bad.hbil -o refused/ --depfile refused.d --stamp refused.stamp
says 'bad.hbil:2: error: steps=99999: must be in'
absent refused; absent refused.d; absent refused.stamp
expect 1 -c bad.hbil --error-format msvc
says 'bad.hbil(2): error: steps=99999: must be in'
printf '# a combination\noutputs=ao\n  march=sweep  # here\nestimator=hbao\n' > bad.hbil
expect 1 -c bad.hbil
says 'bad.hbil:3: error: a sweep finds horizons'
expect 1 -c bad.hbil -q
says 'bad.hbil:3: error:'
expect 1 --set march=sweep,estimator=hbao
says 'shadergen: a sweep finds horizons'

say 'wrong usage'
expect 2 --nonsense
says '--nonsense'
says 'see shadergen --help'
expect 2 --formta glsl
says 'did you mean --format?'
expect 2 --chek
says 'did you mean --check?'
expect 2 march
says 'unknown argument march; see'
expect 2 --set=slices=4
for flag in --set -c --config --preset --target --format --pass -o --output --explain --hook --depfile --stamp --error-format; do
    expect 2 $flag
    says 'no value after'
    expect 2 $flag ''
done
expect 2 --format hlls
says 'glsl, spirv, c, manifest, hlsl, hlsl6, msl or essl'
expect 2 --format hlsl --target gl --pass march
says 'made from the shaders for Vulkan'
expect 2 --format essl --target gl --pass march
says 'another target is set'
expect 2 --format spirv --target gles --set stage=fragment --pass march
says 'has no SPIR-V'
expect 2 --error-format clang
says 'gcc or msvc'
expect 2 --json
says '--list-options'
expect 2 --cost -o costs.txt
says '--cost prints'
absent costs.txt
expect 2 --check
says '--check compares files'
expect 2 --depfile d.d
says '--depfile'
absent d.d
expect 2 --pass marhc
says 'prepare march light'
expect 2 --explain slicse
says 'did you mean the option slices'
expect 2 --explain hbao_pus
says 'or the preset hbao_plus?'
expect 2 -o all.comp
says 'several passes'
absent all.comp
expect 2 --format spirv
no_data
expect 2 --set outputs=ao --pass light
says 'this config has no pass light'

say 'what cannot be read or written'
echo 'a file' > file
expect 3 -c missing.hbil
says 'missing.hbil'
expect 3 -c .
mkfifo pipe
cat pipe > piped.txt &
expect 0 --pass march -o pipe
wait
check 'a pipe gets the text' grep -q '^#version' piped.txt
check 'and stays a pipe' test -p pipe
expect 3 --pass march -o file/march.comp
says 'file/march.comp'
expect 3 -o file/out/
expect 3 --pass march -o missing/march.comp
check 'the file in the way is as it was' grep -qx 'a file' file
if [ -c /dev/full ]; then
    for arguments in '--pass march' '--format manifest' --print-config --list-options --list-presets '--explain slices' \
        '--explain gtao' --help --version; do
        checks=$((checks + 1))
        code=0
        # shellcheck disable=SC2086
        "$bin" $arguments > /dev/full 2> err.txt || code=$?
        [ $code -eq 3 ] || fault "exit code $code, not 3, with a full disk as output: shadergen $arguments"
    done
fi
checks=$((checks + 1))
code=0
"$bin" --pass march >&- 2> err.txt || code=$?
[ $code -eq 3 ] || fault "exit code $code, not 3, with the output closed"

say 'an output pipe that nobody reads'
# 141: ended by the signal, as programs in a pipe are.
{ sleep 0.3; "$bin" --pass march 2> err.txt; echo $? > code.txt; } | :
check 'ended by the signal, or code 3' grep -Eqx '141|3' code.txt
(trap '' PIPE; { sleep 0.3; "$bin" --pass march 2> err.txt; echo $? > code.txt; } | :)
check 'code 3 where the signal is ignored' grep -qx 3 code.txt

say 'outputs'
expect 0 -o all/
silent
no_data
check 'three texts' test "$(find all -type f | sort | tr '\n' ' ')" = 'all/light.comp all/march.comp all/prepare.comp '
for pass in prepare march light; do
    expect 0 --pass $pass
    cp out.txt printed
    same printed all/$pass.comp
    expect 0 --pass $pass -o one.comp
    same one.comp all/$pass.comp
    expect 0 --pass $pass -o -
    same out.txt all/$pass.comp
    absent ./-
    check 'begins with #version' sh -c "head -n 1 all/$pass.comp | grep -q '^#version 450$'"
    check 'no carriage return, tab or non-ASCII letter' sh -c "! LC_ALL=C grep -q '[^ -~]' all/$pass.comp"
done
expect 0 -o -
cat all/prepare.comp all/march.comp all/light.comp > joined
same out.txt joined
expect 0 --format spirv -o spirv/
for pass in prepare march light; do
    check "SPIR-V magic of $pass" test "$(od -An -tx4 -N4 spirv/$pass.spv | tr -d ' ')" = 07230203
done
expect 0 --format spirv --pass march -o -
same out.txt spirv/march.spv
expect 0 --format manifest -o all/
expect 0 --format manifest
same out.txt all/plan.json
check 'manifest is an object' sh -c "head -c 1 all/plan.json | grep -q '{'"
no_temporaries all

say 'presets'
cat > sky.glsl << 'END'
// ours
const vec3 zenith = vec3(0.45, 0.75, 1.30);
vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {
    return zenith * (0.5 + 0.5 * direction.z);
}
END
for preset in $presets; do
    for target in vulkan gl gles; do
        hook=
        "$bin" --preset "$preset" --print-config | grep -qx environment=hook && hook='--hook sky.glsl'
        # shellcheck disable=SC2086
        expect 0 --preset "$preset" --target $target $hook
        silent
        check "$preset has texts for $target" grep -q '^void main' out.txt
        # shellcheck disable=SC2086
        expect 0 --preset "$preset" --target $target $hook --format spirv -o "spirv-$preset-$target/"
        silent
        check "$preset has SPIR-V for $target" test -s "spirv-$preset-$target/march.spv"
    done
done

say 'a hook'
hooked='outputs=far,environment=hook'
expect 2 --set $hooked
says 'pass light calls a function of yours'
says '--hook FILE'
no_data
expect 2 --set $hooked --pass light --format spirv -o hooked/
says '--hook FILE'
absent hooked
expect 0 --set $hooked --pass march
expect 0 --set $hooked --format manifest
expect 0 --set $hooked --print-config
for target in vulkan gl; do
    expect 0 --set $hooked --target $target --hook sky.glsl -o hooked/
    silent
    check 'the text has the function' grep -q '^const vec3 zenith' hooked/light.comp
    check 'only in the pass that calls it' sh -c '! grep -q zenith hooked/march.comp hooked/prepare.comp'
    expect 0 --set $hooked --target $target --hook sky.glsl --format spirv -o hooked/
    silent
done
"$bin" --set $hooked --pass light --hook - < sky.glsl > from_stdin
expect 0 --set $hooked --pass light --hook sky.glsl
same out.txt from_stdin
for arguments in '' "--set outputs=far,environment=sh" "--set outputs=ao,environment=hook"; do
    # shellcheck disable=SC2086
    expect 2 $arguments --hook sky.glsl
    says '--hook without environment=hook'
    says 'leave --hook out'
    no_data
done
expect 3 --set $hooked --hook missing.glsl
says 'missing.glsl'
sed 's/zenith \*/zenit */' sky.glsl > wrong.glsl
expect 1 --set $hooked --hook wrong.glsl --format spirv -o wrong/
check 'file and line of the fault' grep -qx "wrong.glsl:4: 'zenit' : undeclared identifier *" err.txt
check 'no word about our text' sh -c '! grep -qi report err.txt'
absent wrong
{ cat sky.glsl; echo 'void more() {'; } > open.glsl
expect 1 --set $hooked --hook open.glsl
says 'open.glsl: hook: braces do not match'
echo '// nothing' > empty.glsl
expect 1 --set $hooked --hook empty.glsl
says 'empty.glsl: hook: no function vec3 hbil_far_hook'
{ echo '#version 450'; cat sky.glsl; } > version.glsl
expect 1 --set $hooked --hook version.glsl
says 'version.glsl: hook: #version'
{ cat sky.glsl; echo '#define texelFetch nothing'; } > behind.glsl
expect 1 --set $hooked --hook behind.glsl --format spirv --pass light
says 'behind.glsl'
{ cat sky.glsl; printf '\0'; } > zero.glsl
expect 1 --set $hooked --hook zero.glsl
says 'zero.glsl holds a zero byte'

say 'unchanged outputs'
touch -t 200101020000 reference
touch -t 200101010000 all/*.comp
expect 0 -o all/
for pass in prepare march light; do check "$pass.comp keeps its time" test ! all/$pass.comp -nt reference; done
expect 0 --set slices=5 -o all/
for pass in prepare march light; do check "$pass.comp, which changed, is new" test all/$pass.comp -nt reference; done

say 'all outputs or none'
cp -r all before
mkdir all/light.comp.tmp # in the way of the last temporary file
expect 3 --set slices=6,outputs=near+composite,depth=device -o all/
rmdir all/light.comp.tmp
for pass in prepare march light; do same all/$pass.comp before/$pass.comp; done
no_temporaries all

say 'a full disk'
mkdir disk
if mount -t tmpfs -o size=8k tmpfs disk 2> /dev/null; then
    mounted=$work/disk
    echo 'old' > disk/march.comp
    expect 3 --pass march -o disk/march.comp
    check 'the old file is whole' grep -qx old disk/march.comp
    no_temporaries disk
    umount disk && mounted=
else
    echo "skip  $group: no tmpfs can be mounted here"
fi

say 'where a config comes from'
printf '# ours\nslices=4 steps=5 # both\nreach=2.5\n' > a.hbil
printf 'steps=7\n' > b.hbil
has() { check "config has $1" grep -qx "$1" out.txt; }
expect 0 -c a.hbil --print-config
has slices=4; has steps=5; has reach=2.5
expect 0 -c a.hbil -c b.hbil --print-config
has slices=4; has steps=7
expect 0 --set slices=9 -c a.hbil --preset sampled --print-config
has slices=9; has steps=5
expect 0 --preset fast --print-config
has slices=2; has march=sweep
expect 0 --target gl --print-config
has target=gl
"$bin" -c a.hbil --pass march > from_file
checks=$((checks + 1))
"$bin" -c - --pass march < a.hbil > from_stdin || fault 'config from standard input'
same from_file from_stdin
expect 0 --set falloff=0.5 --pass march
silent
expect 0 --set falloff=0.5 --pass march -v
says 'falloff has no effect'

say 'round trips'
# A text tells how it was made; a printed config is a config.
for config in '' slices=4 'target=gl,outputs=ao+near+bent+composite' 'reach=2.5,falloff=0.35,dynamic=slices+reach' \
    'normals=depth,depth=device,depth_direction=reversed,depth_far=infinite' 'width=1920,height=1080,noise=ign,bias=0.0123' \
    'seed_compat=screen_azimuth+slice_mean,spacing=geometric,pull=1.25e-6' 'outputs=ao,projection=orthographic'; do
    group="round trips of '$config'"
    rm -rf made
    expect 0 ${config:+--set "$config"} -o made/
    for text in made/*.comp; do
        line=$(sed -n 's,^// rebuild  *: shadergen ,,p' "$text")
        check "$text has a rebuild line" test -n "$line"
        # shellcheck disable=SC2086
        expect 0 $line
        same out.txt "$text"
    done
    expect 0 ${config:+--set "$config"} --print-config
    cp out.txt printed.hbil
    expect 0 -c printed.hbil --print-config
    same out.txt printed.hbil
    expect 0 -c printed.hbil --pass march
    same out.txt made/march.comp
done

say 'languages'
expect 0 --format hlsl -o hlsl/
check 'registers' grep -q 'u_view_depth : register(t0)' hlsl/march.hlsl
expect 0 --format hlsl6 --pass march
check 'shader model 6 has spaces' grep -q 'u_view_depth : register(t0, space0)' out.txt
expect 0 --format msl -o msl/
check 'Metal has a kernel' grep -q '^kernel void' msl/march.metal
expect 0 --format essl -o essl/
check 'ESSL 3.10' sh -c "head -n 1 essl/march.comp | grep -q '^#version 310 es$'"
expect 0 --target gles -o essl2/
same essl/march.comp essl2/march.comp
expect 0 --target gles --set stage=fragment,outputs=ao -o fragment/
check 'ESSL 3.00 and its vertex shader' test "$(find fragment -type f | sort | tr '\n' ' ')" = 'fragment/march.frag fragment/prepare.frag fragment/vertex.vert '
expect 0 --target gl --set stage=fragment,outputs=ao --pass march -o march.frag
check 'GLSL 3.30' sh -c "head -n 1 march.frag | grep -q '^#version 330 core$'"
expect 0 --list-options --json
check 'the options as data' sh -c "head -n 2 out.txt | grep -q '\"schema\": 1' && tail -n 1 out.txt | grep -qx '}'"
if command -v python3 > /dev/null; then check 'which is JSON' python3 -c 'import json,sys; d=json.load(open("out.txt")); assert len(d["options"]) > 50 and d["presets"]'; fi

say 'a C header'
printf 'outputs=ao+near\nslices=4\n' > game.hbil
for target in vulkan gl 'gles --set stage=fragment'; do
    # shellcheck disable=SC2086
    expect 0 -c game.hbil --target $target --format c -o game-shaders.h
    silent
    printf '#include "game-shaders.h"\n#include <stdio.h>\nint main(void)\n{\n    int i;\n    puts(GAME_SHADERS_CONFIG);\n' > use.c
    printf '    for (i = 0; i < 2; ++i) puts(game_shaders_passes[i].name);\n' >> use.c
    printf '    return GAME_SHADERS_HASH == 0 || sizeof(game_shaders_frame) != 32;\n}\n' >> use.c
    cp use.c use.cpp
    warnings='-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wundef -Wdouble-promotion -Werror'
    for compiler in 'gcc -std=c99' 'clang -std=c99' 'g++ -std=c++11' 'clang++ -std=c++11'; do
        command -v "${compiler%% *}" > /dev/null || { echo "skip  $group: no ${compiler%% *}"; continue; }
        case $compiler in *++*) of=use.cpp ;; *) of=use.c ;; esac
        # shellcheck disable=SC2086
        check "compiles with $compiler, $target" $compiler $warnings $of -o use
        check "runs, $compiler, $target" sh -c './use | tail -n 2 | tr "\n" " " | grep -qx "prepare march "'
    done
done
expect 0 -c game.hbil --format c
check 'on standard output, with a name of its own' grep -q '^#define HBIL_SHADERS_HASH ' out.txt
expect 0 -c game.hbil --format c --pass march
check 'one pass' sh -c '! grep -q prepare_words out.txt && grep -q march_words out.txt'
no_temporaries .

say 'up to date'
expect 0 -c game.hbil -o fresh/
expect 0 -c game.hbil -o fresh/ --check
silent
expect 5 -c game.hbil --set slices=9 -o fresh/ --check
says 'fresh/march.comp is not up to date'
expect 0 -c game.hbil -o fresh/ --check
rm fresh/prepare.comp
expect 5 -c game.hbil -o fresh/ --check
absent fresh/prepare.comp
expect 5 -c game.hbil -o never/ --check
absent never

say 'a rule for make'
mkdir 'a folder'
cp game.hbil 'a folder/my $game#1.hbil'
expect 0 -c 'a folder/my $game#1.hbil' --format c -o 'a folder/out put.h' --depfile rule.d
# shellcheck disable=SC2016
check 'outputs and configs, escaped' grep -qxF 'a\ folder/out\ put.h: a\ folder/my\ $$game\#1.hbil' rule.d
expect 0 -c game.hbil --set $hooked --hook sky.glsl -o ruled/ --depfile rule.d --stamp ruled.stamp
check 'the stamp, the config and the hook' grep -qxF 'ruled.stamp: game.hbil sky.glsl' rule.d
check 'the stamp holds a hash' grep -Eqx '[0-9a-f]{16}' ruled.stamp
if command -v ninja > /dev/null; then
    cat > build.ninja << END
rule shaders
  command = $bin -c game.hbil --format c -o built.h --depfile built.d
  depfile = built.d
  restat = 1
build built.h: shaders
build all: phony built.h
END
    rm -f built.h
    check 'ninja builds' ninja all
    check 'and then has no work' sh -c 'ninja all | grep -q "no work to do"'
    sleep 0.02
    echo '# touched' >> game.hbil
    check 'a touched config is work' sh -c 'ninja -n all | grep -q shaders || ninja -n all | grep -q built.h'
    check 'ninja builds again' ninja all
    sed -i 's/slices=4/slices=5/' game.hbil
    check 'ninja builds what changed' ninja all
    check 'it has changed' grep -q 'slices=5' built.h
    check 'and has no work' sh -c 'ninja all | grep -q "no work to do"'
fi

say 'a read-only folder'
mkdir locked
chmod 555 locked
if touch locked/probe 2> /dev/null; then
    rm -f locked/probe
    if command -v setpriv > /dev/null && chmod 777 . && setpriv --reuid=65534 --clear-groups "$bin" --version > /dev/null 2>&1; then
        checks=$((checks + 1))
        code=0
        setpriv --reuid=65534 --clear-groups "$bin" --pass march -o locked/march.comp 2> err.txt || code=$?
        [ $code -eq 3 ] || fault "exit code $code, not 3"
        says 'cannot write locked/march.comp'
    else
        echo "skip  $group: root writes everywhere, and nobody cannot run shadergen here"
    fi
else
    expect 3 --pass march -o locked/march.comp
    says 'cannot write locked/march.comp'
fi
check 'nothing in it' test -z "$(ls -A locked)"

say 'a text that glslang refuses (exit code 4)'
echo "skip  $group: no config leads there"

echo "shadergen: $checks checks, $failed failed"
[ $failed -eq 0 ]
