/* hbil-table - all presets on all captures: errors against the scene and against the height field, samples, milliseconds.
 * Writes Markdown to stdout or between the markers of a page. Not a test: nothing is judged here. */
#include <time.h>

#define HBIL_IMPLEMENTATION
#define BENCH_NAME "hbil-table"
#include "bench_common.h"
#include "../../examples/frame/environment.h"
#include "../../examples/frame/runner.h"
#include "../captures.h"
#include "../numeric/brute_force.h"

#define ROWS_MAX   32
#define RUNS       3     /* timed, after one that is not */
#define LONG_RUN   4e3   /* ms, from which on the first run is the only one */
#define ONE_DEVICE 3e4   /* ms, from which on the second backend is left out */
#define RAYS       1024  /* a pixel of the height field's far light: standard error about .003 */
#define STRIDE     16    /* between pixels that get rays */
#define WORSE      1.02  /* times our error is worth a mark */

static const char mark_begin[] = "<!-- table: written by make table -->";
static const char mark_end[] = "<!-- table: end -->";

/* A preset as it is, or with a seed's arithmetic. */
typedef struct row { const char *preset, *seed, *options; } row;

#define YPIPELINE "seed_compat=screen_azimuth+slice_mean+noise_2pi+uniform_bent"
#define MAYAUX    "seed_compat=screen_azimuth+slice_mean+uniform_bent+cone_relation"
#define ARTICLE   "seed_compat=screen_azimuth+slice_mean+noise_2pi"

/* What the articles compute that we do not, see seed_compat: on the presets that are theirs, and on one whose reach is the
 * screen, as that of the truths, which tells arithmetic from settings. */
static const row seeds[] = {
    {"sampled", "YPipeline", "far_visibility=direction " YPIPELINE},
    {"sampled", "Mayaux 2018", "far_visibility=cone " MAYAUX},
    {"sampled", "HBAO + GTAO article", ARTICLE},
    {"gtao", "HBAO + GTAO article", ARTICLE},
    {"hbil_paper", "Mayaux 2018", MAYAUX},
    {"hbil_screen", "YPipeline", YPIPELINE},
};

enum { SCENE, HEIGHT_FIELD, TRUTHS };
enum { VULKAN, GL, BACKENDS };

typedef struct cell {
    value  ao[TRUTHS], near[TRUTHS], far[TRUTHS];
    double ms[BACKENDS]; /* 0: not run */
    int    taps;         /* depth samples a pixel, if no side ends early */
} cell;

typedef struct job {
    const char    *only_preset, *only_capture, *only_backend, *out;
    row            rows[ROWS_MAX];
    int            row_count;
    capture_names  captures;
    runner        *runners[BACKENDS];
    environment    sky;
    cell           cells[ROWS_MAX][CAPTURES_MAX];
} job;

/* ---------------------------------------------------------------------- errors */

static value compare_rays(const image *far, const bf_pixel *rays, bf_grid grid)
{
    sums s = {0.0, 0.0, 0.0, 0.0, 0.0};
    int  i, c;

    for (i = 0; far && i < grid.columns * grid.rows; ++i) {
        const int x = grid.first + i % grid.columns * grid.stride, y = grid.first + i / grid.columns * grid.stride;

        for (c = 0; c < 3 && rays[i].sky == 0.0; ++c)
            add(&s, (double)far->data[far->channels * (y * far->width + x) + c], rays[i].far[c]);
    }
    return result(&s, 0);
}

/* ---------------------------------------------------------------------- one capture */

/* Far light of the height field under the captures' sky. */
static bf_pixel *run_rays(const job *j, const capture *cap, bf_grid grid)
{
    const environment_view v = {&j->sky, cap->view};
    bf_scene   scene;
    bf_pixel  *out = malloc((size_t)grid.columns * (size_t)grid.rows * sizeof *out);

    memset(&scene, 0, sizeof scene);
    scene.camera = bf_camera_from(cap->projection, cap->width, cap->height);
    scene.depth = cap->depth.data;
    scene.sky_depth = 1e9;
    scene.normal = cap->normal.data;
    scene.sky = environment_view_radiance;
    scene.sky_data = &v;
    if (!out || !bf_run(&scene, grid, RAYS, out)) die(5, "out of memory for the rays");
    return out;
}

