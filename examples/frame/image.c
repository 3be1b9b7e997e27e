/* image.c - float images in memory, EXR through OpenEXR's C core, PNG through stb. */
#include "image.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <openexr.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wundef"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#define MAX_SIZE 16384 /* pixels a side */
#ifndef EXR_BYTES_MAX
#define EXR_BYTES_MAX 4294967296.0 /* of all images that are read of a file: an 8K frame with all passes and truths */
#endif
#define SHORT_NAME 31  /* bytes of a name, from which on the file must say that it has long ones */
#define MAX_NAME 256   /* bytes of a channel name; the format itself allows 255 */

int frame_error(char *error, size_t error_size, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    if (error_size > 0) vsnprintf(error, error_size, format, args);
    va_end(args);
    return 0;
}

int image_make_slices(image *out, int width, int height, int depth, int channels)
{
    memset(out, 0, sizeof *out);
    if (width < 1 || width > MAX_SIZE || height < 1 || height > MAX_SIZE || depth < 1 || depth > MAX_SIZE) return 0;
    if (channels < 1 || channels > 4) return 0;
    out->data = calloc((size_t)width * (size_t)height * (size_t)depth, (size_t)channels * sizeof(float));
    if (!out->data) return 0;
    out->width = width;
    out->height = height;
    out->depth = depth;
    out->channels = channels;
    return 1;
}

int image_make(image *out, int width, int height, int channels)
{
    return image_make_slices(out, width, height, 1, channels);
}

int image_slices(const image *img) { return img->depth > 1 ? img->depth : 1; }

void image_free(image *img)
{
    free(img->data);
    memset(img, 0, sizeof *img);
}

/* ---- files that are replaced whole or not at all ---------------------------------------------------------------- */

/* Is this the name of a temporary file of `base` whose process is no more? */
static int is_leftover(const char *name, const char *base)
{
    const size_t length = strlen(base);
    char        *end = NULL;
    long         process;

    if (strncmp(name, base, length) != 0 || name[length] != '.' || name[length + 1] < '1' || name[length + 1] > '9') return 0;
    process = strtol(name + length + 1, &end, 10);
    return strcmp(end, ".tmp") == 0 && kill((pid_t)process, 0) != 0 && errno == ESRCH;
}

void temp_clean(const char *path)
{
    const char    *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    const size_t   folder = (size_t)(base - path);
    char           name[4096];
    struct dirent *entry;
    DIR           *d;

    if (folder + 256 >= sizeof name) return;
    memcpy(name, folder ? path : ".", folder ? folder : 1);
    name[folder ? folder : 1] = 0;
    d = opendir(name);
    while (d && (entry = readdir(d)) != NULL) {
        if (!is_leftover(entry->d_name, base)) continue;
        snprintf(name + folder, sizeof name - folder, "%s", entry->d_name);
        remove(name);
    }
    if (d) closedir(d);
}

/* The temporary file lies beside its target, since rename() is atomic within one file system only. Its name holds the
 * process id: two runs that write the same file do not write into each other's half. Caller frees; NULL: no memory. */
static char *temp_path(const char *path)
{
    size_t size = strlen(path) + 32;
    char  *temp = malloc(size);

    temp_clean(path);
    if (temp) snprintf(temp, size, "%s.%ld.tmp", path, (long)getpid());
    return temp;
}

/* ok: move temp onto path. Otherwise, or if that fails: remove it. Frees temp. */
static int temp_finish(char *temp, const char *path, int ok, char *error, size_t error_size)
{
    struct stat there;
    if (ok && stat(path, &there) == 0 && !S_ISREG(there.st_mode) && !S_ISDIR(there.st_mode)) /* a device or a pipe: rename would put a file in its place */
        ok = frame_error(error, error_size, "%s: is no regular file, which a whole one could replace. Choose another path", path);
    if (ok && rename(temp, path) != 0)
        ok = frame_error(error, error_size, "%s: cannot be replaced (%s). Choose a path that can be written", path,
                         strerror(errno));
    if (!ok) remove(temp);
    free(temp);
    return ok;
}

