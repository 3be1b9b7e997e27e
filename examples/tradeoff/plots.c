/* plots.c - see plots.h. gnuplot reads all from its standard input, data included. */
#include "plots.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../frame/image.h"
#include "labels.h"
#include "metrics.h"

#define PATH_BYTES 4096
#define COLUMNS    3  /* of panels */

/* Colours that are told apart by everyone (Okabe, Ito 2008). */
#define BLUE   "#0072b2"
#define ORANGE "#d55e00"
#define GREY   "#b0b0b0"

/* What a picture is made of. */
typedef struct picture {
    const points    *points;
    const marginal  *marginals;
    const grid      *grid;
    const selection *selection;
    const label     *labels;
    const char      *title;
    int              count;   /* of marginals, of labels */
    int              width, height;
} picture;

typedef void draw_function(FILE *out, const picture *pic);

/* In single quotes, where only these mean anything. */
static void quoted(FILE *out, const char *text)
{
    fputc('\'', out);
    for (; *text; text++) {
        if (*text == '\'') fputc('\'', out);
        fputc(*text == '\n' ? ' ' : *text, out);
    }
    fputc('\'', out);
}

static void file_name(char out[PATH_BYTES], const char *stem, int png, int temporary)
{
    snprintf(out, PATH_BYTES, temporary ? "%s.%s.%ld.tmp" : "%s.%s", stem, png ? "png" : "svg", (long)getpid());
}

/* ---- the child --------------------------------------------------------------------------------------------------- */

static void write_script(FILE *out, const char *stem, draw_function *draw, const picture *pic)
{
    char path[PATH_BYTES];
    int  png;

    for (png = 0; png < 2; png++) {
        file_name(path, stem, png, 0);
        temp_clean(path);
        file_name(path, stem, png, 1);
        fprintf(out, "reset\nset terminal %s size %d,%d noenhanced font 'DejaVu Sans,11' background '#ffffff'\n"
                     "set output ",
                png ? "pngcairo" : "svg", pic->width, pic->height);
        quoted(out, path);
        fputs("\nset encoding utf8\nset datafile missing '?'\nset border lc rgb '#606060'\n"
              "set grid lt 1 lc rgb '#e0e0e0'\nset key noautotitle\n", out);
        draw(out, pic);
        fputs("\nunset output\n", out);
    }
}

static int rename_both(const char *stem, int ok, char *error, size_t error_size)
{
    char from[PATH_BYTES], to[PATH_BYTES];
    int  png;

    for (png = 0; png < 2; png++) {
        file_name(from, stem, png, 1);
        file_name(to, stem, png, 0);
        if (ok && rename(from, to) != 0)
            ok = frame_error(error, error_size, "%s: cannot be replaced (%s). Choose a folder that can be written", to,
                             strerror(errno));
        remove(from);
    }
    return ok;
}

/* A gnuplot that ends early must not end this program by SIGPIPE: its exit code tells. */
static int run(const char *stem, draw_function *draw, const picture *pic, char *error, size_t error_size)
{
    struct sigaction ignore, before;
    FILE            *child;
    int              status;

    memset(&ignore, 0, sizeof ignore);
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, &before);
    child = popen("command -v gnuplot >/dev/null || exit 127; exec gnuplot", "w");
    if (child) write_script(child, stem, draw, pic);
    status = child ? pclose(child) : -1;
    sigaction(SIGPIPE, &before, NULL);
    if (status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 127)
        return frame_error(error, error_size,
                           "gnuplot is missing. Install it (Debian: apt-get install gnuplot-nox) or give --no-plots");
    if (status != 0)
        frame_error(error, error_size,
                    "%s: gnuplot failed, see above. It must be of version 5 and know svg and pngcairo", stem);
    return rename_both(stem, status == 0, error, error_size);
}

/* ---- the front --------------------------------------------------------------------------------------------------- */

static void front_data(FILE *out, const points *p)
{
    int i, kind;

    for (kind = 0; kind < 3; kind++) {
        fprintf(out, "$%s << END\n", kind == 0 ? "all" : kind == 1 ? "front" : "presets");
        for (i = 0; i < p->count; i++) {
            const point *q = &p->list[i];

            if ((kind == 1 && !q->on_front) || (kind == 2 && !row_name(q->row)[0])) continue;
            fprintf(out, "%.9g %.9g \"%s\"\n", q->ms, q->error, kind == 2 ? row_name(q->row) : "");
        }
        fputs("END\n", out);
    }
}

