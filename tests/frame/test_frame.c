/* test_frame.c - the frame library and hbil-frame: files, conventions, metrics, the built-in scene, exit codes.
 * The group that runs the program needs its path in the environment variable HBIL_FRAME_BIN. */
#include <math.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cJSON.h>
#include <openexr.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../../examples/frame/capture.h"
#include "../../examples/frame/environment.h"
#include "../../examples/frame/metric.h"
#include "../../examples/frame/sequence.h"
#include "../captures.h"

#define COUNT(a) (sizeof(a) / sizeof *(a))
#define W 21 /* of the test frame: odd, and not a multiple of any block */
#define H 37 /* three ZIP blocks of 16 lines, the last one cut */

static char folder[] = "test_frame_XXXXXX"; /* in the working folder, removed at the end */
static char error[1024];

/* A path in the folder; lives until the fourth call after it. */
static const char *at(const char *name)
{
    static char paths[4][128];
    static int  next;
    char       *path = paths[next = (next + 1) % 4];

    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    char command[64];

    (void)state;
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command) == 0 ? 0 : -1;
}

static void assert_error_has(const char *part)
{
    if (!strstr(error, part)) fail_msg("error \"%s\" does not say \"%s\"", error, part);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static image make_image(int width, int height, int channels)
{
    image  img;
    size_t i;

    assert_true(image_make(&img, width, height, channels));
    for (i = 0; i < (size_t)(width * height * channels); i++) img.data[i] = (float)i * 0.37f - 11.0f;
    return img;
}

static unsigned char *read_bytes(const char *path, size_t *size)
{
    FILE          *file = fopen(path, "rb");
    unsigned char *bytes;

    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = 0;
    fclose(file);
    return bytes;
}

static void write_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");

    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* depth.Z, normal.XYZ and a layer that is absent, as x.exr. */
static void write_sample(image_layer layers[3])
{
    const image none = {0, 0, 0, NULL};

    layers[0].layer = "depth", layers[0].channels = "Z", layers[0].pixels = make_image(W, H, 1), layers[0].required = 1;
    layers[1].layer = "normal", layers[1].channels = "XYZ", layers[1].pixels = make_image(W, H, 3), layers[1].required = 1;
    layers[2].layer = "near", layers[2].channels = "RGB", layers[2].pixels = none, layers[2].required = 0;
    assert_true(exr_write(at("x.exr"), layers, 3, error, sizeof error));
}

static void free_layers(image_layer *layers, int count)
{
    int i;

    for (i = 0; i < count; i++) image_free(&layers[i].pixels);
}

static void exr_round_trip_is_exact(void **state)
{
    image_layer wrote[3], got[3];

    (void)state;
    write_sample(wrote);
    memcpy(got, wrote, sizeof got);
    assert_true(exr_read(at("x.exr"), got, 3, error, sizeof error));
    assert_memory_equal(got[0].pixels.data, wrote[0].pixels.data, W * H * sizeof(float));
    assert_memory_equal(got[1].pixels.data, wrote[1].pixels.data, W * H * 3 * sizeof(float));
    assert_null(got[2].pixels.data);
    free_layers(wrote, 3);
    free_layers(got, 3);
}

static void missing_channel_is_named_with_those_that_exist(void **state)
{
    image_layer layers[3];

    (void)state;
    write_sample(layers);
    free_layers(layers, 3);
    layers[2].required = 1;
    assert_false(exr_read(at("x.exr"), layers, 3, error, sizeof error));
    assert_error_has("x.exr: no channel near.R");
    assert_error_has("depth.Z normal.X normal.Y normal.Z");
    assert_null(layers[0].pixels.data);
    layers[2].required = 0;
    layers[2].layer = "normal", layers[2].channels = "XW"; /* a layer in part is a fault even if it is optional */
    assert_false(exr_read(at("x.exr"), layers, 3, error, sizeof error));
    assert_error_has("no channel normal.W");
}

/* OpenEXR 3.1.5 takes a block whose compressed size is exactly its raw size for a raw one when it reads, yet writes the compressed bytes.
 * Among small blocks of few values some have that size. */
static void exr_blocks_that_compress_to_their_own_size_survive(void **state)
{
    uint32_t seed = 3;
    int      round, i;

    (void)state;
    for (round = 0; round < 1500; round++) {
        image_layer out = {"a", "Y", {0, 0, 0, NULL, 0}, 1}, in = out;
        const int   distinct = 1 + round % 30;

        assert_true(image_make(&out.pixels, 3 + round % 29, 1, 1));
        for (i = 0; i < out.pixels.width; i++) {
            seed = seed * 1664525u + 1013904223u;
            out.pixels.data[i] = (float)((seed >> 16) % (uint32_t)distinct) * 1.2345678f;
        }
        assert_true(exr_write(at("block.exr"), &out, 1, error, sizeof error));
        if (!exr_read(at("block.exr"), &in, 1, error, sizeof error)) fail_msg("%d: %s", round, error);
        assert_memory_equal(in.pixels.data, out.pixels.data, (size_t)out.pixels.width * sizeof(float));
        image_free(&in.pixels);
        image_free(&out.pixels);
    }
}

static void truncated_exr_is_refused_wherever_it_is_cut(void **state)
{
    image_layer    layers[3];
    size_t         size, cut;
    unsigned char *bytes;
    int            i;

    (void)state;
    write_sample(layers);
    free_layers(layers, 3);
    bytes = read_bytes(at("x.exr"), &size);
    for (i = 0; i < 60; i++) {
        cut = i < 10 ? (size_t)i * 37u : size * (size_t)(i - 10) / 50u; /* the header closer than the pixels */
        write_bytes(at("cut.exr"), bytes, cut);
        error[0] = 0;
        if (exr_read(at("cut.exr"), layers, 3, error, sizeof error)) fail_msg("read a file cut at %d of %d", (int)cut, (int)size);
        assert_error_has("cut.exr: ");
        assert_null(layers[0].pixels.data);
    }
    free(bytes);
}

/* Every byte of the header damaged in turn: no crash, no leak; some damage (a comment, a flag) is harmless. */
static void damaged_exr_never_crashes(void **state)
{
    image_layer    layers[3];
    size_t         size, i;
    unsigned char *bytes;

    (void)state;
    write_sample(layers);
    free_layers(layers, 3);
    bytes = read_bytes(at("x.exr"), &size);
    for (i = 4; i < size && i < 700; i++) {
        bytes[i] ^= 0xff;
        write_bytes(at("bad.exr"), bytes, size);
        exr_read(at("bad.exr"), layers, 3, error, sizeof error);
        free_layers(layers, 3);
        bytes[i] ^= 0xff;
    }
    free(bytes);
}

/* Replace 4 bytes that lie `offset` behind `text` in the header of x.exr. */
static void patch_header(const char *text, size_t offset, int32_t value)
{
    size_t         size, i;
    unsigned char *bytes = read_bytes(at("x.exr"), &size);

    for (i = 0; i + offset + 4 < size && strcmp((const char *)bytes + i, text) != 0; i++) { }
    assert_true(i + offset + 4 < size);
    memcpy(bytes + i + offset, &value, 4); /* little-endian, as the format and every machine that runs this */
    write_bytes(at("patched.exr"), bytes, size);
    free(bytes);
}

static void odd_headers_are_explained(void **state)
{
    image_layer layers[3];

    (void)state;
    write_sample(layers);
    free_layers(layers, 3);
    patch_header("depth.Z", sizeof "depth.Z" + 8, 3); /* behind type and linearity: x sampling */
    assert_false(exr_read(at("patched.exr"), layers, 3, error, sizeof error));
    assert_error_has("patched.exr: ");
    patch_header("box2i", sizeof "box2i" + 4 + 8, 20000); /* behind the attribute's size and the minimum: x maximum */
    assert_false(exr_read(at("patched.exr"), layers, 3, error, sizeof error));
    assert_error_has("20001x37");
    write_bytes(at("text.exr"), "no picture", 10);
    assert_false(exr_read(at("text.exr"), layers, 3, error, sizeof error));
    assert_error_has("is not an OpenEXR file");
    assert_false(exr_read(at("none.exr"), layers, 3, error, sizeof error));
    assert_error_has("cannot be opened");
    error[3] = '!';
    assert_false(exr_read(at("none.exr"), layers, 3, error, 3)); /* a small buffer is not overrun */
    assert_int_equal(error[3], '!');
}

/* Write depth.Z with values 0, 1, 2.. in any storage, type and compression, its window beginning at (-5, 7). */
static void write_foreign(exr_storage_t storage, exr_compression_t compression, exr_pixel_type_t type, int width, int height)
{
    exr_attr_box2i_t           box;
    exr_attr_v2f_t             centre;
    exr_context_initializer_t  settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t              context;
    image                      img = make_image(width, height, 1);
    int part, x, y, step_x = width, step_y = 8;

    memset(&centre, 0, sizeof centre);
    box.min.x = -5, box.min.y = 7, box.max.x = width - 6, box.max.y = height + 6;
    for (x = 0; x < width * height; x++) img.data[x] = (float)x;
    assert_int_equal(exr_start_write(&context, at("foreign.exr"), EXR_WRITE_FILE_DIRECTLY, &settings), 0);
    assert_int_equal(exr_add_part(context, "p", storage, &part), 0);
    assert_int_equal(exr_initialize_required_attr(context, part, &box, &box, 1.0f, &centre, 1.0f, EXR_LINEORDER_INCREASING_Y,
                                                  compression), 0);
    if (storage == EXR_STORAGE_TILED)
        assert_int_equal(exr_set_tile_descriptor(context, part, 16, 8, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN), 0);
    assert_int_equal(exr_add_channel(context, part, "depth.Z", type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1), 0);
    assert_int_equal(exr_write_header(context), 0);
    if (storage == EXR_STORAGE_TILED) step_x = 16;
    else exr_get_scanlines_per_chunk(context, part, &step_y);
    for (y = 0; y < height; y += step_y) {
        for (x = 0; x < width; x += step_x) {
            exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
            exr_chunk_info_t      chunk;
            if (storage == EXR_STORAGE_TILED) exr_write_tile_chunk_info(context, part, x / 16, y / 8, 0, 0, &chunk);
            else exr_write_scanline_chunk_info(context, part, box.min.y + y, &chunk);
            assert_int_equal(exr_encoding_initialize(context, part, &chunk, &encode), 0);
            encode.channels[0].user_bytes_per_element = 4;
            encode.channels[0].user_data_type = EXR_PIXEL_FLOAT;
            encode.channels[0].user_pixel_stride = 4;
            encode.channels[0].user_line_stride = 4 * width;
            encode.channels[0].encode_from_ptr = (const uint8_t *)(img.data + y * width + x);
            assert_int_equal(exr_encoding_choose_default_routines(context, part, &encode), 0);
            assert_int_equal(exr_encoding_run(context, part, &encode), 0);
            exr_encoding_destroy(context, &encode);
        }
    }
    assert_int_equal(exr_finish(&context), 0);
    image_free(&img);
}

static void every_storage_type_and_compression_is_read(void **state)
{
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                                     EXR_COMPRESSION_ZIP,
                                                     EXR_COMPRESSION_PIZ};
    static const exr_pixel_type_t  types[] = {EXR_PIXEL_UINT, EXR_PIXEL_HALF, EXR_PIXEL_FLOAT};
    image_layer layer;
    size_t      s, c, t;
    int         i;

    (void)state;
    memset(&layer, 0, sizeof layer);
    layer.layer = "depth", layer.channels = "Z", layer.required = 1;
    for (s = 0; s < 2; s++) {
        for (c = 0; c < COUNT(compressions); c++) {
            for (t = 0; t < COUNT(types); t++) {
                write_foreign(s ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, compressions[c], types[t], W, H);
                if (!exr_read(at("foreign.exr"), &layer, 1, error, sizeof error)) fail_msg("%s", error);
                assert_int_equal(layer.pixels.width, W);
                assert_int_equal(layer.pixels.height, H);
                for (i = 0; i < W * H; i++) assert_true(layer.pixels.data[i] == (float)i); /* < 2048: exact in half too */
                image_free(&layer.pixels);
            }
        }
    }
}

static void a_file_that_cannot_be_written_leaves_nothing(void **state)
{
    image_layer layers[3];
    image       two = make_image(4, 4, 2);
    char        temp[64];

    (void)state;
    write_sample(layers);
    assert_false(exr_write(at("none/x.exr"), layers, 3, error, sizeof error));
    assert_error_has("none/x.exr: cannot be written");
    assert_false(png_write(at("none/x.png"), &layers[1].pixels, 1, error, sizeof error));
    assert_error_has("none/x.png: cannot be written");
    assert_false(png_write(at("two.png"), &two, 1, error, sizeof error));
    assert_error_has("1 or 3 channels");
    assert_false(text_write(folder, "a folder is in the way", error, sizeof error));
    assert_error_has("cannot be replaced");
    snprintf(temp, sizeof temp, "%s.%ld.tmp", folder, (long)getpid());
    assert_int_equal(access(temp, F_OK), -1);
    free_layers(layers, 3);
    image_free(&two);
}

