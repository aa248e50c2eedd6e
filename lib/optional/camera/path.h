/* A person's way through the room, filtered.
 *
 * Where a placement is across the line of sight, the image says to a hundredth of the distance or better.  How far
 * away it is, it says by the person's size alone, which each lift gets wrong by some percent.  So what the filter
 * did not expect is split: along the line of sight it is mostly noise, across it mostly motion.
 *
 * Both parts go through an alpha-beta filter of place and rate, with a fading memory: it does not overshoot.  How
 * much of the last place is left in the next follows from how far an acceleration moves somebody from one frame to
 * the next, compared with the noise (the tracking index of Kalata, 1984).  The first placements get the gains of a
 * straight line through all of them.
 *
 * tools/evaluation/room.py measures it; the numbers below were chosen on training people.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_PATH_H
#define EDML_PATH_H

#include <string.h>

#include "../../api/pose.h"
#include "../../geometry/vector.h"

#define MAX_WAY REAL(100.0)        /* metres from the camera, along an axis */
#define MAX_JOINT_WAY REAL(120.0)  /* the same of a joint */
#define MAX_RATE REAL(24.0)        /* metres per second, along an axis */
#define LEAP REAL(0.6666666666667) /* half of a third of the distance, in quarters of it ... */
#define MAX_LEAP REAL(7.5)         /* ... and metres, at most */
#define NEAREST REAL(0.25)         /* a quarter of the distance from which on noise grows with it */
#define MAX_ROOT_INDEX REAL(4.0)   /* beyond it nothing but 1 % is left */
#define ROOT_INDEX_ALONG                                                                                   \
    REAL(10.0) /* root of acceleration over noise: 1.5 m/s^2 over 1.5 % of the distance */
#define ROOT_INDEX_ACROSS REAL(100.0) /* 20 m/s^2 over 0.2 % */

enum { PATH_GAP_MS = 1000, MAX_FOLLOWED = 1000 };

typedef struct {
    real place, rate;
} path_gains;

/* false for NaN */
static int is_within_way(api_real a, real way) { return a < TO_API(way) && a > -TO_API(way); }

static int are_within_way(edml_point p, real way)
{
    return is_within_way(p.x, way) && is_within_way(p.y, way) && is_within_way(p.z, way);
}

static point path_point(edml_point p)
{
    const point q = {FROM_API(p.x), FROM_API(p.y), FROM_API(p.z)};
    return q;
}

/* Of a straight line through n placements, 2 <= n <= MAX_FOLLOWED. */
static path_gains line_gains(int n)
{
    const path_gains gains = {DIV((real)(4 * n - 2), (real)(n * (n + 1))),
                              DIV((real)6, (real)(n * (n + 1)))};
    return gains;
}

/* In the steady state, but no less than a line's.  The tracking index is the square of root_index * seconds over the
 * root of the distance: <= 100 over 1. */
static path_gains gains_of(real root_index, real seconds, real root_distance, int placements)
{
    const path_gains line = line_gains(placements);
    const real ratio = DIV(MUL(root_index, seconds), root_distance);
    const real root = ratio < MAX_ROOT_INDEX ? ratio : MAX_ROOT_INDEX, index = SQUARE(root);
    const real left = (REAL(4.0) + index - MUL(root, SQRT(REAL(8.0) + index))) / 4; /* 1 to 0.1 */
    path_gains gains = {REAL(1.0) - SQUARE(left), MUL(REAL(1.0) - left, REAL(1.0) - left)};
    if (gains.place < line.place) gains.place = line.place;
    if (gains.rate < line.rate) gains.rate = line.rate; /* 1 of two placements: they have one rate */
    return gains;
}

static real limit_to(real most, real a) { return a > most ? most : a < -most ? -most : a; }

static point limit_way(point p)
{
    const point q = {limit_to(MAX_WAY, p.x), limit_to(MAX_WAY, p.y), limit_to(MAX_WAY, p.z)};
    return q;
}

/* A rate and what `step` metres in `seconds` add to it, within MAX_RATE. */
static real add_step(real rate, real step, real seconds)
{
    const real most = MUL(MAX_RATE, seconds);
    const real more = step >= most ? MAX_RATE : step <= -most ? -MAX_RATE : DIV(step, seconds);
    return limit_to(MAX_RATE, rate + more);
}

