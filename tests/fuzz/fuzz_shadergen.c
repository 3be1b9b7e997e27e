/* fuzz_shadergen.c - command lines of shadergen: a word a line, behind an empty line what the file "c" holds, behind another "hook".
 *
 * It may write: only into a folder of ours. Words that lead out of it are left alone. shadergen matrix gets no file here:
 * fuzz_matrix.c reads those. */
#include "fuzz.h"

#define main shadergen_main
int shadergen_main(int argc, char **argv);
#include "../../shadergen/shadergen.c"
#undef main

enum { WORDS_MAX = 24 };

/* The text up to an empty line, terminated; what follows. */
static char *part(char *text, char **next)
{
    char *end = *text == '\n' ? text : strstr(text, "\n\n");
    *next = end ? end + (end == text ? 1 : 2) : text + strlen(text);
    if (end) *end = 0;
    return text;
}

/* Is this one to be let through? */
static int is_harmless(int argc, char **argv)
{
    int i, matrix_is = argc > 1 && strcmp(argv[1], "matrix") == 0;
    for (i = 1; i < argc; ++i)
        if (*argv[i] == '/' || strstr(argv[i], "..") || strlen(argv[i]) > 500 || (matrix_is && strcmp(argv[i], "-") == 0)) return 0;
    return 1;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int ready;
    static char name[] = "shadergen";
    char *text = (char *)malloc(size + 1), *argv[WORDS_MAX + 2] = { name }, *at, *content, *hook, *rest;
    int argc = 1, code;
    if (!text) return 0;
    if (!ready) {
        fuzz_enter_folder();
        ready = 1;
    }
    memcpy(text, data, size);
    text[size] = 0;
    at = part(text, &content);
    content = part(content, &hook);
    hook = part(hook, &rest);
    for (at = strtok(at, "\n"); at && argc <= WORDS_MAX; at = strtok(NULL, "\n")) argv[argc++] = at;
    argv[argc] = NULL;
    if (is_harmless(argc, argv)) {
        if (argc < 2 || strcmp(argv[1], "matrix")) fuzz_write("c", content, strlen(content));
        fuzz_write("hook", hook, strlen(hook));
        rewind(stdin);
        code = shadergen_main(argc, argv);
        FUZZ_REQUIRE(code >= DONE && code <= STALE);
        FUZZ_REQUIRE(code != COMPILER || strstr(hook, "hbil_far_hook")); /* glslang takes all of our text, if not of the hook's */
        source_count = msvc = 0;
        fuzz_empty_folder();
    }
    free(text);
    return 0;
}
