/* case_file.c - writes and reads cases. A line is a word and what belongs to it; numbers of an image follow its line. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_file.h"

enum { CASE_BYTES_MAX = 64 << 20 };

/* ------------------------------------------------------------------------------------------------------------- writing */

/* A text that grows. failed: out of memory, once and for all. */
typedef struct growing { char *text; size_t size, room; int failed; } growing;

static void put(growing *g, const char *text)
{
    const size_t n = strlen(text);
    if (g->size + n + 1 > g->room && !g->failed) {
        const size_t room = 2 * g->room + n + 4096;
        char *more = (char *)realloc(g->text, room);
        g->failed = !more;
        if (more) g->text = more, g->room = room;
    }
    if (g->failed) return;
    memcpy(g->text + g->size, text, n + 1);
    g->size += n;
}

/* The shortest of decimals that read back equal; else hex. */
static void put_number(growing *g, float v)
{
    char text[40];
    if (v != v) strcpy(text, " nan");
    else if (isinf(v)) strcpy(text, v > 0 ? " inf" : " -inf");
    else {
        snprintf(text, sizeof text, " %.6g", (double)v);
        if (strtof(text, NULL) != v) snprintf(text, sizeof text, " %a", (double)v);
    }
    put(g, text);
}

static void put_numbers(growing *g, const char *name, const float *v, int n, float usual)
{
    int i, differs = 0;
    for (i = 0; i < n; ++i) differs |= !(v[i] == usual);
    if (!differs) return;
    put(g, name);
    for (i = 0; i < n; ++i) put_number(g, v[i]);
    put(g, "\n");
}

static void put_whole(growing *g, const char *name, uint32_t v)
{
    char text[64];
    snprintf(text, sizeof text, "%s %u\n", name, v);
    put(g, text);
}

static void put_live(growing *g, const hbil_config *config, const hbil_config *live)
{
    char text[64];
    int32_t i;
    for (i = 0; i < hbil_option_count(); ++i) {
        const hbil_option *o = hbil_option_at(i);
        int32_t whole;
        float number;
        memcpy(&whole, (const char *)live + o->offset, 4);
        memcpy(&number, &whole, 4);
        if (!(config->dynamic & o->dynamic) || !whole) continue;
        snprintf(text, sizeof text, "live %s", o->name);
        put(g, text);
        put_number(g, o->kind == HBIL_KIND_FLOAT ? number : (float)whole);
        put(g, "\n");
    }
}

static void put_image(growing *g, const char *name, const image *img)
{
    const int row = img->width * img->channels, rows = img->height * image_slices(img);
    char text[96];
    int i, k;
    snprintf(text, sizeof text, "input %s %d %d %d %d\n", name, img->width, img->height, image_slices(img), img->channels);
    put(g, text);
    for (i = 0; i < rows; ++i) {
        for (k = 0; k < row; ++k) put_number(g, img->data[i * row + k]);
        put(g, "\n");
    }
}

static void put_frame(growing *g, const test_case *c, int i)
{
    const hbil_frame *f = &c->frame[i];
    int k;
    put(g, "\nframe\n");
    put_whole(g, "width", f->width);
    put_whole(g, "height", f->height);
    put_whole(g, "index", f->index);
    put_whole(g, "reset", f->reset);
    put_numbers(g, "projection", f->projection, 16, 0);
    put_numbers(g, "view", f->view, 16, 0);
    put_numbers(g, "far_color", f->far_color, 3, 1);
    put_numbers(g, "far_sh", f->far_sh[0], 27, 0);
    put_numbers(g, "probe_origin", f->probe_origin, 3, 0);
    put_numbers(g, "probe_step", f->probe_step, 3, 1);
    put_live(g, &c->config, &c->live[i]);
    for (k = 0; k < CASE_INPUTS; ++k)
        if (c->input[i][k].data) put_image(g, case_inputs[k], &c->input[i][k]);
}

int case_write(const char *path, const test_case *c, const char *note, char *error, size_t error_size)
{
    growing g = { NULL, 0, 0, 0 };
    char config[2048];
    int i, ok;
    put(&g, "# a case of hbil-search: what it fails, or once failed, is told by hbil-search --replay\n");
    put(&g, note);
    hbil_config_print(&c->config, 0, config, sizeof config, NULL);
    put(&g, "config ");
    put(&g, config);
    put(&g, "\n");
    for (i = 0; i < c->frames; ++i) put_frame(&g, c, i);
    ok = g.failed ? frame_error(error, error_size, "%s: out of memory", path) : text_write(path, g.text, error, error_size);
    free(g.text);
    return ok;
}

/* ------------------------------------------------------------------------------------------------------------- reading */

typedef struct reader { const char *path, *at; int line; char *error; size_t error_size; } reader;

static int fault(reader *r, const char *what)
{
    return frame_error(r->error, r->error_size, "%s:%d: %s", r->path, r->line, what);
}

/* To the next thing that is no blank, line break or comment. 0: the end. */
static int skip(reader *r)
{
    for (; *r->at; ++r->at) {
        if (*r->at == '#') r->at += strcspn(r->at, "\n");
        if (*r->at == '\n') ++r->line;
        else if (*r->at != ' ' && *r->at != '\r' && *r->at != '\t') return *r->at != 0;
    }
    return 0;
}

static int get_word(reader *r, char *word, size_t size)
{
    size_t n;
    if (!skip(r)) return fault(r, "the file ends here: a word is missing");
    n = strcspn(r->at, " \n\r\t");
    if (n >= size) return fault(r, "no such word: it is too long");
    memcpy(word, r->at, n);
    word[n] = 0;
    r->at += n;
    return 1;
}

