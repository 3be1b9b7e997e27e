/* plots.c - see plots.h. gnuplot reads all from its standard input, data included. */
#include "plots.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../frame/image.h"

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
    const char      *title;
    int              count;   /* of marginals */
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
        file_name(path, stem, png, 1);
        fprintf(out, "reset\nset terminal %s size %d,%d noenhanced font 'DejaVu Sans,11' background '#ffffff'\n"
                     "set output ",
                png ? "pngcairo" : "svg", pic->width, pic->height);
        quoted(out, path);
        fputs("\nset encoding utf8\nset datafile missing '?'\nset border lc rgb '#606060'\nset grid lc rgb '#e0e0e0'\n"
              "set key noautotitle\n", out);
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

static int presets_count(const points *p)
{
    int i, count = 0;

    for (i = 0; i < p->count; i++) count += row_name(p->list[i].row)[0] != 0;
    return count;
}

/* Room beyond the points: for what is written right of them, most on that side. */
static void front_ranges(FILE *out, const points *p)
{
    double low = (double)INFINITY, high = 0.0;
    int    i;

    for (i = 0; i < p->count; i++) {
        if (p->list[i].error > 0.0) low = fmin(low, p->list[i].error);
        high = fmax(high, p->list[i].error);
    }
    if (high > 0.0) log_axis(out, 'y', low / 1.25, high * 1.25);
    log_axis(out, 'x', p->list[0].ms / 1.25, p->list[p->count - 1].ms * 1.6);
}

static void draw_front(FILE *out, const picture *pic)
{
    const points *p = pic->points;
    char          label[256];

    front_data(out, p);
    fputs("set title ", out);
    quoted(out, pic->title);
    fputs("\nset logscale xy\nset key top right box lc rgb '#e0e0e0' opaque\nset xlabel ", out);
    snprintf(label, sizeof label, "ms, geometric mean over %d frames", p->frame_count);
    quoted(out, label);
    snprintf(label, sizeof label, "%s of %s, root mean square over %d frames", csv_number_name(pic->selection->error),
             pic->selection->output, p->frame_count);
    fputs("\nset ylabel ", out);
    quoted(out, label);
    fputc('\n', out);
    front_ranges(out, p);
    fprintf(out, "plot $all using 1:2 with points pt 7 ps 0.4 lc rgb '" GREY "' title '%d configs', "
            "$front using 1:2 with steps lw 2 lc rgb '" BLUE "' title 'Pareto front', "
            "$front using 1:2 with points pt 7 ps 0.6 lc rgb '" BLUE "'", p->count);
    if (presets_count(p) > 0)
        fputs(", $presets using 1:2 with points pt 9 ps 1.3 lc rgb '" ORANGE "' title 'presets, externals', "
              "$presets using 1:2:3 with labels left offset char 0.8,0.5 textcolor rgb '" ORANGE "'", out);
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

/* image needs every cell: '?' is a hole. */
static void grid_data(FILE *out, const grid *g)
{
    int x, y;

    fputs("$d << END\n", out);
    for (y = 0; y < g->rows; y++) {
        for (x = 0; x < g->columns; x++) {
            const point *q = g->cell[y][x];

            if (q) fprintf(out, "%d %d %.9g %.9g\n", x, y, q->error, q->ms);
            else fprintf(out, "%d %d ? ?\n", x, y);
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
        fprintf(out, "\nplot $d using 1:2:%d with image, $d using 1:2:(sprintf('%%.3g', $%d)) with labels textcolor "
                     "rgb '#202020'\n",
                3 + k, 3 + k);
    }
    fputs("unset multiplot\n", out);
}

/* ---- ready ------------------------------------------------------------------------------------------------------- */

int plot_front(const points *p, const selection *s, const char *stem, const char *title, char *error, size_t error_size)
{
    picture pic;

    memset(&pic, 0, sizeof pic);
    pic.points = p;
    pic.selection = s;
    pic.title = title;
    pic.width = 900;
    pic.height = 560;
    return run(stem, draw_front, &pic, error, error_size);
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
