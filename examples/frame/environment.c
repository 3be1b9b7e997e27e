/* environment.c - the light behind what is visible: read, handed to a plan, and evaluated in double. */
#include "environment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "json.h"

#define NUMBERS_BYTES_MAX 65536        /* of a file of spherical harmonics */
#define PROBES_BYTES_MAX  (64u << 20)
#define PROBES_SIDE_MAX   256          /* probes along an axis: what every Vulkan device takes as a 3D texture */
#define SLABS_MAX         2048         /* slices of a 3D texture: what GL promises, and more devices than not have */
#define COARSE_SIZE       32           /* texels a side from which a cube map is blurred: 3 degrees, the lobe is 120 wide */
#define PI 3.14159265358979323846

#define Y0 0.28209479177387814 /* sqrt(1 / 4pi); orthonormal real spherical harmonics, Condon-Shortley phase left out */
#define Y1 0.48860251190291992 /* sqrt(3 / 4pi) */
#define Y2 1.09254843059207907 /* sqrt(15 / 4pi) */

void environment_free(environment *env)
{
    image_free(&env->cube);
    image_free(&env->probes);
    memset(env, 0, sizeof *env);
}

static int no_memory(char *error, size_t error_size)
{
    return frame_error(error, error_size, "out of memory for the environment. Give a smaller one");
}

/* ---- numbers ----------------------------------------------------------------------------------------------------- */

/* Finite numbers between commas or blanks, nothing else; the first `most` into out. How many there are, -1: something else. */
static int read_numbers(const char *p, float *out, int most)
{
    static const char *const blanks = " \t\r\n";
    char *end;
    int   count, comma = 0;

    for (count = 0; p += strspn(p, blanks), *p; count++) {
        const float value = strtof(p, &end);

        if (end == p || !isfinite(value)) return -1;
        if (count < most) out[count] = value;
        p = end + strspn(end, blanks);
        comma = *p == ',';
        p += comma;
    }
    return comma ? -1 : count;
}

static int parse_color(environment *out, const char *text, const char *numbers, char *error, size_t error_size)
{
    out->misuse = 1;
    if (read_numbers(numbers, out->color, 3) != 3 || out->color[0] < 0.0f || out->color[1] < 0.0f || out->color[2] < 0.0f)
        return frame_error(error, error_size, "--env %s: must be color: and three finite numbers, 0 or more: red, green and blue "
                           "of a radiance, as in color:0.4,0.5,0.7", text);
    out->kind = HBIL_ENVIRONMENT_CONSTANT;
    return 1;
}

/* L(d) = mix(ground, zenith, 0.5 + 0.5 d.z): the mean is in Y00, half of the difference in Y10. */
static int parse_sky(environment *out, const char *text, const char *numbers, char *error, size_t error_size)
{
    static const float captures[6] = {0.30f, 0.22f, 0.14f, 0.45f, 0.75f, 1.30f};
    float colors[6];
    int   c;

    out->misuse = 1;
    memcpy(colors, captures, sizeof colors);
    if (*numbers && read_numbers(numbers + 1, colors, 6) != 6)
        return frame_error(error, error_size, "--env %s: must be sky alone, or sky: and six finite numbers: red, green and blue "
                           "of the ground, then of the zenith", text);
    for (c = 0; c < 3; c++) {
        out->sh[0][c] = (float)(0.5 * ((double)colors[c] + (double)colors[3 + c]) / Y0);
        out->sh[2][c] = (float)(0.5 * ((double)colors[3 + c] - (double)colors[c]) / Y1);
    }
    out->kind = HBIL_ENVIRONMENT_SH;
    out->order = 1;
    out->captures_sky = memcmp(colors, captures, sizeof colors) == 0;
    return 1;
}

