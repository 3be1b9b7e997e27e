/* hbil-marches - how accurate and how fast each variant of the march is: a Markdown table. Not a test: nothing is judged.
 *
 * Errors: against the height-field truth and the scene's truth, at the size of the captures. Times: in units, on one capture
 * enlarged, medians of interleaved runs. The unit is a march that computes its addresses and fetches depth there, nothing
 * else: what no march of 18 taps undercuts, whatever the device. */
#include <stddef.h>
#include <time.h>

#define HBIL_IMPLEMENTATION
#define BENCH_NAME "hbil-marches"
#include "bench_common.h"
#include "../../examples/frame/runner.h"
#include "../captures.h"

/* name: NULL in front of a section's title, which is config. config: as in hbil_config_parse, first word may be preset=NAME.
 * ao_only: what the time is divided by in the last column, NULL: nothing. Everything has f0=none environment=none. */
typedef struct row { const char *name, *config, *ao_only; } row;

#define YPIPELINE "seed_compat=screen_azimuth+slice_mean+noise_2pi+uniform_bent"

#define THICK "estimator=bitmask occluder=thick thickness=0.5"
#define NEAR(name, options) {"ao+near " name, "outputs=ao+near " options, "outputs=ao " options}
#define PRESET(name) {"ao+near " name, "preset=" name " outputs=ao+near", "preset=" name " outputs=ao"}

static const row table[] = {
    {NULL, "sweep", NULL},
    {"ao sweep 2", "outputs=ao march=sweep slices=2", NULL},
    {"ao sweep 4", "outputs=ao march=sweep slices=4", NULL},
    {"ao sweep 8", "outputs=ao march=sweep slices=8", NULL},
    NEAR("sweep 2", "march=sweep slices=2"),
    NEAR("sweep 4", "march=sweep slices=4"),
    NEAR("sweep 8", "march=sweep slices=8"),
    NEAR("sweep 4, facing", "march=sweep slices=4 facing=half_space"),
    PRESET("fast"),
    PRESET("balanced"),
    PRESET("quality"),
    NEAR("both 4, 8 steps up to 1 m, 0.5 m thick", "march=both reach=1 steps=8 slices=4 " THICK),
    {NULL, "samples", NULL},
    {"ao 2x5", "outputs=ao slices=2 steps=5", NULL},
    {"ao 2x5 spread interleave", "outputs=ao slices=2 steps=5 mips=spread interleave=yes", NULL},
    {"ao 3x6", "outputs=ao slices=3 steps=6", NULL},
    {"ao 3x6 interleave", "outputs=ao slices=3 steps=6 interleave=yes", NULL},
    NEAR("3x6", "slices=3 steps=6"),
    NEAR("3x6 packed", "slices=3 steps=6 gather=packed"),
    NEAR("3x6 side", "slices=3 steps=6 gather=side"),
    NEAR("3x6 mean", "slices=3 steps=6 mips=mean"),
    NEAR("3x6 spread", "slices=3 steps=6 mips=spread"),
    NEAR("3x6 weighted", "slices=3 steps=6 mips=weighted"),
    NEAR("3x6 nearest", "slices=3 steps=6 mips=nearest"),
    PRESET("sampled"),
    NEAR("3x6, 0.5 m thick", "slices=3 steps=6 mips=spread interleave=yes " THICK),
    NEAR("3x6, 0.5 m thick, facing", "slices=3 steps=6 mips=spread interleave=yes facing=filter " THICK),
    {NULL, "articles", NULL},
    PRESET("hbil_screen"),
    PRESET("gtao"),
    PRESET("bitmask"),
    NEAR("3x6 YPipeline", "slices=3 steps=6 " YPIPELINE),
};

#define ROWS_MAX    128
#define ENTRIES_MAX (2 * ROWS_MAX + 1)
#define RUNS_MAX    100
#define BATCH       16   /* shaders that are timed in turns, next to the unit; each keeps 0.2 to 0.4 GB at 1920x1080 */
#define SMOOTH      1.05 /* ratio of neighbouring depths up to which they are taken for one surface */

static const char mark_begin[] = "<!-- marches: written by make marches -->";
static const char mark_end[] = "<!-- marches: end -->";
static const char unit_config[] = "outputs=ao slices=3 steps=3";
static const int  sizes[][2] = {{640, 360}, {1280, 720}, {1920, 1080}, {3840, 2160}};
enum { SIZES = sizeof sizes / sizeof *sizes };

/* Against the height field: ao, its 95th percentile, near; and near against the scene. */
typedef struct cell { value ao, near, scene; double p95; } cell;

