/* report.c - Markdown on stdout, and CSV. */
#include "bout.h"

#define SAME_TIME 1.02 /* times ours counts as no slower */

static const char *const term_names[TERMS] = {"equal taps", "equal time"};

static void put_label(const row *r)
{
    if (r->peer == OURS) printf("| hbil `%s`, %s", presets[r->preset], convention_names[r->convention]);
    else printf("| %s, %s", peer_names[r->peer], convention_names[r->convention]);
    if (r->convention == AS_BEST) printf(" for the %s", truth_names[r->judge]);
    printf("%s%s |", *r->settings ? ": " : "", r->settings);
}

static void put_rows(const bout *b)
{
    int i, truth;

    puts("| method | taps | ms | scene: rmse | bias | corr. | height field: rmse | bias | corr. |\n"
         "|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (i = 0; i < b->row_count; ++i) {
        const row *r = &b->rows[i];

        put_label(r);
        printf(" %d | %.1f |", r->taps, r->median);
        for (truth = 0; truth < TRUTHS; ++truth)
            if (r->e[truth].known)
                printf(" %.4f | %+.3f | %.2f |", r->e[truth].rmse, r->e[truth].bias, r->e[truth].correlation);
            else printf(" - | - | - |");
        putchar('\n');
    }
}

/* May this row be judged by that truth under that convention? */
static int fits(const row *r, int peer, int truth, int convention)
{
    return r->peer == peer && r->e[truth].known && r->convention == convention
           && (convention != AS_BEST || r->judge == truth);
}

/* Presets without a reach are large as shipped. */
static const row *own_row(const bout *b, int preset, int truth, int convention)
{
    int i;

    for (i = 0; i < b->row_count; ++i)
        if (b->rows[i].preset == preset && fits(&b->rows[i], OURS, truth, convention)) return &b->rows[i];
    return convention == AS_LARGE ? own_row(b, preset, truth, AS_SHIPPED) : NULL;
}

/* Fewest taps of the peer that are at least those of ours. */
static int taps_for(const bout *b, int peer, int taps)
{
    int i, best = 0;

    for (i = 0; i < b->row_count; ++i) {
        const row *r = &b->rows[i];
        if (r->peer == peer && r->taps >= taps && (!best || r->taps < best)) best = r->taps;
    }
    return best;
}

/* The peer's row of least error that meets the terms of ours; NULL: none does. */
static const row *rival(const bout *b, const row *own, int peer, int truth, int convention, int terms)
{
    const int  taps = taps_for(b, peer, own->taps);
    const row *best = NULL;
    int        i;

    for (i = 0; i < b->row_count; ++i) {
        const row *r = &b->rows[i];

        if (!fits(r, peer, truth, convention)
            || (terms == EQUAL_TAPS ? r->taps != taps : r->median > SAME_TIME * own->median))
            continue;
        if (!best || r->e[truth].rmse < best->e[truth].rmse) best = r;
    }
    return best;
}

static void put_pair(const bout *b, int preset, int truth, int peer, int terms, tally *t)
{
    int convention;

    if (!own_row(b, preset, truth, AS_SHIPPED)) return;
    printf("| `%s` | %s | %s | %s |", presets[preset], truth_names[truth], peer_names[peer], term_names[terms]);
    for (convention = 0; convention < CONVENTIONS; ++convention) {
        const row *own = own_row(b, preset, truth, convention), *other = rival(b, own, peer, truth, convention, terms);
        int        won;

        if (!other) {
            printf(" %.4f : - |", own->e[truth].rmse);
            continue;
        }
        won = own->e[truth].rmse <= other->e[truth].rmse;
        t->asked[preset][truth][peer][terms][convention]++;
        t->won[preset][truth][peer][terms][convention] += won;
        printf(" %.4f : %.4f%s (%d : %d taps, time x %.2f) |", own->e[truth].rmse, other->e[truth].rmse,
               won ? "" : " **loses**", own->taps, other->taps, other->median / own->median);
    }
    putchar('\n');
}