static int no_memory(const char *path, char *error, size_t error_size)
{
    return frame_error(error, error_size, "%s: out of memory. Close other programs or use a smaller frame", path);
}

/* Write `size` bytes through a temporary file. */
static int bytes_write(const char *path, const void *bytes, size_t size, char *error, size_t error_size)
{
    char *temp = temp_path(path);
    FILE *file = temp ? fopen(temp, "wb") : NULL;
    int   ok;

    if (!temp) return no_memory(path, error, error_size);
    if (!file) {
        frame_error(error, error_size, "%s: cannot be written (%s). Make its folder or choose another path", path, strerror(errno));
        free(temp);
        return 0;
    }
    ok = fwrite(bytes, 1, size, file) == size;
    if (fclose(file) != 0) ok = 0; /* a full disk may show here only */
    if (!ok) frame_error(error, error_size, "%s: writing failed (%s). Is the disk full?", path, strerror(errno));
    return temp_finish(temp, path, ok, error, error_size);
}

int text_write(const char *path, const char *text, char *error, size_t error_size)
{
    return bytes_write(path, text, strlen(text), error, error_size);
}

char *text_read(const char *path, size_t most, const char *what, char *error, size_t error_size)
{
    FILE  *file = fopen(path, "rb");
    char  *text = NULL, *larger;
    size_t size = 0, room = 0;

    if (!file) {
        frame_error(error, error_size, "%s: cannot be opened (%s). Check the path", path, strerror(errno));
        return NULL;
    }
    do { /* grown as it is read: the size of a pipe is not known, and `most` may be far more than there is */
        room = room * 2 + 4096;
        larger = realloc(text, room + 1);
        if (!larger) break;
        text = larger;
        size += fread(text + size, 1, room - size, file);
    } while (size == room && size <= most);
    if (!larger || ferror(file) || size > most) {
        frame_error(error, error_size, "%s: cannot be read as a file of at most %lu bytes. Give %s", path,
                    (unsigned long)most, what);
        free(text);
        text = NULL;
    } else {
        text[size] = 0;
    }
    fclose(file);
    return text;
}

/* ---- PNG -------------------------------------------------------------------------------------------------------- */

/* [0, 1] to a byte; NaN is black. IEC 61966-2-1 transfer for linear values. */
static unsigned char to_byte(float value, int linear)
{
    float v = value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f;

    if (linear) v = v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1.0f / 2.4f) - 0.055f;
    return (unsigned char)(v * 255.0f + 0.5f);
}

int png_write(const char *path, const image *img, int linear, char *error, size_t error_size)
{
    size_t         count, i;
    unsigned char *bytes, *png;
    int            png_size = 0, ok;

    if (!img->data || (img->channels != 1 && img->channels != 3))
        return frame_error(error, error_size, "%s: a PNG is made of 1 or 3 channels, not of %d", path, img->channels);
    count = (size_t)img->width * (size_t)img->height * (size_t)img->channels;
    bytes = malloc(count);
    if (!bytes) return no_memory(path, error, error_size);
    for (i = 0; i < count; i++) bytes[i] = to_byte(img->data[i], linear);
    png = stbi_write_png_to_mem(bytes, img->width * img->channels, img->width, img->height, img->channels, &png_size);
    free(bytes);
    if (!png) return no_memory(path, error, error_size);
    ok = bytes_write(path, png, (size_t)png_size, error, error_size);
    STBIW_FREE(png);
    return ok;
}

/* ---- EXR -------------------------------------------------------------------------------------------------------- */

/* The library says what is wrong through a callback: keep the last message, to put it behind the file's name. */
typedef struct exr_log { char text[256]; } exr_log;

static void keep_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *user = NULL;

    (void)code;
    if (context && exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user)
        snprintf(((exr_log *)user)->text, sizeof ((exr_log *)user)->text, "%s", message);
}

/* While it writes, the library holds a lock of the context where it says so: keep_message would wait for itself. The code has to do. */
static void no_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context, (void)code, (void)message;
}

static exr_context_initializer_t exr_settings(exr_log *log)
{
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;

    memset(log, 0, sizeof *log);
    settings.error_handler_fn = keep_message;
    settings.user_data = log;
    settings.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION; /* half a frame is a fault, not half a result */
    return settings;
}

