/* matrix.h - test values of every option, and a pairwise matrix of configs, both made from the option table.
 * Include after test.h. Deterministic: the same table gives the same matrix. */
#ifndef HBIL_TEST_MATRIX_H
#define HBIL_TEST_MATRIX_H

#include <stdio.h>
#include <string.h>

#define MATRIX_OPTIONS 64
#define MATRIX_VALUES  24
#define MATRIX_ROWS    512

typedef char matrix_text[128];

/* Contexts in which options that need another one are alive. */
static const char *const matrix_contexts[] = { "", "reach=2", "depth=device", "projection=orthographic", "width=64 height=64",
    "outputs=far environment=sh", "outputs=far environment=sh far_visibility=cone", "outputs=far environment=sh estimator=bitmask",
    "outputs=far environment=sh estimator=bitmask far_visibility=free_bits", "outputs=far environment=cube far_visibility=ao",
    "outputs=cone", "outputs=ao+multi_bounce", "outputs=specular_occlusion", "outputs=specular_occlusion roughness=0.3",
    "outputs=ao estimator=hbao reach=2", "outputs=ao estimator=hbao_plus", "occluder=thick estimator=bitmask", "occluder=heuristic",
    "march=sweep slices=4", "march=sweep slices=4 facing=filter outputs=sh+near", "march=both estimator=bitmask reach=2",
    "multisample=yes", "filter=3x3", "temporal=yes", "bounces=recursive", "reach=2 firefly=5 outputs=near+specular_occlusion roughness=0.3" };

/* Legal values of an option as text: choices; members, all, none; ends, default and whole numbers with text of their own. */
static inline int matrix_values(int32_t option, matrix_text out[MATRIX_VALUES])
{
    static const double numbers[] = { 1, 2, 2.5, 640 };
    const hbil_option *o = hbil_option_at(option);
    char list[512];
    char *word;
    int n = 0;
    size_t i;
    strcpy(out[n++], "default");
    if (!*o->choices) {
        snprintf(out[n++], sizeof out[0], "%.9g", o->min);
        snprintf(out[n++], sizeof out[0], "%.9g", o->max);
        for (i = 0; i < sizeof numbers / sizeof numbers[0]; ++i)
            if (numbers[i] > o->min && numbers[i] < o->max && (o->kind == HBIL_KIND_FLOAT || numbers[i] == (double)(int)numbers[i]))
                snprintf(out[n++], sizeof out[0], "%.9g", numbers[i]);
        return n;
    }
    strcpy(list, o->choices);
    for (word = strtok(list, " "); word; word = strtok(NULL, " ")) {
        assert_true(n < MATRIX_VALUES - 1);
        strcpy(out[n++], word);
    }
    if (o->kind == HBIL_KIND_SET && n > 2) { /* all members at once */
        char *all = list;
        strcpy(list, o->choices);
        for (; *all; ++all) if (*all == ' ') *all = '+';
        if (strlen(list) < sizeof out[0]) strcpy(out[n++], list);
    }
    return n;
}

/* Combinations that the library refuses by design are moved to legal ones, by the fixes that its errors name. */
static inline void matrix_repair(hbil_config *c)
{
    hbil_diag items[16];
    int round, i;
    if (!c->width != !c->height) c->width = c->height = c->width ? c->width : c->height;
    if (c->reach == 0) c->dynamic &= ~(uint32_t)HBIL_DYNAMIC_REACH; /* 0 stands for a shader without it */
    if (c->firefly == 0) c->dynamic &= ~(uint32_t)HBIL_DYNAMIC_FIREFLY;
    if (c->roughness == 0) c->dynamic &= ~(uint32_t)HBIL_DYNAMIC_ROUGHNESS;
    for (round = 0; round < 16; ++round) {
        hbil_diags diags = { items, 16, 0 };
        hbil_config resolved;
        if (hbil_config_resolve(c, &resolved, &diags) == HBIL_OK) return;
        for (i = 0; i < diags.count && i < diags.capacity; ++i) {
            const char *fix = strstr(items[i].text, "; set ");
            if (items[i].severity != HBIL_ERROR) continue;
            assert_non_null(fix);
            assert_int_equal(hbil_config_parse(c, fix + 6, strlen(fix + 6), NULL), HBIL_OK);
            break;
        }
    }
}

typedef struct matrix_state {
    int         options, values[MATRIX_OPTIONS];
    matrix_text text[MATRIX_OPTIONS][MATRIX_VALUES];
    char        covered[MATRIX_OPTIONS][MATRIX_VALUES][MATRIX_OPTIONS][MATRIX_VALUES];
} matrix_state;

static inline int matrix_gain(const matrix_state *m, const int *row, int option, int value)
{
    int other, gain = 0;
    for (other = 0; other < m->options; ++other)
        if (row[other] >= 0 && other != option && !m->covered[option][value][other][row[other]]) ++gain;
    return gain;
}