static void png_has_the_size_and_kind_of_the_image(void **state)
{
    image          img = make_image(W, H, 3);
    size_t         size;
    unsigned char *bytes;

    (void)state;
    img.data[0] = NAN;
    img.data[1] = INFINITY;
    assert_true(png_write(at("x.png"), &img, 1, error, sizeof error));
    bytes = read_bytes(at("x.png"), &size);
    assert_memory_equal(bytes, "\x89PNG", 4);
    assert_int_equal(bytes[19], W); /* IHDR: width, height, depth, colour type 2 = RGB */
    assert_int_equal(bytes[23], H);
    assert_int_equal(bytes[24], 8);
    assert_int_equal(bytes[25], 2);
    free(bytes);
    image_free(&img);
}

/* ---- captures ---------------------------------------------------------------------------------------------------- */

#define PERSPECTIVE  "[[1.5,0,0.1,0],[0,2,-0.2,0],[0,0,-1.002002,-0.2002002],[0,0,-1,0]]" /* near 0.1, far 100 */
#define ORTHOGRAPHIC "[[0.5,0,0,0.1],[0,0.4,0,0],[0,0,-0.02002002,-1.002002],[0,0,0,1]]" /* the same */
#define VIEW         "[[1,0,0,0],[0,0,1,-2],[0,-1,0,-3],[0,0,0,1]]"
#define CAMERA(w, h, n, f, p, v) \
    "{\"width\":" w ",\"height\":" h ",\"near\":" n ",\"far\":" f ",\"projection_rows\":" p ",\"view_rows\":" v "}"

static void write_frame(void)
{
    image_layer layers[] = {{"depth", "Z", {0, 0, 0, NULL}, 1}, {"normal", "XYZ", {0, 0, 0, NULL}, 1},
                            {"albedo", "RGB", {0, 0, 0, NULL}, 1}, {"direct", "RGB", {0, 0, 0, NULL}, 1}};
    int i, p;

    for (i = 0; i < 4; i++) layers[i].pixels = make_image(W, H, i ? 3 : 1);
    for (p = 0; p < W * H; p++) { /* a wall at 5 m that faces the camera */
        layers[0].pixels.data[p] = 5.0f;
        for (i = 0; i < 3; i++) {
            layers[1].pixels.data[3 * p + i] = i == 2 ? 1.0f : 0.0f;
            layers[2].pixels.data[3 * p + i] = 0.5f;
            layers[3].pixels.data[3 * p + i] = 1.0f;
        }
    }
    assert_true(exr_write(at("frame.exr"), layers, 4, error, sizeof error));
    free_layers(layers, 4);
    write_bytes(at("camera.json"), CAMERA("21", "37", "0.1", "100", PERSPECTIVE, VIEW),
                strlen(CAMERA("21", "37", "0.1", "100", PERSPECTIVE, VIEW)));
}

static void capture_is_loaded_with_the_y_row_turned(void **state)
{
    capture cap;

    (void)state;
    write_frame();
    if (!capture_load(&cap, at("frame.exr"), at("camera.json"), error, sizeof error)) fail_msg("%s", error);
    assert_int_equal(cap.width, W);
    assert_int_equal(cap.height, H);
    assert_false(cap.orthographic);
    assert_true(cap.projection[0] == 1.5f && cap.projection[5] == -2.0f && cap.projection[8] == 0.1f && cap.projection[9] == 0.2f);
    assert_true(cap.projection[11] == -1.0f && cap.view[6] == -1.0f && cap.view[14] == -3.0f);
    assert_null(cap.truth_ao.data);
    assert_null(cap.emission.data);
    capture_free(&cap);
}

static void odd_cameras_are_explained(void **state)
{
    static const struct { const char *json, *says; int misfit; } cases[] = {
        {CAMERA("64", "36", "0.1", "100", PERSPECTIVE, VIEW), "camera is for 64x36, the frame", 1},
        {"{\"width\":21,\n\"height\":}", "is not valid JSON (line 2)", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, VIEW) " more", "is not valid JSON", 0},
        {"[1, 2]", "\"width\" is missing", 0},
        {CAMERA("\"21\"", "37", "0.1", "100", PERSPECTIVE, VIEW), "\"width\" is not one", 0},
        {CAMERA("21", "37", "0.1", "1e999", PERSPECTIVE, VIEW), "\"far\" is not one", 0},
        {CAMERA("21", "37", "0.1", "100", "[[1,0,0,0],[0,1,0,0],[0,0,1,0]]", VIEW), "\"projection_rows\" is not one", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[1,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), "row 0 of \"view_rows\"", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[1,0,0,0],[0,1,0,1e999],[0,0,1,0],[0,0,0,1]]"), "row 1, column 3", 0},
        {CAMERA("21", "37", "0.1", "100", "[[1,0,0,0],[0,1,0,0],[0,0,-1,-0.2],[0,0,1,0]]", VIEW), "neither perspective", 0},
        {CAMERA("21", "37", "0.1", "100", "[[1,0.5,0,0],[0,2,0,0],[0,0,-1.002002,-0.2002002],[0,0,-1,0]]", VIEW), "has a shear", 0},
        {CAMERA("21", "37", "0.1", "100", "[[1,0,0,0],[0,-2,0,0],[0,0,-1.002002,-0.2002002],[0,0,-1,0]]", VIEW),
         "has a shear, a mirror", 0},
        {CAMERA("21", "37", "100", "0.1", PERSPECTIVE, VIEW), "must be 0 < near < far", 0},
        {CAMERA("21", "37", "0.2", "100", PERSPECTIVE, VIEW), "does not map \"near\" 0.2", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), "is not rigid", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]"), "is not rigid", 0},
    };
    capture cap;
    size_t  i;

    (void)state;
    write_frame();
    for (i = 0; i < COUNT(cases); i++) {
        write_bytes(at("odd.json"), cases[i].json, strlen(cases[i].json));
        assert_false(capture_load(&cap, at("frame.exr"), at("odd.json"), error, sizeof error));
        assert_error_has("odd.json: ");
        assert_error_has(cases[i].says);
        assert_int_equal(cap.misfit, cases[i].misfit);
        assert_null(cap.depth.data);
    }
    assert_false(capture_load(&cap, at("frame.exr"), at("none.json"), error, sizeof error));
    assert_error_has("none.json: cannot be opened");
}

/* ---- conventions ------------------------------------------------------------------------------------------------- */

#define NEAR_Z 0.25f
#define FAR_Z  200.0f

/* A column of depths from near to far in equal ratios, the last pixel sky; off-centre, seen from a turned camera. */
static capture make_capture(int orthographic)
{
    capture cap;
    int     i;

    memset(&cap, 0, sizeof cap);
    cap.width = 1;
    cap.height = H;
    cap.orthographic = orthographic;
    cap.near_z = NEAR_Z;
    cap.far_z = FAR_Z;
    cap.depth = make_image(1, H, 1);
    cap.normal = make_image(1, H, 3);
    cap.albedo = make_image(1, H, 3);
    cap.direct = make_image(1, H, 3);
    for (i = 0; i < H; i++) {
        float x = 0.1f * (float)i, *n = cap.normal.data + 3 * i;
        cap.depth.data[i] = i == H - 1 ? 1e10f : NEAR_Z * powf(FAR_Z / NEAR_Z, (float)i / (H - 2));
        n[0] = sinf(x) * 0.6f, n[1] = cosf(x) * 0.6f, n[2] = 0.8f;
    }
    cap.depth.data[H - 2] = FAR_Z;
    cap.projection[0] = 1.3f, cap.projection[5] = -2.1f;
    cap.projection[orthographic ? 12 : 8] = 0.1f, cap.projection[orthographic ? 13 : 9] = -0.2f;
    cap.projection[orthographic ? 15 : 11] = orthographic ? 1.0f : -1.0f;
    cap.projection[10] = orthographic ? -2.0f / (FAR_Z - NEAR_Z) : -(FAR_Z + NEAR_Z) / (FAR_Z - NEAR_Z);
    cap.projection[14] = orthographic ? -(FAR_Z + NEAR_Z) / (FAR_Z - NEAR_Z) : -2.0f * FAR_Z * NEAR_Z / (FAR_Z - NEAR_Z);
    /* rows (0.6 0.8 0) (0 0 1) (0.8 -0.6 0): a rotation, written in columns */
    cap.view[0] = 0.6f, cap.view[2] = 0.8f, cap.view[4] = 0.8f, cap.view[6] = -0.6f, cap.view[9] = 1.0f, cap.view[15] = 1.0f;
    return cap;
}

static hbil_plan make_plan(const char *text)
{
    hbil_config config = {0};
    hbil_plan   plan;

    assert_int_equal(hbil_config_parse(&config, text, strlen(text), NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&config, &plan, NULL), HBIL_OK);
    return plan;
}

static void free_inputs(image *inputs)
{
    int i;

    for (i = 0; i < HBIL_MAX_TEXTURES; i++) image_free(&inputs[i]);
}

/* Device depth back to metres by the frame's own matrix, in double, and compared within what rounding to float can do.
 *
 * d is stored with a relative error of at most e = 2^-24 (round to nearest). With s = ndc units per unit of d (1, GL: 2):
 *   perspective   ndc = b / z - |..|, so dz / z = z * s * dd / b <= z * s * d * e / b. Forward, d <= 1: the error grows
 *                 with z / near. Reversed, d = b / (s z) - const, so d * s * z / b <= 1: never more than e.
 *   orthographic  ndc is linear in z: dz = s * dd / |a| <= s * d * e / |a| at any z.
 * The planes themselves: the matrix is rounded to float too, so a depth on a plane may fall outside [0, 1] and is clamped;
 * the entries' own error, (|a| + |b| / z) e, comes on top there.
 * Second-order terms and the double arithmetic of this check: one part in a thousand more, and 1e-12. */
static void check_depths(const capture *cap, const hbil_plan *plan, const hbil_frame *frame, const image *depth)
{
    const double a = (double)frame->projection[10], b = (double)frame->projection[14], e = 1.0 / 16777216.0;
    const int    gl = plan->config.clip == HBIL_CLIP_GL, reversed = plan->config.depth_direction == HBIL_DEPTH_DIRECTION_REVERSED;
    const double s = gl ? 2.0 : 1.0;
    int i;

    for (i = 0; i < H - 1; i++) {
        const double z = (double)cap->depth.data[i], d = (double)depth->data[i], ndc = gl ? 2.0 * d - 1.0 : d;
        const double back = cap->orthographic ? (b - ndc) / a : b / (ndc + a);
        const int    clamped = d <= 0.0 || d >= 1.0;
        const double bound = cap->orthographic ? (s * d + clamped * (fabs(a) * z + fabs(b))) * e / fabs(a)
                                               : (s * d + clamped * (fabs(a) + fabs(b) / z)) * e * z * z / fabs(b);

        assert_true(d >= 0.0 && d <= 1.0);
        if (!(fabs(back - z) <= bound * 1.001 + 1e-12 * z)) fail_msg("depth %.9g came back as %.9g, allowed %.3g", z, back, bound);
        if (reversed && !cap->orthographic && !clamped) assert_true(fabs(back - z) <= z * e * 1.001 + 1e-12 * z);
    }
    assert_true(depth->data[H - 1] == (reversed ? 0.0f : 1.0f));                      /* sky: exactly the clear value */
    assert_true(fabsf(depth->data[0] - (reversed ? 1.0f : 0.0f)) < 1e-6f);            /* the near plane */
    if (plan->config.depth_far == HBIL_DEPTH_FAR_FINITE) assert_true(fabsf(depth->data[H - 2] - (reversed ? 0.0f : 1.0f)) < 1e-6f);
}

static void every_depth_convention_round_trips(void **state)
{
    int k;

    (void)state;
    for (k = 0; k < 12; k++) {
        const int  orthographic = k >= 8;
        char       text[160];
        capture    cap = make_capture(orthographic);
        image      inputs[HBIL_MAX_TEXTURES];
        hbil_plan  plan;
        hbil_frame frame;
        int        c;

        snprintf(text, sizeof text, "depth=device projection=%s depth_direction=%s clip=%s depth_far=%s",
                 orthographic ? "orthographic" : "perspective", k & 1 ? "reversed" : "forward", k & 2 ? "gl" : "vulkan",
                 k & 4 ? "infinite" : "finite");
        plan = make_plan(text);
        if (!capture_encode(&cap, &plan, &frame, inputs, error, sizeof error)) fail_msg("%s: %s", text, error);
        check_depths(&cap, &plan, &frame, &inputs[hbil_plan_texture(&plan, "depth")]);
        for (c = 0; c < 16; c++) /* all but the depth row is the capture's own, off-centre terms included */
            if (c != 10 && c != 14) assert_true(frame.projection[c] == cap.projection[c]);
        if ((k & 7) == 2) { /* GL, forward, finite: what the capture came with */
            assert_true(fabsf(frame.projection[10] - cap.projection[10]) < 1e-6f);
            assert_true(fabsf(frame.projection[14] - cap.projection[14]) < 1e-6f);
        }
        assert_int_equal(frame.width, 1);
        assert_int_equal(frame.height, H);
        free_inputs(inputs);
        capture_free(&cap);
    }
}