/* A shader that is timed. */
typedef struct entry {
    hbil_plan      plan;
    const capture *cap;
    const char    *march;  /* own text of that pass, NULL: hbil.h's */
    runner        *runner;
    hbil_frame     frame;
    image          in[HBIL_MAX_TEXTURES];
    double         ms[RUNS_MAX], prepare[RUNS_MAX];
    double         units, prepare_units;
} entry;

typedef struct job {
    const char   *backend, *only, *time_capture, *out;
    int           runs, batch, width, height, no_time, no_error, with_sizes;
    row           rows[ROWS_MAX], extra[ROWS_MAX];
    int           row_count, extra_count;
    capture_names names;            /* of those with truth */
    capture       caps[CAPTURES_MAX];
    cell          cells[ROWS_MAX][CAPTURES_MAX];
    entry        *entries;          /* [0]: the unit */
    int           entry_count, march_of[ROWS_MAX], twin_of[ROWS_MAX]; /* 0: none */
    double        unit_ms[RUNS_MAX * ENTRIES_MAX], prepare_ms[RUNS_MAX * ENTRIES_MAX]; /* of all batches */
    int           unit_count;
    char         *unit_text;
    double        per_pixel[ROWS_MAX][SIZES]; /* relative to sizes[0] */
    char          device[256];
} job;

/* ---------------------------------------------------------------------- configs */

static void refuse(const char *text, const hbil_diag *items, const hbil_diags *diags)
{
    int i = 0;

    while (i < diags->count && i < diags->capacity && items[i].severity != HBIL_ERROR) ++i;
    die(1, "%s: %s", text, i < diags->count && i < diags->capacity ? items[i].text : "refused");
}

static void make_plan(const job *j, const char *text, const capture *cap, hbil_plan *plan)
{
    hbil_diag   items[16];
    hbil_diags  diags = {items, 16, 0};
    hbil_config c;
    const char *options = text;

    memset(&c, 0, sizeof c);
    if (strncmp(text, "preset=", 7) == 0) {
        char preset[32];

        options += 7 + strcspn(text + 7, " ");
        snprintf(preset, sizeof preset, "%.*s", (int)(options - text) - 7, text + 7);
        if (hbil_config_preset(preset, &c, &diags) != HBIL_OK) refuse(text, items, &diags);
    }
    c.target = runner_target(j->backend);
    c.projection = cap->orthographic ? HBIL_PROJECTION_ORTHOGRAPHIC : HBIL_PROJECTION_PERSPECTIVE;
    c.f0 = HBIL_F0_NONE;
    c.environment = HBIL_ENVIRONMENT_NONE;
    if (hbil_config_parse(&c, options, strlen(options), &diags) != HBIL_OK || hbil_plan_build(&c, plan, &diags) != HBIL_OK)
        refuse(text, items, &diags);
}

/* Text with another body for the function that begins with `head`; frees the old one. */
static char *with_body(char *text, const char *head, const char *body)
{
    char  *begin = strstr(text, head), *end = begin ? strstr(begin, "\n}\n") : NULL, *made;
    size_t size;

    begin = end ? strstr(begin, "{\n") : NULL;
    if (!begin) die(1, "the unit: the march has no function %s any more. Adapt unit_text in marches.c", head);
    size = strlen(text) + strlen(body) + 1;
    made = malloc(size);
    if (!made) die(5, "out of memory");
    snprintf(made, size, "%.*s{\n%s%s", (int)(begin - text), text, body, end + 1);
    free(text);
    return made;
}

/* The march of the plan, which has no light, without everything but addresses and depth. */
static char *unit_text(const hbil_plan *plan)
{
    char *text = malloc(HBIL_GLSL_MAX);

    if (!text) die(5, "out of memory");
    if (hbil_emit_glsl(plan, hbil_plan_pass(plan, "march"), text, HBIL_GLSL_MAX, NULL) != HBIL_OK)
        die(1, "the unit: %s has no pass march", unit_config);
    text = with_body(text, "float hbil_horizon(", "    float sum = 0.0;\n"
        "    hbil_visit at = hbil_visit(0.0, vec2(r.pixel) + 0.5, HBIL_SKY);\n"
        "    for (int i = 0; i < HBIL_STEPS; ++i) {\n"
        "        if (!hbil_go(r, s, i, at)) break;\n"
        "        sum += at.z;\n"
        "    }\n"
        "    return sum;\n");
    return with_body(text, "void hbil_horizon_slice(",
        "    hbil_side front = hbil_side_of(r, slice, d, jitter, 1.0);\n"
        "    hbil_side back = hbil_side_of(r, slice, d, jitter, -1.0);\n"
        "    sum.blocked += hbil_horizon(r, front) + hbil_horizon(r, back);\n");
}

