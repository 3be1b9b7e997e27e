/* check.c - asserts numbers of PNG pictures, for run.sh.
 *
 * viewer-check mean A.png LOW HIGH mean of all channels, 0 to 255 viewer-check spread A.png LOW HIGH their
 * standard deviation viewer-check differ A.png B.png LOW HIGH mean absolute difference
 *
 * exit: 0 LOW <= number <= HIGH; 1 not, and the number is printed; 2 usage; 3 a picture cannot be read, or sizes
 * differ. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

typedef struct picture { unsigned char *data; int width, height; } picture;

static int load(const char *path, picture *out)
{
    int channels;

    out->data = stbi_load(path, &out->width, &out->height, &channels, 3);
    if (!out->data) fprintf(stderr, "viewer-check: %s: %s\n", path, stbi_failure_reason());
    return out->data != NULL;
}

static double mean(const picture *p, double power, double from)
{
    const size_t count = (size_t)p->width * (size_t)p->height * 3;
    double       sum = 0.0;
    size_t       i;

    for (i = 0; i < count; i++) sum += pow((double)p->data[i] - from, power);
    return sum / (double)count;
}

static double difference(const picture *a, const picture *b)
{
    const size_t count = (size_t)a->width * (size_t)a->height * 3;
    double       sum = 0.0;
    size_t       i;

    for (i = 0; i < count; i++) sum += abs((int)a->data[i] - (int)b->data[i]);
    return sum / (double)count;
}

int main(int argc, char **argv)
{
    const int differ = argc == 6 && strcmp(argv[1], "differ") == 0;
    const int spread = argc == 5 && strcmp(argv[1], "spread") == 0;
    double    number, low, high;
    picture   a = {NULL, 0, 0}, b = {NULL, 0, 0};

    if (!differ && !spread && !(argc == 5 && strcmp(argv[1], "mean") == 0)) {
        fputs("usage: viewer-check mean|spread A.png LOW HIGH, or differ A.png B.png LOW HIGH\n", stderr);
        return 2;
    }
    if (!load(argv[2], &a) || (differ && !load(argv[3], &b))) return 3;
    if (differ && (a.width != b.width || a.height != b.height)) {
        fprintf(stderr, "viewer-check: %s and %s differ in size\n", argv[2], argv[3]);
        return 3;
    }
    number = differ ? difference(&a, &b) : spread ? sqrt(mean(&a, 2.0, mean(&a, 1.0, 0.0))) : mean(&a, 1.0, 0.0);
    low = strtod(argv[argc - 2], NULL);
    high = strtod(argv[argc - 1], NULL);
    stbi_image_free(a.data);
    stbi_image_free(b.data);
    if (number >= low && number <= high) return 0;
    printf("%s %s%s%s is %.3f, not in [%g, %g]\n", argv[1], argv[2], differ ? " " : "", differ ? argv[3] : "", number,
           low, high);
    return 1;
}