static void normals_and_inputs_are_as_the_config_asks(void **state)
{
    capture    cap = make_capture(0);
    hbil_plan  plan = make_plan("normals=world");
    hbil_frame frame;
    image      inputs[HBIL_MAX_TEXTURES];
    int        i, r;

    (void)state;
    assert_true(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    for (i = 0; i < H; i++) {
        const float *w = inputs[hbil_plan_texture(&plan, "normal")].data + 3 * i, *m = frame.view;
        for (r = 0; r < 3; r++) /* turned back by the view matrix it is the view normal again */
            assert_true(fabsf(m[r] * w[0] + m[4 + r] * w[1] + m[8 + r] * w[2] - cap.normal.data[3 * i + r]) < 1e-6f);
    }
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "depth")].data, cap.depth.data, H * sizeof(float));
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "radiance")].data, cap.direct.data, 3 * H * sizeof(float));
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "direct")].data, cap.direct.data, 3 * H * sizeof(float));
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "albedo")].data, cap.albedo.data, 3 * H * sizeof(float));
    free_inputs(inputs);

    plan = make_plan("normals=depth outputs=ao");
    assert_true(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) assert_int_equal(inputs[i].data != NULL, i == hbil_plan_texture(&plan, "depth"));
    free_inputs(inputs);
    capture_free(&cap);
}