static int get_numbers(reader *r, float *out, int n)
{
    for (; n > 0; --n, ++out) {
        char *end;
        if (!skip(r)) return fault(r, "the file ends here: numbers are missing");
        *out = strtof(r->at, &end);
        if (end == r->at) return fault(r, "a number is missing here: write decimals, hex floats, nan or inf");
        r->at = end;
    }
    return 1;
}

static int get_whole(reader *r, uint32_t *out)
{
    char *end;
    if (!skip(r)) return fault(r, "the file ends here: a whole number is missing");
    *out = (uint32_t)strtoul(r->at, &end, 10);
    if (end == r->at) return fault(r, "a whole number is missing here");
    r->at = end;
    return 1;
}

static int get_config(reader *r, test_case *out)
{
    const size_t n = strcspn(r->at, "\n");
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    hbil_config c;
    memset(&c, 0, sizeof c);
    item.text[0] = 0;
    if (hbil_config_parse(&c, r->at, n, &diags) != HBIL_OK || hbil_config_resolve(&c, &out->config, &diags) != HBIL_OK)
        return fault(r, item.text);
    r->at += n;
    return 1;
}

static int get_live(reader *r, hbil_config *live)
{
    char name[64];
    const hbil_option *o;
    float number = 0;
    int32_t whole;
    if (!get_word(r, name, sizeof name) || !get_numbers(r, &number, 1)) return 0;
    o = hbil_option_at(hbil_option_find(name, strlen(name), NULL));
    if (!o || !o->dynamic) return fault(r, "live: no dynamic option of that name");
    if (!(fabs((double)number) < 2e9)) return fault(r, "live: no value of an option");
    whole = (int32_t)number;
    memcpy((char *)live + o->offset, o->kind == HBIL_KIND_FLOAT ? (const void *)&number : (const void *)&whole, 4);
    return 1;
}

static int get_image(reader *r, image inputs[CASE_INPUTS])
{
    char name[64];
    uint32_t size[4];
    int i, k;
    if (!get_word(r, name, sizeof name)) return 0;
    for (k = 0; k < CASE_INPUTS && strcmp(name, case_inputs[k]); ++k) { }
    if (k == CASE_INPUTS || inputs[k].data) return fault(r, "input: no such name, or a second one of it");
    for (i = 0; i < 4; ++i)
        if (!get_whole(r, &size[i])) return 0;
    if (size[3] < 1 || size[3] > 4 || size[0] > 16384 || size[1] > 16384 || size[2] > 16384 ||
        (uint64_t)size[0] * size[1] * size[2] * size[3] > CASE_BYTES_MAX / 2)
        return fault(r, "input: width, height, slices and 1 to 4 channels; more numbers than a case may have");
    if (!image_make_slices(&inputs[k], (int)size[0], (int)size[1], (int)size[2], (int)size[3]))
        return fault(r, "input: no such size, or out of memory");
    return get_numbers(r, inputs[k].data, (int)(size[0] * size[1] * size[2] * size[3]));
}

static void start_frame(hbil_frame *f)
{
    int k;
    memset(f, 0, sizeof *f);
    for (k = 0; k < 3; ++k) f->far_color[k] = f->probe_step[k] = 1;
}

static int get_field(reader *r, const char *word, test_case *c)
{
    const int i = c->frames - 1;
    hbil_frame *f = &c->frame[i];
    const struct { const char *name; float *to; int n; } numbers[] = {
        { "projection", f->projection, 16 }, { "view", f->view, 16 }, { "far_color", f->far_color, 3 }, { "far_sh", f->far_sh[0], 27 },
        { "probe_origin", f->probe_origin, 3 }, { "probe_step", f->probe_step, 3 } };
    const struct { const char *name; uint32_t *to; } wholes[] = {
        { "width", &f->width }, { "height", &f->height }, { "index", &f->index }, { "reset", &f->reset } };
    size_t k;
    for (k = 0; k < sizeof numbers / sizeof *numbers; ++k)
        if (strcmp(word, numbers[k].name) == 0) return get_numbers(r, numbers[k].to, numbers[k].n);
    for (k = 0; k < sizeof wholes / sizeof *wholes; ++k)
        if (strcmp(word, wholes[k].name) == 0) return get_whole(r, wholes[k].to);
    if (strcmp(word, "live") == 0) return get_live(r, &c->live[i]);
    if (strcmp(word, "input") == 0) return get_image(r, c->input[i]);
    return fault(r, "no such word: config, frame, live, input, or a field of hbil_frame");
}

static int get_case(reader *r, test_case *out)
{
    char word[64];
    int known = 0;
    while (skip(r)) {
        if (!get_word(r, word, sizeof word)) return 0;
        if (strcmp(word, "config") == 0) {
            if (known++ || !get_config(r, out)) return known > 1 ? fault(r, "config: a second one") : 0;
        } else if (strcmp(word, "frame") == 0) {
            if (out->frames == CASE_FRAMES) return fault(r, "frame: more than a case may have");
            start_frame(&out->frame[out->frames++]);
        } else if (!out->frames) {
            return fault(r, "a line \"frame\" must come before this one");
        } else if (!get_field(r, word, out)) {
            return 0;
        }
    }
    return (known && out->frames) || fault(r, "a line \"config\" or \"frame\" is missing");
}

int case_read(const char *path, test_case *out, char *error, size_t error_size)
{
    char *text = text_read(path, CASE_BYTES_MAX, "a case of hbil-search", error, error_size);
    reader r = { path, text, 1, error, error_size };
    int ok;
    memset(out, 0, sizeof *out);
    ok = text && get_case(&r, out);
    free(text);
    if (ok) case_link(out);
    else case_free(out);
    return ok;
}