/* One row: starts from a pair that is not covered yet, then takes for each option the value that covers most. */
static inline int matrix_row(matrix_state *m, int *row)
{
    int a, b, x, y, found = 0;
    for (a = 0; a < m->options; ++a) row[a] = -1;
    for (a = 0; a < m->options && !found; ++a)
        for (b = a + 1; b < m->options && !found; ++b)
            for (x = 0; x < m->values[a] && !found; ++x)
                for (y = 0; y < m->values[b] && !found; ++y)
                    if (!m->covered[a][x][b][y]) { row[a] = x; row[b] = y; found = 1; }
    if (!found) return 0;
    for (a = 0; a < m->options; ++a) {
        int best = 0;
        if (row[a] >= 0) continue;
        for (x = 1; x < m->values[a]; ++x) if (matrix_gain(m, row, a, x) > matrix_gain(m, row, a, best)) best = x;
        row[a] = best;
    }
    for (a = 0; a < m->options; ++a)
        for (b = 0; b < m->options; ++b) m->covered[a][row[a]][b][row[b]] = 1;
    return 1;
}

/* Configs in which every two values of every two options meet. Returns their number. */
static inline int matrix_pairwise(hbil_config out[MATRIX_ROWS])
{
    static matrix_state m;
    int row[MATRIX_OPTIONS], a, n = 0;
    memset(&m, 0, sizeof m);
    m.options = hbil_option_count();
    assert_true(m.options <= MATRIX_OPTIONS);
    for (a = 0; a < m.options; ++a) m.values[a] = matrix_values(a, m.text[a]);
    while (matrix_row(&m, row)) {
        hbil_config *c = &out[n++];
        assert_true(n < MATRIX_ROWS);
        memset(c, 0, sizeof *c);
        for (a = 0; a < m.options; ++a) {
            hbil_result result = hbil_config_set(c, hbil_option_at(a)->name, m.text[a][row[a]], NULL);
            assert_true(result == HBIL_OK);
        }
        matrix_repair(c);
    }
    return n;
}

/* What each config has, as the numbers of "name=value". */
typedef struct matrix_words {
    char           words[1024][256];
    int            count;
    unsigned short of[MATRIX_ROWS][MATRIX_OPTIONS];
} matrix_words;

static inline void matrix_read_words(matrix_words *m, const hbil_config *c, unsigned short of[MATRIX_OPTIONS])
{
    hbil_config resolved; /* what is of no use is a default there */
    char text[4096], *word;
    int i, n = 0;
    assert_int_equal(hbil_config_resolve(c, &resolved, NULL), HBIL_OK);
    assert_int_equal(hbil_config_print(&resolved, 1, text, sizeof text, NULL), HBIL_OK);
    for (word = strtok(text, " \n"); word; word = strtok(NULL, " \n")) {
        assert_true(n < MATRIX_OPTIONS && strlen(word) < sizeof m->words[0]);
        for (i = 0; i < m->count && strcmp(m->words[i], word); ++i) { }
        assert_true(i < 1024);
        if (i == m->count) strcpy(m->words[m->count++], word);
        of[n++] = (unsigned short)i;
    }
    assert_int_equal(n, hbil_option_count());
}

/* Moves a few configs to the front in which every value is there that any of them has where it is of use. Returns their number. */
static inline int matrix_cover(hbil_config *configs, int count)
{
    static matrix_words m;
    char seen[1024];
    int n, k, i;
    memset(&m, 0, sizeof m);
    memset(seen, 0, sizeof seen);
    for (k = 0; k < count; ++k) matrix_read_words(&m, &configs[k], m.of[k]);
    for (n = 0; n < count; ++n) {
        int best = n, most = 0;
        hbil_config taken;
        for (k = n; k < count; ++k) {
            int fresh = 0;
            for (i = 0; i < hbil_option_count(); ++i) fresh += !seen[m.of[k][i]];
            if (fresh > most) best = k, most = fresh;
        }
        if (!most) return n;
        for (i = 0; i < hbil_option_count(); ++i) seen[m.of[best][i]] = 1;
        taken = configs[best];
        configs[best] = configs[n];
        configs[n] = taken;
        memcpy(m.of[best], m.of[n], sizeof m.of[n]);
    }
    return n;
}

/* Every value of every option in every context: what pairs alone do not reach. Returns their number; configs that are equal once
 * resolved are given once. */
static inline int matrix_in_contexts(hbil_config *out, int most)
{
    size_t k;
    int32_t i;
    int n = 0, v, j;
    for (k = 0; k < sizeof matrix_contexts / sizeof matrix_contexts[0]; ++k)
        for (i = 0; i < hbil_option_count(); ++i) {
            matrix_text values[MATRIX_VALUES];
            int count = matrix_values(i, values);
            for (v = 0; v < count; ++v) {
                hbil_config c, resolved;
                memset(&c, 0, sizeof c);
                hbil_config_parse(&c, matrix_contexts[k], strlen(matrix_contexts[k]), NULL);
                hbil_config_set(&c, hbil_option_at(i)->name, values[v], NULL);
                matrix_repair(&c);
                if (hbil_config_resolve(&c, &resolved, NULL) != HBIL_OK) continue;
                for (j = 0; j < n && memcmp(&out[j], &resolved, sizeof resolved); ++j) { }
                assert_true(j < most);
                out[j] = resolved;
                n += j == n;
            }
        }
    return n;
}

#endif