static void a_plan_that_does_not_fit_the_capture_is_explained(void **state)
{
    capture    cap = make_capture(0);
    hbil_plan  plan = make_plan("projection=orthographic");
    hbil_frame frame;
    image      inputs[HBIL_MAX_TEXTURES];
    int        i;

    (void)state;
    assert_false(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    assert_error_has("option projection: orthographic, but the frame's camera is perspective. Set projection=perspective");
    plan = make_plan("width=64 height=64");
    assert_false(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    assert_error_has("options width, height: 64x64 baked, but the frame is 1x37");
    plan = make_plan("");
    strcpy(plan.textures[hbil_plan_texture(&plan, "albedo")].name, "voxels");
    assert_false(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    assert_error_has("the input voxels");
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) assert_null(inputs[i].data);
    capture_free(&cap);
}

/* ---- metrics ----------------------------------------------------------------------------------------------------- */

/* Five pixels: plain, plain, sky, emitter, black but lit surface (albedo 0, truth_ao not). */
static void metrics_match_numbers_worked_out_by_hand(void **state)
{
    capture cap;
    image   result = make_image(5, 1, 1), truth = make_image(5, 1, 1), vectors = make_image(5, 1, 3), other = make_image(5, 1, 3);
    metric  m;
    int     i;

    (void)state;
    memset(&cap, 0, sizeof cap);
    cap.depth = make_image(5, 1, 1);
    cap.albedo = make_image(5, 1, 3);
    cap.truth_ao = make_image(5, 1, 1);
    for (i = 0; i < 5; i++) {
        cap.depth.data[i] = i == 2 ? 1e10f : 3.0f;
        cap.albedo.data[3 * i] = cap.albedo.data[3 * i + 1] = cap.albedo.data[3 * i + 2] = i < 2 ? 0.5f : 0.0f;
        cap.truth_ao.data[i] = i == 4 ? 0.25f : 0.0f;
        assert_int_equal(metric_counts(&cap, (size_t)i), i != 2 && i != 3);
        truth.data[i] = 0.5f;
        result.data[i] = 0.5f;
    }
    result.data[0] = 0.75f, result.data[1] = -0.5f, result.data[2] = 100.0f, result.data[3] = NAN, result.data[4] = 0.5f;
    m = metric_measure(&result, &truth, &cap);
    assert_int_equal(m.nan, 1);
    assert_int_equal(m.inf, 0);
    assert_int_equal(m.negative, 1);
    assert_true(m.min == -0.5 && m.max == 100.0 && fabs(m.mean - 100.75 / 4.0) < 1e-12);
    assert_int_equal(m.compared, 3); /* differences 0.25, -1, 0 */
    assert_true(fabs(m.bias - -0.75 / 3.0) < 1e-12 && fabs(m.rmse - sqrt(1.0625 / 3.0)) < 1e-12);

    result.data[1] = -INFINITY;
    m = metric_measure(&result, &truth, &cap);
    assert_int_equal(m.inf, 1);
    assert_int_equal(m.compared, 2);
    assert_true(fabs(m.bias - 0.125) < 1e-12);
    assert_int_equal(metric_measure(&result, &cap.truth_near, &cap).compared, 0); /* absent */
    assert_int_equal(metric_measure(&vectors, &truth, &cap).compared, 0);         /* other shape */
    other.data[0] += 3.0f; /* one of the 3 x 3 values that are compared */
    m = metric_measure(&other, &vectors, &cap);
    assert_true(m.compared == 3 && fabs(m.bias - 3.0 / 9.0) < 1e-12 && fabs(m.rmse - 1.0) < 1e-12);
    image_free(&result);
    image_free(&truth);
    image_free(&vectors);
    image_free(&other);
    capture_free(&cap);
}

/* ---- environments ------------------------------------------------------------------------------------------------ */

static void assert_rgb(const char *what, const double got[3], double r, double g, double b, double within)
{
    const double want[3] = {r, g, b};
    int          c;

    for (c = 0; c < 3; c++)
        if (!(fabs(got[c] - want[c]) <= within)) fail_msg("%s: channel %d is %.9g, not %.9g", what, c, got[c], want[c]);
}

static void the_sky_is_the_one_of_the_captures(void **state)
{
    static const double up[3] = {0, 0, 1}, down[3] = {0, 0, -2}, level[3] = {0.6, -0.8, 0}, tilted[3] = {0, 0.8, 0.6};
    environment env;
    double      rgb[3];

    (void)state;
    assert_true(environment_parse(&env, "sky", error, sizeof error));
    assert_true(env.kind == HBIL_ENVIRONMENT_SH && env.order == 1 && env.captures_sky);
    environment_radiance(&env, up, rgb);
    assert_rgb("zenith", rgb, 0.45, 0.75, 1.30, 1e-6);
    environment_radiance(&env, down, rgb);
    assert_rgb("ground", rgb, 0.30, 0.22, 0.14, 1e-6);
    environment_radiance(&env, level, rgb);
    assert_rgb("horizon", rgb, 0.375, 0.485, 0.72, 1e-6);
    environment_irradiance(&env, tilted, rgb); /* mean + 2/3 * 0.6 of half the difference */
    assert_rgb("E/pi", rgb, 0.375 + 0.4 * 0.075, 0.485 + 0.4 * 0.265, 0.72 + 0.4 * 0.58, 1e-6);
    environment_free(&env);
    assert_true(environment_parse(&env, "sky:.30,.22,.14,.45,.75,1.3", error, sizeof error));
    assert_true(env.captures_sky);
    assert_true(environment_parse(&env, "sky:1,2,3,5,4,3", error, sizeof error));
    assert_false(env.captures_sky);
    environment_radiance(&env, up, rgb);
    assert_rgb("own zenith", rgb, 5, 4, 3, 1e-6);
}

/* E/pi of each harmonic by a sum over 200 x 400 directions of the sphere, and the harmonics themselves against hbil.h's text. */
static void harmonics_are_those_of_the_header_and_bands_those_of_a_cosine(void **state)
{
    static const double n[3] = {0.48, -0.64, 0.6}, d[3] = {2.0 / 7.0, 3.0 / 7.0, -6.0 / 7.0}, pi = 3.14159265358979;
    const double basis[9] = {0.282095, 0.488603 * d[1], 0.488603 * d[2], 0.488603 * d[0], 1.092548 * d[0] * d[1],
                             1.092548 * d[1] * d[2], 0.315392 * (3 * d[2] * d[2] - 1), 1.092548 * d[0] * d[2],
                             0.546274 * (d[0] * d[0] - d[1] * d[1])};
    int k, i, j;

    (void)state;
    for (k = 0; k < 9; k++) {
        environment env;
        double      rgb[3], sum = 0.0, weight = 0.0;

        memset(&env, 0, sizeof env);
        env.kind = HBIL_ENVIRONMENT_SH;
        env.sh[k][0] = 1.0f, env.sh[k][1] = -2.0f;
        environment_radiance(&env, d, rgb);
        assert_rgb("harmonic", rgb, basis[k], -2.0 * basis[k], 0.0, 5e-6); /* six digits of the header */
        for (i = 0; i < 200; i++) {
            for (j = 0; j < 400; j++) {
                const double z = (2.0 * i + 1.0) / 200.0 - 1.0, r = sqrt(1.0 - z * z), a = (j + 0.5) * pi / 200.0;
                const double w[3] = {r * cos(a), r * sin(a), z}, cosine = w[0] * n[0] + w[1] * n[1] + w[2] * n[2];

                if (cosine <= 0.0) continue;
                environment_radiance(&env, w, rgb);
                sum += cosine * rgb[0];
                weight += cosine;
            }
        }
        environment_irradiance(&env, n, rgb);
        assert_rgb("E/pi", rgb, sum / weight, -2.0 * sum / weight, 0.0, 2e-3);
    }
}

static void numbers_of_an_environment_are_read_from_text_and_file(void **state)
{
    static const double up[3] = {0, 0, 1};
    const char *file = "1 2 3\n0,0,0\n.5 0 -.5\n0 0 0\n";
    char        text[128], list[256] = "sh:1";
    environment env;
    double      rgb[3];
    int         i;

    (void)state;
    assert_true(environment_parse(&env, "color:0.5,0,3", error, sizeof error));
    assert_int_equal(env.kind, HBIL_ENVIRONMENT_CONSTANT);
    environment_irradiance(&env, up, rgb);
    assert_rgb("colour", rgb, 0.5, 0, 3, 0);
    assert_true(environment_parse(&env, "sh:1,2,3", error, sizeof error));
    assert_true(env.kind == HBIL_ENVIRONMENT_SH && env.order == 0 && env.sh[0][2] == 3.0f && env.sh[1][0] == 0.0f);
    write_bytes(at("sh.txt"), file, strlen(file));
    snprintf(text, sizeof text, "sh:%s", at("sh.txt"));
    if (!environment_parse(&env, text, error, sizeof error)) fail_msg("%s", error);
    assert_true(env.order == 1 && env.sh[2][0] == 0.5f && env.sh[2][2] == -0.5f && !env.captures_sky);
    for (i = 2; i <= 27; i++) snprintf(list + strlen(list), sizeof list - strlen(list), ",%d", i);
    assert_true(environment_parse(&env, list, error, sizeof error));
    assert_true(env.order == 2 && env.sh[8][2] == 27.0f);
}

/* A radiance of order 1, so that E/pi is known: 0.6 + 0.3 x, 0.5 - 0.4 y + 0.1 z, 0.7 + 0.2 x + 0.4 z. */
static void ramp(const double d[3], double factor, double rgb[3])
{
    rgb[0] = 0.6 + factor * 0.3 * d[0];
    rgb[1] = 0.5 + factor * (-0.4 * d[1] + 0.1 * d[2]);
    rgb[2] = 0.7 + factor * (0.2 * d[0] + 0.4 * d[2]);
}

/* cube.exr: the ramp. The table is that of the OpenGL specification, "Cube Map Texture Selection": major axis and what sc and tc
 * are there, as signed axes 1 x, 2 y, 3 z. */
static void write_cube(int size, int beside)
{
    static const int table[6][3] = {{1, -3, -2}, {-1, 3, -2}, {2, 1, 3}, {-2, 1, -3}, {3, 1, -2}, {-3, -1, -2}};
    image_layer      layer = {"", "RGB", {0, 0, 0, NULL}, 1};
    int              face, x, y, c;

    layer.pixels = make_image(beside ? 6 * size : size, beside ? size : 6 * size, 3);
    for (face = 0; face < 6; face++) {
        for (y = 0; y < size; y++) {
            for (x = 0; x < size; x++) {
                const int    column = x + (beside ? face * size : 0), row = y + (beside ? 0 : face * size);
                const double value[3] = {1.0, (2.0 * x + 1.0) / size - 1.0, (2.0 * y + 1.0) / size - 1.0};
                const double length = sqrt(1.0 + value[1] * value[1] + value[2] * value[2]);
                double       d[3], rgb[3];

                for (c = 0; c < 3; c++) d[abs(table[face][c]) - 1] = (table[face][c] < 0 ? -1.0 : 1.0) * value[c] / length;
                ramp(d, 1.0, rgb);
                for (c = 0; c < 3; c++) layer.pixels.data[3 * (row * layer.pixels.width + column) + c] = (float)rgb[c];
            }
        }
    }
    assert_true(exr_write(at("cube.exr"), &layer, 1, error, sizeof error));
    image_free(&layer.pixels);
}

static void a_cube_map_is_read_and_blurred(void **state)
{
    static const double axes[8][3] = {{1, 0.3, -0.2}, {-1, 0.5, 0.4}, {0.2, 1, -0.6}, {0.3, -1, 0.1}, {-0.4, 0.2, 1},
                                      {0.6, 0.5, -1}, {0.9, 0.8, 0.7}, {-0.9, -0.9, -0.9}};
    int beside, size, i;

    (void)state;
    for (beside = 0; beside < 2; beside++) {
        for (size = 8; size <= 72; size += 64) { /* smaller than what is blurred, and no multiple of it */
            environment env, blurred;
            hbil_plan   plan = make_plan("environment=cube outputs=far");
            hbil_frame  frame;
            image       inputs[HBIL_MAX_TEXTURES];
            double      want[3], got[3];

            write_cube(size, beside);
            memset(inputs, 0, sizeof inputs);
            memset(&frame, 0, sizeof frame);
            memset(&blurred, 0, sizeof blurred);
            if (!environment_parse(&env, at("cube.exr"), error, sizeof error)) fail_msg("%s", error);
            assert_true(environment_encode(&env, &plan, &frame, inputs, error, sizeof error));
            blurred.kind = HBIL_ENVIRONMENT_CUBE;
            blurred.cube = inputs[hbil_plan_texture(&plan, "sky")];
            assert_true(blurred.cube.width == ENVIRONMENT_CUBE_SIZE && blurred.cube.depth == 6);
            for (i = 0; i < 8; i++) {
                const double *a = axes[i], length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
                const double  d[3] = {a[0] / length, a[1] / length, a[2] / length};

                ramp(d, 1.0, want); /* between texels a bilinear patch cuts the corner: a quarter of a texel at most */
                environment_radiance(&env, a, got);
                assert_rgb("radiance", got, want[0], want[1], want[2], 0.3 / size);
                ramp(d, 2.0 / 3.0, want);
                environment_irradiance(&env, d, got);
                assert_rgb("E/pi", got, want[0], want[1], want[2], size > 8 ? 3e-4 : 5e-3);
                environment_radiance(&blurred, a, got);
                assert_rgb("blurred", got, want[0], want[1], want[2], 0.01);
            }
            free_inputs(inputs);
            plan = make_plan("environment=cube outputs=far estimator=bitmask far_visibility=free_bits");
            assert_true(environment_encode(&env, &plan, &frame, inputs, error, sizeof error));
            assert_memory_equal(inputs[hbil_plan_texture(&plan, "sky")].data, env.cube.data,
                                (size_t)(18 * size * size) * sizeof(float));
            free_inputs(inputs);
            environment_free(&env);
        }
    }
}

/* probes.json: 3 x 2 x 2 probes of order 1; Y00 of red is linear in the position, Y11 of green is 1. */
static void write_probes(void)
{
    char text[2048] = "{\"size\":[3,2,2],\"origin\":[-4,-6,-8],\"step\":[4,8,12],\"order\":1,\n\"coefficients\":[";
    int  i;

    for (i = 0; i < 12; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s[[%g,0,0],[0,0,0],[0,0,0],[0,1,0]]", i ? ",\n" : "",
                 20.0 + (i % 3) - 2.0 * (i / 3 % 2) + 0.5 * (i / 6));
    snprintf(text + strlen(text), sizeof text - strlen(text), "]}");
    write_bytes(at("probes.json"), text, strlen(text));
}

static void probes_are_read_and_interpolated(void **state)
{
    static const double inside[3] = {-1, 0, 1}, beyond[3] = {100, -100, 4}, right[3] = {1, 0, 0};
    hbil_plan   plan = make_plan("environment=probes outputs=far sh_order=1");
    environment env, there;
    hbil_frame  frame;
    image       inputs[HBIL_MAX_TEXTURES], *grid;
    double      rgb[3];

    (void)state;
    write_probes();
    memset(inputs, 0, sizeof inputs);
    memset(&frame, 0, sizeof frame);
    if (!environment_parse(&env, at("probes.json"), error, sizeof error)) fail_msg("%s", error);
    assert_true(env.kind == HBIL_ENVIRONMENT_PROBES && env.order == 1);
    assert_true(env.size[0] == 3 && env.origin[2] == -8.0f && env.step[1] == 8.0f);
    there = environment_at(&env, inside); /* cell 0.75 0.75 0.75 */
    environment_radiance(&there, right, rgb);
    assert_rgb("inside", rgb, 0.28209479 * (20.0 + 0.75 - 1.5 + 0.375), 0.4886025, 0.0, 1e-5);
    there = environment_at(&env, beyond); /* cell 2 0 1 */
    environment_irradiance(&there, right, rgb);
    assert_rgb("beyond", rgb, 0.28209479 * 22.5, 2.0 / 3.0 * 0.4886025, 0.0, 1e-5);
    assert_true(environment_encode(&env, &plan, &frame, inputs, error, sizeof error));
    grid = &inputs[hbil_plan_texture(&plan, "probes")];
    assert_true(grid->width == 3 && grid->height == 2 && grid->depth == 8 && grid->channels == 3);
    assert_true(grid->data[3 * 11] == 20.5f && grid->data[3 * (6 * 6) + 1] == 1.0f); /* the last of Y00, the first of Y11 */
    assert_true(frame.probe_origin[1] == -6.0f && frame.probe_step[2] == 12.0f);
    free_inputs(inputs);
    plan = make_plan("environment=probes outputs=far");
    assert_true(environment_encode(&env, &plan, &frame, inputs, error, sizeof error));
    assert_int_equal(inputs[hbil_plan_texture(&plan, "probes")].depth, 18);
    free_inputs(inputs);
    plan = make_plan("environment=cube outputs=far");
    assert_false(environment_encode(&env, &plan, &frame, inputs, error, sizeof error));
    assert_error_has("--env CUBE.exr");
    environment_free(&env);
}

static void odd_environments_are_explained(void **state)
{
    static const struct { const char *text, *says; int misuse; } cases[] = {
        {"", "must be sky, sky:", 1},                       {"skye", "--env skye: must be sky", 1},
        {"sky:1,2,3", "six finite numbers", 1},             {"color:1,2", "three finite numbers", 1},
        {"color:1,2,-3", "0 or more", 1},                   {"color:1,2,nan", "three finite numbers", 1},
        {"color:1,2,3,", "three finite numbers", 1},        {"color:1,,2", "three finite numbers", 1},
        {"sh:1,2", "another count of numbers", 1},          {"sh:", "holds none", 1},
        {"sh:none.txt", "none.txt: cannot be opened", 0},   {"none.exr", "none.exr: cannot be opened", 0},
        {"none.json", "none.json: cannot be opened", 0},    {"sh:.", "not only numbers", 1},
    };
    static const struct { const char *json, *says; } probes[] = {
        {"{\"size\":[1,1,1],\n\"origin\"", "is not valid JSON (line 2)"},
        {"{\"size\":[1,1],\"origin\":[0,0,0],\"step\":[1,1,1],\"order\":1}", "\"size\" is not one"},
        {"{\"size\":[1,1,1],\"step\":[1,1,1],\"order\":1}", "\"origin\" is missing"},
        {"{\"size\":[1,0,1],\"origin\":[0,0,0],\"step\":[1,1,1],\"order\":1}", "\"size\" must be whole numbers"},
        {"{\"size\":[1,1,1],\"origin\":[0,0,0],\"step\":[1,0,1],\"order\":1}", "\"step\" must be in"},
        {"{\"size\":[1,1,1],\"origin\":[0,0,0],\"step\":[1,1,1],\"order\":3}", "\"order\" 3"},
        {"{\"size\":[2,1,1],\"origin\":[0,0,0],\"step\":[1,1,1],\"order\":0,\"coefficients\":[[[1,1,1]]]}", "holds 1 probes"},
        {"{\"size\":[1,1,1],\"origin\":[0,0,0],\"step\":[1,1,1],\"order\":0,\"coefficients\":[[[1,1]]]}", "probe 0"},
        {"{\"size\":[1,1,1],\"origin\":[0,0,0],\"step\":[1,1,1],\"order\":1,\"coefficients\":[[[1,1,1]]]}", "must be 4 arrays"},
        {"{\"size\":[1,1,1],\"origin\":[0,0,0],\"step\":[1,1,1],\"order\":0,\"coefficients\":[[[1e99,1,1]]]}", "larger than"},
    };
    image_layer layer = {"", "RGB", {0, 0, 0, NULL}, 1};
    environment env;
    size_t      i;

    (void)state;
    for (i = 0; i < COUNT(cases); i++) {
        assert_false(environment_parse(&env, cases[i].text, error, sizeof error));
        assert_error_has(cases[i].says);
        assert_int_equal(env.misuse, cases[i].misuse);
        assert_int_equal(env.kind, 0);
    }
    for (i = 0; i < COUNT(probes); i++) {
        write_bytes(at("odd_probes.json"), probes[i].json, strlen(probes[i].json));
        assert_false(environment_parse(&env, at("odd_probes.json"), error, sizeof error));
        assert_error_has("odd_probes.json: ");
        assert_error_has(probes[i].says);
        assert_false(env.misuse);
    }
    layer.pixels = make_image(12, 3, 3);
    assert_true(exr_write(at("odd_cube.exr"), &layer, 1, error, sizeof error));
    assert_false(environment_parse(&env, at("odd_cube.exr"), error, sizeof error));
    assert_error_has("odd_cube.exr: size 12x3 is no strip of six square faces");
    image_free(&layer.pixels);
    layer.pixels = make_image(12, 2, 3);
    layer.pixels.data[3 * 13 + 1] = NAN;
    assert_true(exr_write(at("odd_cube.exr"), &layer, 1, error, sizeof error));
    assert_false(environment_parse(&env, at("odd_cube.exr"), error, sizeof error));
    assert_error_has("holds NaN or infinity (pixel 1, 1)");
    image_free(&layer.pixels);
}

/* ---- inputs that some configs ask for ---------------------------------------------------------------------------- */

/* The vector that an encoding says, written from Meyer 2010 and the layout of the 888 channels, not from the encoder. */
static void decode_normal(const char *encoding, const float *t, int channels, double out[3])
{
    const int    unorm = strstr(encoding, "unorm") != NULL, octahedral = strstr(encoding, "octahedral") != NULL;
    double       v[3] = {0, 0, 0}, length;
    int          c;

    if (strcmp(encoding, "octahedral_888") == 0) {
        const int b[3] = {(int)lrintf(t[0] * 255.0f), (int)lrintf(t[1] * 255.0f), (int)lrintf(t[2] * 255.0f)};
        v[0] = (b[0] + 256 * (b[2] % 16)) / 2047.5 - 1.0;
        v[1] = (b[1] + 256 * (b[2] / 16)) / 2047.5 - 1.0;
    } else {
        for (c = 0; c < channels; c++) v[c] = unorm ? 2.0 * (double)t[c] - 1.0 : (double)t[c];
    }
    if (octahedral) {
        const double x = v[0], y = v[1];
        v[2] = 1.0 - fabs(x) - fabs(y);
        if (v[2] < 0.0) v[0] = copysign(1.0 - fabs(y), x), v[1] = copysign(1.0 - fabs(x), y);
    } else if (channels == 2) {
        v[2] = sqrt(fmax(0.0, 1.0 - v[0] * v[0] - v[1] * v[1]));
    }
    length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (c = 0; c < 3; c++) out[c] = v[c] / length;
}

static void every_normal_encoding_round_trips(void **state)
{
    static const struct { const char *name; int channels, world; double within; } cases[] = {
        {"xyz", 3, 1, 1e-6},              {"xyz_unorm", 3, 1, 1e-6},     {"octahedral", 2, 1, 1e-6},
        {"octahedral_unorm", 2, 1, 1e-6}, {"octahedral_888", 3, 1, 1e-3}, {"xy", 2, 0, 1e-3}, {"xy_unorm", 2, 0, 1e-3},
    };
    size_t k;
    int    world, i, c;

    (void)state;
    for (k = 0; k < COUNT(cases); k++) {
        for (world = 0; world <= cases[k].world; world++) {
            char       text[96];
            capture    cap = make_capture(0);
            image      inputs[HBIL_MAX_TEXTURES], *normal;
            hbil_plan  plan;
            hbil_frame frame;

            for (i = 0; i < H; i++) { /* all octants */
                const double a = 2.4 * i, z = 1.0 - (cases[k].world ? 2.0 * i / (H - 1.0) : i / (double)H), r = sqrt(1.0 - z * z);
                float       *n = cap.normal.data + 3 * i;
                n[0] = (float)(r * cos(a)), n[1] = (float)(r * sin(a)), n[2] = (float)z;
            }
            snprintf(text, sizeof text, "normals=%s normal_encoding=%s", world ? "world" : "view", cases[k].name);
            plan = make_plan(text);
            if (!capture_encode(&cap, &plan, &frame, inputs, error, sizeof error)) fail_msg("%s", error);
            normal = &inputs[hbil_plan_texture(&plan, "normal")];
            assert_int_equal(normal->channels, cases[k].channels);
            for (i = 0; i < H; i++) {
                const float *n = cap.normal.data + 3 * i, *m = frame.view;
                double       v[3];

                decode_normal(cases[k].name, normal->data + i * normal->channels, normal->channels, v);
                for (c = 0; c < 3; c++) {
                    const float want = world ? m[4 * c] * n[0] + m[4 * c + 1] * n[1] + m[4 * c + 2] * n[2] : n[c];
                    if (!(fabs(v[c] - (double)want) < cases[k].within))
                        fail_msg("%s: %g came back as %g", text, (double)want, v[c]);
                }
                for (c = 0; c < normal->channels && strstr(cases[k].name, "8"); c++)
                    assert_true(fabsf(normal->data[i * 3 + c] * 255.0f - roundf(normal->data[i * 3 + c] * 255.0f)) < 1e-4f);
            }
            free_inputs(inputs);
            capture_free(&cap);
        }
    }
}

static void reflectance_roughness_and_glow_are_handed_over(void **state)
{
    capture    cap = make_capture(0);
    hbil_plan  scalar = make_plan("f0=scalar"), rgb = make_plan("f0=rgb"), lobe = make_plan("outputs=specular_occlusion");
    hbil_frame frame;
    image      inputs[HBIL_MAX_TEXTURES], *got;
    int        i;

    (void)state;
    assert_false(capture_encode(&cap, &scalar, &frame, inputs, error, sizeof error));
    assert_error_has("set f0=none");
    assert_false(capture_encode(&cap, &lobe, &frame, inputs, error, sizeof error));
    assert_error_has("roughness=0.4");
    cap.f0 = make_image(1, H, 3);
    cap.roughness = make_image(1, H, 1);
    assert_true(capture_encode(&cap, &scalar, &frame, inputs, error, sizeof error));
    got = &inputs[hbil_plan_texture(&scalar, "f0")];
    assert_true(got->channels == 1
                && fabsf(got->data[1] - 0.2126f * cap.f0.data[3] - 0.7152f * cap.f0.data[4] - 0.0722f * cap.f0.data[5]) < 1e-5f);
    free_inputs(inputs);
    assert_true(capture_encode(&cap, &rgb, &frame, inputs, error, sizeof error));
    assert_memory_equal(inputs[hbil_plan_texture(&rgb, "f0")].data, cap.f0.data, 3 * H * sizeof(float));
    free_inputs(inputs);
    image_free(&cap.f0);
    cap.f0 = make_image(1, H, 1);
    assert_true(capture_encode(&cap, &rgb, &frame, inputs, error, sizeof error));
    got = &inputs[hbil_plan_texture(&rgb, "f0")];
    for (i = 0; i < 3 * H; i++) assert_true(got->data[i] == cap.f0.data[i / 3]);
    free_inputs(inputs);
    assert_true(capture_encode(&cap, &lobe, &frame, inputs, error, sizeof error));
    assert_memory_equal(inputs[hbil_plan_texture(&lobe, "roughness")].data, cap.roughness.data, H * sizeof(float));
    free_inputs(inputs);
    cap.emissive = 1;
    assert_false(capture_encode(&cap, &rgb, &frame, inputs, error, sizeof error));
    assert_error_has("no emission.RGB");
    cap.emission = make_image(1, H, 3);
    assert_true(capture_encode(&cap, &rgb, &frame, inputs, error, sizeof error));
    got = &inputs[hbil_plan_texture(&rgb, "radiance")];
    for (i = 0; i < 3 * H; i++) assert_true(got->data[i] == cap.direct.data[i] + cap.emission.data[i]);
    assert_memory_equal(inputs[hbil_plan_texture(&rgb, "direct")].data, cap.direct.data, 3 * H * sizeof(float));
    free_inputs(inputs);
    capture_free(&cap);
}

/* frame-7.exr with truth, f0 and roughness, and hf-7.exr beside it. */
static void write_numbered_frame(int hf_height)
{
    static const char *const names[] = {"depth", "normal", "albedo", "direct", "truth_far", "truth_bounce", "f0", "roughness"};
    static const char *const channels[] = {"Z", "XYZ", "RGB", "RGB", "RGB", "RGB", "Y", "Y"};
    image_layer layers[COUNT(names)], fields[3] = {{"hf_valid", "Y", {0, 0, 0, NULL}, 1}, {"hf_ao", "Y", {0, 0, 0, NULL}, 1},
                                                   {"hf_near", "RGB", {0, 0, 0, NULL}, 1}};
    size_t i;

    for (i = 0; i < COUNT(names); i++) {
        layers[i].layer = names[i];
        layers[i].channels = channels[i];
        layers[i].pixels = make_image(W, H, (int)strlen(channels[i]));
    }
    for (i = 0; i < 3; i++) fields[i].pixels = make_image(W, hf_height, i == 2 ? 3 : 1);
    assert_true(exr_write(at("frame-7.exr"), layers, (int)COUNT(names), error, sizeof error));
    assert_true(exr_write(at("hf-7.exr"), fields, 3, error, sizeof error));
    free_layers(layers, (int)COUNT(names));
    free_layers(fields, 3);
}

static void optional_layers_and_the_height_field_are_found(void **state)
{
    capture cap;

    (void)state;
    write_frame();
    write_numbered_frame(H);
    if (!capture_load(&cap, at("frame-7.exr"), at("camera.json"), error, sizeof error)) fail_msg("%s", error);
    assert_true(cap.truth_far.channels == 3 && cap.truth_bounce.channels == 3);
    assert_true(cap.f0.channels == 1 && cap.roughness.channels == 1);
    assert_true(cap.hf_valid.channels == 1 && cap.hf_ao.channels == 1 && cap.hf_near.channels == 3 && !cap.truth_ao.data);
    capture_free(&cap);
    write_numbered_frame(H - 1);
    assert_false(capture_load(&cap, at("frame-7.exr"), at("camera.json"), error, sizeof error));
    assert_error_has("hf-7.exr: size 21x36, the frame beside it is 21x37");
    write_bytes(at("hf-7.exr"), "no picture", 10);
    assert_false(capture_load(&cap, at("frame-7.exr"), at("camera.json"), error, sizeof error));
    assert_error_has("hf-7.exr: is not an OpenEXR file");
    assert_int_equal(remove(at("hf-7.exr")), 0);
    assert_true(capture_load(&cap, at("frame-7.exr"), at("camera.json"), error, sizeof error));
    assert_null(cap.hf_valid.data);
    capture_free(&cap);
}

static void the_height_field_is_compared_where_it_is_valid(void **state)
{
    image   result = make_image(4, 1, 1), truth = make_image(4, 1, 1);
    capture cap;
    metric  m;
    int     i;

    (void)state;
    memset(&cap, 0, sizeof cap);
    memset(&m, 0, sizeof m);
    metric_height_field(&m, &result, &truth, &cap);
    assert_int_equal(m.hf_compared, 0); /* no such truth */
    cap.hf_valid = make_image(4, 1, 1);
    for (i = 0; i < 4; i++) cap.hf_valid.data[i] = i == 1 || i == 3, result.data[i] = truth.data[i] + (float)i;
    result.data[0] = NAN;
    metric_height_field(&m, &result, &truth, &cap); /* differences 1 and 3 */
    assert_int_equal(m.hf_compared, 2);
    assert_true(fabs(m.hf_bias - 2.0) < 1e-6 && fabs(m.hf_rmse - sqrt(5.0)) < 1e-6);
    image_free(&result);
    image_free(&truth);
    capture_free(&cap);
}

/* ---- the built-in scene ------------------------------------------------------------------------------------------ */

#define SCENE_W 96
#define SCENE_H 96
#define RAYS    64

static double last_progress;

static void check_progress(double done)
{
    assert_true(done >= last_progress && done <= 1.0);
    last_progress = done;
}

/* The images of a capture of a scene, in an order of their own; their count. */
static int scene_images(const capture *cap, const image *list[10])
{
    list[0] = &cap->depth, list[1] = &cap->normal, list[2] = &cap->albedo, list[3] = &cap->direct, list[4] = &cap->emission;
    list[5] = &cap->truth_ao, list[6] = &cap->truth_near, list[7] = &cap->truth_far;
    list[8] = &cap->f0, list[9] = &cap->roughness;
    return cap->f0.data ? 10 : 8;
}

static void scene_has_the_same_bytes_every_time(void **state)
{
    const image *ours[10], *theirs[10];
    const char  *name;
    capture      a, b;
    int          s, k;

    (void)state;
    for (s = 0; (name = capture_scene_name(s)) != NULL; s++) {
        last_progress = 0.0;
        assert_true(capture_scene(&a, name, 40, 23, 8, check_progress, error, sizeof error));
        assert_true(last_progress == 1.0);
        assert_true(capture_scene(&b, name, 40, 23, 8, NULL, error, sizeof error));
        scene_images(&b, theirs);
        for (k = scene_images(&a, ours); k-- > 0;)
            assert_memory_equal(ours[k]->data, theirs[k]->data, (size_t)(40 * 23 * ours[k]->channels) * sizeof(float));
        assert_memory_equal(a.projection, b.projection, sizeof a.projection);
        assert_memory_equal(a.view, b.view, sizeof a.view);
        capture_free(&a);
        capture_free(&b);
    }
    assert_int_equal(s, 4);
    assert_null(capture_scene_name(-1));
}

/* Depth and normal where the motion leads are those of the surface here, but for what was hidden. */
static void motion_of_a_scene_leads_to_the_same_surface(void **state)
{
    static const float still[3] = {0.0f, 0.0f, 0.0f}, move[3] = {0.1f, 0.02f, 0.15f};
    capture last, now;
    int     x, y, same = 0, inside = 0;

    (void)state;
    assert_true(capture_scene_from(&last, "cornell", still, 0.0f, 160, 90, 0, NULL, error, sizeof error));
    assert_true(capture_scene_from(&now, "cornell", move, 2.0f, 160, 90, 0, NULL, error, sizeof error));
    assert_true(capture_motion(&now, &last));
    for (y = 0; y < now.height; y++)
        for (x = 0; x < now.width; x++) {
            const float *m = now.motion.data + 2 * (y * now.width + x);
            const int    u = (int)lround((double)x + (double)m[0]), v = (int)lround((double)y + (double)m[1]);
            const float *a = now.albedo.data + 3 * (y * now.width + x), *b;

            if (now.depth.data[y * now.width + x] > 1e8f || u < 0 || v < 0 || u >= last.width || v >= last.height) continue;
            b = last.albedo.data + 3 * (v * last.width + u);
            inside++;
            same += fabsf(a[0] - b[0]) + fabsf(a[1] - b[1]) < 1e-3f
                 && fabsf(last.depth.data[v * last.width + u] - now.depth.data[y * now.width + x] - move[2]) < 0.4f;
        }
    print_message("%d of %d pixels\n", same, inside);
    assert_true(inside > 3000 && same > 0.95 * inside);
    capture_free(&last);
    capture_free(&now);
}

static void motion_of_captures_is_that_of_their_cameras(void **state)
{
    const capture_names list = captures_list();
    int                 i, k, compared = 0;

    (void)state;
    for (i = 0; i < list.count; i++) {
        capture last, now;
        image   given;
        double  worst = 0.0;

        if (!captures_has(list.name[i], 1)) continue;
        assert_true(captures_load(list.name[i], 0, &last, error, sizeof error));
        assert_true(captures_load(list.name[i], 1, &now, error, sizeof error));
        given = now.motion;
        memset(&now.motion, 0, sizeof now.motion);
        assert_true(given.data && capture_motion(&now, &last));
        for (k = 0; k < now.width * now.height; k++) {
            if (now.depth.data[k] > 1e8f) continue;
            worst = fmax(worst, fabs((double)given.data[2 * k] - (double)now.motion.data[2 * k]));
            worst = fmax(worst, fabs((double)given.data[2 * k + 1] - (double)now.motion.data[2 * k + 1]));
        }
        print_message("%s: at most %.4f pixels apart\n", list.name[i], worst);
        assert_true(worst < 0.02);
        image_free(&given);
        capture_free(&last);
        capture_free(&now);
        compared++;
    }
    if (!compared) {
        print_message("HBIL_CAPTURES is not set, or holds no moving camera: skipped\n");
        skip();
    }
}

static void frames_follow_each_other(void **state)
{
    static const float move[3] = {0.1f, 0.0f, 0.0f};
    hbil_config c = {0};
    hbil_plan   plan;
    hbil_frame  frame;
    image       inputs[HBIL_MAX_TEXTURES];
    capture     last, now;
    int         i;

    (void)state;
    assert_int_equal(hbil_config_parse(&c, "temporal=yes reproject=gather", 29, NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    assert_true(capture_scene(&last, "cornell", 32, 18, 0, NULL, error, sizeof error));
    assert_true(capture_scene_from(&now, "cornell", move, 0.0f, 32, 18, 0, NULL, error, sizeof error));
    assert_true(capture_encode(&last, &plan, &frame, inputs, error, sizeof error));
    assert_int_equal(frame.reset, 1); /* and no motion */
    assert_true(inputs[hbil_plan_texture(&plan, "motion")].data[0] == 0.0f);
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) image_free(&inputs[i]);
    assert_true(capture_motion(&now, &last));
    assert_true(capture_encode(&now, &plan, &frame, inputs, error, sizeof error));
    capture_follow(&frame, &last);
    assert_int_equal(frame.reset, 0);
    assert_int_equal(frame.last_width, 32);
    assert_memory_equal(frame.last_view, last.view, sizeof frame.last_view);
    assert_memory_equal(frame.last_projection, last.projection, sizeof frame.last_projection);
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "motion")].data, now.motion.data, 2 * 32 * 18 * sizeof(float));
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) image_free(&inputs[i]);
    capture_free(&last);
    capture_free(&now);
}

