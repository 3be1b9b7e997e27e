/* bounds.c - hbil-bounds: rounding errors of each output, as distance, field of view, reach and slices go to their ends. The emitted text runs
 * on the CPU in float and, as the reference, in double with full storage and arithmetic; inputs and noise are the same. Into README.md. */
#define BENCH_NAME "hbil-bounds"
#define HBIL_IMPLEMENTATION
#include "../../hbil.h"

#include "../bench/bench_common.h"
#include "twin.h"

enum { WIDTH = 96, HEIGHT = 72, WIDEST = 16384, LOWEST = 16, MOST_PIXELS = WIDEST * LOWEST, PRECISIONS = 3 };
/* Outputs of the first table, and of the second. */
enum { FIRST = 3, OUTPUTS = 11 };

static const char mark_begin[] = "<!-- bounds: written by make bounds -->", mark_end[] = "<!-- bounds: end -->";
static const char base[] = "outputs=ao+near+bent reach=1 slices=3 dynamic=slices+reach filter=3x3 ";
static const char everything[] = "outputs=ao+near+bent+uniform_ao+cone+sh+far+irradiance+specular_occlusion+composite environment=sh f0=rgb "
                                 "roughness=0.3 reach=1 slices=3 dynamic=slices+reach filter=3x3 ";
static const char bounced[] = "outputs=ao+multi_bounce reach=1 slices=3 dynamic=slices+reach filter=3x3 "; /* goes with no near light */
static const char *const output_names[OUTPUTS] = {"ao", "near", "bent", "uniform_ao", "cone", "sh", "far", "irradiance", "specular_occlusion", "multi_bounce",
                                                  "composite"};
static const char *const precision_names[PRECISIONS] = {"float", "storage=half", "arithmetic=half too"};
static const char *const precision_options[PRECISIONS] = {"", "storage=half ", "storage=half arithmetic=half "};

/* The scene: a relief in front of the camera, as deep as `relief` of its distance. */
typedef struct point {
    double distance, relief, fov, reach; /* m, part, degrees, m */
    int    slices;
    const char *options;                 /* of the method */
    int    width, height;                /* pixels */
    const char *config;                  /* what the options are added to */
} point;

static const double limit = 2e-3; /* what one pixel in a thousand may exceed; where more do, hbil.h says so (hbil_config_resolve) */

typedef struct cell { double often, most; } cell; /* what one pixel in a thousand exceeds; maximum */

static twin *single, *exact;
static int done, all;

static double relief_at(double x, double y)
{
    return 0.4 * sin(9 * x + 2 * y) * cos(7 * y - x) + 0.3 * sin(31 * x) * sin(27 * y + 1) + (fmod(fabs(x + 2 * y) * 3, 1.0) < 0.3 ? 0.3 : 0.0);
}

/* Depth, normal (of the depth, in double) and radiance of the pixel (x, y). */
static void scene_pixel(const point *p, double tan_half, double x, double y, float *z, float n[3], float light[3])
{
    const double u = 2 * x / p->width - 1, v = (2 * y / p->height - 1) * p->height / p->width, e = 1e-3;
    const double d = p->distance * (1 + p->relief * relief_at(u, v));
    const double du = p->distance * p->relief * (relief_at(u + e, v) - relief_at(u - e, v)) / (2 * e);
    const double dv = p->distance * p->relief * (relief_at(u, v + e) - relief_at(u, v - e)) / (2 * e);
    const double t = tan_half, a[3] = {t * (d + u * du), t * v * du, du}, b[3] = {t * u * dv, t * (d + v * dv), dv};
    double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const double side = c[2] > 0 ? -1 : 1, l = side / sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    *z = (float)d;
    n[0] = (float)(c[0] * l); /* view space, z away from the eye; the frame's view axis is +z, see make_frame */
    n[1] = (float)(c[1] * l);
    n[2] = (float)(c[2] * l);
    light[0] = (float)(0.5 + 0.5 * sin(13 * u));
    light[1] = (float)(0.5 + 0.5 * cos(11 * v));
    light[2] = 1.0f;
}

