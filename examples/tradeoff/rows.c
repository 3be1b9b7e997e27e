/* rows.c - the results file. */
#include "rows.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FILE_MAX ((size_t)1 << 28)
#define KEY_MAX  512
#define ROW_MAX  4096

/* Columns of the key. */
enum { VERSION, HASH, CONFIG_TEXT, PRESET, DEVICE, DRIVER, BACKEND, FRAME, WIDTH, HEIGHT, OUTPUT };

static int compare_keys(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

/* A cell must hold no comma and no line end. */
static void clean(char *out, size_t size, const char *text)
{
    snprintf(out, size, "%s", text);
    for (; *out; out++)
        if (*out == ',' || *out == '\n' || *out == '\r' || *out == '"') *out = *out == ',' ? ';' : ' ';
}

static void version_text(char out[32])
{
    snprintf(out, 32, "%d.%d.%d", HBIL_VERSION_MAJOR, HBIL_VERSION_MINOR, HBIL_VERSION_PATCH);
}

/* The cells of a line, in place. How many. */
static int split(char *line, char *cells[ROWS_COLUMNS])
{
    int count = 0;

    for (;;) {
        if (count < ROWS_COLUMNS) cells[count] = line;
        count++;
        line = strchr(line, ',');
        if (!line) return count;
        *line++ = 0;
    }
}

static char *key_of_cells(char *const c[ROWS_COLUMNS])
{
    char *key = malloc(KEY_MAX);

    if (key)
        snprintf(key, KEY_MAX, "%s|%s|%s|%s|%s|%sx%s|%s", c[DEVICE], c[DRIVER], c[VERSION], c[HASH], c[FRAME], c[WIDTH],
                 c[HEIGHT], c[OUTPUT]);
    return key;
}

void rows_key(char *out, size_t size, const runner_info *about, uint64_t hash, const char *frame, int width,
              int height, int output)
{
    char device[128], driver[128], version[32];

    clean(device, sizeof device, about->device);
    clean(driver, sizeof driver, about->driver);
    version_text(version);
    snprintf(out, size, "%s|%s|%s|%016llx|%s|%dx%d|%s", device, driver, version,
             (unsigned long long)hash, frame, width, height, out_names[output]);
}

/* All of the file, terminated. NULL: errno says why. */
static char *read_file(int file, size_t *size)
{
    struct stat info;
    char       *text;
    ssize_t     got;

    if (fstat(file, &info) != 0) return NULL;
    if ((size_t)info.st_size > FILE_MAX) return errno = EFBIG, NULL;
    *size = (size_t)info.st_size;
    text = malloc(*size + 1);
    if (!text) return NULL;
    got = pread(file, text, *size, 0);
    if (got < 0 || (size_t)got != *size) return free(text), NULL;
    text[*size] = 0;
    return text;
}

/* Keys of all rows behind the header. The text is cut up. */
static int read_rows(rows *r, const char *path, char *text, char *error, size_t error_size)
{
    char *line = strchr(text, '\n') + 1, *end, *cells[ROWS_COLUMNS];
    int   number = 2, room = 0;

    for (; *line; line = end + 1, number++) {
        end = strchr(line, '\n');
        *end = 0;
        if (split(line, cells) != ROWS_COLUMNS)
            return frame_error(error, error_size, "%s: line %d has not %d cells. Remove it, or choose another --out",
                               path, number, ROWS_COLUMNS);
        if (r->count == room) {
            char **more = realloc(r->keys, (size_t)(room = room ? 2 * room : 256) * sizeof *more);

            if (!more) return frame_error(error, error_size, "%s: out of memory", path);
            r->keys = more;
        }
        r->keys[r->count] = key_of_cells(cells);
        if (!r->keys[r->count++]) return frame_error(error, error_size, "%s: out of memory", path);
    }
    if (r->count) qsort(r->keys, (size_t)r->count, sizeof *r->keys, compare_keys);
    return 1;
}

static int write_all(int file, const char *text, size_t size)
{
    while (size > 0) {
        const ssize_t wrote = write(file, text, size);

        if (wrote < 0 && errno == EINTR) continue;
        if (wrote < 0) return 0;
        text += wrote;
        size -= (size_t)wrote;
    }
    return 1;
}

/* Cuts off a torn last line, checks the header, writes it into an empty file. */
static int mend(rows *r, const char *path, char *text, size_t size, char *error, size_t error_size)
{
    const size_t header = strlen(ROWS_HEADER "\n");
    size_t       whole = size;

    while (whole > 0 && text[whole - 1] != '\n') whole--;
    if (whole > 0 && strncmp(text, ROWS_HEADER "\n", header) != 0)
        return frame_error(error, error_size, "%s: is no results file of this version. Choose another --out", path);
    if (whole == 0 && strncmp(text, ROWS_HEADER, size) != 0)
        return frame_error(error, error_size, "%s: is no results file. Choose another --out", path);
    r->repaired = (int)(size - whole);
    text[whole] = 0;
    if ((whole < size && ftruncate(r->file, (off_t)whole) != 0)
        || (whole == 0 && !write_all(r->file, ROWS_HEADER "\n", header)))
        return frame_error(error, error_size, "%s: %s. Make room, or choose another --out", path, strerror(errno));
    return whole == 0 || read_rows(r, path, text, error, error_size);
}

int rows_open(rows *r, const char *path, char *error, size_t error_size)
{
    struct flock lock;
    char        *text;
    size_t       size = 0;
    int          ok;

    memset(r, 0, sizeof *r);
    memset(&lock, 0, sizeof lock);
    lock.l_type = F_WRLCK;
    r->file = open(path, O_RDWR | O_CREAT | O_APPEND, 0666);
    if (r->file < 0) return frame_error(error, error_size, "%s: %s. Choose another --out", path, strerror(errno));
    text = fcntl(r->file, F_SETLK, &lock) == 0 ? read_file(r->file, &size) : NULL;
    ok = text ? mend(r, path, text, size, error, error_size)
              : frame_error(error, error_size,
                            "%s: cannot be read, or another sweep writes it (%s). Wait for that, or choose another "
                            "--out",
                            path, strerror(errno));
    free(text);
    if (!ok) rows_close(r);
    return ok;
}

void rows_close(rows *r)
{
    int i;

    for (i = 0; i < r->count; i++) free(r->keys[i]);
    free(r->keys);
    if (r->file >= 0) close(r->file);
    memset(r, 0, sizeof *r);
    r->file = -1;
}

int rows_has(const rows *r, const char *key)
{
    return r->count > 0 && bsearch(&key, r->keys, (size_t)r->count, sizeof *r->keys, compare_keys) != NULL;
}

/* Appends a number, or nothing where it is not known, and a comma. */
static size_t put_number(char *text, size_t used, size_t size, double value)
{
    const int wrote =
        isfinite(value) ? snprintf(text + used, size - used, "%.6g,", value) : snprintf(text + used, size - used, ",");

    return used + (size_t)wrote;
}

/* One row. Its length. */
static size_t make_row(char *text, size_t size, const char *left, int output, const measured *m)
{
    const errors *e = &m->out[output];
    const times  *t = &m->time;
    const double  head[] = {
        t->min, t->median, t->max, t->runs, m->cost.fetches, m->cost.bytes_read, m->cost.bytes_written,
        m->cost.registers, e->rmse_sampling, e->rmse_estimator, e->rmse_model, e->bias_model, e->p95_model,
        e->rmse_field, e->bias_field, e->flicker};
    size_t        used = (size_t)snprintf(text, size, "%s,%s,", left, out_names[output]), i;

    for (i = 0; i < sizeof head / sizeof *head; i++) used = put_number(text, used, size, head[i]);
    return used + (size_t)snprintf(text + used, size - used, "%d\n", t->noisy);
}

int rows_add(rows *r, const runner_info *about, uint64_t hash, const char *words, const char *preset, const char *frame,
             int width, int height, const measured *m, unsigned wanted, char *error, size_t error_size)
{
    char   device[128], driver[128], version[32], left[ROW_MAX - 1024], text[OUTS * ROW_MAX];
    size_t used = 0;
    int    k;

    clean(device, sizeof device, about->device);
    clean(driver, sizeof driver, about->driver);
    version_text(version);
    snprintf(left, sizeof left, "%s,%016llx,%s,%s,%s,%s,%s,%s,%d,%d", version,
             (unsigned long long)hash, words, preset, device, driver, about->backend, frame, width,
             height);
    for (k = 0; k < OUTS; k++)
        if (m->out[k].present && (wanted & 1u << k)) used += make_row(text + used, ROW_MAX, left, k, m);
    return write_all(r->file, text, used)
        || frame_error(error, error_size, "the results cannot be written: %s. Make room and go on", strerror(errno));
}
