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

#include "csv.h"

#define FILE_MAX ((size_t)1 << 28)
#define KEY_MAX  512
#define ROW_MAX  4096

#define AT(name, trait, source)   AT_##name,
#define NAME(name, trait, source) "," #name
enum { CSV_COLUMNS(AT, AT) COLUMNS };
static const char        with_comma[] = CSV_COLUMNS(NAME, NAME) "\n";
static const char *const header = with_comma + 1;

/* What a config's rows on a frame begin with. */
typedef struct origin {
    char        version[32], hash[24], device[128], driver[128], commit[128];
    const char *config, *preset, *backend, *frame;
    int         width, height;
} origin;

static int compare_keys(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

/* A cell must hold no comma and no line end. */
static void clean(char *out, size_t size, const char *text)
{
    snprintf(out, size, "%s", text);
    for (; *out; out++)
        if (*out == ',' || *out == '\n' || *out == '\r' || *out == '"') *out = *out == ',' ? ';' : ' ';
}

static void find_origin(origin *of, const runner_info *about, uint64_t hash, const char *frame, int width, int height)
{
    memset(of, 0, sizeof *of);
    snprintf(of->version, sizeof of->version, "%d.%d.%d", HBIL_VERSION_MAJOR, HBIL_VERSION_MINOR, HBIL_VERSION_PATCH);
    snprintf(of->hash, sizeof of->hash, "%016llx", (unsigned long long)hash);
    clean(of->device, sizeof of->device, about->device);
    clean(of->driver, sizeof of->driver, about->driver);
    of->backend = about->backend;
    of->frame = frame;
    of->width = width;
    of->height = height;
}

/* The cells of a line, in place. How many. */
static int split(char *line, char *cells[COLUMNS])
{
    int count = 0;

    for (;;) {
        if (count < COLUMNS) cells[count] = line;
        count++;
        line = strchr(line, ',');
        if (!line) return count;
        *line++ = 0;
    }
}

static char *key_of_cells(char *const c[COLUMNS])
{
    char *key = malloc(KEY_MAX);

    if (key)
        snprintf(key, KEY_MAX, "%s|%s|%s|%s|%s|%sx%s|%s", c[AT_device], c[AT_driver], c[AT_version], c[AT_config_hash],
                 c[AT_frame], c[AT_width], c[AT_height], c[AT_output]);
    return key;
}

void rows_key(char *out, size_t size, const runner_info *about, uint64_t hash, const char *frame, int width,
              int height, int output)
{
    origin of;

    find_origin(&of, about, hash, frame, width, height);
    snprintf(out, size, "%s|%s|%s|%s|%s|%dx%d|%s", of.device, of.driver, of.version, of.hash, frame, width, height,
             out_names[output]);
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
    char *line = strchr(text, '\n') + 1, *end, *cells[COLUMNS];
    int   number = 2, room = 0;

    for (; *line; line = end + 1, number++) {
        end = strchr(line, '\n');
        *end = 0;
        if (split(line, cells) != COLUMNS)
            return frame_error(error, error_size, "%s: line %d has not %d cells. Remove it, or choose another --out",
                               path, number, COLUMNS);
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

/* Appends; what cannot be appended whole is taken off again. */
static int write_all(int file, const char *text, size_t size)
{
    struct stat before;

    if (fstat(file, &before) != 0) return 0;
    while (size > 0) {
        const ssize_t wrote = write(file, text, size);

        if (wrote < 0 && errno == EINTR) continue;
        if (wrote < 0) {
            const int why = errno;

            if (ftruncate(file, before.st_size) != 0) {} /* then the next run does it */
            errno = why;
            return 0;
        }
        text += wrote;
        size -= (size_t)wrote;
    }
    return 1;
}

/* Cuts off a torn last line, checks the header, writes it into an empty file. */
static int mend(rows *r, const char *path, char *text, size_t size, char *error, size_t error_size)
{
    const size_t head = sizeof with_comma - 2;
    size_t       whole = size;

    while (whole > 0 && text[whole - 1] != '\n') whole--;
    if (whole > 0 && strncmp(text, header, head) != 0)
        return frame_error(error, error_size, "%s: is no results file of this version. Choose another --out", path);
    if (whole == 0 && strncmp(text, header, size) != 0)
        return frame_error(error, error_size, "%s: is no results file. Choose another --out", path);
    r->repaired = (int)(size - whole);
    text[whole] = 0;
    if ((whole < size && ftruncate(r->file, (off_t)whole) != 0)
        || (whole == 0 && !write_all(r->file, header, head)))
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

#define PUT_TEXT(name, trait, source)   used += (size_t)snprintf(text + used, size - used, "%s,", source);
#define PUT_NUMBER(name, trait, source) used = put_number(text, used, size, source);

/* One row. Its length. */
static size_t make_row(char *text, size_t size, const origin *of, int output, const measured *m)
{
    const errors *e = &m->out[output];
    size_t        used = 0;

    CSV_COLUMNS(PUT_TEXT, PUT_NUMBER)
    text[used - 1] = '\n';
    return used;
}

int rows_add(rows *r, const runner_info *about, uint64_t hash, const char *words, const char *preset, const char *frame,
             int width, int height, const measured *m, unsigned wanted, char *error, size_t error_size)
{
    char   text[OUTS * ROW_MAX];
    size_t used = 0;
    origin of;
    int    k;

    find_origin(&of, about, hash, frame, width, height);
    of.config = words;
    of.preset = preset;
    clean(of.commit, sizeof of.commit, r->commit ? r->commit : "");
    for (k = 0; k < OUTS; k++)
        if (m->out[k].present && (wanted & 1u << k)) used += make_row(text + used, ROW_MAX, &of, k, m);
    return write_all(r->file, text, used)
        || frame_error(error, error_size, "the results cannot be written: %s. Make room and go on", strerror(errno));
}