/* What stands behind "sh:" is a list of numbers if it looks like one, else the name of a file that holds one. */
static int parse_sh(environment *out, const char *text, const char *list, char *error, size_t error_size)
{
    const int named = list[strspn(list, "0123456789+-.eE, ")] != 0;
    char     *read = named ? text_read(list, NUMBERS_BYTES_MAX, "a text of 3, 12 or 27 numbers", error, error_size) : NULL;
    const int count = named && !read ? 0 : read_numbers(read ? read : list, out->sh[0], 27);

    free(read);
    out->misuse = !named;
    if (named && !read) return 0;
    if (count != 3 && count != 12 && count != 27)
        return frame_error(error, error_size, "%s%s: %s. Give 3, 12 or 27 finite numbers, separated by commas or blanks: red, "
                           "green and blue per coefficient, order 0, 1 or 2", named ? "" : "--env ", named ? list : text,
                           count < 0 ? "not only numbers" : count == 0 ? "holds none" : "holds another count of numbers");
    out->kind = HBIL_ENVIRONMENT_SH;
    out->order = count == 3 ? 0 : count == 12 ? 1 : 2;
    return 1;
}

/* ---- cube maps --------------------------------------------------------------------------------------------------- */

/* Direction through a point of a face, s and t in [-1, 1], as GL and Vulkan look up a cube map. Length 1 to sqrt(3). */
static void cube_direction(int face, double s, double t, double out[3])
{
    const double table[6][3] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t}, {s, -1, -t}, {s, -t, 1}, {-s, -t, -1}};

    memcpy(out, table[face], sizeof table[face]);
}

static void cube_point(const double d[3], int *face, double *s, double *t)
{
    const double x = fabs(d[0]), y = fabs(d[1]), z = fabs(d[2]), m = fmax(fmax(x, y), fmax(z, 1e-30));

    if (x >= y && x >= z) *face = d[0] < 0.0, *s = (*face ? d[2] : -d[2]) / m, *t = -d[1] / m;
    else if (y >= z) *face = 2 + (d[1] < 0.0), *s = d[0] / m, *t = (*face == 3 ? -d[2] : d[2]) / m;
    else *face = 4 + (d[2] < 0.0), *s = (*face == 5 ? -d[0] : d[0]) / m, *t = -d[1] / m;
}

/* Solid angle of the rectangle between the middle of a face and (s, t). sr */
static double corner_angle(double s, double t) { return atan2(s * t, sqrt(s * s + t * t + 1.0)); }

static double texel_angle(int x, int y, int size)
{
    const double s0 = 2.0 * x / size - 1.0, s1 = 2.0 * (x + 1) / size - 1.0;
    const double t0 = 2.0 * y / size - 1.0, t1 = 2.0 * (y + 1) / size - 1.0;

    return corner_angle(s1, t1) - corner_angle(s0, t1) - corner_angle(s1, t0) + corner_angle(s0, t0);
}

static float *cube_texel(const image *cube, int face, int x, int y)
{
    return cube->data + 3 * (((size_t)face * (size_t)cube->height + (size_t)y) * (size_t)cube->width + (size_t)x);
}

/* One texel of a cube map: unit direction of its middle, and its solid angle. */
typedef struct texel { double d[3], angle; } texel;

/* All texels of a cube map of this size in the order of its image. Caller frees. */
static texel *make_texels(int size)
{
    texel *texels = malloc((size_t)6 * (size_t)size * (size_t)size * sizeof *texels), *at = texels;
    int    face, x, y;

    for (face = 0; texels && face < 6; face++) {
        for (y = 0; y < size; y++) {
            for (x = 0; x < size; x++, at++) {
                const double s = (2.0 * x + 1.0) / size - 1.0, t = (2.0 * y + 1.0) / size - 1.0;
                const double length = sqrt(s * s + t * t + 1.0);

                cube_direction(face, s, t, at->d);
                at->d[0] /= length;
                at->d[1] /= length;
                at->d[2] /= length;
                at->angle = texel_angle(x, y, size);
            }
        }
    }
    return texels;
}

/* E/pi at a normal: the cosine-weighted mean, so that one colour everywhere stays that colour. */
static void sum_texels(const image *cube, const texel *texels, const double n[3], double rgb[3])
{
    const size_t count = 6 * (size_t)cube->width * (size_t)cube->width;
    double       weight = 0.0;
    size_t       i;

    rgb[0] = rgb[1] = rgb[2] = 0.0;
    for (i = 0; i < count; i++) {
        const double *d = texels[i].d, w = (d[0] * n[0] + d[1] * n[1] + d[2] * n[2]) * texels[i].angle;

        if (w <= 0.0) continue;
        weight += w;
        rgb[0] += w * (double)cube->data[3 * i];
        rgb[1] += w * (double)cube->data[3 * i + 1];
        rgb[2] += w * (double)cube->data[3 * i + 2];
    }
    rgb[0] /= weight;
    rgb[1] /= weight;
    rgb[2] /= weight;
}