static void make_frame(const point *p, const hbil_plan *plan, hbil_frame *frame, image inputs[HBIL_MAX_TEXTURES])
{
    const double t = tan(p->fov * 3.14159265358979 / 360);
    const int32_t depth = hbil_plan_texture(plan, "depth"), normal = hbil_plan_texture(plan, "normal");
    int x, y, k;
    uint32_t other;
    memset(frame, 0, sizeof *frame);
    memset(inputs, 0, HBIL_MAX_TEXTURES * sizeof *inputs);
    frame->width = (uint32_t)p->width;
    frame->height = (uint32_t)p->height;
    frame->projection[0] = (float)(1 / t); /* left-handed, reversed and infinite: w = z, texel row 0 at y = -1 */
    frame->projection[5] = (float)(1 / t * p->width / p->height);
    frame->projection[10] = 1;
    frame->projection[11] = 1;
    frame->projection[14] = -1e-3f;
    if (plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC) { /* as much of the scene: ndc = z / 1e6 */
        frame->projection[0] /= (float)p->distance;
        frame->projection[5] /= (float)p->distance;
        frame->projection[10] = 1e-6f;
        frame->projection[11] = frame->projection[14] = 0;
        frame->projection[15] = 1;
    }
    frame->view[0] = frame->view[5] = frame->view[10] = frame->view[15] = 1;
    for (k = 0; k < 3; ++k) frame->far_sh[0][k] = 1.5f, frame->far_sh[1][k] = 0.4f, frame->far_sh[3][k] = -0.3f, frame->far_sh[6][k] = 0.2f;
    for (other = 0; other < plan->texture_count; ++other)
        if (plan->textures[other].life == HBIL_LIFE_INPUT && !image_make(&inputs[other], p->width, p->height, other == (uint32_t)depth ? 1 : 3))
            die(5, "out of memory");
    for (y = 0; y < p->height; ++y)
        for (x = 0; x < p->width; ++x) {
            const int i = y * p->width + x;
            float light[3];
            scene_pixel(p, t, x + 0.5, y + 0.5, &inputs[depth].data[i], &inputs[normal].data[3 * i], light);
            for (other = 0; other < plan->texture_count; ++other) { /* radiance, albedo, f0 and direct alike; no paint is white */
                const float part = strcmp(plan->textures[other].name, "albedo") == 0 ? 0.8f : 1.0f;
                if (!inputs[other].data || other == (uint32_t)depth || other == (uint32_t)normal) continue;
                for (k = 0; k < 3; ++k) inputs[other].data[3 * i + k] = part * light[k];
            }
        }
}

static void make_plan(const char *text, hbil_plan *plan)
{
    hbil_diag item;
    hbil_diags diags = {&item, 1, 0};
    hbil_config c;
    memset(&c, 0, sizeof c);
    if (hbil_config_parse(&c, text, strlen(text), &diags) != HBIL_OK || hbil_plan_build(&c, plan, &diags) != HBIL_OK)
        die(4, "%s: %s", text, item.text);
}

static void run(twin *t, const point *p, const char *options, hbil_plan *plan, image outputs[HBIL_MAX_TEXTURES])
{
    static char said[4096];
    image inputs[HBIL_MAX_TEXTURES];
    hbil_frame frame;
    hbil_config live;
    char text[512];
    snprintf(text, sizeof text, "%s%s%s", p->config, p->options, options);
    make_plan(text, plan);
    make_frame(p, plan, &frame, inputs);
    live = plan->config;
    live.reach = (float)p->reach;
    live.slices = p->slices;
    frame.live = &live;
    if (!twin_run(t, plan, &frame, inputs, outputs, said, sizeof said)) die(4, "%s: %s", text, said);
    free_images(inputs);
}

/* Length of the difference of an output, pixel by pixel. All are at most 1 but sh, which is divided by an open hemisphere's. */
static cell difference(const image *got, const double *truth, double one)
{
    static double d[MOST_PIXELS];
    const int channels = got->channels, pixels = got->width * got->height * image_slices(got);
    cell c;
    int i, k;
    for (i = 0; i < pixels; ++i) {
        double sum = 0;
        for (k = 0; k < channels; ++k) {
            const double off = (double)got->data[i * got->channels + k] - truth[i * got->channels + k];
            sum += off * off;
        }
        d[i] = sqrt(sum) / one;
        if (!(d[i] < 1e30)) die(4, "an output is no number");
    }
    qsort(d, (size_t)pixels, sizeof *d, by_size);
    c.often = d[pixels - 1 - pixels / 1000];
    c.most = d[pixels - 1];
    return c;
}

static void measure(const point *p, cell cells[PRECISIONS][OUTPUTS])
{
    image outputs[HBIL_MAX_TEXTURES], reference[HBIL_MAX_TEXTURES];
    static hbil_plan truth, plan;
    int k, o;
    run(exact, p, "", &truth, reference);
    for (k = 0; k < PRECISIONS; ++k) {
        run(single, p, precision_options[k], &plan, outputs);
        for (o = 0; o < OUTPUTS; ++o) {
            const int32_t there = hbil_plan_texture(&plan, output_names[o]);
            cells[k][o].often = cells[k][o].most = -1;
            if (there >= 0 && outputs[there].data)
                cells[k][o] = difference(&outputs[there], twin_output(exact, hbil_plan_texture(&truth, output_names[o])),
                                         strcmp(output_names[o], "sh") ? 1 : 1.7725);
        }
        free_images(outputs);
    }
    free_images(reference);
    ++done;
    fprintf(stderr, "\r%s: %d of %d points", BENCH_NAME, done, all);
}