/* Both ends of an axis with a logarithmic scale, and names at 1, 2 and 5 times each power of ten, at more where it is
 * short. */
static void log_axis(FILE *out, char axis, double low, double high)
{
    static const double steps[] = {1.0, 2.0, 5.0, 1.2, 1.5, 2.5, 3.0, 4.0, 6.0, 7.0, 8.0, 9.0};
    const int           count = high > 3.0 * low ? 3 : 12;
    const char         *comma = "";
    int                 decade, k;

    fprintf(out, "set %crange [%.9g:%.9g]\nset %ctics (", axis, low, high, axis);
    for (decade = (int)floor(log10(low)); decade <= (int)floor(log10(high)); decade++) {
        for (k = 0; k < count; k++) {
            const double tic = steps[k] * pow(10.0, decade);

            if (tic < low || tic > high) continue;
            fprintf(out, "%s'%g' %.9g", comma, tic, tic);
            comma = ",";
        }
    }
    if (!*comma) fprintf(out, "'%.3g' %.9g", sqrt(low * high), sqrt(low * high)); /* between two of them */
    fputs(")\n", out);
}

/* The area with the points, and letters in it; pixels. */
enum { AREA_LEFT = 80, AREA_BOTTOM = 80, AREA_WIDTH = 800, AREA_HEIGHT = 440 };
#define LETTER_WIDTH  8.5
#define LETTER_HEIGHT 15.0
#define LINE_STEP     8    /* between the places of the front's line that names keep off */
#define TIED          16.0 /* names further away are tied to their points */

typedef struct span { double low, high; } span;

/* Of both axes, with room around the points. y is NaN where no error is above 0. */
static void front_spans(const points *p, span *x, span *y)
{
    int i;

    x->low = p->list[0].ms / 1.25;
    x->high = p->list[p->count - 1].ms * 1.25;
    y->low = y->high = (double)NAN;
    for (i = 0; i < p->count; i++) {
        if (!(p->list[i].error > 0.0)) continue;
        y->low = fmin(y->low, p->list[i].error / 1.25);
        y->high = fmax(y->high, p->list[i].error * 1.25);
    }
}

/* On a logarithmic axis that is so long. */
static double along(span s, double value, double length) { return length * log(value / s.low) / log(s.high / s.low); }

/* The points, and the front's line at every few pixels. How many. */
static int front_spots(const points *p, spot *spots)
{
    const point *last = NULL;
    span         x, y;
    int          i, count = p->count;

    front_spans(p, &x, &y);
    for (i = 0; i < p->count; i++) {
        const spot at = {along(x, p->list[i].ms, AREA_WIDTH), along(y, p->list[i].error, AREA_HEIGHT)};
        spot       s;

        spots[i] = at;
        if (!p->list[i].on_front) continue;
        if (last && isfinite(at.y)) { /* an error of 0 is not on the picture */
            const spot from = spots[last - p->list];

            for (s = from; s.x < at.x; s.x += LINE_STEP) spots[count++] = s;
            for (s.x = at.x; s.y > at.y; s.y -= LINE_STEP) spots[count++] = s;
        }
        last = &p->list[i];
    }
    return count;
}

/* The names of the presets, in their places; caller frees. NULL: out of memory. */
static label *front_labels(const points *p, int *count)
{
    const size_t most = (size_t)(p->count * 3 + (AREA_WIDTH + AREA_HEIGHT) / LINE_STEP);
    label       *labels = calloc((size_t)p->count, sizeof *labels), *l = labels;
    spot        *spots = calloc(most, sizeof *spots);
    int          i, spot_count = labels && spots ? front_spots(p, spots) : 0;

    for (i = 0; spot_count > 0 && i < p->count; i++) {
        const char *name = row_name(p->list[i].row);

        if (!*name || !isfinite(spots[i].y)) continue;
        l->text = name;
        l->of = spots[i];
        l->width = LETTER_WIDTH * (double)strlen(name);
        l++->height = LETTER_HEIGHT;
    }
    *count = (int)(l - labels);
    labels_place(labels, *count, spots, spot_count, AREA_WIDTH, AREA_HEIGHT);
    if (!spots) free(labels), labels = NULL;
    free(spots);
    return labels;
}

static double clamp(double v, double middle, double width)
{
    return fmin(fmax(v, middle - 0.5 * width), middle + 0.5 * width);
}

