/* overlay.h - lines of text as triangles. */
#ifndef HBIL_VIEWER_OVERLAY_H
#define HBIL_VIEWER_OVERLAY_H

/* Corners (x y in pixels, grey) of text with a dark edge, its top left at (x, y); a line is 12 * scale pixels
 * high. At most max corners; their number. */
int overlay_text(float *corners, int max, const char *text, float x, float y, float scale);

#endif