static void put_row(page *p, const char *name, const point *at)
{
    cell cells[PRECISIONS][OUTPUTS];
    int k, o;
    measure(at, cells);
    put(p, "| %s |", name);
    for (k = 0; k < PRECISIONS; ++k)
        for (o = 0; o < FIRST; ++o) {
            if (cells[k][o].most < 0) put(p, " |");
            else put(p, cells[k][o].often > limit ? " **%.0e** / %.0e |" : " %.0e / %.0e |", cells[k][o].often, cells[k][o].most);
        }
    put(p, "\n");
}

static const point plain = {4, 0.2, 60, 1, 3, "", WIDTH, HEIGHT, base};

/* An end of the second table, and what it has shown. */
typedef struct worst { cell cell; char where[40]; } worst;

static void put_worst(page *p, const worst of[PRECISIONS][OUTPUTS])
{
    int k, o;
    put(p, "\n|  |");
    for (k = 0; k < PRECISIONS; ++k) put(p, " %s | at |", precision_names[k]);
    put(p, "\n|:--|--:|:--|--:|:--|--:|:--|\n");
    for (o = 0; o < OUTPUTS; ++o) {
        put(p, "| `%s` |", output_names[o]);
        for (k = 0; k < PRECISIONS; ++k)
            put(p, of[k][o].cell.often > limit ? " **%.0e** / %.0e | %s |" : " %.0e / %.0e | %s |", of[k][o].cell.often, of[k][o].cell.most, of[k][o].where);
        put(p, "\n");
    }
}

/* Every output at the ends alone. */
static void put_ends(page *p)
{
    static const struct { const char *name; double distance, relief, fov, reach; int slices; const char *options; } ends[] = {
        {"times 0.001", 4e-3, 0.2, 60, 1e-3, 3, ""}, {"times 1e6", 4e6, 0.2, 60, 1e6, 3, ""}, {"1e6 m away", 1e6, 8e-7, 60, 1, 3, ""},
        {"1 degree", 4, 0.2, 1, 1, 3, ""}, {"170 degrees", 4, 0.2, 170, 1, 3, ""}, {"reach 1e-6 m", 4, 0.2, 60, 1e-6, 3, ""},
        {"reach 1e9 m", 4, 0.2, 60, 1e9, 3, ""}, {"slices=1", 4, 0.2, 60, 1, 1, ""}, {"slices=64", 4, 0.2, 60, 1, 64, ""},
        {"bitmask", 4, 0.2, 60, 1, 3, "estimator=bitmask "}, {"downscale=2", 4, 0.2, 60, 1, 3, "downscale=2 "},
    };
    worst of[PRECISIONS][OUTPUTS];
    cell cells[PRECISIONS][OUTPUTS];
    const size_t n = sizeof ends / sizeof *ends;
    size_t i, r;
    int k, o;
    memset(of, 0, sizeof of);
    all += 2 * (int)n;
    for (r = 0; r < 2 * n; ++r) {
        point at = plain;
        i = r % n;
        at.distance = ends[i].distance, at.relief = ends[i].relief, at.fov = ends[i].fov, at.reach = ends[i].reach, at.slices = ends[i].slices;
        at.options = ends[i].options, at.config = r < n ? everything : bounced;
        measure(&at, cells);
        for (k = 0; k < PRECISIONS; ++k)
            for (o = 0; o < OUTPUTS; ++o)
                if (cells[k][o].often > of[k][o].cell.often) {
                    of[k][o].cell = cells[k][o];
                    snprintf(of[k][o].where, sizeof of[k][o].where, "%s", ends[i].name);
                }
    }
    put_worst(p, (const worst(*)[OUTPUTS])of);
}