/* The mean radiance of a larger cube map by solid angle, COARSE_SIZE texels a side; a smaller one as it is. */
static int make_coarse(const image *cube, image *out)
{
    const int size = cube->width < COARSE_SIZE ? cube->width : COARSE_SIZE;
    double   *sums = calloc((size_t)24 * (size_t)size * (size_t)size, sizeof *sums);
    size_t    i;
    int       face, x, y, c;

    if (!sums || !image_make_slices(out, size, size, 6, 3)) {
        free(sums);
        return 0;
    }
    for (face = 0; face < 6; face++) {
        for (y = 0; y < cube->width; y++) {
            for (x = 0; x < cube->width; x++) {
                const double angle = texel_angle(x, y, cube->width);
                const float *from = cube_texel(cube, face, x, y);
                double      *sum = sums + 4 * ((face * size + y * size / cube->width) * size + x * size / cube->width);

                for (c = 0; c < 3; c++) sum[c] += angle * (double)from[c];
                sum[3] += angle;
            }
        }
    }
    for (i = 0; i < (size_t)6 * (size_t)size * (size_t)size; i++)
        for (c = 0; c < 3; c++) out->data[3 * i + (size_t)c] = (float)(sums[4 * i + (size_t)c] / sums[4 * i + 3]);
    free(sums);
    return 1;
}

/* Radiance to E/pi. The lobe of a cosine is so wide that a few texels hold it. */
static int blur_cube(const image *cube, image *out)
{
    enum { SIZE = ENVIRONMENT_CUBE_SIZE };
    image   coarse = {0, 0, 0, NULL};
    texel  *from = NULL, *to = make_texels(SIZE);
    double  rgb[3];
    size_t  i;
    int     c, ok = to && make_coarse(cube, &coarse) && image_make_slices(out, SIZE, SIZE, 6, 3);

    if (ok) from = make_texels(coarse.width);
    for (i = 0; from && i < (size_t)6 * SIZE * SIZE; i++) {
        sum_texels(&coarse, from, to[i].d, rgb);
        for (c = 0; c < 3; c++) out->data[3 * i + (size_t)c] = (float)rgb[c];
    }
    ok = from != NULL;
    image_free(&coarse);
    free(from);
    free(to);
    if (!ok) image_free(out);
    return ok;
}

/* The six faces of a strip, one below the other in memory. */
static int parse_cube(environment *out, const char *path, char *error, size_t error_size)
{
    image_layer  layer = {"", "RGB", {0, 0, 0, NULL}, 1};
    const image *strip = &layer.pixels;
    size_t       i, count;
    int          size, beside, face, y, ok;

    if (!exr_read(path, &layer, 1, error, error_size)) return 0;
    beside = strip->width > strip->height;
    size = beside ? strip->height : strip->width;
    count = 3 * (size_t)strip->width * (size_t)strip->height;
    for (i = 0; i < count && isfinite(strip->data[i]); i++) { }
    if (strip->width * strip->height != 6 * size * size)
        ok = frame_error(error, error_size, "%s: size %dx%d is no strip of six square faces. Write a cube map of 6N x N or "
                         "N x 6N: +X -X +Y -Y +Z -Z", path, strip->width, strip->height);
    else if (i < count)
        ok = frame_error(error, error_size, "%s: holds NaN or infinity (pixel %lu, %lu). Write finite radiance", path,
                         (unsigned long)(i / 3 % (size_t)strip->width), (unsigned long)(i / 3 / (size_t)strip->width));
    else if (!image_make_slices(&out->cube, size, size, 6, 3))
        ok = no_memory(error, error_size);
    else {
        for (face = 0; face < 6; face++)
            for (y = 0; y < size; y++)
                memcpy(cube_texel(&out->cube, face, 0, y),
                       strip->data + 3 * (beside ? (size_t)y * (size_t)strip->width + (size_t)(face * size)
                                                 : (size_t)(face * size + y) * (size_t)size),
                       3 * (size_t)size * sizeof(float));
        out->kind = HBIL_ENVIRONMENT_CUBE;
        ok = 1;
    }
    image_free(&layer.pixels);
    return ok;
}