static void draw_label(FILE *out, const label *l)
{
    const double x = clamp(l->of.x, l->middle.x, l->width), y = clamp(l->of.y, l->middle.y, l->height);

    fputs("set label ", out);
    quoted(out, l->text);
    fprintf(out, " at graph %.5f,%.5f center front textcolor rgb '" ORANGE "'\n", l->middle.x / AREA_WIDTH,
            l->middle.y / AREA_HEIGHT);
    if (hypot(x - l->of.x, y - l->of.y) > TIED)
        fprintf(out, "set arrow from graph %.5f,%.5f to graph %.5f,%.5f nohead front lc rgb '" ORANGE "'\n",
                l->of.x / AREA_WIDTH, l->of.y / AREA_HEIGHT, x / AREA_WIDTH, y / AREA_HEIGHT);
}

/* Puts the next plot between these places, pixels of a picture. */
static void place_plot(FILE *out, const picture *pic, int left, int bottom, int width, int height)
{
    fprintf(out, "set lmargin at screen %.5f\nset rmargin at screen %.5f\nset bmargin at screen %.5f\n"
            "set tmargin at screen %.5f\n", (double)left / pic->width, (double)(left + width) / pic->width,
            (double)bottom / pic->height, (double)(bottom + height) / pic->height);
}

static void front_axes(FILE *out, const picture *pic)
{
    const points *p = pic->points;
    const char   *plural = p->frame_count == 1 ? "" : "s";
    char          text[256];
    span          x, y;

    front_spans(p, &x, &y);
    fputs("set logscale xy\nset xlabel ", out);
    snprintf(text, sizeof text, "ms, geometric mean over %d frame%s", p->frame_count, plural);
    quoted(out, text);
    snprintf(text, sizeof text, "%s of %s, root mean square over %d frame%s", csv_number_name(pic->selection->error),
             pic->selection->output, p->frame_count, plural);
    fputs("\nset ylabel ", out);
    quoted(out, text);
    fputc('\n', out);
    log_axis(out, 'x', x.low, x.high);
    if (isfinite(y.low)) log_axis(out, 'y', y.low, y.high);
}

static void draw_front(FILE *out, const picture *pic)
{
    int i;

    front_data(out, pic->points);
    place_plot(out, pic, AREA_LEFT, AREA_BOTTOM, AREA_WIDTH, AREA_HEIGHT);
    fputs("set title ", out);
    quoted(out, pic->title);
    fputs("\nset key below center horizontal samplen 2\n", out);
    front_axes(out, pic);
    for (i = 0; i < pic->count; i++) draw_label(out, &pic->labels[i]);
    fprintf(out, "plot $all using 1:2 with points pt 7 ps 0.5 lc rgb '" GREY "' title '%d configs', "
            "$front using 1:2 with steps lw 2 lc rgb '" BLUE "' title 'Pareto front', "
            "$front using 1:2 with points pt 7 ps 0.6 lc rgb '" BLUE "'", pic->points->count);
    if (pic->count > 0)
        fputs(", $presets using 1:2 with points pt 9 ps 1.3 lc rgb '" ORANGE "' title 'presets, externals'", out);
}

/* ---- distance from the centre ------------------------------------------------------------------------------------ */

/* Presets, externals, and the ends of the front. NULL: the point gets no line. */
static const char *line_name(const points *p, const point *q)
{
    const point *last = &p->list[p->count - 1];

    if (row_name(q->row)[0]) return row_name(q->row);
    if (q == p->list) return "fastest of all";
    while (!last->on_front) last--;
    return q == last ? "most accurate of all" : NULL;
}

/* A block of data for each line: distance, error of each panel. The range of all errors above 0; NaN: there is none. */
static span ring_data(FILE *out, const points *p, const int *panels, int count)
{
    span range = {(double)NAN, (double)NAN};
    int  i, k, ring;

    for (i = 0; i < p->count; i++) {
        if (!line_name(p, &p->list[i])) continue;
        fprintf(out, "$line%d << END\n", i);
        for (ring = 0; ring < METRIC_RINGS; ring++) {
            fprintf(out, "%g", (ring + 0.5) / METRIC_RINGS);
            for (k = 0; k < count; k++) {
                const double e = p->list[i].mean[panels[k] + ring];

                if (e > 0.0) fprintf(out, " %.9g", e);
                else fputs(" ?", out);
                if (e > 0.0) range.low = fmin(range.low, e), range.high = fmax(range.high, e);
            }
            fputc('\n', out);
        }
        fputs("END\n", out);
    }
    return range;
}

