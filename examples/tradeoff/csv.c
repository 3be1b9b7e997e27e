/* csv.c - see csv.h. */
#include "csv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../frame/image.h"

#define BYTES_MAX  ((size_t)1 << 28)
#define FIELDS_MAX 128

typedef struct column { const char *name; int trait; } column;

#define CSV_COLUMN(name, trait, source) {#name, CSV_##trait},
static const column texts[] = {CSV_COLUMNS(CSV_COLUMN, CSV_NONE)};
static const column numbers[] = {CSV_COLUMNS(CSV_NONE, CSV_COLUMN)};

/* A file that is being read, and where it has what. */
typedef struct reader {
    const char *path;
    int         line, fields;                 /* fields: of the first line */
    int         text_at[CSV_TEXT_COUNT], number_at[CSV_NUMBER_COUNT]; /* -1: absent */
    char       *error;
    size_t      error_size;
} reader;

#define AGAIN "Delete the line: the sweep measures it again when it is resumed"

static int find(const column *columns, int count, const char *name)
{
    int i;

    for (i = 0; i < count; i++)
        if (strcmp(columns[i].name, name) == 0) return i;
    return -1;
}

int         csv_number(const char *name) { return find(numbers, CSV_NUMBER_COUNT, name); }
const char *csv_number_name(int index) { return numbers[index].name; }
int         csv_number_trait(int index) { return numbers[index].trait; }

/* Cuts a line into fields, in place. How many; FIELDS_MAX + 1: too many. */
static int split(char *line, const char *fields[FIELDS_MAX])
{
    char *in = line, *out;
    int   count = 0;

    for (;;) {
        if (count == FIELDS_MAX) return FIELDS_MAX + 1;
        fields[count++] = out = in;
        if (*in == '"') { /* "" inside is one quotation mark */
            for (in++; *in && (*in != '"' || in[1] == '"'); in++) {
                if (*in == '"') in++;
                *out++ = *in;
            }
            if (*in == '"') in++;
        }
        while (*in && *in != ',') *out++ = *in++;
        if (!*in) {
            *out = 0;
            return count;
        }
        *out = 0;
        in++;
    }
}

static int read_header(reader *r, char *line)
{
    const char *fields[FIELDS_MAX];
    int         i, k;

    for (k = 0; k < CSV_TEXT_COUNT; k++) r->text_at[k] = -1;
    for (k = 0; k < CSV_NUMBER_COUNT; k++) r->number_at[k] = -1;
    r->fields = split(line, fields);
    if (r->fields > FIELDS_MAX)
        return frame_error(r->error, r->error_size, "%s:1: more than %d columns. Give a CSV of a sweep", r->path,
                           FIELDS_MAX);
    for (i = 0; i < r->fields; i++) {
        if ((k = find(texts, CSV_TEXT_COUNT, fields[i])) >= 0) r->text_at[k] = i;
        if ((k = csv_number(fields[i])) >= 0) r->number_at[k] = i;
    }
    for (k = 0; k < CSV_TEXT_COUNT + CSV_NUMBER_COUNT; k++) {
        const column *c = k < CSV_TEXT_COUNT ? &texts[k] : &numbers[k - CSV_TEXT_COUNT];

        if (c->trait == CSV_MUST && (k < CSV_TEXT_COUNT ? r->text_at[k] : r->number_at[k - CSV_TEXT_COUNT]) < 0)
            return frame_error(r->error, r->error_size,
                               "%s:1: no column %s. Give a CSV of a sweep, its first line included", r->path, c->name);
    }
    return 1;
}

static int is_output(const char *text)
{
    static const char *const names[CSV_OUTPUTS] = CSV_OUTPUT_NAMES;
    int i;

    for (i = 0; i < CSV_OUTPUTS && strcmp(text, names[i]) != 0; i++) continue;
    return i < CSV_OUTPUTS;
}

static int read_number(reader *r, int index, const char *text, double *out)
{
    const int signed_ = csv_number_trait(index) == CSV_SIGNED;
    char     *end;

    *out = *text ? strtod(text, &end) : (double)NAN;
    if ((*text && (*end || end == text)) || isinf(*out) || (!signed_ && *out < 0.0))
        return frame_error(r->error, r->error_size, "%s:%d: %s is \"%.40s\", no number that it can have. " AGAIN,
                           r->path, r->line, numbers[index].name, text);
    return 1;
}

static int read_row(reader *r, char *line, csv_row *row)
{
    const char *fields[FIELDS_MAX], *output;
    const int   count = split(line, fields);
    int         k;

    if (count != r->fields)
        return frame_error(r->error, r->error_size, "%s:%d: %s%d fields, line 1 has %d: torn or foreign. " AGAIN,
                           r->path, r->line, count > FIELDS_MAX ? "more than " : "",
                           count > FIELDS_MAX ? FIELDS_MAX : count, r->fields);
    row->line = r->line;
    for (k = 0; k < CSV_TEXT_COUNT; k++) row->text[k] = r->text_at[k] < 0 ? "" : fields[r->text_at[k]];
    for (k = 0; k < CSV_NUMBER_COUNT; k++)
        if (!read_number(r, k, r->number_at[k] < 0 ? "" : fields[r->number_at[k]], &row->number[k])) return 0;
    output = row->text[CSV_output];
    if (!is_output(output))
        return frame_error(r->error, r->error_size, "%s:%d: output is \"%.40s\", not ao, near or far. " AGAIN, r->path,
                           r->line, output);
    if (!row->text[CSV_config_hash][0] || !row->text[CSV_frame][0] || !(row->number[CSV_ms_median] > 0.0))
        return frame_error(r->error, r->error_size, "%s:%d: config_hash, frame or ms_median is empty or 0. " AGAIN,
                           r->path, r->line);
    return 1;
}

static int read_lines(reader *r, csv *out)
{
    char  *line = out->bytes, *end, *header = NULL;
    size_t lines = 1;
    int    ok = 1;

    for (end = line; (end = strchr(end, '\n')) != NULL; end++) lines++;
    out->rows = calloc(lines, sizeof *out->rows);
    for (; out->rows && ok && *line; line = end + 1) {
        r->line++;
        end = strchr(line, '\n');
        if (!end) {
            snprintf(out->note, sizeof out->note,
                     "%s:%d: the last line has no end and is left out. Resume the sweep, or end it", r->path, r->line);
            break;
        }
        *end = 0;
        if (end > line && end[-1] == '\r') end[-1] = 0;
        if (!header) {
            header = strdup(line);
            ok = header && read_header(r, line);
        } else if (strcmp(line, header) != 0) {
            ok = read_row(r, line, &out->rows[out->count]);
            out->count += ok;
        }
    }
    if (!out->rows || (r->line > 0 && !header && !out->note[0]))
        ok = frame_error(r->error, r->error_size, "%s: out of memory", r->path);
    free(header);
    return ok;
}

int csv_read(csv *out, const char *path, char *error, size_t error_size)
{
    reader r;
    int    ok;

    memset(out, 0, sizeof *out);
    memset(&r, 0, sizeof r);
    r.path = path;
    r.error = error;
    r.error_size = error_size;
    out->bytes = text_read(path, BYTES_MAX, "the CSV of a sweep", error, error_size);
    ok = out->bytes && read_lines(&r, out);
    if (ok && out->count == 0)
        ok = frame_error(error, error_size, "%s: nothing is measured in it%s. Run a sweep", path,
                         out->note[0] ? " but a torn line" : "");
    if (!ok) csv_free(out);
    return ok;
}

void csv_free(csv *table)
{
    free(table->bytes);
    free(table->rows);
    memset(table, 0, sizeof *table);
}
