/* cost_report.c - see cost.h: passes of a plan made and counted, the table, and what each option adds. */
#include "cost.h"
#include "../backends/hbil_glslang.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define WORDS_MAX (1 << 18) /* SPIR-V words of a pass after inlining */
#define METRICS   ((int)(sizeof(cost_counts) / sizeof(double)))
#define NONE      (-1)

static void add(cost_counts *to, const cost_counts *c, double factor)
{
    double *t = (double *)to;
    const double *from = (const double *)c;
    int k;
    for (k = 0; k < METRICS; ++k) t[k] += factor * from[k];
}

/* ------------------------------------------------------------------------------------------------------------ plans */

typedef struct cost_compiled { char *text; uint32_t *words; size_t count; } compiled;
typedef cost_cache cache;

void cost_cache_free(cost_cache *c)
{
    while (c->count > 0) {
        --c->count;
        free(c->items[c->count].text);
        free(c->items[c->count].words);
    }
    free(c->items);
    c->items = NULL;
    c->count = 0;
}

/* The text behind the head, which names the whole config. */
static const char *body(const char *text)
{
    const char *at = strstr(text, "\nlayout(");
    return at ? at : text;
}

static const compiled *cache_get(cache *c, const char *text)
{
    compiled *grown, *to;
    int i;
    for (i = 0; i < c->count; ++i)
        if (strcmp(body(c->items[i].text), body(text)) == 0) return &c->items[i];
    grown = (compiled *)realloc(c->items, (size_t)(c->count + 1) * sizeof *c->items);
    if (!grown) return NULL;
    c->items = grown;
    to = &c->items[c->count];
    to->text = (char *)malloc(strlen(text) + 1);
    to->words = (uint32_t *)malloc(WORDS_MAX * sizeof *to->words);
    if (to->text && to->words && hbil_glslang_optimize(text, HBIL_TARGET_VULKAN, to->words, WORDS_MAX, &to->count, NULL,
                                                       0) == HBIL_GLSLANG_OK) {
        uint32_t *fits = (uint32_t *)realloc(to->words, to->count * sizeof *to->words);
        if (fits) to->words = fits;
        strcpy(to->text, text);
        ++c->count;
        return to;
    }
    free(to->text);
    free(to->words);
    return NULL;
}

/* plan: of target=vulkan, stage=compute. */
static int count_pass(const hbil_plan *plan, int32_t pass, const hook_file *hook, cache *c, cost *out)
{
    static const hook_file none = { NULL, NULL };
    const hook_file *with = hook ? hook : &none;
    const compiled *words;
    size_t size;
    char *text = build_glsl(plan, pass, with->text, &size, NULL);
    words = text ? cache_get(c, text) : NULL;
    free(text);
    if (!words) { /* build_pass finds out whose fault it is, and says so */
        file f = { "", NULL, 0 };
        const int code = build_pass(plan, pass, 1, with, &f);
        free(f.data);
        if (code == DONE) fprintf(stderr, "shadergen: spirv-opt refused pass %s\n", plan->passes[pass].name);
        return code == DONE ? COMPILER : code;
    }
    if (cost_of_words(plan, pass, words->words, words->count, out)) return DONE;
    fprintf(stderr, "shadergen: cannot count pass %s: %s\n", plan->passes[pass].name, out->error);
    return COMPILER;
}

static int as_vulkan(const hbil_plan *plan, hbil_plan *to)
{
    hbil_config c = plan->config;
    c.target = HBIL_TARGET_VULKAN;
    c.stage = HBIL_STAGE_COMPUTE;
    return hbil_plan_build(&c, to, NULL) == HBIL_OK ? DONE : CONFIG;
}

int cost_of_pass(const hbil_plan *plan, int32_t pass, const hook_file *hook, cost *out)
{
    hbil_plan vulkan;
    cache c = { NULL, 0 };
    int code = as_vulkan(plan, &vulkan);
    if (code != DONE || pass < 0 || pass >= (int32_t)vulkan.pass_count) return CONFIG;
    if (!hbil_glslang_init()) { fprintf(stderr, "shadergen: glslang does not start\n"); return IO; }
    code = count_pass(&vulkan, pass, hook, &c, out);
    cost_cache_free(&c);
    hbil_glslang_shutdown();
    return code;
}

/* The walk of a LINES grid: the one loop that an invocation enters. NONE: no such grid. */
static int walk_of(const hbil_plan *plan, int32_t pass, const cost *c)
{
    int k;
    for (k = 0; k < c->loops && plan->passes[pass].grid == HBIL_GRID_LINES; ++k)
        if (c->fixed.enters[k] > 0) return k;
    return NONE;
}

