/* test_extreme.c - every extreme case on every device that is named: the contract holds, what a case expects holds, devices agree on legal
 * inputs. test_extreme DEVICE...; HBIL_LONG=1: the dear ones too. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

#include <math.h>

#include "cases.h"
#include "contract.h"
#include "devices.h"

enum { DEVICES_MAX = 4, TESTS_MAX = 256 };

/* What a named test found, over its cases, by device. */
typedef struct finding {
    const char *name;
    int         cases, faults;
    char        first[2400];
    double      sum;            /* of differences to the first device, per pixel */
    long        pixels, beyond; /* compared; farther than 2e-3 */
    char        worst[300];
    double      worst_value;
} finding;

static device *devices[DEVICES_MAX];
static int     device_count, long_too;
static finding findings[TESTS_MAX];
static int     finding_count;
static struct { long cases, frames, pixels, plans, skipped; } totals;

static void fault(finding *f, const char *format, ...)
{
    char text[sizeof f->first];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (getenv("HBIL_EXTREME")) print_message("%s: %s\n", f->name, text);
    if (f->faults++ == 0) memcpy(f->first, text, sizeof text);
}

/* Differences of an output of two devices, in units of the brightest light or 1. */
static void compare(finding *f, const char *where, const char *output, const image *a, const image *b, double scale)
{
    const int pixels = a->width * a->height * image_slices(a);
    double sum = 0;
    int p, k;
    for (p = 0; p < pixels; ++p) {
        double worst = 0;
        for (k = 0; k < a->channels; ++k) {
            const double d = fabs((double)a->data[p * a->channels + k] - (double)b->data[p * a->channels + k]) / scale;
            if (!(d <= worst)) worst = d;
        }
        sum += worst;
        f->beyond += !(worst <= 2e-3);
        if (worst > f->worst_value) {
            f->worst_value = worst;
            snprintf(f->worst, sizeof f->worst, "%s, %s, pixel (%d, %d): %g and %g", where, output, p % a->width, p / a->width % a->height,
                     (double)a->data[p * a->channels], (double)b->data[p * a->channels]);
        }
    }
    if (getenv("HBIL_EXTREME") && sum / pixels > 1e-5) print_message("%s: %s, %s: mean difference %.1e\n", f->name, where, output, sum / pixels);
    f->sum += sum;
    f->pixels += pixels;
}

/* Does rounding alone decide? Of samples whose cosines all round to 1 any may be the horizon, and gives its light; normals of pixels that
 * stand alone are cross products of two tangents that both point at the eye; the power 0.1 is infinitely steep at 0. */
static int decided_by_rounding(const extreme_case *c)
{
    return c->flags & EXTREME_TIES
           && (strstr(c->config, "gather=side") || strstr(c->config, "normals=depth") || strstr(c->config, "ao_exponent=0.1"));
}

static void judge(finding *f, const extreme_case *c, const hbil_plan *plan, int index, const extreme_frame *x, image out[][HBIL_MAX_TEXTURES])
{
    char why[400], where[200];
    uint32_t t;
    int d;
    for (d = 0; d < device_count; ++d) {
        if (!contract_holds(plan, &x->frame, x->inputs, out[d], why, sizeof why))
            fault(f, "%s, frame %d of \"%s\": %s", device_name(devices[d]), index, c->config, why);
        if (c->flags & EXTREME_EXACT && strcmp(device_name(devices[d]), "loose") == 0) continue;
        if (c->expect && !c->expect(plan, index, x, out[d], why, sizeof why))
            fault(f, "%s, frame %d of \"%s\": %s", device_name(devices[d]), index, c->config, why);
    }
    snprintf(where, sizeof where, "frame %d of \"%.120s\"", index, c->config);
    for (t = 0; t < plan->texture_count && c->flags & EXTREME_LEGAL && !decided_by_rounding(c); ++t) {
        const char *name = plan->textures[t].name;
        const int light = !strcmp(name, "near") || !strcmp(name, "sh") || !strcmp(name, "irradiance") || !strcmp(name, "composite") || !strcmp(name, "far");
        if (plan->textures[t].life != HBIL_LIFE_OUTPUT) continue;
        for (d = 1; d < device_count; ++d)
            compare(f, where, name, &out[0][t], &out[d][t], light ? fmax(1, contract_brightest(plan, &x->frame, x->inputs)) : 1);
    }
}

/* One frame on all devices. 0: it could not be run. */
static int frame_of(finding *f, const extreme_case *c, const hbil_plan plans[], int index)
{
    image out[DEVICES_MAX][HBIL_MAX_TEXTURES];
    extreme_frame *x = (extreme_frame *)calloc(1, sizeof *x);
    char why[2000];
    int d, i, ok = 1;
    if (!x) abort();
    memset(out, 0, sizeof out);
    c->fill(&plans[0], index, x);
    for (d = 0; d < device_count && ok; ++d) {
        ok = device_run(devices[d], &plans[d], &x->frame, x->inputs, out[d], why, sizeof why);
        if (!ok) fault(f, "%s, frame %d of \"%s\": %s", device_name(devices[d]), index, c->config, why);
    }
    if (ok) judge(f, c, &plans[0], index, x, out);
    totals.frames += device_count;
    totals.pixels += (long)device_count * (long)x->frame.width * (long)x->frame.height;
    for (d = 0; d < device_count; ++d)
        for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&out[d][i]);
    extreme_free(x);
    free(x);
    return ok;
}