/* ---------------------------------------------------------------------- errors */

/* 95th percentile of |difference|. */
static double p95(const image *out, const image *truth, const image *where)
{
    const int count = truth->width * truth->height;
    double   *d = malloc((size_t)count * sizeof *d), found;
    int       i, n = 0;

    if (!d) die(5, "out of memory");
    for (i = 0; i < count; ++i)
        if (where->data[i] > 0.5f) d[n++] = fabs((double)out->data[out->channels * i] - (double)truth->data[i]);
    qsort(d, (size_t)n, sizeof *d, by_size);
    found = n ? d[(n - 1) * 95 / 100] : 0.0;
    free(d);
    return found;
}

static cell measure(const job *j, runner *r, const char *config, const capture *cap)
{
    static hbil_plan plan;
    hbil_frame       frame;
    image            in[HBIL_MAX_TEXTURES], out[HBIL_MAX_TEXTURES];
    const image     *ao, *near;
    char             error[512] = "";
    cell             c;

    make_plan(j, config, cap, &plan);
    if (!capture_encode(cap, &plan, &frame, in, error, sizeof error)
        || !runner_run(r, &plan, &frame, in, out, 1, NULL, error, sizeof error)) die(5, "%s: %s", config, error);
    ao = output(&plan, out, "ao");
    near = output(&plan, out, "near");
    c.ao = compare(ao, &cap->hf_ao, &cap->hf_valid, cap, 0);
    c.p95 = c.ao.known ? p95(ao, &cap->hf_ao, &cap->hf_valid) : 0.0;
    c.near = compare(near, &cap->hf_near, &cap->hf_valid, cap, 1);
    c.scene = compare(near, &cap->truth_near, NULL, cap, 1);
    free_images(in);
    free_images(out);
    return c;
}

static void measure_rows(job *j)
{
    char    error[512] = "";
    runner *r = runner_open(j->backend, 0, error, sizeof error);
    int     i, k;

    if (!r) die(5, "%s", error);
    for (i = 0; i < j->row_count; ++i) {
        if (!j->rows[i].name) continue;
        fprintf(stderr, "errors, row %d of %d: %s\n", i + 1, j->row_count, j->rows[i].name);
        for (k = 0; k < j->names.count; ++k) j->cells[i][k] = measure(j, r, j->rows[i].config, &j->caps[k]);
    }
    runner_close(r);
}

static cell mean_cell(const cell *cells, int count)
{
    cell mean;
    int  i;

    memset(&mean, 0, sizeof mean);
    for (i = 0; i < count; ++i) {
        add_value(&mean.ao, cells[i].ao);
        add_value(&mean.near, cells[i].near);
        add_value(&mean.scene, cells[i].scene);
        if (cells[i].ao.known) mean.p95 += cells[i].p95;
    }
    if (mean.ao.known) mean.p95 /= mean.ao.known;
    divide(&mean.ao);
    divide(&mean.near);
    divide(&mean.scene);
    return mean;
}

/* ---------------------------------------------------------------------- a larger frame */

/* Where a pixel of the larger frame lies among four of the smaller one. On one surface bilinear, else the nearest one alone:
 * no surface is invented between two. */
typedef struct mix { size_t index[4]; double weight[4]; } mix;

static mix mix_at(const image *depth, double x, double y)
{
    const double left = fmin(fmax(x, 0.0), depth->width - 1.0), top = fmin(fmax(y, 0.0), depth->height - 1.0);
    const int    x0 = (int)left, y0 = (int)top, x1 = x0 + (x0 + 1 < depth->width), y1 = y0 + (y0 + 1 < depth->height);
    const double fx = left - x0, fy = top - y0;
    double least = 1e30, most = 0.0;
    mix    m;
    int    i;

    for (i = 0; i < 4; ++i) {
        m.index[i] = (size_t)((i >> 1) ? y1 : y0) * (size_t)depth->width + (size_t)((i & 1) ? x1 : x0);
        m.weight[i] = ((i & 1) ? fx : 1.0 - fx) * ((i >> 1) ? fy : 1.0 - fy);
        least = fmin(least, (double)depth->data[m.index[i]]);
        most = fmax(most, (double)depth->data[m.index[i]]);
    }
    if (most < SMOOTH * least) return m;
    for (i = 0; i < 4; ++i) m.weight[i] = i == (fx >= 0.5) + 2 * (fy >= 0.5);
    return m;
}