void cost_per_pixel(const hbil_plan *plan, int32_t pass, const cost *c, cost_counts *out)
{
    const int walk = walk_of(plan, pass, c);
    memset(out, 0, sizeof *out);
    if (walk == NONE) *out = c->fixed;
    else add(out, &c->step[walk], plan->textures[plan->passes[pass].domain].layers);
}

/* Adds to `to` one step of each loop that is entered, and of those that such a step enters. */
static void add_steps(const cost *c, const cost_counts *from, double factor, int depth, cost_counts *to)
{
    int k;
    for (k = 0; k < c->loops && depth < COST_LOOPS_MAX; ++k) {
        if (from->enters[k] <= 0) continue;
        add(to, &c->step[k], factor * from->enters[k]);
        add_steps(c, &c->step[k], factor * from->enters[k], depth + 1, to);
    }
}

static double pixels_of(const hbil_plan *plan, int32_t pass)
{
    const double div = plan->textures[plan->passes[pass].domain].div;
    return div * div;
}

void cost_add(const hbil_plan *plan, int32_t pass, const cost *c, cost_total *t)
{
    cost_counts pixel;
    cost_per_pixel(plan, pass, c, &pixel);
    add(&t->fixed, &pixel, 1 / pixels_of(plan, pass));
    add_steps(c, &pixel, 1 / pixels_of(plan, pass), 0, &t->loops);
    memset(t->fixed.enters, 0, sizeof t->fixed.enters);
    memset(t->loops.enters, 0, sizeof t->loops.enters);
    t->unknown += c->loops - (walk_of(plan, pass, c) != NONE);
    if (c->registers > t->registers) t->registers = c->registers;
}

static int count_plan(const hbil_plan *plan, const hook_file *hook, cache *c, cost *one, cost_total *t)
{
    int32_t pass;
    int code = DONE;
    memset(t, 0, sizeof *t);
    for (pass = 0; pass < (int32_t)plan->pass_count && code == DONE; ++pass) {
        code = count_pass(plan, pass, hook, c, one);
        if (code == DONE) cost_add(plan, pass, one, t);
    }
    return code;
}

int cost_of_plans(const hbil_plan *plan, cost_cache *c, cost_total *out)
{
    hbil_plan vulkan;
    cost *one = (cost *)malloc(sizeof *one);
    int code = as_vulkan(plan, &vulkan);
    if (!one) {
        return no_memory();
    }
    if (code == DONE) code = count_plan(&vulkan, NULL, c, one, out);
    free(one);
    return code;
}

int cost_of_plan(const hbil_plan *plan, const hook_file *hook, cost_total *out)
{
    hbil_plan vulkan;
    cache c = { NULL, 0 };
    cost *one = (cost *)malloc(sizeof *one);
    int code = as_vulkan(plan, &vulkan);
    if (!one || !hbil_glslang_init()) {
        free(one);
        fprintf(stderr, "shadergen: out of memory, or glslang does not start\n");
        return IO;
    }
    if (code == DONE) code = count_plan(&vulkan, hook, &c, one, out);
    cost_cache_free(&c);
    free(one);
    hbil_glslang_shutdown();
    return code;
}

/* ----------------------------------------------------------------------------------------------------------- report */

#define NAME_WIDTH 34

static const char *const access_names[COST_ACCESSES] = { "fetch", "load", "store", "atomic" };

/* A number in a column; differences carry their sign. */
static void print_number(FILE *out, int width, double x, int sign)
{
    char text[32];
    const int whole = fabs(x - floor(x + 0.5)) < 1e-6 || fabs(x) >= 10000;
    if (fabs(x) < 0.005) snprintf(text, sizeof text, "%s", sign ? "." : "0");
    else snprintf(text, sizeof text, sign ? "%+.*f" : "%.*f", whole ? 0 : fabs(x) < 1 ? 2 : 1, x);
    fprintf(out, " %*s", width, text);
}

static void print_row(FILE *out, const char *name, const cost_counts *c, int registers, int sign)
{
    int k;
    fprintf(out, "%-*s", NAME_WIDTH, name);
    for (k = 0; k < COST_ACCESSES; ++k) print_number(out, 6, c->access[k], sign);
    fputs(" |", out);
    print_number(out, 7, c->bytes_read, sign);
    print_number(out, 7, c->bytes_written, sign);
    fputs(" |", out);
    for (k = 0; k < COST_CLASSES; ++k) print_number(out, k == COST_FLOAT ? 7 : 6, c->ops[k], sign);
    fputs(" |", out);
    if (registers == NONE) fputc('\n', out);
    else { print_number(out, 4, registers, sign); fputc('\n', out); }
}

static void print_head(FILE *out, const char *first)
{
    fprintf(out, "%-*s", NAME_WIDTH, first);
    fprintf(out, " %6s %6s %6s %6s | %7s %7s | %7s %6s %6s %6s %6s %6s %6s %6s | %4s\n", "fetch", "load", "store",
            "atomic", "read", "written", "float", "div", "root", "transc", "int", "conv", "comp", "branch", "regs");
}