static void draw_ring_panel(FILE *out, const points *p, int column)
{
    static const char *const colors[] = {"#000000", "#e69f00", "#56b4e9", "#009e73", "#0072b2", "#d55e00", "#cc79a7"};
    const int                count = (int)(sizeof colors / sizeof *colors);
    int                      i, line = 0;

    for (i = 0; i < p->count; i++) {
        const char *name = line_name(p, &p->list[i]);

        if (!name) continue;
        fprintf(out, "%s$line%d using 1:%d with linespoints lw 2 pt %d dt %d lc rgb '%s' title ", line ? ", " : "plot ",
                i, column, 4 + line, 1 + line / count, colors[line % count]);
        quoted(out, name);
        line++;
    }
    fputc('\n', out);
}

/* Columns of the first ring, of those that are known. How many. */
static int ring_panels(const points *p, int panels[2])
{
    const int columns[] = {CSV_ring1_hf, CSV_ring1_model};
    int       k, ring, count = 0;

    for (k = 0; k < 2; k++) {
        for (ring = 0; ring < METRIC_RINGS && !points_know(p, columns[k] + ring); ring++) continue;
        if (ring < METRIC_RINGS) panels[count++] = columns[k];
    }
    return count;
}

/* A panel, with what belongs to it, and the names of the lines right of all. */
enum { PANEL_LEFT = 70, PANEL_BOTTOM = 60, PANEL_WIDTH = 320, PANEL_HEIGHT = 300, NAMES_WIDTH = 240 };

static void draw_rings(FILE *out, const picture *pic)
{
    int        panels[2], k;
    const int  count = ring_panels(pic->points, panels);
    const span range = ring_data(out, pic->points, panels, count);

    fputs("set multiplot title ", out);
    quoted(out, pic->title);
    fputs("\nset xrange [0:1]\nset xtics 0.2\nset xlabel 'distance from the centre; the corner: 1'\nunset key\n", out);
    if (isfinite(range.low)) {
        fputs("set logscale y\n", out);
        log_axis(out, 'y', range.low / 1.1, range.high * 1.1);
    }
    for (k = 0; k < count; k++) {
        place_plot(out, pic, PANEL_LEFT + k * (PANEL_LEFT + PANEL_WIDTH), PANEL_BOTTOM, PANEL_WIDTH, PANEL_HEIGHT);
        fprintf(out, "set title 'RMSE against the %s'\n", panels[k] == CSV_ring1_hf ? "height field" : "scene");
        if (k + 1 == count) fputs("set key outside right top vertical Left reverse samplen 2\n", out);
        draw_ring_panel(out, pic->points, 2 + k);
    }
    fputs("unset multiplot\n", out);
}

/* ---- marginals --------------------------------------------------------------------------------------------------- */

static void draw_marginal(FILE *out, const marginal *m)
{
    double low = 1.0, high = 1.0;
    size_t letters = 0;
    int    i;

    for (i = 0; i < m->values; i++) letters += strlen(m->value[i]) + 2;
    fputs("set title ", out);
    quoted(out, m->option);
    fprintf(out, "\nset xtics %s (", letters > 32 ? "rotate by -30" : "norotate");
    for (i = 0; i < m->values; i++) {
        if (i) fputc(',', out);
        quoted(out, m->value[i]);
        fprintf(out, " %d", i);
        if (!isfinite(m->error[i])) continue;
        low = fmin(low, fmin(m->error[i], m->ms[i]));
        high = fmax(high, fmax(m->error[i], m->ms[i]));
    }
    fprintf(out, ")\nset xrange [-0.4:%g]\n", m->values - 0.6);
    log_axis(out, 'y', low / 1.15, high * 1.15);
    fputs("$d << END\n", out);
    for (i = 0; i < m->values; i++)
        if (isfinite(m->error[i])) fprintf(out, "%d %.9g %.9g\n", i, m->error[i], m->ms[i]);
    fputs("END\nplot $d using 1:3 with linespoints pt 6 lw 2 dt 2 lc rgb '" ORANGE "' title 'time', "
          "$d using 1:2 with linespoints pt 7 lw 2 lc rgb '" BLUE "' title 'error'\n", out);
}

static void draw_marginals(FILE *out, const picture *pic)
{
    const int columns = pic->count < COLUMNS ? pic->count : COLUMNS;
    int       i;

    fprintf(out, "set multiplot layout %d,%d title ", (pic->count + columns - 1) / columns, columns);
    quoted(out, pic->title);
    fputs("\nset logscale y\nset key below center horizontal samplen 2\n", out);
    for (i = 0; i < pic->count; i++) draw_marginal(out, &pic->marginals[i]);
    fputs("unset multiplot\n", out);
}