/* nearness: mix 1 / value, in which planes are straight. unit: make the sum a unit vector. */
static void mix_pixel(const image *from, const mix *m, int nearness, int unit, float *to)
{
    double sum[4] = {0.0, 0.0, 0.0, 0.0}, length = 1.0;
    int    c, i;

    for (c = 0; c < from->channels; ++c)
        for (i = 0; i < 4; ++i) {
            const double v = (double)from->data[m->index[i] * (size_t)from->channels + (size_t)c];
            if (m->weight[i] > 0.0) sum[c] += m->weight[i] * (nearness ? 1.0 / v : v);
        }
    if (unit) length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (c = 0; c < from->channels; ++c)
        to[c] = (float)(nearness ? 1.0 / sum[c] : length > 0.0 ? sum[c] / length : 0.0);
}

/* The capture at another size, without its truths. */
static void enlarge(const capture *from, int width, int height, capture *to)
{
    static const size_t offsets[] = {offsetof(capture, depth), offsetof(capture, normal), offsetof(capture, albedo),
        offsetof(capture, direct), offsetof(capture, emission), offsetof(capture, f0), offsetof(capture, roughness)};
    enum { IMAGES = sizeof offsets / sizeof *offsets };
    image  old[IMAGES], made[IMAGES];
    size_t at = 0;
    int    x, y, k;

    memset(made, 0, sizeof made);
    for (k = 0; k < IMAGES; ++k) {
        memcpy(&old[k], (const char *)from + offsets[k], sizeof *old);
        if (old[k].data && !image_make(&made[k], width, height, old[k].channels))
            die(5, "out of memory for %dx%d", width, height);
    }
    for (y = 0; y < height; ++y)
        for (x = 0; x < width; ++x, ++at) {
            const double from_x = (x + 0.5) * from->width / width - 0.5, from_y = (y + 0.5) * from->height / height - 0.5;
            const mix    m = mix_at(&from->depth, from_x, from_y);

            for (k = 0; k < IMAGES; ++k)
                if (old[k].data) mix_pixel(&old[k], &m, k == 0, k == 1, made[k].data + at * (size_t)old[k].channels);
        }
    memset(to, 0, sizeof *to);
    to->width = width;
    to->height = height;
    to->orthographic = from->orthographic;
    to->near_z = from->near_z;
    to->far_z = from->far_z;
    memcpy(to->projection, from->projection, sizeof to->projection);
    memcpy(to->view, from->view, sizeof to->view);
    for (k = 0; k < IMAGES; ++k) memcpy((char *)to + offsets[k], &made[k], sizeof *made);
}

/* ---------------------------------------------------------------------- times */

static void open_entry(job *j, entry *e)
{
    char error[512] = "";

    e->runner = runner_open(j->backend, 0, error, sizeof error);
    if (!e->runner || !capture_encode(e->cap, &e->plan, &e->frame, e->in, error, sizeof error)) die(5, "%s", error);
    if (e->march && !runner_text(e->runner, "march", e->march)) die(5, "out of memory");
    snprintf(j->device, sizeof j->device, "%s, %s", runner_about(e->runner)->device, j->backend);
}

/* prepare and light are the same in all variants, so they count for none; where prepare is not, put_unit says so. */
static void run_entry(entry *e, int run)
{
    char     error[512] = "";
    image    out[HBIL_MAX_TEXTURES];
    double   ms[HBIL_MAX_PASSES];
    uint32_t p;

    if (!runner_run(e->runner, &e->plan, &e->frame, e->in, out, 1, ms, error, sizeof error)) die(5, "%s", error);
    free_images(out);
    e->ms[run] = e->prepare[run] = 0.0;
    for (p = 0; p < e->plan.pass_count; ++p) {
        if (strcmp(e->plan.passes[p].name, "prepare") == 0) e->prepare[run] += ms[p];
        else if (strcmp(e->plan.passes[p].name, "light") != 0) e->ms[run] += ms[p];
    }
}

/* In turns, so that what else the machine does hits all alike. Each has a runner of its own, which keeps its pipelines: all
 * that is made on the way is made in the first turn, which does not count. */
static void time_batch(job *j, entry **batch, int count)
{
    int run, i;

    for (i = 0; i < count; ++i) open_entry(j, batch[i]);
    for (run = -1; run < j->runs; ++run) {
        fprintf(stderr, "  run %d of %d of %d shaders\n", run + 1, j->runs, count);
        for (i = 0; i < count; ++i) run_entry(batch[i], run < 0 ? 0 : run);
    }
    for (i = 0; i < count; ++i) {
        runner_close(batch[i]->runner);
        free_images(batch[i]->in);
    }
}

/* Part `quarters` / 4 of the way through the sorted values; sorts them. */
static double quantile(double *values, int count, int quarters)
{
    qsort(values, (size_t)count, sizeof *values, by_size);
    return values[(count - 1) * quarters / 4];
}