/* The row's preset with ao, near and far light as far as its estimator has them, under the captures' sky. */
static void make_plan(const row *r, const capture *cap, int backend, hbil_plan *plan)
{
    hbil_diag   items[4];
    hbil_diags  diags = {items, 4, 0};
    hbil_config c;
    char        text[256];
    int         plain;

    if (hbil_config_preset(r->preset, &c, &diags) != HBIL_OK) die(1, "%s", diags.count ? items[0].text : r->preset);
    plain = c.estimator == HBIL_ESTIMATOR_HBAO || c.estimator == HBIL_ESTIMATOR_HBAO_PLUS;
    c.target = backend == GL ? HBIL_TARGET_GL : HBIL_TARGET_VULKAN;
    c.projection = cap->orthographic ? HBIL_PROJECTION_ORTHOGRAPHIC : HBIL_PROJECTION_PERSPECTIVE;
    snprintf(text, sizeof text, "f0=none environment=sh %s %s",
             plain ? "outputs=ao+far far_visibility=ao" : "outputs=ao+near+far", r->options);
    if (hbil_config_parse(&c, text, strlen(text), &diags) != HBIL_OK || hbil_plan_build(&c, plan, &diags) != HBIL_OK)
        die(1, "preset %s, %s: %s", r->preset, text, diags.count ? items[0].text : "?");
}

/* Sum of the passes of each of `runs` runs; the median. */
static double milliseconds(const double *ms, int runs, int passes)
{
    double sum[RUNS];
    int    i, k;

    for (i = 0; i < runs; ++i)
        for (k = 0, sum[i] = 0.0; k < passes; ++k) sum[i] += ms[i * passes + k];
    qsort(sum, (size_t)runs, sizeof *sum, by_size);
    return sum[runs / 2];
}

/* Runs the plan, leaves the outputs of the last run. The time in ms. */
static double run_plan(const job *j, const capture *cap, int backend, const hbil_plan *plan, image out[HBIL_MAX_TEXTURES])
{
    hbil_frame frame;
    image      in[HBIL_MAX_TEXTURES];
    double     ms[RUNS * HBIL_MAX_PASSES], first;
    char       error[512] = "";
    const int  passes = (int)plan->pass_count;

    if (!capture_encode(cap, plan, &frame, in, error, sizeof error)
        || !environment_encode(&j->sky, plan, &frame, in, error, sizeof error)
        || !runner_run(j->runners[backend], plan, &frame, in, out, 1, ms, error, sizeof error)) die(5, "%s", error);
    first = milliseconds(ms, 1, passes);
    if (first < LONG_RUN) {
        free_images(out);
        if (!runner_run(j->runners[backend], plan, &frame, in, out, RUNS, ms, error, sizeof error)) die(5, "%s", error);
        first = milliseconds(ms, RUNS, passes);
    }
    free_images(in);
    return first;
}

static void measure(const hbil_plan *plan, const image *out, const capture *cap, const bf_pixel *rays, bf_grid grid,
                    cell *to)
{
    const image *ao = output(plan, out, "ao"), *near = output(plan, out, "near"), *far = output(plan, out, "far");

    to->taps = 2 * plan->config.slices * (plan->config.march == HBIL_MARCH_SWEEP ? 1 : plan->config.steps);
    to->ao[SCENE] = compare(ao, &cap->truth_ao, NULL, cap, 0);
    to->ao[HEIGHT_FIELD] = compare(ao, &cap->hf_ao, &cap->hf_valid, cap, 0);
    to->near[SCENE] = compare(near, &cap->truth_near, NULL, cap, 1);
    to->near[HEIGHT_FIELD] = compare(near, &cap->hf_near, &cap->hf_valid, cap, 1);
    to->far[SCENE] = compare(far, &cap->truth_far, NULL, cap, 0);
    to->far[HEIGHT_FIELD] = compare_rays(far, rays, grid);
}