/* ---- slices x steps ---------------------------------------------------------------------------------------------- */

static void grid_tics(FILE *out, char axis, const double *values, int count)
{
    int i;

    fprintf(out, "set %ctics (", axis);
    for (i = 0; i < count; i++) fprintf(out, "%s'%g' %d", i ? "," : "", values[i], i);
    fprintf(out, ")\nset %crange [-0.5:%g]\n", axis, count - 0.5);
}

/* image needs every cell: NaN is a hole. */
static void grid_data(FILE *out, const grid *g)
{
    int x, y;

    fputs("$d << END\n", out);
    for (y = 0; y < g->rows; y++) {
        for (x = 0; x < g->columns; x++) {
            const point *q = g->cell[y][x];

            if (q) fprintf(out, "%d %d %.9g %.9g\n", x, y, q->error, q->ms);
            else fprintf(out, "%d %d NaN NaN\n", x, y);
        }
        fputc('\n', out);
    }
    fputs("END\n", out);
}

static void draw_grid(FILE *out, const picture *pic)
{
    const grid *g = pic->grid;
    int         k;

    grid_data(out, g);
    fputs("set multiplot layout 1,2 title ", out);
    quoted(out, pic->title);
    fputs("\nset logscale cb\nset xlabel 'slices'\nset ylabel 'steps'\nunset grid\nunset colorbox\n"
          "set palette defined (0 '#f7fbff', 1 '#6baed6')\n", out);
    grid_tics(out, 'x', g->slices, g->columns);
    grid_tics(out, 'y', g->steps, g->rows);
    for (k = 0; k < 2; k++) {
        fputs("set title ", out);
        quoted(out, k ? "ms" : csv_number_name(pic->selection->error));
        fprintf(out, "\nplot $d using 1:2:%d with image, $d using 1:2:"
                "(sprintf($%d < 1000 ? '%%.3g' : $%d == $%d ? '%%.0f' : '', $%d)) "
                "with labels textcolor rgb '#202020'\n", 3 + k, 3 + k, 3 + k, 3 + k, 3 + k);
    }
    fputs("unset multiplot\n", out);
}

/* ---- ready ------------------------------------------------------------------------------------------------------- */

int plot_front(const points *p, const selection *s, const char *stem, const char *title, char *error, size_t error_size)
{
    picture pic;
    label  *labels;
    int     ok;

    memset(&pic, 0, sizeof pic);
    labels = front_labels(p, &pic.count);
    if (!labels) return frame_error(error, error_size, "out of memory");
    pic.points = p;
    pic.selection = s;
    pic.labels = labels;
    pic.title = title;
    pic.width = AREA_LEFT + AREA_WIDTH + 20;
    pic.height = AREA_BOTTOM + AREA_HEIGHT + 40;
    ok = run(stem, draw_front, &pic, error, error_size);
    free(labels);
    return ok;
}

int plot_rings_known(const points *p)
{
    int panels[2];

    return ring_panels(p, panels) > 0;
}

int plot_rings(const points *p, const char *stem, const char *title, char *error, size_t error_size)
{
    picture pic;
    int     panels[2];

    memset(&pic, 0, sizeof pic);
    pic.points = p;
    pic.title = title;
    pic.width = ring_panels(p, panels) * (PANEL_LEFT + PANEL_WIDTH) + NAMES_WIDTH;
    pic.height = PANEL_BOTTOM + PANEL_HEIGHT + 60;
    return run(stem, draw_rings, &pic, error, error_size);
}

int plot_marginals(const marginal *list, int count, const char *stem, const char *title, char *error, size_t error_size)
{
    picture pic;

    memset(&pic, 0, sizeof pic);
    pic.marginals = list;
    pic.count = count;
    pic.title = title;
    pic.width = count < COLUMNS ? 330 * count + 60 : 330 * COLUMNS;
    pic.height = 60 + 260 * ((count + COLUMNS - 1) / COLUMNS);
    return run(stem, draw_marginals, &pic, error, error_size);
}

int plot_grid(const grid *g, const selection *s, const char *stem, const char *title, char *error, size_t error_size)
{
    picture pic;

    memset(&pic, 0, sizeof pic);
    pic.grid = g;
    pic.selection = s;
    pic.title = title;
    pic.width = 160 + 2 * (70 + 62 * g->columns);
    pic.height = 150 + 42 * g->rows;
    return run(stem, draw_grid, &pic, error, error_size);
}
