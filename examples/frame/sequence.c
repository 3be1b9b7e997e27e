/* sequence.c - see sequence.h. Patterns come from the command line: they never reach printf. */
#include "sequence.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Behind the % at `at`: length up to and with the d, 1 for %, 0: neither. */
static size_t conversion(const char *at, int *width, int *zeros)
{
    const size_t digits = strspn(at, "0123456789");

    if (*at == '%') return 1;
    if (digits > 2 || at[digits] != 'd' || (digits && *at != '0')) return 0; /* blanks have no place in a name */
    *zeros = *at == '0';
    *width = digits ? atoi(at) : 0;
    return digits + 1;
}

int sequence_conversions(const char *pattern)
{
    int    count = 0, width, zeros;
    size_t n;

    for (; (pattern = strchr(pattern, '%')) != NULL; pattern += 1 + n) {
        n = conversion(pattern + 1, &width, &zeros);
        if (n == 0) return -1;
        count += pattern[1] != '%';
    }
    return count;
}

int sequence_name(char *out, size_t size, const char *pattern, int number)
{
    size_t used = 0;
    int    width = 0, zeros = 0;

    while (*pattern && used < size) {
        const size_t n = *pattern == '%' ? conversion(pattern + 1, &width, &zeros) : 0;
        if (n == 0 || pattern[1] == '%') out[used++] = *pattern;
        else used += (size_t)snprintf(out + used, size - used, zeros ? "%0*d" : "%*d", width, number);
        pattern += n + 1;
    }
    if (used >= size) return 0;
    out[used] = 0;
    return 1;
}

int sequence_range(const char *text, int *first, int *last)
{
    int used = 0;

    if (strspn(text, "0123456789:") != strlen(text) || strlen(text) > 11) return 0;
    return sscanf(text, "%d:%d%n", first, last, &used) == 2 && text[used] == 0 && *first <= *last && *last <= 99999;
}
