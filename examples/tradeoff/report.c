/* report.c - see report.h. */
#include "report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "../frame/image.h"
#include "plots.h"

#define PATH_BYTES 4096
#define NAME_BYTES 64

static const char *const outputs[] = CSV_OUTPUT_NAMES;

/* A page in the making. */
typedef struct page {
    FILE       *out;
    const char *folder;
    int         pictures;
    char       *error;
    size_t      error_size;
} page;

static const char *meaning(int error)
{
    switch (error) {
    case CSV_rmse_sampling:  return "against the same estimator, converged: what more samples buy";
    case CSV_rmse_estimator: return "of the converged estimator against the height field: what another estimator buys";
    case CSV_rmse_model:     return "against the path-traced scene, what the screen hides included";
    default:                 return "against the depth buffer as a solid height field: sampling and estimator together";
    }
}

/* A number in a cell, right of the last '|'; a dash where there is none. */
static void cell(FILE *out, const char *format, double value)
{
    fputc(' ', out);
    if (isfinite(value)) fprintf(out, format, value);
    else fputc('-', out);
    fputs(" |", out);
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

/* Columns of the table beside time, error and config, where they are known of any point. The CSV has more. */
static const struct { int column; const char *format; } extras[] = {
    {CSV_rmse_sampling, "%.4f"}, {CSV_rmse_estimator, "%.4f"}, {CSV_rmse_hf, "%.4f"}, {CSV_bias_hf, "%+.4f"},
    {CSV_rmse_model, "%.4f"}, {CSV_bias_model, "%+.4f"}, {CSV_edge_rmse, "%.4f"}, {CSV_psnr, "%.1f"},
    {CSV_flip, "%.4f"}, {CSV_flicker, "%.4f"}, {CSV_noise, "%.2g"}, {CSV_fetches, "%.1f"},
};
#define EXTRAS ((int)(sizeof extras / sizeof *extras))

static int shown(const points *p, const selection *s, int extra)
{
    return extras[extra].column != s->error && points_know(p, extras[extra].column);
}

static void write_head(FILE *out, const points *p, const selection *s, int on_front)
{
    const char *range = p->frame_count > 1 ? " over frames |" : "", *line = *range ? "---|" : "";
    int         k;

    fprintf(out, "| preset | ms |%s %s |%s", range, csv_number_name(s->error), range);
    for (k = 0; k < EXTRAS; k++)
        if (shown(p, s, k)) fprintf(out, " %s |", csv_number_name(extras[k].column));
    fprintf(out, "%s config |\n|---|---:|%s---:|%s", on_front ? "" : " dominated by |", line, line);
    for (k = 0; k < EXTRAS; k++)
        if (shown(p, s, k)) fputs("---:|", out);
    fputs(on_front ? "---|\n" : "---|---|\n", out);
}

static void write_point(FILE *out, const points *p, const selection *s, const point *q)
{
    const point *by = NULL;
    const double gain = q->on_front ? 0.0 : front_dominated(p, 1, q->row->text[CSV_config_hash], &by);
    const char  *preset = q->row->text[CSV_preset], *config = q->row->text[CSV_config];
    int          k;

    fprintf(out, "| %s%s%s |", preset[0] ? "`" : "", preset, preset[0] ? "`" : "");
    cell(out, "%.4g", q->ms);
    if (p->frame_count > 1) fprintf(out, " %.4g to %.4g |", q->ms_low, q->ms_high);
    cell(out, "%.4f", q->error);
    if (p->frame_count > 1) fprintf(out, " %.4f to %.4f |", q->low, q->high);
    for (k = 0; k < EXTRAS; k++)
        if (shown(p, s, k)) cell(out, extras[k].format, q->mean[extras[k].column]);
    if (by) fprintf(out, " %.1f %%: %.4g ms, %.4f |", 100.0 * gain, by->ms, by->error);
    if (config[0]) fprintf(out, " `%s` |\n", config);
    else fputs(" the defaults |\n", out);
}

static void write_tables(FILE *out, const points *p, const selection *s)
{
    int i, presets = 0;

    fputs("The Pareto front, fastest first:\n\n", out);
    write_head(out, p, s, 1);
    for (i = 0; i < p->count; i++)
        if (p->list[i].on_front) write_point(out, p, s, &p->list[i]);
    for (i = 0; i < p->count; i++) presets += row_name(p->list[i].row)[0] && !p->list[i].on_front;
    if (!presets) return;
    fputs("\nPresets, and externals, that are not on it:\n\n", out);
    write_head(out, p, s, 0);
    for (i = 0; i < p->count; i++)
        if (row_name(p->list[i].row)[0] && !p->list[i].on_front) write_point(out, p, s, &p->list[i]);
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

static void stem_of(char out[PATH_BYTES], const page *pg, const selection *s, const char *kind)
{
    snprintf(out, PATH_BYTES, "%s/%s-%s", pg->folder, s->output, kind);
    fprintf(stderr, "hbil-tradeoff: drawing %s\n", out);
}

static int write_front(page *pg, const points *p, const selection *s)
{
    char stem[PATH_BYTES], title[256];

    if (!pg->pictures) return 1;
    stem_of(stem, pg, s, "front");
    snprintf(title, sizeof title, "%s on %s", s->output, p->list[0].row->text[CSV_device]);
    fprintf(pg->out, "![%s over time: all configs, the Pareto front, presets](%s-front.svg)\n\n",
            csv_number_name(s->error), s->output);
    return plot_front(p, s, stem, title, pg->error, pg->error_size);
}

static int write_rings(page *pg, const points *p, const selection *s)
{
    char stem[PATH_BYTES], title[256];

    if (!pg->pictures) return 1;
    if (!plot_rings_known(p)) {
        fputs("\nError by distance from the image's centre: left out, the CSV has no columns `ring1_hf` to "
              "`ring5_model`.\n", pg->out);
        return 1;
    }
    stem_of(stem, pg, s, "rings");
    snprintf(title, sizeof title, "%s: error by distance from the image's centre", s->output);
    fprintf(pg->out, "\n![Error by distance from the image's centre](%s-rings.svg)\n\n*Error by distance from the "
            "image's centre, in five rings of equal width: presets, and the ends of the front.*\n", s->output);
    return plot_rings(p, stem, title, pg->error, pg->error_size);
}

/* Values that can be compared with none have no factor. */
static void write_factors(FILE *out, const marginal *list, int count)
{
    int i, k;

    fputs("\n| option | error | time | pairs |\n|---|---:|---:|---:|\n", out);
    for (i = 0; i < count; i++) {
        for (k = 0; k < list[i].values; k++) {
            if (!isfinite(list[i].error[k])) continue;
            fprintf(out, "| `%s=%s` |", list[i].option, list[i].value[k]);
            cell(out, "%.3f", list[i].error[k]);
            cell(out, "%.3f", list[i].ms[k]);
            cell(out, "%.0f", list[i].pairs[k] > 0 ? list[i].pairs[k] : (double)NAN);
            fputc('\n', out);
        }
    }
}

static int write_options(page *pg, const points *p, const selection *s)
{
    char      stem[PATH_BYTES], title[256];
    marginal *list;
    int       count, ok = 1;

    list = marginals_make(p, &count);
    if (count < 0) return frame_error(pg->error, pg->error_size, "out of memory");
    if (count == 0) {
        fputs("\nEach option alone: left out, no two configs differ in a single one.\n", pg->out);
        return 1;
    }
    if (pg->pictures) {
        stem_of(stem, pg, s, "options");
        snprintf(title, sizeof title, "%s of %s and ms: factors of each option alone", csv_number_name(s->error),
                 s->output);
        fprintf(pg->out, "\n![Each option alone: factors of error and time](%s-options.svg)\n", s->output);
        ok = plot_marginals(list, count, stem, title, pg->error, pg->error_size);
    }
    fputs("\n*Each option alone: factors against its first value; a step is the geometric mean over all pairs of "
          "configs that differ in nothing else.*\n", pg->out);
    write_factors(pg->out, list, count);
    free(list);
    return ok;
}

static int write_grid(page *pg, const points *p, const selection *s)
{
    char         stem[PATH_BYTES], title[256];
    const point *any = NULL;
    grid         g;
    int          i;

    if (!pg->pictures) return 1;
    if (!grid_make(&g, p)) return frame_error(pg->error, pg->error_size, "out of memory");
    if (g.columns == 0) {
        fputs("\nSlices against steps: left out, no two of each are measured with all else the same.\n", pg->out);
        return 1;
    }
    for (i = 0; !any; i++) any = g.cell[i / g.columns][i % g.columns];
    stem_of(stem, pg, s, "grid");
    snprintf(title, sizeof title, "%s: slices against steps", s->output);
    fprintf(pg->out, "\n![Slices against steps: error and time](%s-grid.svg)\n\n*Slices against steps, all else as in "
                     "`%s`.*\n", s->output,
            any->row->text[CSV_config][0] ? any->row->text[CSV_config] : "the defaults");
    return plot_grid(&g, s, stem, title, pg->error, pg->error_size);
}

/* ---- the page ---------------------------------------------------------------------------------------------------- */

static int write_output(page *pg, const csv *table, const selection *s)
{
    points p;
    int    i, ok;

    if (!points_make(&p, table, s, pg->error, pg->error_size)) return 0;
    fprintf(pg->out, "\n## %s\n\n%d configs, hbil %s, %s: %s%s%s. `%s` is the root mean square %s. Frames:", s->output,
            p.count, p.list[0].row->text[CSV_version], p.list[0].row->text[CSV_backend],
            p.list[0].row->text[CSV_device], p.list[0].row->text[CSV_driver][0] ? ", " : "",
                    p.list[0].row->text[CSV_driver], csv_number_name(s->error),
            meaning(s->error));
    for (i = 0; i < p.frame_count; i++)
        fprintf(pg->out, "%s %s (%g x %g)", i ? "," : "", p.frames[i]->text[CSV_frame], p.frames[i]->number[CSV_width],
                p.frames[i]->number[CSV_height]);
    fputs(".\n", pg->out);
    if (p.left_out > 0)
        fprintf(pg->out, "%d more configs lack a frame and are left out.\n", p.left_out);
    fputc('\n', pg->out);
    ok = write_front(pg, &p, s);
    if (ok) write_tables(pg->out, &p, s);
    ok = ok && write_rings(pg, &p, s) && write_options(pg, &p, s) && write_grid(pg, &p, s);
    points_free(&p);
    return ok;
}

static int write_page(page *pg, const csv *table, const selection *s, int *nothing)
{
    selection one = *s;
    int       i, ok = 1, written = 0;

    fputs("# Speed against accuracy, measured\n\n"
          "Time: the geometric mean over frames of each frame's median; error: the root mean square over frames. "
          "\"Dominated by\" is by how much "
          "another config is better that is neither slower nor worse.\n", pg->out);
    for (i = 0; ok && i < 3; i++) {
        if (s->output && strcmp(s->output, outputs[i]) != 0) continue;
        one.output = outputs[i];
        one.error = s->error;
        one.error = points_error(table, &one);
        if (one.error < 0) continue;
        ok = write_output(pg, table, &one);
        written++;
    }
    if (written > 0) return ok;
    one.output = s->output ? s->output : "ao";
    one.error = s->error >= 0 ? s->error : CSV_rmse_hf;
    *nothing = 1;
    return write_output(pg, table, &one); /* says what there is instead */
}

int report_write(const char *folder, const csv *table, const selection *s, int pictures, int *nothing, char *error,
                 size_t error_size)
{
    page   pg;
    char   path[PATH_BYTES], *text = NULL;
    size_t size = 0;
    int    ok;

    *nothing = 0;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return frame_error(error, error_size, "%s: cannot be made (%s). Choose another folder", folder,
                           strerror(errno));
    memset(&pg, 0, sizeof pg);
    pg.folder = folder;
    pg.pictures = pictures;
    pg.error = error;
    pg.error_size = error_size;
    pg.out = open_memstream(&text, &size);
    if (!pg.out) return frame_error(error, error_size, "out of memory");
    ok = write_page(&pg, table, s, nothing);
    if (fclose(pg.out) != 0 && ok) ok = frame_error(error, error_size, "out of memory");
    snprintf(path, sizeof path, "%s/report.md", folder);
    ok = ok && text_write(path, text, error, error_size);
    free(text);
    return ok;
}