static edml_point add_steps(point rate, point step, real seconds)
{
    const point sum = {add_step(rate.x, step.x, seconds), add_step(rate.y, step.y, seconds),
                       add_step(rate.z, step.z, seconds)};
    return api_point(sum);
}

/* Follows a person to where they were seen, which is not far from where they were expected. */
static void follow_person(edml_path *path, point seen, point expected, real quarter, real seconds)
{
    const point fourth = {seen.x / 4, seen.y / 4, seen.z / 4}, sight = over(fourth, quarter);
    const real root_distance = 2 * SQRT(quarter < NEAREST ? NEAREST : quarter);
    const path_gains along = gains_of(ROOT_INDEX_ALONG, seconds, root_distance, path->placements);
    const path_gains across = gains_of(ROOT_INDEX_ACROSS, seconds, root_distance, path->placements);
    const point news = minus(seen, expected); /* <= 2 MAX_LEAP along an axis: 26 m */
    const point news_along = times(dot(news, sight), sight), news_across = minus(news, news_along);
    const point place = plus(times(along.place, news_along), times(across.place, news_across));
    const point rate = plus(times(along.rate, news_along), times(across.rate, news_across));
    path->at = api_point(limit_way(plus(expected, place))); /* before: <= 126 */
    path->rate = add_steps(path_point(path->rate), rate, seconds);
}

static void start_at(edml_path *path, edml_point seen)
{
    const edml_point still = {0, 0, 0};
    path->at = seen;
    path->rate = still;
    path->placements = 1;
}

/* Moves the path on to a placement that comes `ms` after the last. */
static void move_path(edml_path *path, edml_point at, uint32_t ms)
{
    const point seen = path_point(at), fourth = {seen.x / 4, seen.y / 4, seen.z / 4};
    const real quarter = norm(fourth), seconds = DIV((real)(int32_t)ms, (real)1000);
    const real far = MUL(LEAP, quarter), leap = far < MAX_LEAP ? far : MAX_LEAP;
    point expected = path_point(path->at);
    add_multiple(&expected, seconds, path_point(path->rate)); /* <= 100 + 24 */
    expected = limit_way(expected);
    const point half = {seen.x / 2 - expected.x / 2, seen.y / 2 - expected.y / 2,
                        seen.z / 2 - expected.z / 2};
    if (ABS(half.x) > leap || ABS(half.y) > leap || ABS(half.z) > leap) {
        start_at(path, at);
        return;
    }
    if (path->placements < MAX_FOLLOWED) path->placements++;
    follow_person(path, seen, expected, quarter, seconds);
}

/* Is a placement in reach? */
static edml_status check_placement(const edml_placement *placement)
{
    if (!are_within_way(placement->translation, MAX_JOINT_WAY)) return EDML_ERR_NOT_FINITE;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (!are_within_way(placement->joint[j], MAX_JOINT_WAY)) return EDML_ERR_NOT_FINITE;
    if (!are_within_way(placement->translation, MAX_WAY) || !(placement->translation.z > 0))
        return EDML_ERR_CAMERA;
    return EDML_OK;
}

void edml_path_start(edml_path *path) { memset(path, 0, sizeof *path); }

edml_status edml_path_follow(edml_path *path, edml_placement *placement, uint32_t time_ms)
{
    if (path == NULL || placement == NULL) return EDML_ERR_ARGUMENT;
    const edml_status status = check_placement(placement);
    if (status != EDML_OK) return status;
    const uint32_t later = time_ms - path->time; /* also across the end of the clock's range */
    if (path->placements > 0 && (later == 0 || later > UINT32_MAX / 2)) return EDML_ERR_TIME;
    const edml_point seen = placement->translation;
    if (path->placements == 0 || later > PATH_GAP_MS)
        start_at(path, seen);
    else
        move_path(path, seen, later);
    path->time = time_ms;
    placement->translation = path->at;
    for (int j = 0; j < EDML_JOINTS; j++) {
        placement->joint[j].x += path->at.x - seen.x;
        placement->joint[j].y += path->at.y - seen.y;
        placement->joint[j].z += path->at.z - seen.z;
    }
    return EDML_OK;
}

#endif