/* Errors are those of the first backend that is run; the other gives the same image, see the test `backends`. */
static void run_capture(job *j, int index)
{
    const char *name = j->captures.name[index];
    capture     cap;
    char        error[512] = "";
    bf_grid     grid;
    bf_pixel   *rays;
    int         i, b, measured;

    if (!captures_load(name, 0, &cap, error, sizeof error)) die(3, "%s", error);
    grid = bf_grid_of(cap.width, cap.height, STRIDE / 2, STRIDE);
    rays = run_rays(j, &cap, grid);
    for (i = 0; i < j->row_count; ++i) {
        for (b = measured = 0; b < BACKENDS; ++b) {
            hbil_plan plan;
            image     out[HBIL_MAX_TEXTURES];

            if (!j->runners[b] || (b == GL && j->cells[i][index].ms[VULKAN] > ONE_DEVICE)) continue;
            make_plan(&j->rows[i], &cap, b, &plan);
            j->cells[i][index].ms[b] = run_plan(j, &cap, b, &plan, out);
            if (!measured++) measure(&plan, out, &cap, rays, grid, &j->cells[i][index]);
            free_images(out);
            fprintf(stderr, "%s, %s%s%s, %s: %.1f ms\n", name, j->rows[i].preset, j->rows[i].seed ? " as " : "",
                    j->rows[i].seed ? j->rows[i].seed : "", b == GL ? "gl" : "vulkan", j->cells[i][index].ms[b]);
        }
    }
    free(rays);
    capture_free(&cap);
}

/* ---------------------------------------------------------------------- the page */

/* Bold where the error is that of a seed and larger than ours. */
static void put_value(page *p, value v, value ours, int percent)
{
    const char *bold = v.known && ours.known && v.error > WORSE * ours.error ? "**" : "";

    if (!v.known) put(p, " - |");
    else if (percent) put(p, " %s%.1f%s %+.1f |", bold, 100.0 * v.error, bold, 100.0 * v.bias);
    else put(p, " %s%.3f%s %+.3f |", bold, v.error, bold, v.bias);
}

static void put_ms(page *p, double ms)
{
    if (ms > 0.0) put(p, ms < 100.0 ? " %.1f |" : " %.0f |", ms);
    else put(p, " - |");
}

/* ours: of the same preset without the seed's arithmetic, or c itself. */
static void put_cell(page *p, const cell *c, const cell *ours)
{
    int t;

    put(p, " %d |", c->taps);
    for (t = 0; t < TRUTHS; ++t) put_value(p, c->ao[t], ours->ao[t], 0);
    for (t = 0; t < TRUTHS; ++t) put_value(p, c->near[t], ours->near[t], 1);
    for (t = 0; t < TRUTHS; ++t) put_value(p, c->far[t], ours->far[t], 0);
    put_ms(p, c->ms[VULKAN]);
    put_ms(p, c->ms[GL]);
    put(p, "\n");
}

/* Over the captures that have each truth. */
static cell mean_cell(const cell *cells, int count)
{
    cell mean;
    int  i, t;

    memset(&mean, 0, sizeof mean);
    for (i = 0; i < count; ++i) {
        mean.taps = cells[i].taps;
        for (t = 0; t < TRUTHS; ++t) {
            add_value(&mean.ao[t], cells[i].ao[t]);
            add_value(&mean.near[t], cells[i].near[t]);
            add_value(&mean.far[t], cells[i].far[t]);
        }
        for (t = 0; t < BACKENDS; ++t) mean.ms[t] += cells[i].ms[t] / count;
    }
    for (t = 0; t < TRUTHS; ++t) {
        divide(&mean.ao[t]);
        divide(&mean.near[t]);
        divide(&mean.far[t]);
    }
    return mean;
}

