/* labels.h - where names stand beside their points in a picture. */
#ifndef HBIL_TRADEOFF_LABELS_H
#define HBIL_TRADEOFF_LABELS_H

typedef struct spot { double x, y; } spot; /* pixels, y up */

typedef struct label {
    const char *text;
    spot        of;            /* the point that it names */
    double      width, height; /* of the text */
    spot        middle;        /* of the text: what labels_place finds */
} label;

/* Beside its point, within [0, width] x [0, height], off other labels and off all points, as far as there is room. */
void labels_place(label *list, int count, const spot *points, int point_count, double width, double height);

#endif