static double median(const double *values, int count)
{
    double sorted[RUNS_MAX];

    memcpy(sorted, values, (size_t)count * sizeof *sorted);
    return quantile(sorted, count, 2);
}

/* Its index; the same for the same plan. */
static int add_entry(job *j, const char *config, const capture *cap)
{
    entry *e = &j->entries[j->entry_count];
    int    i;

    make_plan(j, config, cap, &e->plan);
    for (i = 1; i < j->entry_count; ++i)
        if (memcmp(&j->entries[i].plan, &e->plan, sizeof e->plan) == 0) return i;
    e->cap = cap;
    return j->entry_count++;
}

static void add_entries(job *j, const capture *cap)
{
    int i;

    j->entries = calloc(ENTRIES_MAX, sizeof *j->entries);
    if (!j->entries) die(5, "out of memory");
    add_entry(j, unit_config, cap);
    j->entries[0].march = j->unit_text;
    for (i = 0; i < j->row_count; ++i) {
        if (!j->rows[i].name) continue;
        j->twin_of[i] = j->rows[i].ao_only ? add_entry(j, j->rows[i].ao_only, cap) : 0;
        j->march_of[i] = add_entry(j, j->rows[i].config, cap);
    }
}

/* Batches are as large as memory allows; the unit is in each. */
static void time_rows(job *j, const capture *from)
{
    capture cap;
    int     first, i, count;

    enlarge(from, j->width, j->height, &cap);
    add_entries(j, &cap);
    for (first = 1; first < j->entry_count; first += count) {
        entry *batch[ENTRIES_MAX] = {&j->entries[0]};
        double unit;

        count = j->entry_count - first < j->batch ? j->entry_count - first : j->batch;
        for (i = 0; i < count; ++i) batch[1 + i] = &j->entries[first + i];
        fprintf(stderr, "times, shaders %d to %d of %d\n", first, first + count - 1, j->entry_count - 1);
        time_batch(j, batch, 1 + count);
        unit = median(batch[0]->ms, j->runs);
        for (i = 1; i <= count; ++i) {
            batch[i]->units = median(batch[i]->ms, j->runs) / unit;
            batch[i]->prepare_units = median(batch[i]->prepare, j->runs) / unit;
        }
        memcpy(j->unit_ms + j->unit_count, batch[0]->ms, (size_t)j->runs * sizeof *batch[0]->ms);
        memcpy(j->prepare_ms + j->unit_count, batch[0]->prepare, (size_t)j->runs * sizeof *batch[0]->prepare);
        j->unit_count += j->runs;
    }
    capture_free(&cap);
}

/* All sizes of a row in turns, one row after the other: a frame of 3840x2160 takes 2 GB. */
static void time_sizes(job *j, const capture *from)
{
    static entry of[SIZES];
    entry  *batch[SIZES];
    capture caps[SIZES];
    int     i, k;

    for (k = 0; k < SIZES; ++k) enlarge(from, sizes[k][0], sizes[k][1], &caps[k]);
    for (i = 0; i < j->row_count; ++i) {
        double first = 0.0;

        if (!j->rows[i].name) continue;
        fprintf(stderr, "sizes, row %d of %d: %s\n", i + 1, j->row_count, j->rows[i].name);
        memset(of, 0, sizeof of);
        for (k = 0; k < SIZES; ++k) {
            make_plan(j, j->rows[i].config, &caps[k], &of[k].plan);
            of[k].cap = &caps[k];
            batch[k] = &of[k];
        }
        time_batch(j, batch, SIZES);
        for (k = 0; k < SIZES; ++k) {
            const double ms = median(of[k].ms, j->runs) / ((double)sizes[k][0] * sizes[k][1]);

            if (k == 0) first = ms;
            j->per_pixel[i][k] = ms / first;
        }
    }
    for (k = 0; k < SIZES; ++k) capture_free(&caps[k]);
}

/* ---------------------------------------------------------------------- the page */

/* Depth samples a pixel, if no side ends early. */
static void put_taps(page *p, const job *j, const row *r)
{
    static hbil_plan plan;

    make_plan(j, r->config, &j->caps[0], &plan);
    if (plan.config.march == HBIL_MARCH_SWEEP) put(p, " - |"); /* columns of the sweep are shared by pixels */
    else put(p, " %d |", 2 * plan.config.slices * plan.config.steps);
}

/* Errors of each capture, in one column. */
static void put_each(page *p, const job *j, const cell *cells, size_t which)
{
    int k;

    for (k = 0; k < j->names.count; ++k) {
        value v;

        memcpy(&v, (const char *)&cells[k] + which, sizeof v);
        if (k) put(p, " /");
        if (v.known) put(p, " %.3f", v.error);
        else put(p, " -");
    }
    put(p, " |");
}