static void put_label(page *p, const row *r)
{
    if (r->seed) put(p, "| `%s`, arithmetic of %s |", r->preset, r->seed);
    else put(p, "| `%s` |", r->preset);
}

static void put_head(page *p, const char *first, const char *rules)
{
    put(p, "%s taps | ao: scene | ao: height field | near %%: scene | near %%: height field | far: scene |"
           " far: height field | ms Vulkan | ms GL |\n%s---:|---|---|---|---|---|---|---:|---:|\n", first, rules);
}

static void put_notes(page *p, const job *j)
{
    char   date[16] = "";
    time_t now = time(NULL);
    int    b, i;

    strftime(date, sizeof date, "%Y-%m-%d", gmtime(&now));
    put(p, "Errors on the first frame of each capture (");
    for (i = 0; i < j->captures.count; ++i) put(p, "%s%s", i ? ", " : "", j->captures.name[i]);
    put(p, "), %s", date);
    for (b = 0; b < BACKENDS; ++b)
        if (j->runners[b]) put(p, "; %s: %s", b == GL ? "GL" : "Vulkan", runner_about(j->runners[b])->device);
    put(p, ".\n\n"
           "- ao, far: root of the mean square, then mean difference. near: mean |difference|, then mean difference,\n"
           "  in %% of its mean.\n"
           "- scene: path-traced truth, what the screen hides included. height field: rays through the depth buffer as a\n"
           "  solid; for far %d rays on every %dth pixel. The environment is the captures' sky.\n", RAYS, STRIDE);
    put(p, "- Every preset computes ao, near and far, but `hbao` and `hbao_plus` no near; `f0=none`. Its `reach` and "
           "`ao_exponent`\n  are in its error: the truths know neither.\n"
           "- taps: 2 slices * steps, depth samples a pixel; 2 slices of a sweep. ms: median of %d frames, mean of the captures, or one\n"
           "  run where that takes long; Mesa's software rasterisers, no GPU.\n"
           "- **bold**: an article's arithmetic has at least %.0f %% more error than ours with the same samples.\n\n",
        RUNS, 100.0 * (WORSE - 1.0));
}

/* Index of the row with our arithmetic of the same preset. */
static int ours_of(const job *j, int index)
{
    while (j->rows[index].seed) --index;
    return index;
}

static void put_seeds(page *p, const job *j)
{
    int i;

    put(p, "\n");
    for (i = 0; i < j->row_count; ++i)
        if (j->rows[i].seed) /* a list, or Markdown makes one line of them */
            put(p, "- `%s`, arithmetic of %s: `%s`.\n", j->rows[i].preset, j->rows[i].seed, j->rows[i].options);
}

static void write_table(page *p, const job *j)
{
    cell mean[ROWS_MAX];
    int  i, k;

    put_notes(p, j);
    put_head(p, "| preset |", "|---|");
    for (i = 0; i < j->row_count; ++i) {
        mean[i] = mean_cell(j->cells[i], j->captures.count);
        put_label(p, &j->rows[i]);
        put_cell(p, &mean[i], &mean[ours_of(j, i)]);
    }
    put_seeds(p, j);
    put(p, "\n<details><summary>Each capture</summary>\n\n");
    put_head(p, "| capture | preset |", "|---|---|");
    for (k = 0; k < j->captures.count; ++k) {
        for (i = 0; i < j->row_count; ++i) {
            put(p, "| %s ", j->captures.name[k]);
            put_label(p, &j->rows[i]);
            put_cell(p, &j->cells[i][k], &j->cells[ours_of(j, i)][k]);
        }
    }
    put(p, "\n</details>\n");
}

/* ---------------------------------------------------------------------- command line */

