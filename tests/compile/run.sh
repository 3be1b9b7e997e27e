#!/bin/sh
# Proves that each header stands alone: copied to an empty folder, it compiles there without a warning under the strictest
# flags, in two files of one program, as every supported standard, with every compiler found, and its functions link and work.
#
#   sh tests/compile/run.sh [CC ...]       default: gcc clang
#
# A line per combination. Exit 1 if one fails, 77 if no compiler is there.
set -u

root=$(cd "$(dirname "$0")/../.." && pwd)
compilers=${*:-gcc clang}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cp "$root/hbil.h" "$root"/backends/hbil_*.h "$work" || exit 1

warnings='-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wundef -Wdouble-promotion -Werror'
glslang='-lglslang -lSPIRV -lMachineIndependent -lGenericCodeGen -lOGLCompiler -lOSDependent
    -lglslang-default-resource-limits -lSPIRV-Tools-opt -lSPIRV-Tools -lstdc++ -lm'
failed=0
ran=0

# ---------------------------------------------------------------------------------------------------- the two files

# Addresses of all functions that a header declares with its API macro, so that a missing definition fails at link and a new
# function is covered without an edit here.
function_table() # HEADER MACRO
{
    names=$(sed -n "s/^$2  *[a-z].*[ *]\(hbil_[a-z0-9_]*\)(.*/\1/p" "$work/$1")
    [ -n "$names" ] || { echo "compile: no functions found in $1" >&2; exit 1; }
    echo 'typedef void (*any_function)(void);'
    echo 'static const any_function functions[] = {'
    for name in $names; do echo "    (any_function)$name,"; done
    echo '};'
    echo 'static int all_there(void)'
    echo '{'
    echo '    size_t i;'
    echo '    for (i = 0; i < sizeof functions / sizeof functions[0]; ++i) if (functions[i] == NULL) return 0;'
    echo '    return 1;'
    echo '}'
}

# The file with an implementation. Extra lines come first.
write_first() # FILE HEADER IMPLEMENTATION-MACRO [LINE ...]
{
    file=$1; header=$2; macro=$3
    shift 3
    {
        for line in "$@"; do printf '%s\n' "$line"; done
        echo "#define $macro"
        echo "#include \"$header\""
    } > "$work/$file"
}

# The other one: declarations only, every function, a plan, its text, and `checks` (C, may set ok = 0).
write_second() # FILE HEADER API-MACRO CHECKS [LINE ...]
{
    file=$1; header=$2; macro=$3; checks=$4
    shift 4
    {
        for line in "$@"; do printf '%s\n' "$line"; done
        echo "#include \"$header\""
        echo "#include \"$header\" /* twice does no harm */"
        echo '#include <stdio.h>'
        echo '#include <string.h>'
        if [ -n "$macro" ]; then function_table "$header" "$macro"; else echo 'static int all_there(void) { return 1; }'; fi
        cat <<'CODE'
static char text[HBIL_GLSL_MAX];
int main(void)
{
    hbil_config config;
    static hbil_plan plan;
    int ok = all_there() && hbil_version() == HBIL_VERSION;
    memset(&config, 0, sizeof config);
CODE
        printf '%s\n' "$checks"
        cat <<'CODE'
    ok = ok && hbil_plan_build(&config, &plan, NULL) == HBIL_OK;
    ok = ok && hbil_emit_glsl(&plan, 0, text, sizeof text, NULL) == HBIL_OK && strncmp(text, "#version", 8) == 0;
    printf("%s %u\n", ok ? "works" : "fails", (unsigned)strlen(text));
    return !ok;
}
CODE
    } > "$work/$file"
}

# ---------------------------------------------------------------------------------------------------- one combination

# Compiles both files, links, runs. The program must say "works" and how long the text is: as long everywhere.
combination() # NAME COMPILER STANDARD FIRST SECOND [FLAG ...]
{
    name=$1; compiler=$2; standard=$3; first=$4; second=$5
    shift 5
    case $standard in
        c++*) language='-x c++'; library=-lstdc++ ;;
        *)    language='-x c -Wstrict-prototypes'; library= ;;
    esac
    ran=$((ran + 1))
    # shellcheck disable=SC2086
    if (cd "$work" && $compiler -std=$standard -O1 $warnings $language "$first" "$second" -x none -o program "$@" $library &&
        ./program) > "$work/log" 2>&1 && grep -q '^works [1-9]' "$work/log" &&
        { [ ! -e "$work/expected" ] || cmp -s "$work/expected" "$work/log"; }; then
        [ -e "$work/expected" ] || cp "$work/log" "$work/expected"
        printf 'ok    %-34s %-6s %s\n' "$name" "$compiler" "$standard"
    else
        failed=$((failed + 1))
        printf 'FAIL  %-34s %-6s %s\n' "$name" "$compiler" "$standard"
        sed 's/^/      /' "$work/log" | head -40
    fi
}

core() # COMPILER
{
    for standard in c99 c11 c++11 c++20; do combination hbil.h "$1" "$standard" core_1.c core_2.c; done
    for standard in c99 c++11; do
        combination 'hbil.h, HBIL_API static' "$1" "$standard" static_1.c static_2.c
        combination 'hbil.h, HBIL_API static inline' "$1" "$standard" inline_1.c inline_2.c
        combination 'hbil.h after windows.h macros' "$1" "$standard" windows_1.c windows_2.c
    done
}