static void refused(finding *f, const extreme_case *c, const hbil_plan *plan, int index)
{
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    extreme_frame *x = (extreme_frame *)calloc(1, sizeof *x);
    if (!x) abort();
    c->fill(plan, index, x);
    if (hbil_pack_constants(plan, &x->frame, block, sizeof block, NULL, &diags) != HBIL_E_FRAME || diags.count == 0)
        fault(f, "frame %d of \"%s\" is not refused", index, c->config);
    extreme_free(x);
    free(x);
}

static void run_case(const extreme_case *c, finding *f)
{
    hbil_plan plans[DEVICES_MAX];
    char why[400];
    int d, i;
    ++f->cases;
    ++totals.cases;
    for (d = 0; d < device_count; ++d)
        if (!extreme_plan(c, device_target(devices[d]), &plans[d], why, sizeof why)) {
            fault(f, "%s", why);
            return;
        }
    for (i = 0; i < c->frames; ++i)
        if (c->flags & EXTREME_REFUSED) refused(f, c, &plans[0], i);
        else if (!frame_of(f, c, plans, i)) return;
}

static finding *finding_of(const char *name)
{
    int i;
    for (i = 0; i < finding_count; ++i)
        if (strcmp(findings[i].name, name) == 0) return &findings[i];
    if (finding_count == TESTS_MAX) abort();
    findings[finding_count].name = name;
    return &findings[finding_count++];
}

/* All cases, those of one config after each other: a runner keeps the pipelines of the plan that it ran last. */
static int run_all(void **state)
{
    const char *only = getenv("HBIL_EXTREME"); /* part of a name */
    int i, k;
    (void)state;
    for (i = 0; i < extreme_case_count; ++i) (void)finding_of(extreme_cases[i].name);
    for (i = 0; i < extreme_case_count; ++i) {
        int ran = 0;
        for (k = 0; k < i && strcmp(extreme_cases[k].config, extreme_cases[i].config) != 0; ++k) { }
        if (k < i) continue; /* this config was run */
        for (k = i; k < extreme_case_count; ++k) {
            const extreme_case *c = &extreme_cases[k];
            if (strcmp(c->config, extreme_cases[i].config) != 0 || (only && !strstr(c->name, only))) continue;
            if (c->flags & EXTREME_LONG && !long_too) ++totals.skipped;
            else run_case(c, finding_of(c->name)), ++ran;
        }
        totals.plans += ran > 0;
    }
    return 0;
}

static void one_test(void **state)
{
    const finding *f = (const finding *)*state;
    if (f->cases == 0) skip();
    if (f->faults) fail_msg("%d faults; the first: %s", f->faults, f->first);
    if (f->pixels && (f->sum / (double)f->pixels > 1e-5 || f->beyond * 10000 > f->pixels))
        fail_msg("%s and %s: mean difference %.1e, %ld of %ld pixels beyond 2e-3; worst: %s", device_name(devices[0]),
                 device_name(devices[1]), f->sum / (double)f->pixels, f->beyond, f->pixels, f->worst);
}

static int close_all(void **state)
{
    int d, i, hazards = 0;
    unsigned long seen = 0; /* by number */
    (void)state;
    for (i = 0; i < finding_count; ++i)
        if (findings[i].cases && findings[i].name[0] == 'H') {
            const unsigned long bit = 1ul << (atoi(findings[i].name + 1) & 31);
            hazards += !(seen & bit);
            seen |= bit;
        }
    print_message("%d hazards, %ld cases, %ld frames, %ld pixels, %ld variants, %llu values checked", hazards, totals.cases, totals.frames, totals.pixels,
                  totals.plans, contract_values);
    if (totals.skipped) print_message("; %ld cases skipped, HBIL_LONG=1 runs them", totals.skipped);
    print_message("\n");
    for (d = 0; d < device_count; ++d) device_close(devices[d]);
    return 0;
}

int main(int argc, char **argv)
{
    static struct CMUnitTest tests[TESTS_MAX];
    char error[512];
    int i;
    long_too = getenv("HBIL_LONG") && strcmp(getenv("HBIL_LONG"), "1") == 0;
    if (argc < 2 || argc > DEVICES_MAX + 1) return fprintf(stderr, "test_extreme DEVICE...    " DEVICES "; HBIL_EXTREME=part of a name: only such cases\n"), 2;
    for (i = 1; i < argc; ++i) {
        devices[device_count] = device_open(argv[i], error, sizeof error);
        if (!devices[device_count]) return fprintf(stderr, "%s: %s\n", argv[i], error), 77;
        ++device_count;
    }
    for (i = 0; i < extreme_case_count; ++i) (void)finding_of(extreme_cases[i].name);
    for (i = 0; i < finding_count; ++i) {
        tests[i].name = findings[i].name;
        tests[i].test_func = one_test;
        tests[i].initial_state = &findings[i];
    }
    return _cmocka_run_group_tests("extreme", tests, (size_t)finding_count, run_all, close_all);
}
