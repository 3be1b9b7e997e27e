/* neighbours.c - the implementations of hbil.h, its backends, volk, stb_image and stb_image_write in one file with GLFW
 * and its GL header: no name clashes, and all of it links. HBIL_FIRST: hbil.h before the others, else behind them. */
#ifdef HBIL_FIRST
#define HBIL_IMPLEMENTATION
#include "hbil.h"
#endif

#define VOLK_IMPLEMENTATION
#include <volk.h>
#include <GLFW/glfw3.h>
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#define HBIL_VK_IMPLEMENTATION
#include "hbil_vk.h"
#define HBIL_GL_IMPLEMENTATION
#include "hbil_gl.h"
#define HBIL_NULL_IMPLEMENTATION
#include "hbil_null.h"
#ifndef HBIL_FIRST
#define HBIL_IMPLEMENTATION
#include "hbil.h"
#endif
#include <stdio.h>
#include <string.h>

/* The image is kept in memory: written by one half of stb, read by the other. */
static unsigned char png[4096];
static int png_size;
static void keep(void *user, void *data, int size)
{
    (void)user;
    if (size > (int)sizeof png) return;
    memcpy(png, data, (size_t)size);
    png_size = size;
}

/* Each neighbour is called, so that each has to link. */
static int neighbours_work(void)
{
    static const unsigned char pixel[3] = { 1, 2, 3 };
    int            width = 0, height = 0, channels = 0, major = 0, right;
    unsigned char *image;
    stbi_write_png_to_func(keep, NULL, 1, 1, 3, pixel, 3);
    image = stbi_load_from_memory(png, png_size, &width, &height, &channels, 3);
    right = image && width == 1 && height == 1 && memcmp(image, pixel, 3) == 0;
    stbi_image_free(image);
    glfwGetVersion(&major, NULL, NULL);
    return right && major == 3 && volkGetInstanceVersion() == 0; /* 0: not initialised */
}

static int backends_work(const hbil_plan *plan)
{
    static hbil_vk vk;
    static hbil_gl gl;
    hbil_vk_info   vk_info;
    hbil_gl_info   gl_info;
    memset(&vk_info, 0, sizeof vk_info);
    memset(&gl_info, 0, sizeof gl_info);
    return hbil_null_check(plan, 640, 360, NULL) == 0 && hbil_vk_init(&vk_info, &vk) == HBIL_VK_E_ARG &&
           hbil_gl_init(&gl_info, &gl) == HBIL_GL_E_ARG;
}

int main(int argc, char **argv)
{
    hbil_config config;
    hbil_plan   plan;
    char        file[4096];
    FILE       *f = argc == 2 ? fopen(argv[1], "rb") : NULL;
    size_t      size = f ? fread(file, 1, sizeof file, f) : 0;
    if (f) fclose(f);
    memset(&config, 0, sizeof config);
    if (!size || hbil_config_parse(&config, file, size, NULL) != HBIL_OK) return 1;
    if (hbil_plan_build(&config, &plan, NULL) != HBIL_OK) return 1;
    if (!neighbours_work() || !backends_work(&plan)) return 1;
    printf("hash %08lx%08lx\n", (unsigned long)(plan.hash >> 32), (unsigned long)(plan.hash & 0xffffffff));
    return 0;
}