static void usage(int code)
{
    fputs("usage: hbil-table CAPTURES [--out README.md] [--preset NAME] [--capture NAME] [--backend vulkan|gl]\n"
          "All presets on the first frame of each folder in CAPTURES, on both backends; progress on stderr.\n"
          "Markdown to stdout, or with --out into that file, between its marker lines; the rest of it stays.\n"
          "exit: 0 done; 1 a config is refused; 2 usage; 3 a file; 5 backend or memory\n", code ? stderr : stdout);
    exit(code);
}

static void read_arguments(int argc, char **argv, job *j)
{
    const char *folder = NULL;
    int         i;

    for (i = 1; i < argc; ++i) {
        const struct { const char *name, **to; } options[] = {{"--preset", &j->only_preset}, {"--capture", &j->only_capture},
                                                              {"--backend", &j->only_backend}, {"--out", &j->out}};
        int k;

        if (strcmp(argv[i], "--help") == 0) usage(0);
        for (k = 0; k < 4 && strcmp(argv[i], options[k].name) != 0; ++k) { }
        if (k < 4 && i + 1 < argc) *options[k].to = argv[++i];
        else if (argv[i][0] != '-' && !folder) folder = argv[i];
        else usage(2);
    }
    if (!folder || setenv("HBIL_CAPTURES", folder, 1) != 0) usage(2);
    if (j->only_backend && strcmp(j->only_backend, "vulkan") != 0 && strcmp(j->only_backend, "gl") != 0) usage(2);
}

/* Presets in their order, each followed by itself with the arithmetic of seeds. */
static void list_rows(job *j)
{
    const char *name;
    int32_t     i;
    size_t      k;

    for (i = 0; (name = hbil_preset_name(i)) != NULL && j->row_count < ROWS_MAX; ++i) {
        const row plain = {name, NULL, ""};

        if (j->only_preset && strcmp(j->only_preset, name) != 0) continue;
        j->rows[j->row_count++] = plain;
        for (k = 0; k < sizeof seeds / sizeof *seeds && j->row_count < ROWS_MAX; ++k)
            if (strcmp(seeds[k].preset, name) == 0) j->rows[j->row_count++] = seeds[k];
    }
    if (!j->row_count) die(2, "no preset %s; hbil-frame --help lists them", j->only_preset);
}

static void list_captures(job *j)
{
    const capture_names all = captures_list();
    int                 i;

    for (i = 0; i < all.count; ++i)
        if (!j->only_capture || strcmp(j->only_capture, all.name[i]) == 0)
            memcpy(j->captures.name[j->captures.count++], all.name[i], sizeof all.name[i]);
    if (!j->captures.count)
        die(3, "%s: no folder%s%s in it has a frame-000.exr", getenv("HBIL_CAPTURES"), j->only_capture ? " " : "",
            j->only_capture ? j->only_capture : "");
}

int main(int argc, char **argv)
{
    static const char *const backends[BACKENDS] = {"vulkan", "gl"};
    static job j;
    char       error[512] = "";
    page       p = {malloc(PAGE_MAX), 0};
    int        b, i;

    if (!p.text) die(5, "out of memory");
    read_arguments(argc, argv, &j);
    list_rows(&j);
    list_captures(&j);
    if (!environment_parse(&j.sky, "sky", error, sizeof error)) die(5, "%s", error);
    for (b = 0; b < BACKENDS; ++b)
        if (!j.only_backend || strcmp(j.only_backend, backends[b]) == 0) {
            j.runners[b] = runner_open(backends[b], 0, error, sizeof error);
            if (!j.runners[b]) die(5, "%s", error);
        }
    for (i = 0; i < j.captures.count; ++i) run_capture(&j, i);
    write_table(&p, &j);
    if (j.out) replace(j.out, mark_begin, mark_end, p.text);
    else fputs(p.text, stdout);
    for (b = 0; b < BACKENDS; ++b) runner_close(j.runners[b]);
    environment_free(&j.sky);
    free(p.text);
    return 0;
}