static void put_errors(page *p, const job *j, const cell *cells)
{
    const cell mean = mean_cell(cells, j->names.count);

    if (mean.ao.known) put(p, " %.3f | %+.3f | %.3f |", mean.ao.error, mean.ao.bias, mean.p95);
    else put(p, " - | - | - |");
    put_each(p, j, cells, offsetof(cell, ao));
    if (mean.near.known) put(p, " %.3f | %+.3f |", mean.near.error, mean.near.bias);
    else put(p, " - | - |");
    put_each(p, j, cells, offsetof(cell, near));
    if (mean.scene.known) put(p, " %.3f |", mean.scene.error);
    else put(p, " - |");
    put_each(p, j, cells, offsetof(cell, scene));
}

static void put_head(page *p, const job *j)
{
    char captures[CAPTURES_MAX * 67] = "";
    int  k;

    for (k = 0; k < j->names.count; ++k) {
        if (k) strcat(captures, " / ");
        strcat(captures, j->names.name[k]);
    }
    put(p, "| march | taps |");
    if (!j->no_error)
        put(p, " ao rmse | bias | p95 | rmse: %s | near mae | bias | mae: %s | near mae, scene | %s |", captures, captures,
            captures);
    if (!j->no_time) put(p, " units | of ao only |");
    put(p, "\n|---|---:|");
    if (!j->no_error) put(p, "---:|---:|---:|---|---:|---:|---|---:|---|");
    if (!j->no_time) put(p, "---:|---:|");
    put(p, "\n");
}

static void put_row(page *p, const job *j, int i)
{
    const row *r = &j->rows[i];

    if (!r->name) {
        put(p, "| **%s** | %s%s\n", r->config, j->no_error ? "|" : "||||||||||", j->no_time ? "" : "||");
        return;
    }
    put(p, "| %s |", r->name);
    put_taps(p, j, r);
    if (!j->no_error) put_errors(p, j, j->cells[i]);
    if (!j->no_time) {
        const double march = j->entries[j->march_of[i]].units;

        put(p, " %.2f |", march);
        if (j->twin_of[i]) put(p, " %.2f |", march / j->entries[j->twin_of[i]].units);
        else put(p, " - |");
    }
    put(p, "\n");
}

static int prepare_bindings(const hbil_plan *plan)
{
    const int32_t pass = hbil_plan_pass(plan, "prepare");

    return pass < 0 ? 0 : plan->passes[pass].binding_count;
}

static void put_unit(page *p, job *j)
{
    const double low = quantile(j->unit_ms, j->unit_count, 1), middle = quantile(j->unit_ms, j->unit_count, 2);
    const double high = quantile(j->unit_ms, j->unit_count, 3), prepare = quantile(j->prepare_ms, j->unit_count, 2);
    double       packed = 0.0;
    int          i;

    put(p, "\nUnit: %.2f ms (quartiles %.2f and %.2f of %d runs) on %s, `%s` enlarged to %dx%d.\n"
           "The pass `prepare` takes %.2f units.\n",
        middle, low, high, j->unit_count, j->device, j->time_capture, j->width, j->height, prepare / middle);
    for (i = 0; i < j->row_count; ++i) {
        const entry *e = &j->entries[j->march_of[i]];

        if (j->rows[i].name && prepare_bindings(&e->plan) != prepare_bindings(&j->entries[0].plan))
            packed = e->prepare_units > packed ? e->prepare_units : packed;
    }
    if (packed > 0.0) put(p, "Where it packs radiance, too, which no unit counts, up to %.2f units.\n", packed);
}

static void put_notes(page *p, const job *j)
{
    char   date[16] = "";
    time_t now = time(NULL);

    strftime(date, sizeof date, "%Y-%m-%d", gmtime(&now));
    put(p, "\n");
    if (!j->no_error)
        put(p, "- ao: against the depth buffer as a solid height field, means of the captures; bias: mean difference; p95:\n"
               "  of |difference|. near: mean |difference| and mean difference, as parts of the mean truth; scene: against\n"
               "  the path-traced truth, what the screen hides included. A preset's reach and ao_exponent are in its error.\n");
    if (!j->no_time)
        put(p, "- units: of the time of a march of 18 taps (`%s`) that computes its addresses and fetches depth there, and\n"
               "  nothing else. All passes but `prepare` and `light`; medians of %d runs, all shaders in turns, %s.\n",
            unit_config, j->runs, date);
}

