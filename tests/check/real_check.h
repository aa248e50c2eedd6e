/* The vocabulary of the shared stages (lib/real_q24.h) in numbers that watch themselves, in C++: each
 * is a whole number of the width that fixed point has, and every operation on it is counted and
 * looked at for overflow.  Results are those of real_q24.h, bit for bit.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_REAL_CHECK_H
#define EDML_REAL_CHECK_H

#include <stdint.h>

#include <limits>
#include <type_traits>

#include "check.h"

extern "C" {
#include "fixed.h"
#include "model.h"
}

extern check_tally tally;

/* A whole number of T's width. */
template <typename T> class checked {
public:
    checked() = default;
    checked(int number) : value_(number) {}
    template <typename Other, typename = typename std::enable_if<(sizeof(Other) < sizeof(T))>::type>
    checked(checked<Other> narrower) : value_(narrower.value()) {} /* the way back is NARROW */
    T value() const { return value_; }

    /* Of a result in more bits. */
    static checked from(__int128 exact)
    {
        if (exact < std::numeric_limits<T>::min() || exact > std::numeric_limits<T>::max())
            tally.overflows++;
        checked result;
        result.value_ = static_cast<T>(exact);
        return result;
    }

    friend checked operator+(checked a, checked b) { return tally.sums++, from(a.exact() + b.exact()); }
    friend checked operator-(checked a, checked b) { return tally.sums++, from(a.exact() - b.exact()); }
    friend checked operator*(checked a, checked b) { return tally.sums++, from(a.exact() * b.exact()); }
    friend checked operator/(checked a, checked b)
    {
        if (b.value_ == 0) return tally.overflows++, checked(0);
        return tally.sums++, from(a.exact() / b.exact());
    }
    checked operator-() const { return tally.sums++, from(-exact()); }
    checked &operator+=(checked b) { return *this = *this + b; }
    checked &operator-=(checked b) { return *this = *this - b; }
    checked &operator*=(checked b) { return *this = *this * b; }
    checked &operator/=(checked b) { return *this = *this / b; }

    friend bool operator<(checked a, checked b) { return a.value_ < b.value_; }
    friend bool operator>(checked a, checked b) { return a.value_ > b.value_; }
    friend bool operator<=(checked a, checked b) { return a.value_ <= b.value_; }
    friend bool operator>=(checked a, checked b) { return a.value_ >= b.value_; }
    friend bool operator==(checked a, checked b) { return a.value_ == b.value_; }
    friend bool operator!=(checked a, checked b) { return a.value_ != b.value_; }

private:
    __int128 exact() const { return value_; }
    T value_;
};

typedef checked<int32_t> real;
typedef checked<int64_t> wide;
typedef real pixels;
typedef edml_keypoint_q keypoint;
typedef edml_pose_q pose;

struct point {
    real x, y, z;
};

struct rotation {
    real sine;
    uint8_t p, q;
};

typedef edml_point_q placed_point;
typedef edml_body_q person;
typedef int32_t reported;

struct camera {
    pixels fx, fy, cx, cy;
};

struct placement {
    placed_point joint[EDML_JOINTS], rotation[3], translation;
    pixels reprojection;
    uint16_t steps;
};

#define NAME(x) x##_check

struct NAME(edml_matrix) {
    real at[EDML_JOINTS][EDML_JOINTS];
};

struct NAME(edml_eigen) {
    real value[EDML_JOINTS], vector[EDML_JOINTS][EDML_JOINTS];
    rotation turn[640];
};

struct work_memory {
    real distance[EDML_PAIRS];
    NAME(edml_matrix) matrix;
    point x[EDML_JOINTS];
    struct { /* edml_work_q has a union */
        real layer[2][EDML_MAX_UNITS];
        rotation turn[320];
        point step[4][EDML_JOINTS];
    } use;
};

#define REAL(constant) real::from((__int128)((constant) * 16777216.0 + 0.5))
#define SETTING(number) real((number).q24)
#define FRACTION(a) (real(a) * 4096)
#define EPSILON 8
#define MUL(a, b) check_mul(a, b)
#define DIV(a, b) check_div(a, b)
#define SQRT(a) check_sqrt(a)
#define HYPOT(a, b) check_norm(a, b, 0)
#define NORM(a, b, c) check_norm(a, b, c)
#define ABS(a) ((a) < 0 ? -(a) : (a))
#define NARROW(sum) real::from((sum).value())
#define PRODUCT(a, b) check_product(a, b)
#define AS_REAL(sum) check_saturate(sum)
#define IN_REACH(square) ((square) < real(64 << 24))
#define ENDLESS wide::from(INT64_MAX)
#define RESULT(a) (((a) + 128).value() >> 8)
#define GIVEN(a) (real(a) * 256)
#define FINITE(a) check_range(a)
#define EXACT_TO (256 << 16)
#define RUNS(model) ((model)->predict_q != NULL)

static inline bool check_range(int32_t a) { return -(1 << 29) < a && a < 1 << 29; }
static inline bool check_range(real a) { return check_range(a.value()); }
template <typename T> bool check_range(T) = delete; /* nothing that would be narrowed */
template <> inline bool check_range(int16_t a) { return check_range(int32_t{a}); }

static inline real check_mul(real a, real b)
{
    tally.products++;
    return real::from(((__int128)a.value() * b.value() + (1 << 23)) >> 24);
}

static inline wide check_product(real a, real b)
{
    tally.products++;
    return wide::from(((__int128)a.value() * b.value()) >> 8);
}

static inline real check_saturate(wide sum)
{
    const __int128 most = (__int128)64 << 40, exact = sum.value();
    return real::from(((exact > most ? most : exact < -most ? -most : exact) + (1 << 15)) >> 16);
}

static inline real check_div(real a, real b)
{
    tally.ratios++;
    const int64_t n = (int64_t)a.value() * (1 << 24), d = b.value();
    if (d == 0 || n / d >= INT32_MAX || n / d <= -INT32_MAX) return tally.overflows++, real(0);
    return real::from(edml__divide_q24(a.value(), b.value()));
}

static inline real check_sqrt(real a)
{
    tally.roots++;
    return a > 0 ? real::from(edml__root((uint64_t)a.value() << 24)) : real(0);
}

static inline real check_norm(real a, real b, real c)
{
    tally.roots++;
    const __int128 squares = (__int128)a.value() * a.value() + (__int128)b.value() * b.value() +
                             (__int128)c.value() * c.value(); /* < 2^64 */
    return real::from(edml__root((uint64_t)squares));
}

#endif