/* ---- probes ------------------------------------------------------------------------------------------------------ */

static int read_vector(const cJSON *root, const char *name, double out[3], const char *path, char *error, size_t error_size)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, name);

    return json_numbers(item, 3, out)
        || frame_error(error, error_size, "%s: \"%s\" is %s. It must be an array of 3 finite numbers", path, name,
                       item ? "not one" : "missing");
}

/* Size, place and order of the grid. */
static int read_grid(environment *out, const cJSON *root, const char *path, char *error, size_t error_size)
{
    double size[3], origin[3], step[3], order;
    int    a, fits = 1;

    if (!read_vector(root, "size", size, path, error, error_size) || !read_vector(root, "origin", origin, path, error, error_size)
        || !read_vector(root, "step", step, path, error, error_size)
        || !json_number(root, "order", &order, path, error, error_size)) return 0;
    for (a = 0; a < 3; a++) fits &= size[a] >= 1.0 && size[a] <= PROBES_SIDE_MAX && size[a] == floor(size[a]);
    if (!fits || 9.0 * size[2] > SLABS_MAX)
        return frame_error(error, error_size, "%s: \"size\" must be whole numbers, at least 1, at most %d %d %d", path,
                           PROBES_SIDE_MAX, PROBES_SIDE_MAX, SLABS_MAX / 9);
    /* inside what hbil.h takes, after rounding to float */
    for (a = 0; a < 3; a++) fits &= step[a] >= 1e-5 && step[a] <= 1e8 && fabs(origin[a]) <= 1e8;
    if (!fits)
        return frame_error(error, error_size, "%s: \"step\" must be in [1e-5, 1e8] and \"origin\" in [-1e8, 1e8] along each "
                           "axis, in metres", path);
    if (order != 0.0 && order != 1.0 && order != 2.0)
        return frame_error(error, error_size, "%s: \"order\" %g must be 0, 1 or 2", path, order);
    for (a = 0; a < 3; a++) {
        out->size[a] = (int)size[a];
        out->origin[a] = (float)origin[a];
        out->step[a] = (float)step[a];
    }
    out->order = (int)order;
    return 1;
}

static int read_probes(environment *out, const cJSON *root, const char *path, char *error, size_t error_size)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(root, "coefficients"), *probe, *item;
    const int    total = out->size[0] * out->size[1] * out->size[2], each = (out->order + 1) * (out->order + 1);
    double       rgb[3];
    int          i = 0, k, c;

    if (!cJSON_IsArray(list) || cJSON_GetArraySize(list) != total)
        return frame_error(error, error_size, "%s: \"coefficients\" holds %d probes. It must be an array of %d, as \"size\" says, "
                           "x fastest", path, cJSON_IsArray(list) ? cJSON_GetArraySize(list) : 0, total);
    if (!image_make_slices(&out->probes, out->size[0], out->size[1], 9 * out->size[2], 3)) return no_memory(error, error_size);
    cJSON_ArrayForEach(probe, list) {
        k = 0;
        if (cJSON_IsArray(probe)) {
            cJSON_ArrayForEach(item, probe) {
                if (k == each || !json_numbers(item, 3, rgb)) break;
                for (c = 0; c < 3; c++)
                    out->probes.data[3 * ((size_t)k * (size_t)total + (size_t)i) + (size_t)c] = (float)rgb[c];
                k++;
            }
        }
        if (k != each || cJSON_GetArraySize(probe) != each)
            return frame_error(error, error_size, "%s: probe %d of \"coefficients\" must be %d arrays of 3 finite numbers, as "
                               "\"order\" %d says", path, i, each, out->order);
        i++;
    }
    for (i = 0; i < 27 * total; i++)
        if (!isfinite(out->probes.data[i]))
            return frame_error(error, error_size, "%s: a coefficient is larger than a float holds. Use a smaller unit", path);
    out->kind = HBIL_ENVIRONMENT_PROBES;
    return 1;
}

static int parse_probes(environment *out, const char *path, char *error, size_t error_size)
{
    cJSON    *root = json_read(path, PROBES_BYTES_MAX, "the JSON of probes", error, error_size);
    const int ok = root && read_grid(out, root, path, error, error_size) && read_probes(out, root, path, error, error_size);

    cJSON_Delete(root);
    return ok;
}

/* ------------------------------------------------------------------------------------------------------------------ */

