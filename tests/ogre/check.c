/* check - do pictures of hbil-ogre show its room as it is lit by hbil.h, and the right way up? See run.sh.
 *
 *   check DIRECT.png COMPOSITE.png AO.png RECURSIVE.png
 *
 * The floor is asked in particular: it faces up, and no other large surface does. If the depth, the normals or the
 * projection alone are upside down, it is turned away from the eye, and its ao falls to nothing. */
#include <stdio.h>
#include <stdlib.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

enum { DIRECT, COMPOSITE, AO, RECURSIVE, PICTURES };

typedef struct picture { unsigned char *texels; int width, height; } picture;
typedef struct colour { double r, g, b; } colour;

static int failed;

/* Prints what was compared, as the numbers tell more than a verdict. */
static void above(const char *what, double larger, double smaller)
{
    const int ok = larger > smaller;

    printf("%-4s  %-58s %6.3f > %6.3f\n", ok ? "ok" : "FAIL", what, larger, smaller);
    failed |= !ok;
}

/* Mean of 5 x 5 pixels, 0 to 1. x, y: shares of width and height, from the upper left corner. */
static colour at(const picture *p, double x, double y)
{
    const int left = (int)(x * p->width) - 2, top = (int)(y * p->height) - 2;
    colour c = {0, 0, 0};
    int i;

    for (i = 0; i < 25; i++) {
        const unsigned char *t = p->texels + 3 * ((top + i / 5) * p->width + left + i % 5);
        c.r += t[0] / (25 * 255.0);
        c.g += t[1] / (25 * 255.0);
        c.b += t[2] / (25 * 255.0);
    }
    return c;
}

static double mean(const picture *p)
{
    double sum = 0;
    int i;

    for (i = 0; i < 3 * p->width * p->height; i++) sum += p->texels[i];
    return sum / (3 * 255.0 * p->width * p->height);
}

/* Share of the bytes of `lit` that are darker than those of `direct` by more than rounding. */
static double darker(const picture *lit, const picture *direct)
{
    int i, count = 0;

    for (i = 0; i < 3 * lit->width * lit->height; i++) count += lit->texels[i] + 1 < direct->texels[i];
    return count / (3.0 * lit->width * lit->height);
}

static void check(const picture *p)
{
    const colour sky = at(&p[AO], 0.70, 0.03), ceiling = at(&p[AO], 0.42, 0.10), floor = at(&p[AO], 0.45, 0.92);
    const colour contact = at(&p[AO], 0.45, 0.81);
    const colour left = at(&p[COMPOSITE], 0.22, 0.3), right = at(&p[COMPOSITE], 0.82, 0.3);
    const colour shade = at(&p[DIRECT], 0.42, 0.10), bounced = at(&p[COMPOSITE], 0.42, 0.10);
    const colour panel = at(&p[COMPOSITE], 0.685, 0.62);

    above("ao: sky above on the right is open", sky.r, 0.99);
    above("ao: open floor", floor.r, 0.45);
    above("ao: open floor, and where the ball touches it", floor.r, 1.5 * contact.r);
    above("ao: open floor, and the ceiling's corner", floor.r, 2 * ceiling.r);
    above("ao: not black", mean(&p[AO]), 0.3);
    above("ao: not white", 0.8, mean(&p[AO]));
    above("composite: left wall is red", left.r, 2 * left.g);
    above("composite: right wall is green", right.g, 1.5 * right.r);
    above("direct: the ceiling is in the dark", 0.01, shade.g);
    above("composite: and lit by the floor below", bounced.g, 0.3);
    above("composite: orange light of the panel on the wall beside it", panel.r, 1.2 * panel.b);
    above("composite: light is added", mean(&p[COMPOSITE]), mean(&p[DIRECT]) + 0.05);
    above("composite: and nowhere taken away", 0.001, darker(&p[COMPOSITE], &p[DIRECT]));
    above("recursive: more light after some frames", mean(&p[RECURSIVE]), mean(&p[COMPOSITE]) + 0.005);
}

int main(int argc, char **argv)
{
    picture pictures[PICTURES] = {{NULL, 0, 0}};
    int i, channels;

    if (argc != PICTURES + 1) {
        fputs("usage: check DIRECT.png COMPOSITE.png AO.png RECURSIVE.png\n", stderr);
        return 2;
    }
    for (i = 0; i < PICTURES; i++) {
        picture *p = &pictures[i];
        p->texels = stbi_load(argv[i + 1], &p->width, &p->height, &channels, 3);
        if (!p->texels || p->width != pictures[0].width || p->height != pictures[0].height || p->height < 64) {
            fprintf(stderr, "%s: is no PNG, too small, or of another size than the first\n", argv[i + 1]);
            failed = 1;
        }
    }
    if (!failed) check(pictures);
    for (i = 0; i < PICTURES; i++) stbi_image_free(pictures[i].texels);
    return failed;
}
