/* forgetful.c - errors made on purpose, each of which leaks.sh must find:
 *   forgetful leak | read | jump           a lost allocation; a read behind its end; a branch on what was never written
 *   forgetful vulkan | gl                  a device that is opened and forgotten; 77: there is none */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HBIL_IMPLEMENTATION
#include "../../hbil.h"

#include "../../examples/frame/runner.h"

static char *volatile g_block; /* volatile: the compiler sees through none of this */

static int open_and_forget(const char *backend)
{
    char          error[512] = "";
    const runner *r = runner_open(backend, 0, error, sizeof error);
    if (r != NULL) return 0;
    fprintf(stderr, "%s\n", error);
    return 77;
}

/* Writes over what calls before it left on the stack, where leak checkers look for pointers. */
static int wipe_stack(void)
{
    volatile char stale[8192];
    int           sum = 0;
    for (size_t i = 0; i < sizeof stale; ++i) stale[i] = 0;
    for (size_t i = 0; i < sizeof stale; ++i) sum += stale[i];
    return sum;
}

int main(int count, char **words)
{
    const char *what = count > 1 ? words[1] : "";
    int         code = 0;
    if (strcmp(what, "vulkan") == 0 || strcmp(what, "gl") == 0) code = open_and_forget(what);
    else {
        g_block = malloc(40);
        if (g_block == NULL) return 3;
        if (strcmp(what, "read") == 0) code = g_block[40] == 1;
        if (strcmp(what, "jump") == 0 && g_block[4] == 1) puts("1");
        if (strcmp(what, "leak") != 0) free(g_block);
        g_block = NULL;
    }
    return code + wipe_stack();
}