static int ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text), tail = strlen(end);

    return length > tail && strcmp(text + length - tail, end) == 0;
}

int environment_parse(environment *out, const char *text, char *error, size_t error_size)
{
    int ok, misuse;

    memset(out, 0, sizeof *out);
    if (strncmp(text, "color:", 6) == 0) ok = parse_color(out, text, text + 6, error, error_size);
    else if (strncmp(text, "sh:", 3) == 0) ok = parse_sh(out, text, text + 3, error, error_size);
    else if (strcmp(text, "sky") == 0 || strncmp(text, "sky:", 4) == 0) ok = parse_sky(out, text, text + 3, error, error_size);
    else if (ends_with(text, ".exr")) ok = parse_cube(out, text, error, error_size);
    else if (ends_with(text, ".json")) ok = parse_probes(out, text, error, error_size);
    else {
        out->misuse = 1;
        ok = frame_error(error, error_size, "--env %s: must be sky, sky:R,G,B,R,G,B, color:R,G,B, sh:NUMBERS, sh:FILE, CUBE.exr "
                         "or PROBES.json", text);
    }
    misuse = out->misuse && !ok;
    if (!ok) environment_free(out);
    out->misuse = misuse;
    return ok;
}

static int encode_image(const environment *env, const hbil_plan *plan, uint32_t index, image *out)
{
    const int    radiance = plan->config.far_visibility == HBIL_FAR_VISIBILITY_FREE_BITS;
    const int    slabs = plan->config.sh_order == 1 ? 4 : 9;
    const image *source = env->kind == HBIL_ENVIRONMENT_CUBE ? &env->cube : &env->probes;

    if (strcmp(plan->textures[index].name, "sky") == 0 && !radiance) return blur_cube(source, out);
    if (!image_make_slices(out, source->width, source->height,
                           source == &env->cube ? 6 : slabs * env->size[2], 3)) return 0;
    memcpy(out->data, source->data, 3 * (size_t)out->width * (size_t)out->height * (size_t)out->depth * sizeof(float));
    return 1;
}

int environment_encode(const environment *env, const hbil_plan *plan, hbil_frame *frame, image inputs[HBIL_MAX_TEXTURES],
                       char *error, size_t error_size)
{
    uint32_t i;

    memcpy(frame->far_color, env->color, sizeof frame->far_color);
    memcpy(frame->far_sh, env->sh, sizeof frame->far_sh);
    memcpy(frame->probe_origin, env->origin, sizeof frame->probe_origin);
    memcpy(frame->probe_step, env->step, sizeof frame->probe_step);
    for (i = 0; i < plan->texture_count; i++) {
        const int cube = strcmp(plan->textures[i].name, "sky") == 0, probes = strcmp(plan->textures[i].name, "probes") == 0;

        if (!cube && !probes) continue;
        if (env->kind != (cube ? HBIL_ENVIRONMENT_CUBE : HBIL_ENVIRONMENT_PROBES))
            return frame_error(error, error_size, "the config needs the input %s. Give it with --env %s", plan->textures[i].name,
                               cube ? "CUBE.exr" : "PROBES.json");
        if (!encode_image(env, plan, i, &inputs[i])) return no_memory(error, error_size);
    }
    return 1;
}

/* ---- in double --------------------------------------------------------------------------------------------------- */

environment environment_at(const environment *env, const double position[3])
{
    environment out = *env;
    double      cell[3], sum;
    size_t      low[3], high[3];
    int         a, k, c, corner;

    if (env->kind != HBIL_ENVIRONMENT_PROBES) return out;
    memset(&out, 0, sizeof out);
    out.kind = HBIL_ENVIRONMENT_SH;
    out.order = env->order;
    for (a = 0; a < 3; a++) {
        cell[a] = fmin(fmax((position[a] - (double)env->origin[a]) / (double)env->step[a], 0.0), env->size[a] - 1.0);
        low[a] = (size_t)cell[a];
        high[a] = low[a] + 1 < (size_t)env->size[a] ? low[a] + 1 : low[a];
        cell[a] -= (double)low[a];
    }
    for (k = 0; k < 9; k++) {
        for (c = 0; c < 3; c++) {
            for (corner = 0, sum = 0.0; corner < 8; corner++) {
                const size_t x = corner & 1 ? high[0] : low[0], y = corner & 2 ? high[1] : low[1];
                const size_t z = (corner & 4 ? high[2] : low[2]) + (size_t)(k * env->size[2]);
                const double w = (corner & 1 ? cell[0] : 1.0 - cell[0]) * (corner & 2 ? cell[1] : 1.0 - cell[1])
                               * (corner & 4 ? cell[2] : 1.0 - cell[2]);

                sum += w * (double)env->probes.data[3 * ((z * (size_t)env->size[1] + y) * (size_t)env->size[0] + x) + (size_t)c];
            }
            out.sh[k][c] = (float)sum;
        }
    }
    return out;
}

