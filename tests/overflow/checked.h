/* Integers that watch themselves, in C++: each has the width that it has in fixed point, and every
 * operation on it is counted and checked for overflow.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_CHECKED_H
#define EDML_CHECKED_H

#include <stdint.h>

#include <limits>
#include <type_traits>

#include "overflow.h"

extern checked_tally tally;

/* An integer of T's width. */
template <typename T> class checked
{
  public:
    checked() = default;
    checked(int number) : value_(number) {}
    template <typename Other, typename = typename std::enable_if<(sizeof(Other) < sizeof(T))>::type>
    checked(checked<Other> narrower) : value_(narrower.value())
    {
    } /* the way back is TRUNCATE_TO */
    T value() const { return value_; }

    /* A result, given in more bits. */
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

#endif