static const char *exr_reason(const exr_log *log, exr_result_t code)
{
    return log->text[0] ? log->text : exr_get_default_error_message(code);
}

static void channel_name(const image_layer *layer, int index, char name[MAX_NAME])
{
    snprintf(name, MAX_NAME, "%s%s%c", layer->layer, layer->layer[0] ? "." : "", layer->channels[index]);
}

/* The layer and the channel in it that an EXR channel belongs to; NULL: nobody asked for it. */
static const image_layer *find_layer(const image_layer *layers, int count, const char *name, int *index)
{
    char wanted[MAX_NAME];
    int  i;

    for (i = 0; i < count; i++) {
        for (*index = 0; layers[i].channels[*index]; ++*index) {
            channel_name(&layers[i], *index, wanted);
            if (strcmp(wanted, name) == 0) return &layers[i];
        }
    }
    return NULL;
}

static const exr_attr_chlist_entry_t *find_entry(const exr_attr_chlist_t *list, const char *name)
{
    int i;

    for (i = 0; i < list->num_channels; i++)
        if (strcmp(list->entries[i].name.str, name) == 0) return &list->entries[i];
    return NULL;
}

static int missing_channel(const char *path, const char *name, const exr_attr_chlist_t *list, int parts, char *error,
                           size_t error_size)
{
    size_t used;
    int    i;

    frame_error(error, error_size, "%s: no channel %s. Write that pass into the file%s. Channels in it:", path, name,
                parts > 1 ? ", into its first part (others are not read)" : "");
    for (i = 0; i < list->num_channels && error_size > 0; i++) {
        used = strlen(error);
        snprintf(error + used, error_size - used, " %s", list->entries[i].name.str);
    }
    return 0;
}

/* Make the images of all layers that the file has whole. */
static int make_layers(const char *path, exr_context_t context, int width, int height, image_layer *layers, int count,
                       char *error, size_t error_size)
{
    const exr_attr_chlist_t       *list = NULL;
    const exr_attr_chlist_entry_t *entry;
    char   name[MAX_NAME], absent[MAX_NAME];
    int    i, c, found, parts = 1;
    double bytes = 0.0;

    exr_get_count(context, &parts);
    if (exr_get_channels(context, 0, &list) != EXR_ERR_SUCCESS)
        return frame_error(error, error_size, "%s: no channel list. Export the frame again", path);
    for (i = 0; i < count; i++) {
        absent[0] = 0;
        for (c = 0, found = 0; layers[i].channels[c]; c++) {
            channel_name(&layers[i], c, name);
            entry = find_entry(list, name);
            if (entry && (entry->x_sampling != 1 || entry->y_sampling != 1))
                return frame_error(error, error_size, "%s: channel %s is subsampled %dx%d. Write it at full resolution", path, name,
                                   (int)entry->x_sampling, (int)entry->y_sampling);
            found += entry != NULL;
            if (!entry && !absent[0]) memcpy(absent, name, sizeof absent);
        }
        if (absent[0] && (layers[i].required || found > 0)) return missing_channel(path, absent, list, parts, error, error_size);
        if (absent[0]) continue;
        layers[i].pixels.channels = c; /* to be made */
        bytes += (double)sizeof(float) * width * height * c;
    }
    if (bytes > EXR_BYTES_MAX) /* a header is a few bytes, what it announces is not */
        return frame_error(error, error_size, "%s: its passes take %.0f MB in memory, %.0f MB is the most. Export a smaller frame, "
                           "or fewer passes", path, bytes / 1048576.0, EXR_BYTES_MAX / 1048576.0);
    for (i = 0; i < count; i++)
        if (layers[i].pixels.channels > 0 && !image_make(&layers[i].pixels, width, height, layers[i].pixels.channels))
            return no_memory(path, error, error_size);
    return 1;
}

static float *first_value(const image *img, int x, int y)
{
    return img->data + ((size_t)y * (size_t)img->width + (size_t)x) * (size_t)img->channels;
}

