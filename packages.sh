#!/bin/sh
# packages.sh - installs the Debian packages that are lacking.
#
#   sh packages.sh build     what shadergen and hbil-frame need, drivers included
#   sh packages.sh test      that, and what the tests need
#   sh packages.sh blender   Blender with Cycles, about 600 MB: for examples/blender; its test is skipped without it
#   sh packages.sh peers     node and npm, for hbil-peers; its test is skipped without them
#
# Says what it installs; does nothing, and needs no rights, where nothing is lacking. Where dpkg and apt-get are missing it
# prints the list and succeeds: the build will name what it does not find.
set -eu

# cmake runs ninja and, for the libraries, pkg-config; glslang's archives are C++, so g++ even for C programs.
build='cmake ninja-build pkg-config gcc g++ libc6-dev'
# text to SPIR-V, to HLSL and MSL, images, JSON, rays
build="$build glslang-dev spirv-tools spirv-headers libspirv-cross-c-shared-dev libopenexr-dev libcjson-dev libstb-dev libembree-dev"
# Vulkan: headers, loader, meta loader, software driver
build="$build libvulkan-dev libvulkan1 libvulkan-volk-dev mesa-vulkan-drivers"
# GL: headers; OSMesa and EGL are opened at run time, libgl1-mesa-dri is EGL's driver
build="$build libgl-dev libegl-dev libosmesa6 libegl1 libgl1-mesa-dri"
# a second compiler and its sanitizers and libFuzzer, the test runner, validation, locales with a decimal comma, GLFW beside hbil.h
test='clang libclang-rt-14-dev libcmocka-dev vulkan-validationlayers locales libglfw3-dev'
# what is lost, read too far or never written: tests/long/leaks.sh
test="$test valgrind"
# hbil-viewer and hbil-ogre, and a display for their tests
test="$test libassimp-dev libogre-1.12-dev xvfb xauth"
# pictures of what a sweep has measured; fonts for them
test="$test gnuplot-nox fonts-dejavu-core"

case "${1-}" in
    build) wanted=$build ;;
    test)  wanted="$build $test" ;;
    blender) wanted=blender ;;
    peers) wanted='nodejs npm'
           # a node from elsewhere brings its own npm, and Debian's npm refuses to stand beside it
           if command -v node >/dev/null && command -v npm >/dev/null; then wanted=; fi ;;
    *)     echo "usage: sh packages.sh build|test|blender|peers" >&2; exit 2 ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "packages: this is no Debian. Install what matches these Debian 12 packages, unless it is there already:"
    echo "  $wanted"
    exit 0
fi

lacking=
for package in $wanted; do
    status=$(dpkg-query -W -f='${db:Status-Status} ' "$package" 2>/dev/null) || status=
    case " $status" in
        *' installed '*) ;;
        *) lacking="$lacking $package" ;;
    esac
done
if [ -z "$lacking" ]; then
    echo "packages: all there"
    exit 0
fi

echo "packages: lacking:$lacking"
if [ "$(id -u)" -eq 0 ]; then
    root=
elif command -v sudo >/dev/null; then
    root=sudo
else
    echo "packages: neither root nor sudo. Have this run: apt-get install --no-install-recommends$lacking" >&2
    exit 1
fi

# Another apt-get may be at work: wait for it. $root and $lacking are lists of words.
apt() { $root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=120 -o Dpkg::Use-Pty=0 "$@"; }
# shellcheck disable=SC2086
if ! { apt update && apt install -y --no-install-recommends $lacking; }; then
    echo "packages: apt-get failed, see above. If you have all of this by other means, leave the step out: make PACKAGES=: ..." >&2
    exit 1
fi
