/* fresnel.c - see fresnel.h. */
#include "fresnel.h"

#include <math.h>

#define PI     3.14159265358979323846
#define ANGLES 2048

/* The integral over the azimuth of max(0, n.w), in closed form; n.w = across * cos(azimuth) + along. */
static double over_azimuth(double across, double along)
{
    const double end = along >= across ? PI : along <= -across ? 0.0 : acos(-along / across);

    return 2.0 * (along * end + across * sin(end));
}

double fresnel_dropped(double n_v)
{
    const double sine = sqrt(1.0 - n_v * n_v);
    double       sum = 0.0;
    int          i;

    for (i = 0; i < ANGLES; i++) {
        const double angle = (i + 0.5) * PI / ANGLES; /* to the view; half of it to the half vector */

        sum += pow(1.0 - cos(0.5 * angle), 5.0) * sin(angle) * over_azimuth(sine * sin(angle), n_v * cos(angle));
    }
    return sum / ANGLES; /* the step is PI / ANGLES, the whole irradiance PI */
}

double fresnel_bound(double share)
{
    double low = 0.0, high = 1.0;

    if (fresnel_dropped(low) <= share) return low;
    while (high - low > 1e-4) {
        const double middle = 0.5 * (low + high);

        if (fresnel_dropped(middle) <= share) high = middle;
        else low = middle;
    }
    return high;
}