# The core is one C object for all: programs in C++ link with it too.
backends() # COMPILER
{
    (cd "$work" && "$1" -std=c99 -O1 -c core_1.c -o core.o) || exit 1
    for standard in c99 c++11; do
        combination hbil_null.h "$1" "$standard" null_1.c null_2.c core.o
        # shellcheck disable=SC2086
        combination hbil_glslang.h "$1" "$standard" glslang_1.c glslang_2.c core.o $glslang
        combination hbil_vk.h "$1" "$standard" vk_1.c vk_2.c core.o
        combination 'hbil_vk.h after volk.h' "$1" "$standard" volk_1.c volk_2.c core.o
        combination hbil_gl.h "$1" "$standard" gl_1.c gl_2.c core.o
        combination 'hbil_gl.h after GL/gl.h' "$1" "$standard" with_gl_1.c with_gl_2.c core.o
        combination 'hbil_gl.h after GL/glcorearb.h' "$1" "$standard" with_glcore_1.c with_glcore_2.c core.o
    done
}

# ---------------------------------------------------------------------------------------------------- files

write_first core_1.c hbil.h HBIL_IMPLEMENTATION
write_second core_2.c hbil.h HBIL_API ''

# A private copy in each file: both link, and no function of either clashes. "static" has to use all of them, or the compiler
# calls the rest unused; "static inline" has not.
write_second static_2.c hbil.h HBIL_API '' '#define HBIL_API static' '#define HBIL_IMPLEMENTATION'
write_first static_1.c hbil.h HBIL_IMPLEMENTATION '#define HBIL_API static'
{ function_table hbil.h HBIL_API; echo 'int other(void);'; echo 'int other(void) { return all_there(); }'; } >> "$work/static_1.c"
write_second inline_2.c hbil.h '' '' '#define HBIL_API static inline' '#define HBIL_IMPLEMENTATION'
write_first inline_1.c hbil.h HBIL_IMPLEMENTATION '#define HBIL_API static inline'

# windows.h defines these, in any letter case that matters.
set -- '#define near' '#define far' '#define small char' '#define interface struct' '#define IN' '#define OUT' '#define OPTIONAL' \
       '#define min(a, b) min_macro' '#define max(a, b) max_macro' '#define ERROR 0' '#define DIFFERENCE 11' '#define TRANSPARENT 1'
write_first windows_1.c hbil.h HBIL_IMPLEMENTATION "$@"
write_second windows_2.c hbil.h HBIL_API '' "$@"

write_first null_1.c hbil_null.h HBIL_NULL_IMPLEMENTATION
write_second null_2.c hbil_null.h '' '
    ok = ok && hbil_plan_build(&config, &plan, NULL) == HBIL_OK && hbil_null_check(&plan, 640, 360, NULL) == 0;'

write_first glslang_1.c hbil_glslang.h HBIL_GLSLANG_IMPLEMENTATION
write_second glslang_2.c hbil_glslang.h '' '
    {
        static uint32_t words[65536];
        size_t need = 0;
        char log[256];
        ok = ok && hbil_plan_build(&config, &plan, NULL) == HBIL_OK;
        ok = ok && hbil_emit_glsl(&plan, 0, text, sizeof text, NULL) == HBIL_OK && hbil_glslang_init();
        ok = ok && hbil_glslang_compile(text, HBIL_TARGET_VULKAN, words, 65536, &need, log, sizeof log) == HBIL_GLSLANG_OK;
        ok = ok && need > 5 && words[0] == 0x07230203;
        hbil_glslang_shutdown();
    }'

vk_checks='
    {
        static hbil_vk vk;
        hbil_vk_info info;
        memset(&info, 0, sizeof info);
        ok = ok && hbil_vk_init(&info, &vk) == HBIL_VK_E_ARG && vk.message[0];
        ok = ok && hbil_vk_format(HBIL_FORMAT_R32F) == VK_FORMAT_R32_SFLOAT;
        hbil_vk_shutdown(&vk);
    }'
write_first vk_1.c hbil_vk.h HBIL_VK_IMPLEMENTATION
write_second vk_2.c hbil_vk.h HBIL_VK_API "$vk_checks"
write_first volk_1.c hbil_vk.h HBIL_VK_IMPLEMENTATION '#include <volk.h>'
write_second volk_2.c hbil_vk.h HBIL_VK_API "$vk_checks" '#include <volk.h>'

gl_checks='
    {
        static hbil_gl gl;
        hbil_gl_info info;
        memset(&info, 0, sizeof info);
        ok = ok && hbil_gl_init(&info, &gl) == HBIL_GL_E_ARG && gl.message[0];
        ok = ok && hbil_gl_format(HBIL_FORMAT_R32F) == 0x822E;
        hbil_gl_shutdown(&gl);
    }'
write_first gl_1.c hbil_gl.h HBIL_GL_IMPLEMENTATION
write_second gl_2.c hbil_gl.h HBIL_GL_API "$gl_checks"
write_first with_gl_1.c hbil_gl.h HBIL_GL_IMPLEMENTATION '#include <GL/gl.h>'
write_second with_gl_2.c hbil_gl.h HBIL_GL_API "$gl_checks" '#include <GL/gl.h>'
write_first with_glcore_1.c hbil_gl.h HBIL_GL_IMPLEMENTATION '#define GL_GLEXT_PROTOTYPES' '#include <GL/glcorearb.h>'
write_second with_glcore_2.c hbil_gl.h HBIL_GL_API "$gl_checks" '#define GL_GLEXT_PROTOTYPES' '#include <GL/glcorearb.h>'

# ---------------------------------------------------------------------------------------------------- run

for compiler in $compilers; do
    if ! command -v "$compiler" >/dev/null; then
        echo "skip  $compiler is not installed"
        continue
    fi
    core "$compiler"
    backends "$compiler"
done
[ $ran -gt 0 ] || { echo "skipped: none of: $compilers"; exit 77; }
echo "$ran combinations, $failed failed"
[ $failed -eq 0 ]