static void put_rows(page *p)
{
    static const double scales[] = {1e-3, 1, 1e3, 1e6}, far[] = {10, 1e3, 1e5, 1e6}, fovs[] = {1, 5, 20, 60, 120, 150, 170},
                        reaches[] = {1e-6, 1e-3, 1e-1, 10, 1e3, 1e9};
    static const int slices[] = {1, 2, 8, 64};
    static const struct { const char *name, *config; } others[] = {
        {"march=sweep", "outputs=ao+near+bent slices=4 march=sweep filter=3x3 "},
        {"march=both, bitmask, thick", "outputs=ao+near+bent slices=4 march=both estimator=bitmask occluder=thick reach=1 filter=3x3 "},
        {"projection=orthographic", "outputs=ao+near+bent reach=1 slices=3 dynamic=slices+reach filter=3x3 projection=orthographic "},
        {"temporal=yes, first frame", "outputs=ao+near+bent reach=1 slices=3 dynamic=slices+reach filter=3x3 temporal=yes reproject=camera "},
        {"estimator=hbao", "outputs=ao estimator=hbao reach=1 slices=3 filter=3x3 "}, {"estimator=hbao_plus", "outputs=ao estimator=hbao_plus reach=1 slices=3 filter=3x3 "},
    };
    static const struct { const char *name, *options; } methods[] = {
        {"estimator=bitmask", "estimator=bitmask "}, {"estimator=bitmask, thick", "estimator=bitmask occluder=thick "},
        {"occluder=heuristic", "occluder=heuristic "}, {"sampling=bilinear", "sampling=bilinear "}, {"mips=spread", "mips=spread "},
        {"gather=packed", "gather=packed "}, {"downscale=2", "downscale=2 "}, {"noise=ign", "noise=ign "},
    };
    char name[80];
    size_t i;
    point at;
    all = 4 + 4 + 7 + 6 + 4 + 2 + (int)(sizeof methods / sizeof *methods + sizeof others / sizeof *others);
#define EACH(list) for (i = 0, at = plain; i < sizeof list / sizeof *list; ++i)
#define ROW(...) snprintf(name, sizeof name, __VA_ARGS__), put_row(p, name, &at)
    EACH(scales) at.distance = 4 * scales[i], at.reach = scales[i], ROW("all of it times %g", scales[i]);
    EACH(far) at.distance = far[i], at.relief = 0.8 / far[i], ROW("relief of .8 m, %g m away", far[i]);
    EACH(fovs) at.fov = fovs[i], ROW("field of view %g degrees", fovs[i]);
    EACH(reaches) at.reach = reaches[i], ROW("reach %g m", reaches[i]);
    EACH(slices) at.slices = slices[i], ROW("slices=%d", slices[i]);
    EACH(methods) at.options = methods[i].options, ROW("%s", methods[i].name);
    EACH(others) at.config = others[i].config, ROW("%s", others[i].name);
    at = plain;
    at.options = "noise=ign ";
    at.width = WIDEST, at.height = LOWEST, ROW("noise=ign, %d pixels wide", at.width);
    at.options = "", ROW("%d pixels wide", at.width);
#undef ROW
#undef EACH
}

static void put_page(page *p)
{
    int k, o;
    put(p, "|  |");
    for (k = 0; k < PRECISIONS; ++k)
        for (o = 0; o < FIRST; ++o) put(p, " %s, %s |", precision_names[k], output_names[o]);
    put(p, "\n|:--|");
    for (k = 0; k < PRECISIONS * FIRST; ++k) put(p, "--:|");
    put(p, "\n");
    put_rows(p);
    put(p, "\nWhat one pixel in a thousand exceeds / the largest error of a frame of %dx%d, against the same text in double with storage=full; radiance is at "
           "most 1. A relief, %g m away, field of view %g degrees, reach %g m, slices=%d, filter=3x3 but where the row says otherwise. Bold: more than %g. Large errors of "
           "few pixels are horizons, sectors and texels that rounding moves; noise=ign is another noise.\n\nEvery output, and the end at which it is worst:\n", WIDTH,
           HEIGHT, plain.distance, plain.fov, plain.reach, plain.slices, limit);
    put_ends(p);
    fputc('\n', stderr);
    put(p, "\n");
}

static const char help[] =
    "hbil-bounds - rounding errors of each output at the ends of distance, field of view, reach and slices\n\n"
    "usage: hbil-bounds [--out FILE]\n\n"
    "  --out FILE   put the table between the markers of this file (README.md)\n"
    "  -h, --help\n\n"
    "exit: 0 done, 2 wrong usage, 3 cannot read or write, 4 a text does not compile or run, 5 out of memory\n";

int main(int argc, char **argv)
{
    page p = {malloc(PAGE_MAX), 0};
    const char *out = NULL;
    int i;
    for (i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return fputs(help, stdout) < 0 ? 3 : 0;
        if (strcmp(argv[i], "--out") != 0 || ++i == argc) die(2, "%s is not known, or lacks its file: see --help", argv[i < argc ? i : argc - 1]);
        out = argv[i];
    }
    single = twin_open(TWIN_FLOAT, 0);
    exact = twin_open(TWIN_DOUBLE, 0);
    if (!p.text || !single || !exact) die(5, "out of memory");
    put_page(&p);
    fputs(p.text, stdout);
    if (out) replace(out, mark_begin, mark_end, p.text);
    twin_close(single);
    twin_close(exact);
    free(p.text);
    return 0;
}