static void put_sizes(page *p, const job *j)
{
    int i, k;

    put(p, "\nTime of the march per pixel, relative to that at %dx%d (`%s` enlarged, medians of %d runs, %s):\n\n| march |",
        sizes[0][0], sizes[0][1], j->time_capture, j->runs, j->device);
    for (k = 0; k < SIZES; ++k) put(p, " %dx%d |", sizes[k][0], sizes[k][1]);
    put(p, "\n|---|");
    for (k = 0; k < SIZES; ++k) put(p, "---:|");
    for (i = 0; i < j->row_count; ++i) {
        if (!j->rows[i].name) continue;
        put(p, "\n| %s |", j->rows[i].name);
        for (k = 0; k < SIZES; ++k) put(p, " %.2f |", j->per_pixel[i][k]);
    }
    put(p, "\n");
}

static void write_page(page *p, job *j)
{
    int i;

    if (!j->no_time || !j->no_error) {
        put_head(p, j);
        for (i = 0; i < j->row_count; ++i) put_row(p, j, i);
        if (!j->no_time) put_unit(p, j);
        put_notes(p, j);
    }
    if (j->with_sizes) put_sizes(p, j);
}

/* ---------------------------------------------------------------------- command line */

static void usage(int code)
{
    fputs("usage: HBIL_CAPTURES=DIR hbil-marches [options]\n"
          "Errors and times of the variants of the march, on the captures in DIR that have height-field truth.\n"
          "Markdown to stdout, progress on stderr.\n"
          "  --only PATTERN        of the built-in rows those whose name has PATTERN in it\n"
          "  --row [NAME:]CONFIG   one row more, repeatable: \"outputs=ao slices=2\", \"preset=gtao outputs=ao+near\"\n"
          "  --no-error, --no-time leave those columns out\n"
          "  --sizes               also the time per pixel from 640x360 to 3840x2160; nothing else with both of these\n"
          "  --runs N              that count, after one that does not, 1 to 100; 15\n"
          "  --backend NAME        vulkan (default) or gl\n"
          "  --size WxH            of the frame that is timed; 1920x1080\n"
          "  --time-capture NAME   that is timed; the first one\n"
          "  --batch N             shaders in memory at once; 16\n"
          "  --out FILE            also into FILE, between the lines\n"
          "                        <!-- marches: written by make marches --> and <!-- marches: end -->\n"
          "exit: 0 done; 1 a config is refused; 2 usage, no captures; 3 a file; 5 backend or memory\n",
          code ? stderr : stdout);
    exit(code);
}

static char *join(const char *a, const char *b)
{
    const size_t size = strlen(a) + strlen(b) + 1;
    char        *made = malloc(size);

    if (!made) die(5, "out of memory");
    snprintf(made, size, "%s%s", a, b);
    return made;
}

/* [NAME:]CONFIG. Its last option counts, so the twin needs only outputs=ao behind it. Lives until the end. */
static void add_extra(job *j, const char *text)
{
    const char *colon = strchr(text, ':');
    char       *name = join(text, "");
    row        *r = &j->extra[j->extra_count];

    if (j->extra_count == ROWS_MAX - 1) die(2, "more than %d rows", ROWS_MAX - 1);
    if (colon) name[colon - text] = '\0';
    r->name = name;
    r->config = join(colon ? colon + 1 + strspn(colon + 1, " ") : text, "");
    r->ao_only = join(r->config, " outputs=ao");
    j->extra_count++;
}

static int number(const char *text, int most)
{
    char      *end;
    const long n = strtol(text, &end, 10);

    if (*end || n < 1 || n > most) die(2, "%s: a number from 1 to %d is needed", text, most);
    return (int)n;
}

static void read_size(job *j, const char *text)
{
    char rest;

    if (sscanf(text, "%dx%d%c", &j->width, &j->height, &rest) != 2 || j->width < 16 || j->height < 16 || j->width > 8192
        || j->height > 8192) die(2, "--size %s: WxH is needed, each from 16 to 8192", text);
}

