/* marginals.c - see marginals.h. */
#include "marginals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../hbil.h"

#define CONFIG_BYTES 4096
#define SEPARATORS   " ,"

/* A config and what of it is the same in all that it may be compared with. */
typedef struct member { const point *point; char *rest; int value, second; } member;

/* ---- config texts ------------------------------------------------------------------------------------------------ */

/* Finds name=value. The length of the value; -1: it is not there. */
static int find_value(const char *config, const char *option, const char **value)
{
    const size_t length = strlen(option);

    for (; *config; config += strcspn(config, SEPARATORS)) {
        config += strspn(config, SEPARATORS);
        if (strncmp(config, option, length) != 0 || config[length] != '=') continue;
        *value = config + length + 1;
        return (int)strcspn(*value, SEPARATORS);
    }
    return -1;
}

void config_value(const char *config, const char *option, char out[MARGINAL_TEXT])
{
    const char *value = "default";
    char        text[CONFIG_BYTES] = "";
    hbil_config defaults;
    int         length = find_value(config, option, &value);

    if (length < 0) {
        memset(&defaults, 0, sizeof defaults);
        if (hbil_config_print(&defaults, 1, text, sizeof text, NULL) == HBIL_OK)
            length = find_value(text, option, &value);
    }
    snprintf(out, MARGINAL_TEXT, "%.*s", length < 0 ? (int)strlen(value) : length, value);
}

/* The config without one or two options. Values that are spelt out though they are the default are none of a sweep.
 * Caller frees. */