static void patterns_and_ranges_are_read(void **state)
{
    static const struct { const char *pattern; int conversions; const char *name; } patterns[] = {
        {"a/frame-%03d.exr", 1, "a/frame-007.exr"}, {"%d", 1, "7"}, {"%02d", 1, "07"}, {"%2d", -1, NULL}, {"50%%-%d", 1, "50%-7"}, {"plain", 0, "plain"},
        {"%d%d", 2, "77"}, {"%s", -1, NULL}, {"%n", -1, NULL}, {"100%", -1, NULL}, {"%123d", -1, NULL}};
    static const struct { const char *text; int good; } ranges[] = {{"0:11", 1}, {"3:3", 1}, {"4:3", 0}, {"-1:3", 0}, {"1", 0}, {"1:", 0},
        {"1:2x", 0}, {"0:100000", 0}, {"a:b", 0}};
    char   out[32];
    size_t i;
    int    first, last;

    (void)state;
    for (i = 0; i < COUNT(patterns); i++) {
        assert_int_equal(sequence_conversions(patterns[i].pattern), patterns[i].conversions);
        if (!patterns[i].name) continue;
        assert_true(sequence_name(out, sizeof out, patterns[i].pattern, 7));
        assert_string_equal(out, patterns[i].name);
    }
    assert_false(sequence_name(out, 8, "a/frame-%03d.exr", 7));
    for (i = 0; i < COUNT(ranges); i++) assert_int_equal(sequence_range(ranges[i].text, &first, &last), ranges[i].good);
}