/* "fetch view_depth 37, view_normal 1", a line for each kind that there is. */
static void print_textures(FILE *out, const hbil_plan *plan, const cost_counts *c)
{
    int a;
    uint32_t t;
    for (a = 0; a < COST_ACCESSES; ++a) {
        double rest = c->access[a];
        const char *comma = "";
        if (c->access[a] <= 0) continue;
        fprintf(out, "    %s ", access_names[a]);
        for (t = 0; t < plan->texture_count; ++t) {
            if (c->texture[a][t] <= 0) continue;
            fprintf(out, "%s%s %.10g", comma, plan->textures[t].name, c->texture[a][t]);
            comma = ", ";
            rest -= c->texture[a][t];
        }
        if (!*comma) fprintf(out, "the hook's own %.10g", rest);
        fputc('\n', out);
    }
    if (c->shared > 0) fprintf(out, "    shared memory: %.10g values loaded or stored\n", c->shared);
}

/* The loops of unknown length: how often a unit of `pass` enters each. */
static void print_loops(FILE *out, const hbil_plan *plan, const cost *c, int walk)
{
    int k, j;
    char name[96];
    for (k = 0; k < c->loops; ++k) {
        if (k == walk) continue;
        snprintf(name, sizeof name, "  each step of loop %d", k + 1);
        print_row(out, name, &c->step[k], NONE, 0);
        print_textures(out, plan, &c->step[k]);
        if (c->fixed.enters[k] > 0) fprintf(out, "    entered %.10g times\n", c->fixed.enters[k]);
        for (j = 0; j < c->loops; ++j) {
            if (c->step[j].enters[k] <= 0) continue;
            fprintf(out, "    entered %.10g times by each step of ", c->step[j].enters[k]);
            if (j == walk) fputs("the walk\n", out);
            else fprintf(out, "loop %d\n", j + 1);
        }
    }
}

static void print_pass(FILE *out, const hbil_plan *plan, int32_t pass, const cost *c)
{
    const hbil_texture *domain = &plan->textures[plan->passes[pass].domain];
    const int walk = walk_of(plan, pass, c);
    char name[96];
    if (walk != NONE) snprintf(name, sizeof name, "%s, a line", plan->passes[pass].name);
    else if (domain->div == 1) snprintf(name, sizeof name, "%s", plan->passes[pass].name);
    else snprintf(name, sizeof name, "%s, %d x %d pixels", plan->passes[pass].name, domain->div, domain->div);
    print_row(out, name, &c->fixed, c->registers, 0);
    print_textures(out, plan, &c->fixed);
    if (walk != NONE) {
        print_row(out, "  each step of the walk", &c->step[walk], NONE, 0);
        print_textures(out, plan, &c->step[walk]);
        if (domain->div == 1) fputs("    a pixel has", out);
        else fprintf(out, "    %d x %d pixels have", domain->div, domain->div);
        fprintf(out, " %d: one in each layer of %s\n", domain->layers, domain->name);
    }
    print_loops(out, plan, c, walk);
}

static int differs(const cost_counts *a, const cost_counts *b)
{
    const double *x = (const double *)a, *y = (const double *)b;
    int k;
    for (k = 0; k < METRICS; ++k)
        if (fabs(x[k] - y[k]) > 1e-9) return 1;
    return 0;
}

/* What a value costs: the plan less the one without it. ~: loops of unknown length differ, too. */
static void print_difference(FILE *out, const char *name, const cost_total *with, const cost_total *without)
{
    cost_counts d = with->fixed;
    char text[160];
    add(&d, &without->fixed, -1);
    snprintf(text, sizeof text, "  %s%s", name, differs(&with->loops, &without->loops) ? " ~" : "");
    print_row(out, text, &d, with->registers - without->registers, 1);
}

/* Value of an option as hbil_config_print spells it. */
static void value_text(const hbil_config *config, const char *option, char *buf, size_t cap)
{
    char all[4096], name[64];
    const char *at;
    hbil_config_print(config, 1, all, sizeof all, NULL);
    snprintf(name, sizeof name, "%s=", option);
    at = strstr(all, name);
    while (at && at != all && at[-1] != ' ') at = strstr(at + 1, name);
    snprintf(buf, cap, "%.*s", at ? (int)strcspn(at, " ") : 0, at ? at : "");
}

typedef struct report {
    FILE             *out;
    const hbil_plan  *plan; /* of target=vulkan */
    const hook_file  *hook;
    cache             cache;
    cost              one;
    cost_total        total, without;
    time_t            start;
    hbil_plan         other;
} report;