static char *rest_of(const char *config, const char *option, const char *second)
{
    char *out = malloc(strlen(config) + 2), *end = out;

    while (out && *config) {
        size_t length, name;

        config += strspn(config, SEPARATORS);
        length = strcspn(config, SEPARATORS);
        name = strcspn(config, "=");
        if (length > 0 && !(name == strlen(option) && strncmp(config, option, name) == 0)
            && !(second && name == strlen(second) && strncmp(config, second, name) == 0)) {
            memcpy(end, config, length);
            end += length;
            *end++ = ' ';
        }
        config += length;
    }
    if (out) *end = 0;
    return out;
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

/* Where a value stands: a choice in the order of hbil.h, a number by its size; other words behind them. */
static double rank_of(const char *option, const char *value)
{
    const int32_t index = hbil_option_find(option, strlen(option), NULL);
    const size_t  length = strlen(value);
    const char   *choice = index >= 0 && hbil_option_at(index)->choices ? hbil_option_at(index)->choices : "";
    char         *end;
    double        number;
    int           rank;

    for (rank = 0; *choice; rank++) {
        const size_t size = strcspn(choice, " ");

        if (size == length && strncmp(choice, value, size) == 0) return rank;
        choice += size + (choice[size] != 0);
    }
    number = strtod(value, &end);
    return *value && !*end ? number : HUGE_VAL;
}

static int value_index(char (*values)[MARGINAL_TEXT], int count, const char *value)
{
    int i;

    for (i = 0; i < count; i++)
        if (strcmp(values[i], value) == 0) return i;
    return -1;
}

/* The values of an option over all configs, in order. How many; MARGINAL_VALUES + 1: too many. */
static int list_values(const points *p, const char *option, char (*values)[MARGINAL_TEXT])
{
    char value[MARGINAL_TEXT];
    int  i, at, count = 0;

    for (i = 0; i < p->count; i++) {
        if (row_is_external(p->list[i].row)) continue; /* it has no options */
        config_value(p->list[i].row->text[CSV_config], option, value);
        if (value_index(values, count, value) >= 0) continue;
        if (count == MARGINAL_VALUES) return MARGINAL_VALUES + 1;
        for (at = count++; at > 0 && rank_of(option, values[at - 1]) > rank_of(option, value); at--)
            memcpy(values[at], values[at - 1], sizeof value);
        memcpy(values[at], value, sizeof value);
    }
    return count;
}

/* ---- groups ------------------------------------------------------------------------------------------------------ */

static int by_rest(const void *a, const void *b)
{
    return strcmp(((const member *)a)->rest, ((const member *)b)->rest);
}

static void members_free(member *list, int count)
{
    int i;

    for (i = 0; list && i < count; i++) free(list[i].rest);
    free(list);
}

/* All configs, those that differ in nothing but the option, or both options, next to each other. NULL: no memory. */
static member *members_make(const points *p, const char *option, char (*values)[MARGINAL_TEXT], int value_count,
                            const char *second, char (*second_values)[MARGINAL_TEXT], int second_count)
{
    member *list = calloc((size_t)p->count, sizeof *list);
    char    value[MARGINAL_TEXT];
    int     i;

    for (i = 0; list && i < p->count; i++) {
        const char *config = p->list[i].row->text[CSV_config];

        list[i].point = &p->list[i];
        list[i].rest = rest_of(config, option, second);
        if (!list[i].rest) {
            members_free(list, i);
            return NULL;
        }
        config_value(config, option, value);
        list[i].value = value_index(values, value_count, value);
        if (!second) continue;
        config_value(config, second, value);
        list[i].second = value_index(second_values, second_count, value);
    }
    if (list) qsort(list, (size_t)p->count, sizeof *list, by_rest);
    return list;
}

static int group_end(const member *list, int count, int begin)
{
    int end = begin + 1;

    while (end < count && strcmp(list[begin].rest, list[end].rest) == 0) end++;
    return end;
}

/* ---- one option -------------------------------------------------------------------------------------------------- */

/* Sums of logarithms of ratios over all pairs of a value and an earlier one. */
typedef struct links { double error[MARGINAL_VALUES][MARGINAL_VALUES], ms[MARGINAL_VALUES][MARGINAL_VALUES];
                       int pairs[MARGINAL_VALUES][MARGINAL_VALUES]; } links;

static void add_group(links *l, const member *list, int begin, int end)
{
    int i, j;

    for (i = begin; i < end; i++) {
        for (j = begin; j < end; j++) {
            const member *a = &list[i], *b = &list[j];

            if (a->value >= b->value || !(a->point->error > 0.0) || !(b->point->error > 0.0)) continue;
            l->error[a->value][b->value] += log(b->point->error / a->point->error);
            l->ms[a->value][b->value] += log(b->point->ms / a->point->ms);
            l->pairs[a->value][b->value]++;
        }
    }
}

static void chain(marginal *m, const links *l)
{
    int i, j, base = -1;

    for (i = 0; i < m->values; i++) {
        m->error[i] = m->ms[i] = (double)NAN;
        for (j = i - 1; j >= 0; j--) {
            if (l->pairs[j][i] == 0 || (base >= 0 && isnan(m->error[j]))) continue;
            if (base < 0) m->error[base = j] = m->ms[j] = 1.0;
            m->error[i] = m->error[j] * exp(l->error[j][i] / l->pairs[j][i]);
            m->ms[i] = m->ms[j] * exp(l->ms[j][i] / l->pairs[j][i]);
            m->pairs[i] = l->pairs[j][i];
            break;
        }
    }
}

/* 1, 0: no two values can be compared, -1: no memory. */
static int fill(marginal *m, const points *p, const char *option)
{
    member *list;
    links  *l;
    int     begin, end, i, any = 0;

    memset(m, 0, sizeof *m);
    m->values = list_values(p, option, m->value);
    if (m->values < 2 || m->values > MARGINAL_VALUES) return 0;
    snprintf(m->option, sizeof m->option, "%s", option);
    list = members_make(p, option, m->value, m->values, NULL, NULL, 0);
    l = calloc(1, sizeof *l);
    for (begin = 0; list && l && begin < p->count; begin = end) {
        end = group_end(list, p->count, begin);
        add_group(l, list, begin, end);
    }
    if (list && l) chain(m, l);
    for (i = 0; i < m->values; i++) any |= m->pairs[i] > 0;
    if (!list || !l) any = -1;
    members_free(list, p->count);
    free(l);
    return any;
}

marginal *marginals_make(const points *p, int *count)
{
    const int options = (int)hbil_option_count();
    marginal *list = calloc((size_t)options, sizeof *list);
    int       i, made;

    *count = list ? 0 : -1;
    for (i = 0; list && i < options; i++) {
        made = fill(&list[*count], p, hbil_option_at(i)->name);
        if (made < 0) *count = -1;
        if (made < 0) break;
        *count += made;
    }
    if (*count > 0) return list;
    free(list);
    return NULL;
}

/* ---- slices x steps ---------------------------------------------------------------------------------------------- */

/* Has the group more than one member in this column, or row? */
static int is_line(const member *list, int begin, int end, int column, int row)
{
    int i, count = 0;

    for (i = begin; i < end; i++) count += column < 0 ? list[i].second == row : list[i].value == column;
    return count > 1;
}

/* The grid of one group, without rows and columns of less than two. */
static void fill_grid(grid *out, const member *list, int begin, int end, char (*slices)[MARGINAL_TEXT],
                      char (*steps)[MARGINAL_TEXT])
{
    int column[MARGINAL_VALUES], row[MARGINAL_VALUES], i, k;

    memset(out, 0, sizeof *out);
    for (k = 0; k < MARGINAL_VALUES; k++) {
        column[k] = row[k] = -1;
        for (i = begin; i < end; i++) {
            if (list[i].value == k && column[k] < 0 && is_line(list, begin, end, k, -1))
                out->slices[column[k] = out->columns++] = strtod(slices[k], NULL);
            if (list[i].second == k && row[k] < 0 && is_line(list, begin, end, -1, k))
                out->steps[row[k] = out->rows++] = strtod(steps[k], NULL);
        }
    }
    for (i = begin; i < end; i++)
        if (list[i].value >= 0 && list[i].second >= 0 && column[list[i].value] >= 0 && row[list[i].second] >= 0)
            out->cell[row[list[i].second]][column[list[i].value]] = list[i].point;
}

int grid_make(grid *out, const points *p)
{
    char    slices[MARGINAL_VALUES][MARGINAL_TEXT], steps[MARGINAL_VALUES][MARGINAL_TEXT];
    const int columns = list_values(p, "slices", slices), rows = list_values(p, "steps", steps);
    member *list;
    grid    one;
    int     begin, end, most = 0;

    memset(out, 0, sizeof *out);
    if (columns > MARGINAL_VALUES || rows > MARGINAL_VALUES) return 1;
    list = members_make(p, "slices", slices, columns, "steps", steps, rows);
    if (!list) return 0;
    for (begin = 0; begin < p->count; begin = end) {
        end = group_end(list, p->count, begin);
        if (end - begin <= most) continue;
        fill_grid(&one, list, begin, end, slices, steps);
        if (one.columns < 2 || one.rows < 2) continue;
        most = end - begin;
        *out = one;
    }
    members_free(list, p->count);
    return 1;
}