static void read_arguments(int argc, char **argv, job *j)
{
    const struct { const char *name, **to; } words[] = {{"--only", &j->only}, {"--backend", &j->backend},
                                                        {"--out", &j->out}, {"--time-capture", &j->time_capture}};
    const struct { const char *name; int *to; } flags[] = {{"--no-time", &j->no_time}, {"--no-error", &j->no_error},
                                                           {"--sizes", &j->with_sizes}};
    int i, k, f;

    for (i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--help") == 0) usage(0);
        for (k = 0; k < 4 && strcmp(argv[i], words[k].name) != 0; ++k) { }
        for (f = 0; f < 3 && strcmp(argv[i], flags[f].name) != 0; ++f) { }
        if (f < 3) *flags[f].to = 1;
        else if (i + 1 == argc) usage(2);
        else if (k < 4) *words[k].to = argv[++i];
        else if (strcmp(argv[i], "--row") == 0) add_extra(j, argv[++i]);
        else if (strcmp(argv[i], "--runs") == 0) j->runs = number(argv[++i], RUNS_MAX);
        else if (strcmp(argv[i], "--batch") == 0) j->batch = number(argv[++i], ENTRIES_MAX - 1);
        else if (strcmp(argv[i], "--size") == 0) read_size(j, argv[++i]);
        else usage(2);
    }
    if (strcmp(j->backend, "vulkan") != 0 && strcmp(j->backend, "gl") != 0) usage(2);
    if (j->no_time && j->no_error && !j->with_sizes) die(2, "--no-time and --no-error leave nothing to do");
}

/* Built-in rows with PATTERN, under their sections; then those of the command line. */
static void list_rows(job *j)
{
    const row  own = {NULL, "command line", NULL};
    const row *section = NULL;
    size_t     k;
    int        i;

    for (k = 0; k < sizeof table / sizeof *table && j->row_count < ROWS_MAX - 1; ++k) {
        if (!table[k].name) section = &table[k];
        if (!table[k].name || (j->only && !strstr(table[k].name, j->only))) continue;
        if (section) j->rows[j->row_count++] = *section;
        section = NULL;
        j->rows[j->row_count++] = table[k];
    }
    if (j->row_count + j->extra_count >= ROWS_MAX) die(2, "more than %d rows", ROWS_MAX - 1);
    if (j->extra_count) j->rows[j->row_count++] = own;
    for (i = 0; i < j->extra_count; ++i) j->rows[j->row_count++] = j->extra[i];
    if (!j->row_count) die(2, "no row has %s in its name", j->only);
}

/* Refuses a wrong config before anything is measured. A row from the command line may be its own twin: then it has none. */
static void check_rows(job *j)
{
    static hbil_plan plan, twin;
    int              i;

    for (i = 0; i < j->row_count; ++i) {
        if (!j->rows[i].name) continue;
        make_plan(j, j->rows[i].config, &j->caps[0], &plan);
        if (!j->rows[i].ao_only) continue;
        make_plan(j, j->rows[i].ao_only, &j->caps[0], &twin);
        if (memcmp(&plan, &twin, sizeof plan) == 0) j->rows[i].ao_only = NULL;
    }
}

static void load_captures(job *j)
{
    const char         *root = getenv("HBIL_CAPTURES");
    const capture_names all = captures_list();
    char                error[512] = "";
    int                 i;

    if (!root || !*root) die(2, "HBIL_CAPTURES is not set: set it to the folder of the captures");
    for (i = 0; i < all.count; ++i) {
        capture *cap = &j->caps[j->names.count];

        if (!captures_load(all.name[i], 0, cap, error, sizeof error)) die(3, "%s", error);
        if (cap->hf_valid.data) memcpy(j->names.name[j->names.count++], all.name[i], sizeof all.name[i]);
        else capture_free(cap);
    }
    if (!j->names.count) die(2, "HBIL_CAPTURES=%s: no folder in it has frame-000.exr and hf-000.exr", root);
}

static const capture *capture_to_time(job *j)
{
    int k;

    if (!j->time_capture) j->time_capture = j->names.name[0];
    for (k = 0; k < j->names.count; ++k)
        if (strcmp(j->names.name[k], j->time_capture) == 0) return &j->caps[k];
    die(2, "--time-capture %s: no such capture with truth", j->time_capture);
    return NULL;
}

int main(int argc, char **argv)
{
    static job       j;
    static hbil_plan plan;
    const capture   *timed;
    page             p = {malloc(PAGE_MAX), 0};
    int              k;

    if (!p.text) die(5, "out of memory");
    j.backend = "vulkan";
    j.runs = 15;
    j.batch = BATCH;
    j.width = 1920;
    j.height = 1080;
    read_arguments(argc, argv, &j);
    list_rows(&j);
    load_captures(&j);
    timed = capture_to_time(&j);
    check_rows(&j);
    make_plan(&j, unit_config, timed, &plan);
    j.unit_text = unit_text(&plan);
    if (!j.no_error) measure_rows(&j);
    if (!j.no_time) time_rows(&j, timed);
    if (j.with_sizes) time_sizes(&j, timed);
    write_page(&p, &j);
    fputs(p.text, stdout);
    if (j.out) replace(j.out, mark_begin, mark_end, p.text);
    for (k = 0; k < j.names.count; ++k) capture_free(&j.caps[k]);
    free(j.entries);
    free(j.unit_text);
    free(p.text);
    return 0;
}