static void scenes_refuse_what_they_cannot_do(void **state)
{
    capture a;

    (void)state;
    assert_true(capture_scene(&a, "cornell", 1, 1, 0, NULL, error, sizeof error));
    assert_null(a.truth_ao.data);
    assert_null(a.truth_far.data);
    capture_free(&a);
    assert_false(capture_scene(&a, "sponza", 8, 8, 1, NULL, error, sizeof error));
    assert_error_has("There is: cornell, fence, terrain, metals");
    assert_false(capture_scene(&a, "cornell", 8, 20000, 1, NULL, error, sizeof error));
    assert_error_has("[1, 16384]");
}

/* Lambert's formula: cosine-weighted part of the hemisphere around n at p that a polygon covers, seen from its front. */
static double polygon_view(const double p[3], const double n[3], const double corner[4][3])
{
    double r[4][3], sum = 0.0, length, cross[3], dot;
    int    i, j, c;

    for (i = 0; i < 4; i++) {
        for (c = 0; c < 3; c++) r[i][c] = corner[i][c] - p[c];
        length = sqrt(r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2]);
        for (c = 0; c < 3; c++) r[i][c] /= length;
    }
    for (i = 0; i < 4; i++) {
        j = (i + 1) % 4;
        for (c = 0; c < 3; c++) cross[c] = r[i][(c + 1) % 3] * r[j][(c + 2) % 3] - r[i][(c + 2) % 3] * r[j][(c + 1) % 3];
        dot = r[i][0] * r[j][0] + r[i][1] * r[j][1] + r[i][2] * r[j][2];
        length = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
        sum += acos(dot) * (cross[0] * n[0] + cross[1] * n[1] + cross[2] * n[2]) / length;
    }
    return fabs(sum) / (2.0 * 3.14159265358979);
}

/* World position (x right, y away, z up; m) of a pixel, through the capture's own matrices. */
static void world_of(const capture *cap, int x, int y, double out[3])
{
    const double z = (double)cap->depth.data[y * cap->width + x];
    double       v[3];
    int          r, c;

    v[0] = z * (2.0 * (x + 0.5) / cap->width - 1.0) / (double)cap->projection[0];
    v[1] = z * (2.0 * (y + 0.5) / cap->height - 1.0) / (double)cap->projection[5];
    v[2] = -z;
    for (c = 0; c < 3; c++)
        for (r = 0, out[c] = 0.0; r < 3; r++) out[c] += (double)cap->view[4 * c + r] * (v[r] - (double)cap->view[12 + r]);
}

/* The ceiling within 1.5 m of the open front looks out of it over both blocks, so it is exactly the front's form factor that is
 * visible. A pixel's mean of RAYS rays has a deviation of at most 0.5 / sqrt(RAYS), pixels are independent: five sigmas. */
static void scene_ao_of_the_ceiling_is_the_form_factor_of_the_open_front(void **state)
{
    static const double front[4][3] = {{-2.75, 0, 0}, {2.78, 0, 0}, {2.78, 0, 5.488}, {-2.78, 0, 5.488}}, down[3] = {0, 0, -1};
    capture cap;
    double  sum = 0.0, p[3];
    int     x, y, count = 0;

    (void)state;
    assert_true(capture_scene(&cap, "cornell", SCENE_W, SCENE_H, RAYS, NULL, error, sizeof error));
    for (y = 0; y < SCENE_H / 2; y++) {
        for (x = 0; x < SCENE_W; x++) {
            const size_t i = (size_t)(y * SCENE_W + x);
            if (!metric_counts(&cap, i) || cap.normal.data[3 * i + 1] > -0.99f) continue;
            world_of(&cap, x, y, p);
            assert_true(fabs(p[2] - 5.488) < 1e-3);
            if (p[1] > 1.5) continue;
            sum += (double)cap.truth_ao.data[i] - polygon_view(p, down, front);
            count++;
        }
    }
    assert_true(count > 200);
    if (!(fabs(sum / count) < 5.0 * 0.5 / sqrt((double)RAYS * count))) fail_msg("mean error %g over %d pixels", sum / count, count);
    capture_free(&cap);
}

/* The back wall above 4 m sees the whole lamp: direct = albedo * lamp radiance * form factor, to the error of 256 sample points. */
static void scene_direct_light_is_the_form_factor_of_the_lamp(void **state)
{
    static const double lamp[4][3] = {{0.65, 2.27, 5.487}, {-0.65, 2.27, 5.487}, {-0.65, 3.32, 5.487}, {0.65, 3.32, 5.487}};
    static const double forward[3] = {0, -1, 0}, colour[3] = {17.0 * 0.725, 12.0 * 0.71, 4.0 * 0.68};
    capture cap;
    double  p[3], bright = 0.0;
    int     x, y, c, count = 0;

    (void)state;
    assert_true(capture_scene(&cap, "cornell", SCENE_W, SCENE_H, RAYS, NULL, error, sizeof error));
    for (y = 0; y < SCENE_H; y++) {
        for (x = 0; x < SCENE_W; x++) {
            const size_t i = (size_t)(y * SCENE_W + x);
            for (c = 0; c < 3; c++) bright = fmax(bright, (double)cap.direct.data[3 * i + (size_t)c]);
            if (cap.normal.data[3 * i + 1] < -0.99f) assert_true(cap.direct.data[3 * i] == 0.0f); /* the ceiling: behind the lamp */
            if (cap.normal.data[3 * i + 2] < 0.999f) continue;
            world_of(&cap, x, y, p);
            if (p[2] < 4.0 || p[1] < 5.0) continue;
            for (c = 0; c < 3; c++) {
                const double want = colour[c] * polygon_view(p, forward, lamp), got = (double)cap.direct.data[3 * i + (size_t)c];
                /* The lamp's plane is 90 degrees to the wall: at grazing angles close to the ceiling relative errors grow. */
                if (!(fabs(got - want) < 0.01 * want + 1e-4)) fail_msg("direct %g, form factor says %g at height %g", got, want,
                                                                       p[2]);
            }
            count++;
        }
    }
    assert_true(count > 100);
    for (c = 0; c < SCENE_W * SCENE_H; c++) /* what is not open is at most as bright as the brightest surface */
        for (x = 0; x < 3; x++)
            assert_true((double)cap.truth_near.data[3 * c + x] <= bright * (1.0 - (double)cap.truth_ao.data[c]) * 1.1 + 1e-6);
    capture_free(&cap);
}

static const double sky_ground[3] = {0.30, 0.22, 0.14}, sky_zenith[3] = {0.45, 0.75, 1.30}; /* of the captures' README */

/* World direction of a view-space normal: its height, 1 is up. */
static double height_of_normal(const capture *cap, size_t i)
{
    const float *n = cap->normal.data + 3 * i;

    return (double)(cap->view[8] * n[0] + cap->view[9] * n[1] + cap->view[10] * n[2]);
}

/* What the sky adds to its ground colour, as part of zenith - ground: the mean of 0.5 + 0.5 z over the rays, 0 where blocked.
 * It is one number, so each channel must give the same. */
static double sky_height(const capture *cap, size_t i)
{
    const double ao = (double)cap->truth_ao.data[i];
    double       got[3];
    int          c;

    for (c = 0; c < 3; c++) {
        const double far_light = (double)cap->truth_far.data[3 * i + (size_t)c];
        got[c] = (far_light - sky_ground[c] * ao) / (sky_zenith[c] - sky_ground[c]);
    }
    assert_true(fabs(got[0] - got[2]) < 1e-5 && fabs(got[1] - got[2]) < 1e-5);
    return got[2];
}

static void check_scene_pixel(const capture *cap, int x, int y)
{
    const size_t i = (size_t)(y * cap->width + x);
    const float *n = cap->normal.data + 3 * i, *albedo = cap->albedo.data + 3 * i;
    const double sight_x = (2.0 * (x + 0.5) / cap->width - 1.0) / (double)cap->projection[0];
    const double sight_y = (2.0 * (y + 0.5) / cap->height - 1.0) / (double)cap->projection[5];
    const double ao = (double)cap->truth_ao.data[i], up = sky_height(cap, i);
    int          c;

    if (cap->depth.data[i] >= 1e9f || albedo[0] <= 0.0f) { /* sky, lamp */
        assert_true(ao == 0.0 && up == 0.0 && cap->truth_near.data[3 * i] == 0.0f && cap->direct.data[3 * i] == 0.0f);
        assert_int_equal(cap->emission.data[3 * i] > 0.0f, cap->depth.data[i] < 1e9f); /* the lamp glows, sky pixels are black */
        return;
    }
    assert_true(cap->depth.data[i] > cap->near_z && cap->depth.data[i] < cap->far_z);
    assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0f) < 1e-5f);
    assert_true((double)n[0] * sight_x + (double)n[1] * sight_y - (double)n[2] <= 1e-6); /* faces the viewer */
    assert_true(ao >= 0.0 && ao <= 1.0 && up >= -1e-5 && up <= ao + 1e-5);
    for (c = 0; c < 3; c++) {
        const float direct = cap->direct.data[3 * i + (size_t)c], near_light = cap->truth_near.data[3 * i + (size_t)c];
        assert_true(albedo[c] > 0.0f && albedo[c] < 1.0f && cap->emission.data[3 * i + (size_t)c] == 0.0f);
        assert_true(direct >= 0.0f && direct < 20.0f && near_light >= 0.0f && near_light < 20.0f); /* no NaN either */
    }
}

/* 1: within 4 pixels of pixel i on both sides, `step` apart, there is something at least 0.2 m behind it. */
static int is_thin(const capture *cap, int i, int step)
{
    const float *z = cap->depth.data + i;
    int          r, before = 0, after = 0;

    for (r = 1; r <= 4; r++) {
        before |= z[-r * step] > *z + 0.2f;
        after |= z[r * step] > *z + 0.2f;
    }
    return before && after;
}

/* Part of the pixels that belong to something thin. */
static double thin_share(const capture *cap)
{
    int x, y, count = 0;

    for (y = 4; y < cap->height - 4; y++)
        for (x = 4; x < cap->width - 4; x++)
            count += is_thin(cap, y * cap->width + x, 1) || is_thin(cap, y * cap->width + x, cap->width);
    return (double)count / (cap->width * cap->height);
}

/* The fence scene tests thin occluders only as long as little else matters that a screen does not show: open ground that faces up
 * takes most of the picture and all of its border, but for where the fence itself goes on, and no sky is seen. */
static void assert_stands_on_open_ground(const capture *cap)
{
    int x, y, ground = 0, border = 0, rim = 2 * (cap->width + cap->height) - 4;

    for (y = 0; y < cap->height; y++) {
        for (x = 0; x < cap->width; x++) {
            const size_t i = (size_t)(y * cap->width + x);
            const int    is_ground = height_of_normal(cap, i) > 0.999;
            assert_true(cap->depth.data[i] < 1e9f);
            ground += is_ground;
            border += is_ground && (x == 0 || y == 0 || x == cap->width - 1 || y == cap->height - 1);
        }
    }
    if (ground < cap->width * cap->height * 7 / 10 || border < rim * 8 / 10)
        fail_msg("%d of %d pixels are ground, %d of %d at the border", ground, cap->width * cap->height, border, rim);
}

/* Open country: sky on top of the picture, tens of metres of ground below that lies open to it. */
static void assert_is_open(const capture *cap)
{
    const int pixels = cap->width * cap->height;
    double    ao = 0.0, farthest = 0.0, nearest = 1e9;
    int       i, sky = 0;

    for (i = 0; i < pixels; i++) {
        const double depth = (double)cap->depth.data[i];
        if (depth >= 1e9) sky++;
        else farthest = fmax(farthest, depth), nearest = fmin(nearest, depth);
        if (i < cap->width) assert_true(depth >= 1e9);
        ao += (double)cap->truth_ao.data[i];
    }
    if (sky < pixels / 8 || sky > pixels / 3 || ao < 0.8 * (pixels - sky) || farthest < 60.0 || nearest > 10.0)
        fail_msg("%d of %d pixels are sky, ao is %g, depth %g to %g m", sky, pixels, ao / (pixels - sky), nearest, farthest);
}

/* Metals take up to all of what near light there is, and reflect hardly any of it diffusely; everything else mirrors 0.04. */
static void assert_holds_metals(const capture *cap)
{
    const int pixels = cap->width * cap->height;
    int       i, c, metal = 0, coloured = 0;

    for (i = 0; i < pixels; i++) {
        const float *f0 = cap->f0.data + 3 * i, *albedo = cap->albedo.data + 3 * i;
        const int    is_metal = f0[0] > 0.5f;
        for (c = 0; c < 3; c++) {
            if (cap->depth.data[i] >= 1e9f) assert_true(f0[c] == 0.0f);
            else assert_true(is_metal ? f0[c] > 0.3f && f0[c] <= 1.0f && albedo[c] < 0.2f : f0[c] == 0.04f);
        }
        assert_true(cap->roughness.data[i] <= 1.0f && (cap->roughness.data[i] > 0.0f) == (cap->depth.data[i] < 1e9f));
        metal += is_metal;
        coloured += is_metal && f0[0] > f0[2] + 0.4f;
    }
    if (metal < pixels / 10 || coloured < pixels / 25) fail_msg("%d of %d pixels are metal, %d coloured", metal, pixels, coloured);
}