static int print_without(report *r, const char *name, const hbil_config *config)
{
    hbil_diag items[16];
    hbil_diags diags = { items, 16, 0 };
    int code, i = 0;
    memset(items, 0, sizeof items);
    if (hbil_plan_build(config, &r->other, &diags) != HBIL_OK) {
        while (i < 15 && items[i].severity != HBIL_ERROR) ++i;
        fprintf(r->out, "  %-*s cannot go alone: %s\n", NAME_WIDTH - 2, name, items[i].text);
        return DONE;
    }
    if (r->other.hash == r->plan->hash) return DONE;
    if (time(NULL) - r->start >= 2) fprintf(stderr, "shadergen: cost: without %s\n", name);
    code = count_plan(&r->other, r->hook, &r->cache, &r->one, &r->without);
    if (code == DONE) print_difference(r->out, name, &r->total, &r->without);
    return code;
}

/* Members of a set, each switched off alone; the last output cannot go. */
static int print_members(report *r, const hbil_option *o, uint32_t bits)
{
    const char *at = o->choices;
    uint32_t bit = 1;
    int code = DONE;
    for (; *at && code == DONE; at += strcspn(at, " "), at += strspn(at, " "), bit <<= 1) {
        hbil_config c = r->plan->config;
        const uint32_t rest = bits & ~bit;
        char name[96];
        if (!(bits & bit) || (rest == 0 && o->def > 0)) continue;
        memcpy((char *)&c + o->offset, &rest, sizeof rest);
        snprintf(name, sizeof name, "%s+%.*s", o->name, (int)strcspn(at, " "), at);
        code = print_without(r, name, &c);
    }
    return code;
}

static int is_default(const hbil_option *o, uint32_t bits)
{
    const float number = (float)o->def;
    uint32_t def = (uint32_t)o->def;
    if (o->kind == HBIL_KIND_FLOAT) memcpy(&def, &number, sizeof def);
    return bits == def;
}

static int print_options(report *r)
{
    int32_t i;
    int code = DONE;
    for (i = 0; i < hbil_option_count() && code == DONE; ++i) {
        const hbil_option *o = hbil_option_at(i);
        hbil_config c = r->plan->config;
        const uint32_t none = 0;
        uint32_t bits;
        char name[96];
        memcpy(&bits, (const char *)&c + o->offset, sizeof bits);
        if (strcmp(o->name, "target") == 0 || strcmp(o->name, "stage") == 0) continue;
        if (o->kind == HBIL_KIND_SET) { code = print_members(r, o, bits); continue; }
        if (is_default(o, bits)) continue;
        memcpy((char *)&c + o->offset, &none, sizeof none);
        value_text(&r->plan->config, o->name, name, sizeof name);
        code = print_without(r, name, &c);
    }
    return code;
}

static int print_report(report *r)
{
    const hbil_plan *plan = r->plan;
    char text[4096] = "";
    int32_t pass;
    int code = DONE;
    hbil_config_print(&plan->config, 0, text, sizeof text, NULL);
    fprintf(r->out, "# %s\n"
            "# Counted from SPIR-V after spirv-opt. Upper bounds: each figure is of the way through the branches on\n"
            "# which it is largest; loops run to their end; no read is shared or cached. Bytes: texels of the plan's\n"
            "# formats; inputs of your own format: depth 4 (r32f), others 8 (rgba16f). Registers: most 32-bit values\n"
            "# alive at once, an estimate. A step of a loop whose length only the data knows is told apart; ~: these\n"
            "# differ, too.\n\n",
            *text ? text : "the default of every option");
    print_head(r->out, "pass, of each pixel of its grid");
    for (pass = 0; pass < (int32_t)plan->pass_count && code == DONE; ++pass) {
        code = count_pass(plan, pass, r->hook, &r->cache, &r->one);
        if (code != DONE) return code;
        print_pass(r->out, plan, pass, &r->one);
        cost_add(plan, pass, &r->one, &r->total);
    }
    fputc('\n', r->out);
    print_row(r->out, "all, of each pixel of the frame", &r->total.fixed, r->total.registers, 0);
    if (r->total.unknown) print_row(r->out, "and a step of each unknown loop", &r->total.loops, NONE, 0);
    fputc('\n', r->out);
    print_head(r->out, "what each option adds to all");
    return print_options(r);
}

int cost_print(FILE *out, const hbil_plan *plan, const hook_file *hook)
{
    hbil_plan vulkan;
    report *r = (report *)calloc(1, sizeof *r);
    int code = as_vulkan(plan, &vulkan);
    if (!r || !hbil_glslang_init()) {
        free(r);
        fprintf(stderr, "shadergen: out of memory, or glslang does not start\n");
        return IO;
    }
    r->out = out;
    r->plan = &vulkan;
    r->hook = hook;
    r->start = time(NULL);
    if (code == DONE) code = print_report(r);
    cost_cache_free(&r->cache);
    free(r);
    hbil_glslang_shutdown();
    return code;
}
