/* fresnel.h - what becomes of Schlick's (1 - cos)^5 when 1 - F0 stands for 1 - F in diffuse light. */
#ifndef HBIL_TRADEOFF_FRESNEL_H
#define HBIL_TRADEOFF_FRESNEL_H

/* Share of the irradiance of an open surface under uniform light that 1 - F0 keeps and 1 - F does not, by integration;
 * n_v: cosine between normal and view, in [0, 1]. Falls as n_v grows. */
double fresnel_dropped(double n_v);
/* The least n_v from which on no more than `share` is dropped; 1 if it is always more. */
double fresnel_bound(double share);

#endif