/* Decode one block of scan lines or one tile whose first pixel is (x, y) of the image. */
static exr_result_t decode_chunk(exr_context_t context, const exr_chunk_info_t *chunk, int x, int y, const image_layer *layers,
                                 int count)
{
    exr_decode_pipeline_t decode = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_result_t          code;
    int c, index;

    if ((double)chunk->unpacked_size > EXR_BYTES_MAX) return EXR_ERR_OUT_OF_MEMORY;
    code = exr_decoding_initialize(context, 0, chunk, &decode);
    for (c = 0; code == EXR_ERR_SUCCESS && c < decode.channel_count; c++) {
        exr_coding_channel_info_t *channel = &decode.channels[c];
        const image_layer         *layer = find_layer(layers, count, channel->channel_name, &index);
        const image               *img = layer ? &layer->pixels : NULL;

        channel->decode_to_ptr = NULL;
        if (!img || !img->data || channel->width == 0 || channel->height == 0) continue;
        /* Tiles and blocks come from the file: trust none of them to lie inside the image. */
        if (x + channel->width > img->width || y + channel->height > img->height) code = EXR_ERR_BAD_CHUNK_LEADER;
        channel->user_bytes_per_element = (int16_t)sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = img->channels * (int)sizeof(float);
        channel->user_line_stride = img->width * channel->user_pixel_stride;
        channel->decode_to_ptr = (uint8_t *)(first_value(img, x, y) + index);
    }
    if (code == EXR_ERR_SUCCESS) code = exr_decoding_choose_default_routines(context, 0, &decode);
    if (code == EXR_ERR_SUCCESS) code = exr_decoding_run(context, 0, &decode);
    exr_decoding_destroy(context, &decode);
    return code;
}

static exr_result_t decode_scanlines(exr_context_t context, const exr_attr_box2i_t *window, const image_layer *layers, int count)
{
    exr_chunk_info_t chunk;
    int32_t          lines = 0;
    exr_result_t     code = exr_get_scanlines_per_chunk(context, 0, &lines);
    int64_t          y;

    for (y = window->min.y; code == EXR_ERR_SUCCESS && y <= window->max.y; y += lines) {
        code = exr_read_scanline_chunk_info(context, 0, (int)y, &chunk);
        if (code == EXR_ERR_SUCCESS) code = decode_chunk(context, &chunk, 0, (int)(y - window->min.y), layers, count);
    }
    return code;
}

static exr_result_t decode_tiles(exr_context_t context, int width, int height, const image_layer *layers, int count)
{
    exr_chunk_info_t chunk;
    int32_t          tile_w = 0, tile_h = 0;
    exr_result_t     code = exr_get_tile_sizes(context, 0, 0, 0, &tile_w, &tile_h); /* level 0: the full image */
    int x, y;

    if (code == EXR_ERR_SUCCESS && (tile_w < 1 || tile_h < 1)) code = EXR_ERR_INVALID_ATTR;
    for (y = 0; code == EXR_ERR_SUCCESS && y * tile_h < height; y++) {
        for (x = 0; code == EXR_ERR_SUCCESS && x * tile_w < width; x++) {
            code = exr_read_tile_chunk_info(context, 0, x, y, 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS) code = decode_chunk(context, &chunk, x * tile_w, y * tile_h, layers, count);
        }
    }
    return code;
}

/* Is there such a file, and is it an EXR? Asked first, so that the usual mistakes get an answer in plain words. */
static int exr_probe(const char *path, char *error, size_t error_size)
{
    static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char head[4];
    size_t        got;
    FILE         *file = fopen(path, "rb");

    if (!file) return frame_error(error, error_size, "%s: cannot be opened (%s). Check the path", path, strerror(errno));
    got = fread(head, 1, sizeof head, file);
    fclose(file);
    if (got != sizeof head || memcmp(head, magic, sizeof head) != 0)
        return frame_error(error, error_size, "%s: is not an OpenEXR file. Export the frame as .exr", path);
    return 1;
}