static void every_scene_is_sound_and_what_it_is_for(void **state)
{
    const char *name;
    capture     cap;
    double      share;
    int         s, x, y, is_fence, is_metals;

    (void)state;
    for (s = 0; (name = capture_scene_name(s)) != NULL; s++) {
        is_fence = strcmp(name, "fence") == 0;
        is_metals = strcmp(name, "metals") == 0;
        assert_true(capture_scene(&cap, name, 192, 108, 16, NULL, error, sizeof error));
        for (y = 0; y < cap.height; y++)
            for (x = 0; x < cap.width; x++) check_scene_pixel(&cap, x, y);
        share = thin_share(&cap);
        if (is_fence ? share < 0.12 : share > 0.1) fail_msg("%s: %g of the picture is thin", name, share);
        if (is_fence) assert_stands_on_open_ground(&cap);
        if (strcmp(name, "terrain") == 0) assert_is_open(&cap);
        assert_int_equal(cap.f0.data != NULL, is_metals);
        if (is_metals) assert_holds_metals(&cap);
        capture_free(&cap);
    }
}

/* An open surface gets mix(ground, zenith, 0.5 + n.z / 3). Where at least 0.9 is open, what is hidden has half of the zenith, give
 * or take half in a pixel and a quarter in the mean, as it is close to the horizon. A ray deviates by at most 0.25: five sigmas. */
static void far_light_of_open_pixels_is_the_irradiance_of_the_sky(void **state)
{
    enum { FAR_RAYS = 4 * RAYS };
    const double noise = 5.0 * 0.25 / sqrt((double)FAR_RAYS);
    capture cap;
    double  sum = 0.0, hidden = 0.0, lowest = 1.0, highest = -1.0;
    size_t  i;
    int     count = 0;

    (void)state;
    assert_true(capture_scene(&cap, "fence", 160, 90, FAR_RAYS, NULL, error, sizeof error));
    for (i = 0; i < 160 * 90; i++) {
        const double z = height_of_normal(&cap, i), half = 0.5 * (1.0 - (double)cap.truth_ao.data[i]);
        const double got = sky_height(&cap, i), want = 0.5 + z / 3.0 - half;
        if (cap.truth_ao.data[i] < 0.9f) continue;
        if (!(fabs(got - want) < half + noise)) fail_msg("sky part %g, not %g", got, want);
        sum += got - want;
        hidden += half;
        lowest = fmin(lowest, z);
        highest = fmax(highest, z);
        count++;
    }
    assert_true(count > 20 && highest - lowest > 0.1); /* not all of one direction */
    if (!(fabs(sum) < 0.5 * hidden + noise * sqrt((double)count))) fail_msg("mean error %g over %d pixels", sum / count, count);
    capture_free(&cap);
}

/* The ground of the fence scene lies at height 0 and faces up; the sun lights it fully or not, or in part at rims of shadows. */
static void sunlight_on_the_ground_is_the_cosine_to_the_sun(void **state)
{
    const double sun = 0.55 / sqrt(0.55 * 0.55 + 0.72 * 0.72 + 0.55 * 0.55), full = 0.40 * 2.9 * sun;
    capture cap;
    double  p[3];
    int     x, y, lit = 0, dark = 0, count = 0;

    (void)state;
    assert_true(capture_scene(&cap, "fence", 320, 180, 0, NULL, error, sizeof error));
    for (y = 0; y < cap.height; y++) {
        for (x = 0; x < cap.width; x++) {
            const size_t i = (size_t)(y * cap.width + x);
            const double direct = (double)cap.direct.data[3 * i];
            if (cap.albedo.data[3 * i] != 0.40f) continue;
            world_of(&cap, x, y, p);
            assert_true(fabs(p[2]) < 1e-4 && height_of_normal(&cap, i) > 0.99999);
            assert_true(direct < full * 1.002); /* the sun's disk is not a point */
            lit += direct > full * 0.998;
            dark += direct <= 0.0;
            count++;
        }
    }
    assert_true(count > 20000 && lit > count / 2 && dark > count / 20 && lit + dark > count * 9 / 10);
    capture_free(&cap);
}

/* ---- the program ------------------------------------------------------------------------------------------------- */

/* Runs hbil-frame with arguments in which @ is the folder; its exit code. What it says on stderr is put into error[]. */
static int run_program(const char *arguments)
{
    char           command[1024] = "\"$HBIL_FRAME_BIN\" ";
    size_t         used = strlen(command), size;
    unsigned char *said;
    int            status;

    for (; *arguments && used + 64 < sizeof command; arguments++)
        used += (size_t)snprintf(command + used, sizeof command - used, *arguments == '@' ? "%s" : "%.1s",
                                 *arguments == '@' ? folder : arguments);
    snprintf(command + used, sizeof command - used, " >%s/stdout 2>%s/stderr", folder, folder);
    status = system(command);
    assert_true(WIFEXITED(status));
    said = read_bytes(at("stderr"), &size);
    snprintf(error, sizeof error, "%s", (const char *)said);
    free(said);
    return WEXITSTATUS(status);
}

static void exit_codes_are_as_the_help_says(void **state)
{
    static const struct { const char *arguments; int code; const char *says; } cases[] = {
        {"--help", 0, ""},
        {"--version", 0, ""},
        {"", 2, "give either --frame"},
        {"--scene cornell --frame @/frame.exr", 2, "give either --frame"},
        {"--frame @/frame.exr", 2, "--camera"},
        {"--scene sponza", 2, "must be cornell"},
        {"--scene cornell --size 0x9", 2, "WxH"},
        {"--scene cornell --size 64x64x64", 2, "WxH"},
        {"--scene cornell --rays -1", 2, "--rays -1"},
        {"--scene cornell --repeat 0", 2, "--repeat 0"},
        {"--scene cornell --backend metal", 2, "must be vulkan, gl or gles"},
        {"--scene cornell --set", 2, "--set: "},
        {"--scene cornell --fast", 2, "--fast: unknown"},
        {"--frame @/frame.exr --camera @/camera.json --rays 3", 2, "belong to --scene"},
        {"--scene cornell --set slices=99,reech=2", 1, "did you mean reach"},
        {"--scene cornell --set reech=2 --set slices=99", 1, "slices=99"},
        {"--scene cornell --set slices", 1, "slices"},
        {"--scene cornell --preset qality", 1, "quality"},
        {"--scene cornell --set target=gl", 1, "option target"},
        {"--frame @/none.exr --camera @/camera.json", 3, "none.exr: cannot be opened"},
        {"--frame @/camera.json --camera @/camera.json", 3, "is not an OpenEXR file"},
        {"--frame @/frame.exr --camera @/frame.exr", 3, "is not valid JSON"},
        {"--scene cornell --out @/none/x.exr", 3, "is missing"},
        {"--scene cornell --out @", 3, "is a folder"},
        {"--scene cornell --png @/camera.json", 3, "is a file, not a folder"},
        {"--frame @/frame.exr --camera @/small.json", 4, "camera is for 20x37"},
        {"--frame @/frame.exr --camera @/camera.json --set projection=orthographic", 4, "projection=perspective"},
        {"--frame @/frame.exr --camera @/camera.json --set width=20,height=37", 4, "the frame is 21x37"},
    };
    size_t i;
    int    code;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) {
        print_message("skipped: HBIL_FRAME_BIN is not set\n");
        skip();
    }
    write_frame();
    write_bytes(at("small.json"), CAMERA("20", "37", "0.1", "100", PERSPECTIVE, VIEW),
                strlen(CAMERA("20", "37", "0.1", "100", PERSPECTIVE, VIEW)));
    for (i = 0; i < COUNT(cases); i++) {
        code = run_program(cases[i].arguments);
        if (code != cases[i].code) fail_msg("hbil-frame %s: exit %d, not %d: %s", cases[i].arguments, code, cases[i].code, error);
        assert_error_has(cases[i].says);
    }
}

static void a_fault_leaves_the_output_file_alone(void **state)
{
    size_t         size;
    unsigned char *bytes;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    write_frame();
    write_bytes(at("kept.exr"), "kept", 4);
    assert_int_equal(run_program("--frame @/frame.exr --camera @/camera.json --set projection=orthographic --out @/kept.exr"), 4);
    bytes = read_bytes(at("kept.exr"), &size);
    assert_int_equal(size, 4);
    free(bytes);
}

/* A wall that faces the camera and nothing else: fully open, no near light, composite = direct. */
static void check_wall(const char *backend, const char *camera, const char *set, int *ran)
{
    image_layer layers[] = {{"ao", "Y", {0, 0, 0, NULL}, 1}, {"composite", "RGB", {0, 0, 0, NULL}, 1},
                            {"near", "RGB", {0, 0, 0, NULL}, 0}};
    char        arguments[320];
    int         i, code;

    snprintf(arguments, sizeof arguments, "--frame @/frame.exr --camera @/%s --backend %s --set outputs=ao+composite --set %s"
             " --out @/out.exr --png @/png/ --report @/out.json --repeat 3", camera, backend, set);
    code = run_program(arguments);
    if (code == 5) print_message("no %s here: %s", backend, error);
    if (code == 5) return;
    if (code != 0) fail_msg("%s: exit %d: %s", arguments, code, error);
    *ran = 1;
    if (!exr_read(at("out.exr"), layers, 3, error, sizeof error)) fail_msg("%s", error);
    for (i = 0; i < W * H; i++) assert_true(fabsf(layers[0].pixels.data[i] - 1.0f) < 1e-3f);
    for (i = 0; i < 3 * W * H; i++) assert_true(fabsf(layers[1].pixels.data[i] - 1.0f) < 1e-3f);
    assert_null(layers[2].pixels.data); /* near was not asked for */
    free_layers(layers, 3);
}

static void a_flat_wall_is_open_and_lit_by_direct_light_alone(void **state)
{
    static const char *const backends[] = {"vulkan", "gl"}, *const cameras[] = {"camera.json", "orthographic.json"};
    static const char *const sets[] = {"depth=linear", "depth=device,normals=world",
                                       "depth=device,depth_direction=reversed,clip=gl"};
    const char    *orthographic = CAMERA("21", "37", "0.1", "100", ORTHOGRAPHIC, VIEW);
    size_t         b, c, k, size;
    unsigned char *report;
    int            ran = 0;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    write_frame();
    write_bytes(at("orthographic.json"), orthographic, strlen(orthographic));
    for (b = 0; b < COUNT(backends); b++)
        for (c = 0; c < COUNT(cameras); c++)
            for (k = 0; k < COUNT(sets); k++) check_wall(backends[b], cameras[c], sets[k], &ran);
    if (!ran) skip();
    report = read_bytes(at("out.json"), &size);
    assert_non_null(strstr((const char *)report, "\"config_hash\""));
    assert_non_null(strstr((const char *)report, "\"march\""));
    free(report);
    assert_int_equal(access(at("png/before.png"), R_OK) | access(at("png/after.png"), R_OK) | access(at("png/ao.png"), R_OK), 0);
    assert_int_not_equal(access(at("png/near.png"), F_OK), 0);
}

/* World position of a pixel of a perspective capture, off-centre or not. m */
static void position_of(const capture *cap, int x, int y, double out[3])
{
    const double z = (double)cap->depth.data[y * cap->width + x];
    double       v[3];
    int          r, c;

    v[0] = z * (2.0 * (x + 0.5) / cap->width - 1.0 + (double)cap->projection[8]) / (double)cap->projection[0];
    v[1] = z * (2.0 * (y + 0.5) / cap->height - 1.0 + (double)cap->projection[9]) / (double)cap->projection[5];
    v[2] = -z;
    for (c = 0; c < 3; c++)
        for (r = 0, out[c] = 0.0; r < 3; r++) out[c] += (double)cap->view[4 * c + r] * (v[r] - (double)cap->view[12 + r]);
}

/* far of a wall that sees nothing else, against E/pi of the environment at its normal and its pixels. env: NULL: the hook below. */
static int check_far(const char *backend, const char *given, const char *set, const environment *env, double within)
{
    image_layer layer = {"far", "RGB", {0, 0, 0, NULL}, 1};
    char        arguments[400];
    capture     cap;
    int         x, y, c, code;

    snprintf(arguments, sizeof arguments, "--frame @/frame.exr --camera @/turned.json --backend %s %s --set outputs=far%s%s"
             " --out @/far.exr", backend, given, *set ? "," : "", set);
    code = run_program(arguments);
    if (code == 5) print_message("no %s here: %s", backend, error);
    if (code == 5) return 0;
    if (code != 0) fail_msg("%s: exit %d: %s", arguments, code, error);
    assert_true(capture_load(&cap, at("frame.exr"), at("turned.json"), error, sizeof error));
    if (!exr_read(at("far.exr"), &layer, 1, error, sizeof error)) fail_msg("%s", error);
    for (y = 0; y < H; y++) {
        for (x = 0; x < W; x++) {
            const double n[3] = {(double)cap.view[2], (double)cap.view[6], (double)cap.view[10]}; /* towards the camera */
            double       p[3], want[3] = {0.5, 0.25, 0.0};
            environment  here;

            position_of(&cap, x, y, p);
            if (env) here = environment_at(env, p), environment_irradiance(&here, n, want);
            else want[0] += 0.5 * n[0], want[1] += 0.01 * p[1]; /* third: cosine of the aperture, of an open half-space 0 */
            for (c = 0; c < 3; c++) {
                const double got = (double)layer.pixels.data[3 * (y * W + x) + c];
                if (!(fabs(got - want[c]) <= within))
                    fail_msg("%s: far of pixel %d, %d, channel %d is %.9g, not %.9g", arguments, x, y, c, got, want[c]);
            }
        }
    }
    image_free(&layer.pixels);
    capture_free(&cap);
    return 1;
}