/* Each band at a unit direction, times a factor: 1 1 1 is radiance, 1 2/3 1/4 E/pi of an open surface (Ramamoorthi 2001). */
static void sum_sh(const float sh[9][3], const double d[3], double band1, double band2, double rgb[3])
{
    const double x = d[0], y = d[1], z = d[2];
    const double basis[9] = {Y0, band1 * Y1 * y, band1 * Y1 * z, band1 * Y1 * x, band2 * Y2 * x * y, band2 * Y2 * y * z,
                             band2 * Y2 / sqrt(12.0) * (3.0 * z * z - 1.0), band2 * Y2 * x * z,
                             band2 * 0.5 * Y2 * (x * x - y * y)};
    int k, c;

    for (c = 0; c < 3; c++)
        for (k = 0, rgb[c] = 0.0; k < 9; k++) rgb[c] += basis[k] * (double)sh[k][c];
}

static void read_cube(const image *cube, const double d[3], double rgb[3])
{
    const int size = cube->width;
    double    s, t, x, y;
    int       face, x0, y0, x1, y1, c;

    cube_point(d, &face, &s, &t);
    x = fmin(fmax(0.5 * (s + 1.0) * size - 0.5, 0.0), size - 1.0);
    y = fmin(fmax(0.5 * (t + 1.0) * size - 0.5, 0.0), size - 1.0);
    x0 = (int)x, y0 = (int)y;
    x1 = x0 + 1 < size ? x0 + 1 : x0, y1 = y0 + 1 < size ? y0 + 1 : y0;
    x -= x0, y -= y0;
    for (c = 0; c < 3; c++) {
        const double a = (double)cube_texel(cube, face, x0, y0)[c], b = (double)cube_texel(cube, face, x1, y0)[c];
        const double d0 = (double)cube_texel(cube, face, x0, y1)[c], d1 = (double)cube_texel(cube, face, x1, y1)[c];

        rgb[c] = (1.0 - y) * ((1.0 - x) * a + x * b) + y * ((1.0 - x) * d0 + x * d1);
    }
}

void environment_radiance(const environment *env, const double direction[3], double rgb[3])
{
    const double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    const double d[3] = {direction[0] / length, direction[1] / length, direction[2] / length};
    int c;

    for (c = 0; c < 3; c++) rgb[c] = (double)env->color[c]; /* 0 but for CONSTANT */
    if (env->kind == HBIL_ENVIRONMENT_SH) sum_sh(env->sh, d, 1.0, 1.0, rgb);
    if (env->kind == HBIL_ENVIRONMENT_CUBE) read_cube(&env->cube, d, rgb);
}

void environment_view_radiance(const void *data, const double direction[3], double rgb[3])
{
    const environment_view *v = data;
    double                  world[3];
    int                     c;

    for (c = 0; c < 3; ++c) { /* columns of a rotation are rows of its inverse */
        const float *m = v->view + 4 * c;
        world[c] = (double)m[0] * direction[0] + (double)m[1] * direction[1] + (double)m[2] * direction[2];
    }
    environment_radiance(v->light, world, rgb);
}

void environment_irradiance(const environment *env, const double normal[3], double rgb[3])
{
    int c;

    for (c = 0; c < 3; c++) rgb[c] = (double)env->color[c];
    if (env->kind == HBIL_ENVIRONMENT_SH) sum_sh(env->sh, normal, 2.0 / 3.0, 0.25, rgb);
    if (env->kind == HBIL_ENVIRONMENT_CUBE) {
        texel *texels = make_texels(env->cube.width);

        if (texels) sum_texels(&env->cube, texels, normal, rgb);
        free(texels);
    }
}