static int exr_read_open(const char *path, exr_context_t context, const exr_log *log, image_layer *layers, int count,
                         char *error, size_t error_size)
{
    exr_attr_box2i_t window;
    exr_storage_t    storage = EXR_STORAGE_LAST_TYPE;
    exr_result_t     code = exr_get_data_window(context, 0, &window);
    int64_t          width, height;

    if (code == EXR_ERR_SUCCESS) code = exr_get_storage(context, 0, &storage);
    if (code != EXR_ERR_SUCCESS)
        return frame_error(error, error_size, "%s: %s. Export the frame again", path, exr_reason(log, code));
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return frame_error(error, error_size, "%s: holds deep pixels. Export a flat image", path);
    width = (int64_t)window.max.x - window.min.x + 1;
    height = (int64_t)window.max.y - window.min.y + 1;
    if (width < 1 || width > MAX_SIZE || height < 1 || height > MAX_SIZE)
        return frame_error(error, error_size, "%s: size %lldx%lld, allowed is 1x1 to %dx%d. Export a smaller frame", path,
                           (long long)width, (long long)height, MAX_SIZE, MAX_SIZE);
    if (!make_layers(path, context, (int)width, (int)height, layers, count, error, error_size)) return 0;
    code = storage == EXR_STORAGE_TILED ? decode_tiles(context, (int)width, (int)height, layers, count)
                                        : decode_scanlines(context, &window, layers, count);
    if (code != EXR_ERR_SUCCESS)
        return frame_error(error, error_size, "%s: damaged or cut short (%s). Export or copy the frame again", path,
                           exr_reason(log, code));
    return 1;
}

int exr_read(const char *path, image_layer *layers, int count, char *error, size_t error_size)
{
    exr_log                   log;
    exr_context_initializer_t settings = exr_settings(&log);
    exr_context_t             context = NULL;
    exr_result_t              code;
    int i, ok;

    for (i = 0; i < count; i++) memset(&layers[i].pixels, 0, sizeof layers[i].pixels);
    if (!exr_probe(path, error, error_size)) return 0;
    code = exr_start_read(&context, path, &settings);
    if (code != EXR_ERR_SUCCESS)
        ok = frame_error(error, error_size, "%s: damaged header (%s). Export or copy the frame again", path,
                         exr_reason(&log, code));
    else
        ok = exr_read_open(path, context, &log, layers, count, error, error_size);
    if (context) exr_finish(&context);
    for (i = 0; !ok && i < count; i++) image_free(&layers[i].pixels);
    return ok;
}

static char *join_names(const exr_attr_chlist_t *list)
{
    size_t size = 1, used = 0;
    char  *names;
    int    i;

    for (i = 0; i < list->num_channels; i++) size += strlen(list->entries[i].name.str) + 1;
    names = calloc(size, 1);
    for (i = 0; names && i < list->num_channels; i++) {
        strcpy(names + used, list->entries[i].name.str);
        used += strlen(names + used) + 1;
    }
    return names;
}

char *exr_names(const char *path, int *parts)
{
    exr_log                   log;
    exr_context_initializer_t settings = exr_settings(&log);
    exr_context_t             context = NULL;
    const exr_attr_chlist_t  *list = NULL;
    char                     *names = NULL;

    if (!exr_probe(path, NULL, 0)) return NULL;
    if (exr_start_read(&context, path, &settings) == EXR_ERR_SUCCESS && exr_get_count(context, parts) == EXR_ERR_SUCCESS
        && exr_get_channels(context, 0, &list) == EXR_ERR_SUCCESS)
        names = join_names(list);
    if (context) exr_finish(&context);
    return names;
}

typedef exr_result_t (*compress_routine)(exr_encode_pipeline_t *encode);

/* Compress, then hand over the raw bytes where that gained nothing at all: OpenEXR 3.1 reads a block whose stored size is its raw size
 * as raw, but would write it compressed. encoding_user_data: the library's own routine. */
static exr_result_t compress_block(exr_encode_pipeline_t *encode)
{
    const exr_result_t code = (*(const compress_routine *)encode->encoding_user_data)(encode);

    if (code == EXR_ERR_SUCCESS && encode->compressed_bytes == encode->packed_bytes)
        memcpy(encode->compressed_buffer, encode->packed_buffer, (size_t)encode->packed_bytes);
    return code;
}

