/* generated.c - uses what shadergen made at build time: includes the header; of each pass that is named, prints name, bytes
 * and FNV-1a sum of the text, as consumer.c does, and reads the SPIR-V. */
#include "hbil_shaders.h"
#include <stdio.h>

static size_t read_file(const char *folder, const char *name, const char *suffix, unsigned char *data, size_t room)
{
    char   path[4096];
    FILE  *f;
    size_t size;
    snprintf(path, sizeof path, "%s%s%s", folder, name, suffix);
    f = fopen(path, "rb");
    if (!f) return 0;
    size = fread(data, 1, room, f);
    fclose(f);
    return size;
}

int main(int argc, char **argv)
{
    static unsigned char data[1 << 18];
    unsigned long        sum;
    size_t               size, k;
    int                  i;
    for (i = 1; i < argc; ++i) {
        size = read_file(TEXTS, argv[i], ".comp", data, sizeof data);
        for (sum = 2166136261u, k = 0; k < size; ++k) sum = ((sum ^ data[k]) * 16777619u) & 0xffffffff;
        printf("pass %s %d %08lx\n", argv[i], (int)size, sum);
        size = read_file(WORDS, argv[i], ".spv", data, sizeof data);
        if (size < 20 || size % 4 || data[0] != 3 || data[1] != 2 || data[2] != 0x23 || data[3] != 7) return 1;
    }
    return 0;
}
