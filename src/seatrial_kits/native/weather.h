/* Waves, current and wind around a craft: the tables that `weather.py` fills in, field by field. */

#ifndef WEATHER_H
#define WEATHER_H

#include <stdint.h>

typedef struct Weather {
    /* Where the states have place and velocity; z: -1 of a craft that keeps to the surface. */
    int64_t x, y, z, psi, u, v;

    /* Waves: `count` components; phase per second, per metre north and east, and at the origin. */
    int64_t count;
    const double *omega, *north, *east, *phase;

    /* Their loads: `half` numbers per component of its cosine and of its sine (0: no loads), for each
       of so many headings of the craft; those that no craft has come near are NULL. */
    int64_t half, headings;
    const double **loads;

    /* Motion of their water: amplitudes, wave numbers, six motions for each component. `at_origin`:
       the craft itself meets it. */
    int64_t at_origin;
    double depth; /* m, infinite where it is deep */
    const double *amplitude, *k, *motions, *back, *below;

    /* Parts of the craft that meet it: `part_count` of `part_size` that there can be. */
    int64_t part_size, part_count;
    const int64_t *part_rows;
    const double *part_positions;

    /* Current. */
    int64_t has_current, is_steady, profile, layers;
    double speed, direction, reach;
    const double *layer_depths, *layer_velocities;
    int64_t has_tide;
    double tide_period, tide_major, tide_axis, tide_minor, tide_phase;
    double sample_period;          /* s, of the slow variation; 0: there is none */
    const double **samples[2];     /* of speed and direction, in blocks; NULL: not drawn yet */

    /* Wind: mean speed, direction that it blows to, gusts, one gust, and windage. */
    int64_t has_wind, gust_count;
    double wind_mean, wind_cos, wind_sin;
    const double *gust_amplitude, *gust_omega, *gust_phase;
    double gust_peak, gust_start, gust_duration;
    int64_t windage;
    const double *windage_numbers, *windage_scales;

    /* Makes a table that is NULL: a heading's loads, or a block of samples; NULL: it cannot. */
    const double *(*make)(int64_t kind, int64_t number);
} Weather;

enum { UNIFORM, POWER, LINEAR, LAYERED };             /* profile */
enum { AREAS, ISHERWOOD, BLENDERMANN };               /* windage */
enum { SPEED_SAMPLES, DIRECTION_SAMPLES, HEADING };   /* kinds of tables */
enum { FIRST_BLOCK = 64, BLOCKS = 48 };               /* samples of the first block, each next has twice */

#endif
