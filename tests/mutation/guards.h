/* guards.h - the guards of the shaders, found in their sources: what keeps a number, an index or a loop in its range. */
#ifndef HBIL_MUTATION_GUARDS_H
#define HBIL_MUTATION_GUARDS_H

#include <stddef.h>

/* One guard, and the text without it. Lines are whole and as they stand in the source: emitted text has the same ones. */
typedef struct guard {
    char  id[96];       /* "slice.glsl:hbil_border:max#1": file, chunk, kind, number within those */
    char  file[24], chunk[40];
    int   line;         /* of the file, from 1 */
    char  code[320];    /* what is replaced, blanks folded */
    char  without[320]; /* by what */
    char *find, *put;   /* lines of the chunk, and what they become */
} guard;

typedef struct guard_list { guard *at; int count, room; } guard_list;

/* All guards of the .glsl files of a folder, by file name. 1, or 0: error[] says why. Free with guards_free. */
int  guards_read(const char *folder, guard_list *out, char *error, size_t size);
void guards_free(guard_list *list);

/* `text`, as emitted, without a guard. out: at least as long as text + 1024 bytes. Returns how many places were changed: 0 where the
 * guard is not in this text. */
int  guard_remove(const guard *g, const char *text, char *out);

#endif