/* Encode the block of scan lines that begins at row y. */
static exr_result_t encode_chunk(exr_context_t context, int y, const image_layer *layers, int count)
{
    exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_chunk_info_t      chunk;
    exr_result_t          code = exr_write_scanline_chunk_info(context, 0, y, &chunk);
    compress_routine      routine;
    int c, index;

    if (code != EXR_ERR_SUCCESS) return code;
    code = exr_encoding_initialize(context, 0, &chunk, &encode);
    for (c = 0; code == EXR_ERR_SUCCESS && c < encode.channel_count; c++) {
        exr_coding_channel_info_t *channel = &encode.channels[c];
        const image_layer         *layer = find_layer(layers, count, channel->channel_name, &index);
        const image               *img = &layer->pixels;

        channel->user_bytes_per_element = (int16_t)sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = img->channels * (int)sizeof(float);
        channel->user_line_stride = img->width * channel->user_pixel_stride;
        channel->encode_from_ptr = (const uint8_t *)(first_value(img, 0, y) + index);
    }
    if (code == EXR_ERR_SUCCESS) code = exr_encoding_choose_default_routines(context, 0, &encode);
    routine = encode.compress_fn;
    encode.encoding_user_data = &routine;
    if (routine) encode.compress_fn = compress_block;
    if (code == EXR_ERR_SUCCESS) code = exr_encoding_run(context, 0, &encode);
    exr_encoding_destroy(context, &encode);
    return code;
}

static exr_result_t encode_all(exr_context_t context, const image *size, const image_layer *layers, int count)
{
    char         name[MAX_NAME];
    int32_t      lines = 1;
    int          part, i, c, y;
    exr_result_t code = exr_add_part(context, "frame", EXR_STORAGE_SCANLINE, &part);

    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(context, part, size->width, size->height, EXR_COMPRESSION_ZIP);
    for (i = 0; i < count; i++) {
        for (c = 0; layers[i].pixels.data && layers[i].channels[c] && code == EXR_ERR_SUCCESS; c++) {
            channel_name(&layers[i], c, name);
            if (strlen(name) >= SHORT_NAME) exr_set_longname_support(context, 1);
            code = exr_add_channel(context, part, name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
        }
    }
    if (code == EXR_ERR_SUCCESS) code = exr_write_header(context);
    if (code == EXR_ERR_SUCCESS) code = exr_get_scanlines_per_chunk(context, part, &lines);
    for (y = 0; code == EXR_ERR_SUCCESS && y < size->height; y += lines) code = encode_chunk(context, y, layers, count);
    return code;
}

int exr_write(const char *path, const image_layer *layers, int count, char *error, size_t error_size)
{
    exr_log                   log;
    exr_context_initializer_t settings = exr_settings(&log);
    exr_context_t             context = NULL;
    exr_result_t              code;
    const image              *size = NULL;
    char                     *temp;
    int i;

    settings.flags = 0; /* the one that is set is for reading */
    settings.error_handler_fn = no_message;
    for (i = 0; i < count; i++) {
        const image *img = &layers[i].pixels;

        if (!img->data) continue;
        if (!size) size = img;
        if (img->width != size->width || img->height != size->height || img->channels != (int)strlen(layers[i].channels))
            return frame_error(error, error_size, "%s: layer %s does not have the size of the others, or not %d channels", path,
                               layers[i].layer, (int)strlen(layers[i].channels));
    }
    if (!size) return frame_error(error, error_size, "%s: no layer to write", path);
    temp = temp_path(path);
    if (!temp) return no_memory(path, error, error_size);
    code = exr_start_write(&context, temp, EXR_WRITE_FILE_DIRECTLY, &settings);
    if (code == EXR_ERR_SUCCESS) code = encode_all(context, size, layers, count);
    if (context) { /* the chunk table is written here: its fault counts too */
        exr_result_t last = exr_finish(&context);
        if (code == EXR_ERR_SUCCESS) code = last;
    }
    if (code != EXR_ERR_SUCCESS)
        frame_error(error, error_size, "%s: cannot be written (%s). Check the folder and the free space", path,
                    exr_reason(&log, code));
    return temp_finish(temp, path, code == EXR_ERR_SUCCESS, error, error_size);
}