#define HOOK "// red by direction, green by height, blue by aperture\n" \
    "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n" \
    "    return vec3(0.5 + 0.5 * direction.x, 0.25 + 0.01 * position.y, cos_aperture);\n}\n"

/* Every kind of environment through both backends. The march sees a wall as open to 1e-3; its radiances are below 6. */
static void an_open_wall_gets_the_environment_at_its_normal(void **state)
{
    static const char *const backends[] = {"vulkan", "gl"};
    static const struct { const char *option, *text, *set; double within; } cases[] = {
        {"--env", "sky", "", 2e-3},                          {"--env", "color:0.5,2,3", "", 4e-3},
        {"--env", "sh:1,2,3", "", 2e-3},                     {"--env", "@/sh.txt", "far_visibility=cone", 2e-3},
        {"--env", "@/sh2.txt", "", 3e-3},                    {"--env", "@/sh2.txt", "far_visibility=ao", 3e-3},
        {"--env", "@/cube.exr", "", 8e-3},                   {"--env", "@/cube.exr", "far_visibility=direction", 8e-3},
        {"--env", "@/probes.json", "", 1e-2},                {"--env", "@/probes.json", "far_visibility=ao", 1e-2},
        {"--env", "sky", "estimator=bitmask,far_visibility=free_bits", 4e-3},
        {"--hook", "@/hook.glsl", "", 2e-3},
    };
    const char *camera = CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[0.6,0.8,0,1],[0,0,1,-2],[0.8,-0.6,0,-3],[0,0,0,1]]");
    const char *first = "1 2 3 .1 .2 .3 .4 .3 .2 .3 .2 .1", *second = "1 2 3 .1 .2 .3 .4 .3 .2 .3 .2 .1\n"
        "-.1 .2 .1 .3 0 -.2 .1 -.1 .2 -.2 .1 .1 .2 .1 -.3\n";
    size_t      b, k;
    int         ran = 0;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    write_frame();
    write_bytes(at("turned.json"), camera, strlen(camera));
    write_bytes(at("sh.txt"), first, strlen(first));
    write_bytes(at("sh2.txt"), second, strlen(second));
    write_bytes(at("hook.glsl"), HOOK, strlen(HOOK));
    write_cube(24, 1);
    write_probes();
    for (b = 0; b < COUNT(backends); b++) {
        for (k = 0; k < COUNT(cases); k++) {
            const char *text = cases[k].text, *prefix = strstr(text, ".txt") ? "sh:" : "";
            char        given[64], here[128];
            environment env;

            snprintf(given, sizeof given, "%s %s%s", cases[k].option, prefix, text);
            snprintf(here, sizeof here, "%s%s%s", prefix, *text == '@' ? folder : "", *text == '@' ? text + 1 : text);
            memset(&env, 0, sizeof env);
            if (cases[k].option[2] == 'e' && !environment_parse(&env, here, error, sizeof error)) fail_msg("%s", error);
            ran |= check_far(backends[b], given, cases[k].set, env.kind ? &env : NULL, cases[k].within);
            environment_free(&env);
        }
    }
    if (!ran) skip();
}

/* A number of an output in report.json; NAN: there is none. */
static double reported(const char *output, const char *what)
{
    size_t size;
    char  *text = (char *)read_bytes(at("report.json"), &size);
    cJSON *root = cJSON_Parse(text);
    cJSON *item = cJSON_GetObjectItem(cJSON_GetObjectItem(cJSON_GetObjectItem(root, "outputs"), output), what);
    double value = cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;

    cJSON_Delete(root);
    free(text);
    return value;
}

static void errors_are_reported_where_a_truth_is_known(void **state)
{
    static const struct { const char *arguments; int near, far, irradiance, composite; } cases[] = {
        {"--env sky --set outputs=ao+near+far+irradiance+composite", 1, 1, 1, 1},
        {"--env color:1,1,1 --set outputs=ao+near+far+irradiance+composite", 1, 0, 0, 0}, /* truth_far is of another sky */
        {"--set outputs=near+irradiance+composite", 1, 0, 1, 1},                          /* near light alone */
        {"--env sky --set outputs=far+irradiance,estimator=hbao,far_visibility=ao", 0, 1, 1, 0},
    };
    char   arguments[320];
    size_t i;
    int    code;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    for (i = 0; i < COUNT(cases); i++) {
        snprintf(arguments, sizeof arguments, "--scene fence --size 64x36 --rays 16 %s --report @/report.json -q",
                 cases[i].arguments);
        code = run_program(arguments);
        if (code == 5) skip();
        if (code != 0) fail_msg("%s: exit %d: %s", arguments, code, error);
        assert_int_equal(!isnan(reported("near", "rmse")), cases[i].near);
        assert_int_equal(!isnan(reported("far", "rmse")), cases[i].far);
        assert_int_equal(!isnan(reported("irradiance", "rmse")), cases[i].irradiance);
        assert_int_equal(!isnan(reported("composite", "rmse")), cases[i].composite);
        if (cases[i].irradiance) { /* the same pixels: errors of the parts add up */
            const double near_bias = cases[i].near ? reported("near", "bias") : 0.0;
            const double far_bias = cases[i].far ? reported("far", "bias") : 0.0;
            assert_true(fabs(near_bias + far_bias - reported("irradiance", "bias")) < 1e-6);
        }
        assert_true(isnan(reported("near", "hf_rmse")));
    }
}

/* What the option f0 takes from the light it takes from its error, if the truth is taken to be without it, too. */
static void with_f0_errors_are_those_of_what_is_not_mirrored(void **state)
{
    static const char *const outputs[] = {"near", "far"};
    double rmse[2][2];
    char   arguments[320];
    int    f0, k, code;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    for (f0 = 0; f0 < 2; f0++) {
        snprintf(arguments, sizeof arguments, "--scene metals --size 96x54 --rays 64 --env sky --set outputs=near+far,f0=%s -q "
                 "--report @/report.json", f0 ? "rgb" : "none");
        code = run_program(arguments);
        if (code == 5) skip();
        if (code != 0) fail_msg("%s: exit %d: %s", arguments, code, error);
        for (k = 0; k < 2; k++) rmse[f0][k] = reported(outputs[k], "rmse");
    }
    for (k = 0; k < 2; k++)
        if (!(rmse[1][k] < 0.97 * rmse[0][k])) fail_msg("%s: rmse %g, without f0 %g", outputs[k], rmse[1][k], rmse[0][k]);
}

/* before.png is the same with and without --env, unless there is sky in it. */
static void pictures_show_the_sky_where_nothing_else_is(void **state)
{
    static const char *const scenes[] = {"fence", "terrain"}, *const lights[] = {"outputs=near", "outputs=far --env sky"};
    unsigned char *picture[2];
    char           arguments[320];
    size_t         size[2];
    int            s, k, code;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    for (s = 0; s < 2; s++) {
        for (k = 0; k < 2; k++) {
            snprintf(arguments, sizeof arguments, "--scene %s --size 32x18 --rays 0 -q --png @/sky --set %s", scenes[s], lights[k]);
            code = run_program(arguments);
            if (code == 5) skip();
            if (code != 0) fail_msg("%s: exit %d: %s", arguments, code, error);
            picture[k] = read_bytes(at("sky/before.png"), &size[k]);
        }
        assert_int_equal(size[0] != size[1] || memcmp(picture[0], picture[1], size[0]) != 0, s);
        free(picture[0]);
        free(picture[1]);
    }
}

static void environments_that_do_not_fit_the_config_are_explained(void **state)
{
    static const struct { const char *arguments; int code; const char *says; } cases[] = {
        {"--env moon", 2, "--env moon: must be sky"},
        {"--env sky --hook @/hook.glsl", 2, "there is one environment"},
        {"--env @/none.exr", 3, "none.exr: cannot be opened"},
        {"--hook @/none.glsl", 3, "none.glsl: cannot be opened"},
        {"--hook @/empty.glsl", 3, "vec3 hbil_far_hook("},
        {"--env sky --set environment=cube", 1, "--env sky is environment=sh, but --set says environment=cube"},
        {"--hook @/hook.glsl --set environment=none", 1, "is environment=hook, but --set says environment=none"},
        {"--set environment=sh", 1, "--env sky"},
        {"--set environment=cube", 1, "--env CUBE.exr"},
        {"--set environment=hook", 1, "--hook H.glsl"},
        {"--preset hbil_screen", 1, "environment=sh of preset hbil_screen"},
        {"--preset hbil_paper --env sky", 4, "set f0=none"},
        {"--set outputs=specular_occlusion", 4, "roughness=0.4"},
        {"--emissive", 4, "no emission.RGB"},
    };
    char   arguments[320];
    size_t i;
    int    code;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    write_frame();
    write_bytes(at("hook.glsl"), HOOK, strlen(HOOK));
    write_bytes(at("empty.glsl"), "// nothing\n", 11);
    for (i = 0; i < COUNT(cases); i++) {
        snprintf(arguments, sizeof arguments, "--frame @/frame.exr --camera @/camera.json %s", cases[i].arguments);
        code = run_program(arguments);
        if (code != cases[i].code) fail_msg("hbil-frame %s: exit %d, not %d: %s", arguments, code, cases[i].code, error);
        assert_error_has(cases[i].says);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exr_round_trip_is_exact),
        cmocka_unit_test(missing_channel_is_named_with_those_that_exist),
        cmocka_unit_test(exr_blocks_that_compress_to_their_own_size_survive),
        cmocka_unit_test(truncated_exr_is_refused_wherever_it_is_cut),
        cmocka_unit_test(damaged_exr_never_crashes),
        cmocka_unit_test(odd_headers_are_explained),
        cmocka_unit_test(every_storage_type_and_compression_is_read),
        cmocka_unit_test(a_file_that_cannot_be_written_leaves_nothing),
        cmocka_unit_test(png_has_the_size_and_kind_of_the_image),
        cmocka_unit_test(capture_is_loaded_with_the_y_row_turned),
        cmocka_unit_test(odd_cameras_are_explained),
        cmocka_unit_test(every_depth_convention_round_trips),
        cmocka_unit_test(normals_and_inputs_are_as_the_config_asks),
        cmocka_unit_test(a_plan_that_does_not_fit_the_capture_is_explained),
        cmocka_unit_test(metrics_match_numbers_worked_out_by_hand),
        cmocka_unit_test(the_sky_is_the_one_of_the_captures),
        cmocka_unit_test(harmonics_are_those_of_the_header_and_bands_those_of_a_cosine),
        cmocka_unit_test(numbers_of_an_environment_are_read_from_text_and_file),
        cmocka_unit_test(a_cube_map_is_read_and_blurred),
        cmocka_unit_test(probes_are_read_and_interpolated),
        cmocka_unit_test(odd_environments_are_explained),
        cmocka_unit_test(every_normal_encoding_round_trips),
        cmocka_unit_test(reflectance_roughness_and_glow_are_handed_over),
        cmocka_unit_test(optional_layers_and_the_height_field_are_found),
        cmocka_unit_test(the_height_field_is_compared_where_it_is_valid),
        cmocka_unit_test(scene_has_the_same_bytes_every_time),
        cmocka_unit_test(motion_of_a_scene_leads_to_the_same_surface),
        cmocka_unit_test(motion_of_captures_is_that_of_their_cameras),
        cmocka_unit_test(frames_follow_each_other),
        cmocka_unit_test(patterns_and_ranges_are_read),
        cmocka_unit_test(scenes_refuse_what_they_cannot_do),
        cmocka_unit_test(every_scene_is_sound_and_what_it_is_for),
        cmocka_unit_test(far_light_of_open_pixels_is_the_irradiance_of_the_sky),
        cmocka_unit_test(sunlight_on_the_ground_is_the_cosine_to_the_sun),
        cmocka_unit_test(scene_ao_of_the_ceiling_is_the_form_factor_of_the_open_front),
        cmocka_unit_test(scene_direct_light_is_the_form_factor_of_the_lamp),
        cmocka_unit_test(exit_codes_are_as_the_help_says),
        cmocka_unit_test(a_fault_leaves_the_output_file_alone),
        cmocka_unit_test(a_flat_wall_is_open_and_lit_by_direct_light_alone),
        cmocka_unit_test(an_open_wall_gets_the_environment_at_its_normal),
        cmocka_unit_test(errors_are_reported_where_a_truth_is_known),
        cmocka_unit_test(with_f0_errors_are_those_of_what_is_not_mirrored),
        cmocka_unit_test(pictures_show_the_sky_where_nothing_else_is),
        cmocka_unit_test(environments_that_do_not_fit_the_config_are_explained),
    };
    return cmocka_run_group_tests_name("frame", tests, make_folder, remove_folder);
}
