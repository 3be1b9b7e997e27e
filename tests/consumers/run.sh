#!/bin/sh
# hbil.h as others use it: installed, as a subproject, by pkg-config, by a copy, in C++, beside other libraries, and
# with shaders that are made at build time. Each consumer prints the hash and the texts of one config: all print the same.
#
#   sh tests/consumers/run.sh BUILD       BUILD: a build folder of hbil
#
# Paths have blanks. A line per consumer; all run at once.
set -u

if [ $# -ne 1 ] || [ ! -e "$1/CMakeCache.txt" ]; then
    echo "usage: sh run.sh BUILD" >&2
    exit 2
fi
build=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
work=$(mktemp -d "${TMPDIR:-/tmp}/hbil consumers XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit 1
strict='-Wall -Wextra -Werror'

# A command of a consumer; when it fails, its output and the end of the consumer.
run()
{
    "$@" > step.log 2>&1 && return
    echo "failed: $*"
    tail -n 30 step.log
    exit 1
}
fail()   { echo "failed: $*"; exit 1; }
# Standard output of a program is that of the first consumer.
agrees() { "$@" > printed || fail "$*"; diff "$work/expected" printed || fail "$1 prints something else"; }

# ---------------------------------------------------------------------------------------------------- the consumers
# Each in a folder and a process of its own, after the headers are installed in $prefix.

copied() # one header in an empty folder
{
    cp "$root/hbil.h" "$here/consumer.c" .
    run cc consumer.c -o consumer
    agrees ./consumer "$work/consumer.hbil"
}

cplusplus() # COMPILER
{
    # shellcheck disable=SC2086
    run "$1" -std=c++11 $strict -I"$prefix/include" "$here/consumer.cpp" -o consumer
    agrees ./consumer "$work/consumer.hbil"
}

pkg_config()
{
    PKG_CONFIG_PATH=$prefix/share/pkgconfig
    export PKG_CONFIG_PATH
    run pkg-config --exists --print-errors hbil
    version=$(sed -n 's/^#define HBIL_VERSION_[MP][A-Z]* //p' "$root/hbil.h" | paste -sd.)
    [ "$(pkg-config --modversion hbil)" = "$version" ] || fail "hbil.pc has another version than $version of hbil.h"
    eval "run cc $(pkg-config --cflags hbil) \"\$here/consumer.c\" -o consumer"
    agrees ./consumer "$work/consumer.hbil"
    eval "bin=$(pkg-config --variable=bindir hbil)"
    # shellcheck disable=SC2154
    [ "$("$bin/shadergen" --version)" = "shadergen $version" ] || fail "no shadergen $version in bindir"
}

with_cmake() # FOLDER
{
    mkdir source
    cp -r "$here/$1" "$here/consumer.c" source
    run cmake -G Ninja -S "source/$1" -B build -DCMAKE_PREFIX_PATH="$prefix" -DHBIL_SOURCE="$work/hbil source"
    run cmake --build build
    agrees build/consumer "$work/consumer.hbil"
    [ ! -e build/hbil/shadergen ] && [ ! -e build/bin ] || fail 'a program was built that nobody asked for'
}

neighbours() # COMPILER FLAG ...
{
    compiler=$1
    shift
    # shellcheck disable=SC2086
    run "$compiler" $strict "$@" -I"$prefix/include" "$here/neighbours.c" -o neighbours -lglfw -ldl -lm
    ./neighbours "$work/consumer.hbil" > printed || fail neighbours
    grep -qx "$(cat printed)" "$work/expected" || fail 'neighbours prints another hash'
}

# Builds, and fails unless the output has, or with ! has not, a text.
build_says() # [!] TEXT
{
    cmake --build build > build.log 2>&1 || { cat build.log; fail build; }
    if [ "$1" = ! ]; then ! grep -q "$2" build.log && return; else grep -q "$1" build.log && return; fi
    cat build.log
    fail "the build does not say: $*"
}
newer() { sleep 1.1; touch "$1"; }

generated() # GENERATOR WHAT-IT-SAYS-WHEN-NOTHING-IS-LEFT
{
    idle=$2
    cp "$work/consumer.hbil" .
    run cmake -G "$1" -S "$here/generated" -B build -DCMAKE_PREFIX_PATH="$prefix" -DCONFIG="$PWD/consumer.hbil"
    build_says 'shaders of generated: .*consumer.hbil, spirv'
    # shellcheck disable=SC2046
    build/generated $(sed -n 's/^pass \([a-z_0-9]*\) .*/\1/p' "$work/expected") > printed || fail generated
    sed 1d "$work/expected" | diff - printed || fail 'generated prints something else'
    hash=$(sed -n 's/^hash //p' "$work/expected")
    grep -qi "$hash" build/generated.hbil/hbil_shaders.h || fail "no hash $hash in hbil_shaders.h"
    grep -qi "$hash" build/generated.hbil/hbil_shaders.stamp || fail "no hash $hash in the stamp"

    build_says "$idle"
    ! grep -q 'shaders of' build.log || fail 'shadergen ran without need'
    newer consumer.hbil
    build_says 'shaders of generated'
    ! grep -q 'Building C' build.log || fail 'the program was compiled again although no shader changed'
    build_says "$idle"
    ! grep -q 'shaders of' build.log || fail 'shadergen ran without need after the config was touched'
    sed 's/slices=2/slices=3/' "$work/consumer.hbil" > consumer.hbil
    newer consumer.hbil
    build_says 'Building C object'
    ! grep -qi "$hash" build/generated.hbil/hbil_shaders.h || fail 'hbil_shaders.h has not changed with its config'
}

generated_in_subproject() # hbil and its shadergen are built with the program
{
    mkdir source
    cp "$here/consumer.c" source
    cat > source/CMakeLists.txt << 'END'
cmake_minimum_required(VERSION 3.16)
project(whole LANGUAGES C)
include(FetchContent)
FetchContent_Declare(hbil SOURCE_DIR "${HBIL_SOURCE}")
set(HBIL_BUILD_SHADERGEN ON CACHE BOOL "")
FetchContent_MakeAvailable(hbil)
add_executable(consumer consumer.c)
target_link_libraries(consumer PRIVATE hbil::hbil)
hbil_add_shaders(consumer CONFIG "${CONFIG}" FORMAT spirv)
END
    run cmake -G Ninja -S source -B build -DCMAKE_BUILD_TYPE=Debug \
        -DHBIL_SOURCE="$work/hbil source" -DCONFIG="$work/consumer.hbil"
    build_says 'shaders of consumer'
    agrees build/consumer "$work/consumer.hbil"
    [ -s build/consumer.hbil/hbil_shaders/march.spv ] || fail 'no march.spv'
    build_says 'no work to do'
}

# ---------------------------------------------------------------------------------------------------- run

# Installed, then moved; and what a subproject needs of the sources.
cp "$here/consumer.hbil" .
cmake --install "$build" --prefix "$work/first" > install.log || { cat install.log; exit 1; }
mv first 'pre fix'
prefix="$work/pre fix"
mkdir 'hbil source'
for part in CMakeLists.txt hbil.h backends cmake shadergen; do cp -r "$root/$part" 'hbil source'; done
cc -I"$root" "$here/consumer.c" -o consumer && ./consumer consumer.hbil > expected || exit 1
grep -qx 'pass march [1-9][0-9]* [0-9a-f]*' expected || { echo 'consumer prints no march'; exit 1; }

consumer() # NAME FUNCTION [ARGUMENT ...]
{
    folder="$work/$1"
    echo "$1" >> "$work/names"
    shift
    mkdir "$folder"
    (cd "$folder" && "$@" > log 2>&1 && touch passed) &
}

consumer 'hbil.h copied' copied
consumer 'C++11, g++' cplusplus g++
consumer 'C++11, clang++' cplusplus clang++
consumer 'pkg-config' pkg_config
consumer 'find_package' with_cmake find_package
consumer 'FetchContent' with_cmake fetch_content
consumer 'add_subdirectory' with_cmake subdirectory
consumer 'neighbours, C99' neighbours gcc -std=c99
consumer 'neighbours, C99, hbil.h first' neighbours gcc -std=c99 -DHBIL_FIRST
consumer 'neighbours, C++11' neighbours clang++ -x c++ -std=c++11
consumer 'hbil_add_shaders, Ninja' generated Ninja 'no work to do'
consumer 'hbil_add_shaders, make' generated 'Unix Makefiles' 'Built target generated'
consumer 'hbil_add_shaders, FetchContent' generated_in_subproject
wait

count=0
failed=0
while IFS= read -r name; do
    count=$((count + 1))
    if [ -e "$work/$name/passed" ]; then
        echo "ok    $name"
    else
        failed=$((failed + 1))
        echo "FAIL  $name"
        sed 's/^/      /' "$work/$name/log"
    fi
done < names
echo "consumers: $count, $failed failed"
[ $failed -eq 0 ]
