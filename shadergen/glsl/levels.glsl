// levels: where the coarser levels of depth and radiance lie. Level 0 is layer 0; layer 1 holds level 1 in its corner,
// level 2 beside it and level 3 below that.

//@ chunk HBIL_LEVELS
const int HBIL_LEVELS = 3; // coarser levels, of 2, 4 and 8 pixels

//@ chunk hbil_level_at
// Texel q of a level. Screens below 16 pixels have level 0 only.
ivec3 hbil_level_at(ivec2 q, int level) {
    ivec2 corner = ivec2(level > 1 ? (HBIL_SIZE.x + 1) / 2 : 0, level > 2 ? (HBIL_SIZE.y + 3) / 4 : 0);
    return ivec3(q + corner, min(level, 1));
}

//@ chunk hbil_levels
// Levels that the screen has.
int hbil_levels() {
    return min(HBIL_SIZE.x, HBIL_SIZE.y) < 16 ? 0 : HBIL_LEVELS;
}
