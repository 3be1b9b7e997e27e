/* bench_common.h - what hbil-table and hbil-marches share: errors against a truth, a page of Markdown between two markers.
 * The program defines BENCH_NAME, for its messages. */
#ifndef HBIL_BENCH_COMMON_H
#define HBIL_BENCH_COMMON_H

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../examples/frame/metric.h"

#define PAGE_MAX (1u << 20)

static inline void die(int code, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    fputs(BENCH_NAME ": ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    exit(code);
}

/* ---------------------------------------------------------------------- errors */

/* Size of the error and its mean, signed. */
typedef struct value { int known; double error, bias; } value;

typedef struct sums { double count, difference, absolute, square, truth; } sums;

static inline void add(sums *s, double ours, double truth)
{
    const double d = ours - truth;

    s->count += 1.0;
    s->difference += d;
    s->absolute += fabs(d);
    s->square += d * d;
    s->truth += truth;
}

/* relative: mean |difference| and mean difference as parts of the mean truth; else root of the mean square, and mean. */
static inline value result(const sums *s, int relative)
{
    value v = {0, 0.0, 0.0};

    if (s->count == 0.0 || (relative && s->truth <= 0.0)) return v;
    v.known = 1;
    v.error = relative ? s->absolute / s->truth : sqrt(s->square / s->count);
    v.bias = s->difference / (relative ? s->truth : s->count);
    return v;
}

/* Over the pixels of `where`; NULL: those with a truth. out may have more channels than truth. */
static inline value compare(const image *out, const image *truth, const image *where, const capture *cap, int relative)
{
    sums s = {0.0, 0.0, 0.0, 0.0, 0.0};
    int  i, c;

    if (!out || !truth->data || (where && !where->data)) return result(&s, 0);
    for (i = 0; i < cap->width * cap->height; ++i) {
        if (where ? !(where->data[i] > 0.5f) : !metric_counts(cap, (size_t)i)) continue;
        for (c = 0; c < truth->channels; ++c)
            add(&s, (double)out->data[out->channels * i + c], (double)truth->data[truth->channels * i + c]);
    }
    return result(&s, relative);
}

/* Sums of values, then their mean. known counts. */
static inline void add_value(value *sum, value v)
{
    if (!v.known) return;
    sum->known++;
    sum->error += v.error;
    sum->bias += v.bias;
}

static inline void divide(value *sum)
{
    if (!sum->known) return;
    sum->error /= sum->known;
    sum->bias /= sum->known;
}

static inline int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

static inline void free_images(image images[HBIL_MAX_TEXTURES])
{
    int i;

    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&images[i]);
}

static inline const image *output(const hbil_plan *plan, const image out[HBIL_MAX_TEXTURES], const char *name)
{
    const int32_t i = hbil_plan_texture(plan, name);

    return i >= 0 && out[i].data ? &out[i] : NULL;
}

/* ---------------------------------------------------------------------- the page */

typedef struct page { char *text; size_t size; } page;

static inline void put(page *p, const char *format, ...)
{
    va_list args;
    int     n;

    va_start(args, format);
    n = vsnprintf(p->text + p->size, PAGE_MAX - p->size, format, args);
    va_end(args);
    if (n < 0 || (size_t)n >= PAGE_MAX - p->size) die(5, "the table is longer than %u bytes", PAGE_MAX);
    p->size += (size_t)n;
}

/* Puts the table between the markers of the file; the rest of it stays. */
static inline void replace(const char *path, const char *mark_begin, const char *mark_end, const char *table)
{
    char        error[512] = "";
    char       *old = text_read(path, PAGE_MAX / 2, "a page with a table", error, sizeof error);
    const char *begin = old ? strstr(old, mark_begin) : NULL, *end = begin ? strstr(begin, mark_end) : NULL;
    page        p = {malloc(PAGE_MAX), 0};

    if (!old) die(3, "%s", error);
    if (!end) die(3, "%s: no line %s and, below it, %s", path, mark_begin, mark_end);
    if (!p.text) die(5, "out of memory");
    put(&p, "%.*s%s\n\n%s\n%s", (int)(begin - old), old, mark_begin, table, end);
    if (!text_write(path, p.text, error, sizeof error)) die(3, "%s", error);
    free(p.text);
    free(old);
}

#endif