void report_bout(const bout *b, tally *t)
{
    int preset, truth, peer, terms;

    printf("\n## %s, %dx%d\n\n", b->name, b->cap.width, b->cap.height);
    puts("Ours : theirs, rmse; in brackets the taps, and their time over ours.\n");
    printf("| preset | truth | against | at |");
    for (terms = 0; terms < CONVENTIONS; ++terms) printf(" %s |", convention_names[terms]);
    puts("\n|---|---|---|---|---|---|---|");
    for (preset = 0; preset < PRESETS; ++preset)
        for (truth = 0; truth < TRUTHS; ++truth)
            for (peer = 0; peer < PEERS; ++peer)
                for (terms = 0; terms < TERMS; ++terms) put_pair(b, preset, truth, peer, terms, t);
    printf("\nAll rows; \"large\" is %.3g m here, times are medians of %d interleaved rounds.\n\n",
           (double)variant_large(&b->cap), b->repeats);
    put_rows(b);
    fflush(stdout);
}

void report_head(const char *device, const char *driver)
{
    printf("# Ambient occlusion of peers, on %s, %s\n\n", device, driver);
    puts("- three: GTAOPass of three.js and its denoising. n8ao: its AO, depth mips and two denoising passes; it makes\n"
         "  normals from depth, the others read the frame's. Ours: the preset with outputs=ao. Nobody's time has\n"
         "  composition in it.\n"
         "- Taps: depth samples a pixel of the ao pass, of our sweeps horizons; a peer gets at least as many as ours.\n"
         "- as shipped: defaults but for the samples. The packages' radii are 0.25 m and 5 m, n8ao raises its result to\n"
         "  a power of 5; the truths have neither radius nor power. large: radius of the whole scene, no fall-off, no\n"
         "  power: what the truths are of. best: the settings that come nearest to the truth on this very frame: of a\n"
         "  grid of radii, fall-offs, spacings and powers for peers, of powers for ours. No user has a truth for that.\n"
         "- n8ao's image goes through 8 bits between its passes, as shipped.\n"
         "- scene: path-traced truth, what the screen hides included. No method here can see that; a power that\n"
         "  darkens stands in for it by luck. It is noisy, too: about 0.03 of each rmse is its own. height field:\n"
         "  truth of the depth buffer alone.\n"
         "- Near light: neither pass has any. (three.js has SSGINode, for its WebGPU renderer only; n8ao's colour\n"
         "  tints its ao.)");
}

void report_summary(const tally *t)
{
    int preset, truth, peer, terms, convention;

    puts(
        "\n## Frames on which ours has the lower error\n\nOf those where the peer can be that fast.\n\n"
        "| preset | truth | against | at |"
        " as shipped | large | best |\n|---|---|---|---|---:|---:|---:|");
    for (preset = 0; preset < PRESETS; ++preset)
        for (truth = 0; truth < TRUTHS; ++truth)
            for (peer = 0; peer < PEERS; ++peer)
                for (terms = 0; terms < TERMS; ++terms) {
                    printf("| `%s` | %s | %s | %s |", presets[preset], truth_names[truth], peer_names[peer],
                           term_names[terms]);
                    for (convention = 0; convention < CONVENTIONS; ++convention)
                        printf(" %d of %d |", t->won[preset][truth][peer][terms][convention],
                               t->asked[preset][truth][peer][terms][convention]);
                    putchar('\n');
                }
}

void report_csv_head(FILE *csv)
{
    fputs(
        "frame,width,height,device,who,convention,chosen_by,settings,taps,ms_min,ms_median,ms_max,"
        "scene_rmse,scene_bias,"
        "scene_correlation,hf_rmse,hf_bias,hf_correlation\n",
        csv);
}

void report_csv(FILE *csv, const bout *b, const char *device)
{
    int i, truth;

    for (i = 0; i < b->row_count; ++i) {
        const row *r = &b->rows[i];

        fprintf(csv, "%s,%d,%d,\"%s\",%s,%s,%s,%s,%d,%.4f,%.4f,%.4f", b->name, b->cap.width, b->cap.height, device,
                r->peer == OURS ? presets[r->preset] : peer_names[r->peer], convention_names[r->convention],
                r->convention == AS_BEST ? truth_names[r->judge] : "", r->settings, r->taps, r->ms[0], r->median,
                r->ms[b->repeats - 1]);
        for (truth = 0; truth < TRUTHS; ++truth)
            if (r->e[truth].known)
                fprintf(csv, ",%.6f,%.6f,%.6f", r->e[truth].rmse, r->e[truth].bias, r->e[truth].correlation);
            else fputs(",,,", csv);
        fputc('\n', csv);
    }
}
