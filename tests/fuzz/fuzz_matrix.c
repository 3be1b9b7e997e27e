/* fuzz_matrix.c - files of shadergen matrix, byte 0 says which: 'm' the lists of values, else the state of an earlier run. */
#include "fuzz.h"

#include "../../shadergen/matrix_state.c"

static void free_all(matrix_job *m)
{
    variants_free(&m->list);
    variants_free(&m->old);
    map_free(&m->old_index);
    map_free(&m->slot_index);
    free(m->slots);
}

static void read_lists(matrix_job *m)
{
    int32_t i;
    int code = list_read(m);
    FUZZ_REQUIRE(code == DONE || code == CONFIG);
    for (i = 0; i < m->list.count; ++i)
        FUZZ_REQUIRE((m->list.items[i].refused != NULL) == (m->list.items[i].hash == 0));
}

/* As state_read, with a key that any line may have; then as state_remove_old. */
static void read_state(matrix_job *m, char *text)
{
    char *copy = strdup(text), *line, *end;
    map wanted = { NULL, NULL, 0, 0 };
    int32_t i, k;
    m->key = 1;
    for (line = copy; line && (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = 0;
        FUZZ_REQUIRE(read_line(m, line));
    }
    for (i = 0; i < m->old.count; ++i)
        for (k = 0; k < m->old.items[i].count; ++k) {
            const slot *s = &m->slots[m->old.items[i].slots[k]];
            FUZZ_REQUIRE(m->old.items[i].slots[k] < m->slot_count && memchr(s->file, 0, sizeof s->file) && is_ours(s->file));
        }
    m->check = 1;
    FUZZ_REQUIRE(wanted_files(m, &wanted) && remove_named(m, text, &wanted));
    map_free(&wanted);
    free(copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int ready;
    matrix_job m;
    char *text;
    if (!ready) {
        fuzz_enter_folder();
        ready = 1;
    }
    if (!size || !(text = (char *)malloc(size))) return 0;
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    memset(&m, 0, sizeof m);
    m.spirv = m.quiet = 1;
    m.file = "lists";
    m.folder = "";
    if (*data == 'm') {
        fuzz_write("lists", text, size - 1);
        read_lists(&m);
    } else {
        read_state(&m, text);
    }
    free_all(&m);
    free(text);
    return 0;
}
