/* glsl.hpp - as much of GLSL as the emitted shaders use, in C++, so that their text compiles for the CPU as it is.
 *
 * A file that includes this, defines `float` as `real` and then includes a shader's text gets it in the arithmetic GLSL_DOUBLE asks for.
 * What is not here is a compile error, so that nothing is guessed. twin.cpp lists the few substitutions that the text needs before.
 *
 * What Vulkan leaves undefined is counted as a fault and reported with the pass and the invocation: texels outside a texture or not written
 * since the frame began, levels other than 0, NaN or numbers out of range to int and uint, a division by zero, an index outside a vector.
 * C++20: shifts of negative numbers are what GLSL says they are. */
#ifndef HBIL_TWIN_GLSL_HPP
#define HBIL_TWIN_GLSL_HPP

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <ucontext.h>
#ifdef __FMA__
#include <xmmintrin.h>
#endif

#include "twin_abi.h"

typedef unsigned int uint;

namespace glsl {

#if GLSL_DOUBLE
typedef double number;
#else
typedef float number;
#endif

/* ---- faults */

static twin_state *state; /* of the run in progress */

[[gnu::cold, gnu::noinline]] inline void fault(int kind, const char *what, int x, int y, int z)
{
    twin_faults *f = state->faults;
    if (f->count[kind]++ || f->first[kind][0]) return;
    snprintf(f->first[kind], sizeof f->first[kind], "%s: %s (%d, %d, %d), invocation (%d, %d)", state->pass, what, x, y, z, state->at[0],
             state->at[1]);
}

#define GLSL inline __attribute__((always_inline))

/* ---- float */

/* Made from every literal, as GLSL does, and by itself never anything else. */
struct real {
    number v;
    real() = default;
    constexpr real(double x) : v((number)x) {}
    constexpr real(float x) : v((number)x) {}
    constexpr real(int x) : v((number)x) {}
    constexpr real(uint x) : v((number)x) {}
    explicit constexpr real(bool x) : v(x ? (number)1 : (number)0) {}
    GLSL explicit operator int() const
    {
        if (!(v > (number)-2147483649.0 && v < (number)2147483648.0)) return fault(TWIN_CONVERSION, "int of NaN or too large", 0, 0, 0), INT32_MIN;
        return (int)v;
    }
    GLSL explicit operator uint() const
    {
        if (!(v > (number)-1.0 && v < (number)4294967296.0)) return fault(TWIN_CONVERSION, "uint of NaN or out of range", 0, 0, 0), 0u;
        return (uint)v;
    }
};

/* GLSL_LOOSE: results are as bad as Vulkan lets them be. Denormals are 0; functions are off by as many units in the last place as the
 * specification has in its table of precision, up or down by chance (the same for the same operands). Where the processor can, products are
 * fused with sums, and it is what flushes: a test would keep the two apart. */
#if GLSL_LOOSE && defined(__FMA__)
struct flushing {
    const unsigned before = _mm_getcsr();
    flushing() { _mm_setcsr(before | 0x8040); } /* flush to zero, denormals are zero */
    ~flushing() { _mm_setcsr(before); }
};
GLSL constexpr number flushed(number v) { return v; }
#else
struct flushing {};
GLSL constexpr number flushed(number v) { return GLSL_LOOSE && v < 0x1p-126f && v > -0x1p-126f ? v * 0 : v; }
#endif
#if GLSL_LOOSE
GLSL constexpr uint32_t bits_of(number v) { return __builtin_bit_cast(uint32_t, (float)v); }
GLSL constexpr int thrown(number a, number b = 0)
{
    const uint32_t bits = (bits_of(a) ^ bits_of(b) * 0x85ebca6bu) * 0x9e3779b9u;
    return (int)(bits >> 20 & 7) < 3 ? -1 : (int)(bits >> 20 & 7) > 4; /* -1, 0, 1 */
}
GLSL constexpr number off_by(number v, int ulps, number a, number b = 0)
{
    v = flushed(v);
    if (v - v != 0 || v == 0) return v;
    return flushed((number)__builtin_bit_cast(float, bits_of(v) + (uint32_t)(ulps * thrown(a, b))));
}
#else
GLSL constexpr int thrown(number) { return 0; }
GLSL constexpr number off_by(number v, int, number, number = 0) { return v; }
#endif

GLSL constexpr number divided(number a, number b)
{
    if (b == 0) fault(TWIN_DIVISION, "division by zero", 0, 0, 0);
    return off_by(a / b, 2, a, b);
}

GLSL constexpr real operator+(real a, real b) { a.v = flushed(a.v + b.v); return a; }
GLSL constexpr real operator-(real a, real b) { a.v = flushed(a.v - b.v); return a; }
GLSL constexpr real operator*(real a, real b) { a.v = flushed(a.v * b.v); return a; }
GLSL constexpr real operator/(real a, real b) { a.v = divided(a.v, b.v); return a; }
GLSL constexpr real operator-(real a) { a.v = -a.v; return a; }
GLSL real &operator+=(real &a, real b) { return a = a + b; }
GLSL real &operator-=(real &a, real b) { return a = a - b; }
GLSL real &operator*=(real &a, real b) { return a = a * b; }
GLSL real &operator/=(real &a, real b) { a.v = divided(a.v, b.v); return a; }
GLSL constexpr bool operator<(real a, real b) { return a.v < b.v; }
GLSL constexpr bool operator>(real a, real b) { return a.v > b.v; }
GLSL constexpr bool operator<=(real a, real b) { return a.v <= b.v; }
GLSL constexpr bool operator>=(real a, real b) { return a.v >= b.v; }
GLSL constexpr bool operator==(real a, real b) { return a.v == b.v; }
GLSL constexpr bool operator!=(real a, real b) { return a.v != b.v; }

GLSL real root(real x) { ++state->counts->roots; x.v = (number)::sqrt(x.v); return x; }
GLSL real sqrt(real x) { x.v = off_by(root(x).v, 4, x.v); return x; } /* 1 / inversesqrt(x) */
#if GLSL_DOUBLE
#define GLSL_CALL(name) ::name
#else
#define GLSL_CALL(name) ::name##f
#endif
#define GLSL_FUNCTION(name) GLSL real name(real x) { x.v = GLSL_CALL(name)(x.v); return x; }
GLSL_FUNCTION(floor) GLSL_FUNCTION(rint)
GLSL real roundEven(real x) { return rint(x); }
GLSL real sin(real x) { return real(GLSL_CALL(sin)(x.v) + (number)0x1p-11 * thrown(x.v)); }
GLSL real cos(real x) { return real(GLSL_CALL(cos)(x.v) + (number)0x1p-11 * thrown(x.v)); }
GLSL real exp2(real x) { x.v = off_by(GLSL_CALL(exp2)(x.v), 3 + (int)(2 * fmin(fabs((double)x.v), 500)), x.v); return x; }
GLSL real log2(real x)
{
    const number exact = GLSL_CALL(log2)(x.v);
    x.v = x.v >= (number)0.5 && x.v <= 2 ? exact + (number)0x1p-21 * thrown(x.v) : off_by(exact, 3, x.v);
    return x;
}
GLSL real inversesqrt(real x) { x.v = off_by((number)1 / root(x).v, 2, x.v); return x; }
GLSL real abs(real x) { x.v = GLSL_CALL(fabs)(x.v); return x; }
GLSL real fract(real x) { return x - floor(x); }
GLSL real atan(real y, real x) { y.v = off_by(GLSL_CALL(atan2)(y.v, x.v), 4096, y.v, x.v); return y; }
/* NaN as GLSL words it: the first operand, unless the other one is less. GLSL_STICKY: NaN wherever one is, as other devices may. */
GLSL real min(real a, real b)
{
#if GLSL_STICKY
    if (b.v != b.v) return b;
#endif
    return b.v < a.v ? b : a;
}
GLSL real max(real a, real b)
{
#if GLSL_STICKY
    if (b.v != b.v) return b;
#endif
    return a.v < b.v ? b : a;
}
GLSL real clamp(real x, real low, real high) { return min(max(x, low), high); }
GLSL real mix(real a, real b, real t) { return a * (real(1) - t) + b * t; }
GLSL real smoothstep(real low, real high, real x)
{
    const real t = clamp((x - low) / (high - low), 0, 1);
    return t * t * (real(3) - real(2) * t);
}
GLSL real min(double a, double b) { return min(real(a), real(b)); } /* two literals are not ints */
GLSL real max(double a, double b) { return max(real(a), real(b)); }

GLSL int abs(int x) { return x < 0 ? -x : x; }
GLSL int min(int a, int b) { return b < a ? b : a; }
GLSL int max(int a, int b) { return a < b ? b : a; }
GLSL int clamp(int x, int low, int high) { return min(max(x, low), high); }
GLSL uint min(uint a, uint b) { return b < a ? b : a; }
GLSL uint max(uint a, uint b) { return a < b ? b : a; }
GLSL int findLSB(uint x) { return x ? __builtin_ctz(x) : -1; }
GLSL int bitCount(uint x) { return __builtin_popcount(x); }
GLSL uint floatBitsToUint(real x)
{
    const float f = (float)x.v; /* bits are those of a float in either arithmetic */
    uint bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}
GLSL real uintBitsToFloat(uint bits)
{
    float f;
    memcpy(&f, &bits, sizeof f);
    return real(f);
}

/* ---- vectors */

template <int I, class P> GLSL constexpr auto &part(P &p)
{
    if constexpr (I == 0) return p.x;
    else if constexpr (I == 1) return p.y;
    else if constexpr (I == 2) return p.z;
    else return p.w;
}

/* Components I of a vector of type P, in that order: read as a vector of type V, written by one if each is there once. It is a member of the
 * union that P begins with, so its address is that of the vector. */
template <class V, class P, class S, int... I> struct swizzle {
    S first;
    GLSL operator V() const { return V(part<I>(*reinterpret_cast<const P *>(this))...); }
    GLSL swizzle &operator=(const V &v)
    {
        int k = 0;
        ((part<I>(*reinterpret_cast<P *>(this)) = v[k++]), ...);
        return *this;
    }
    GLSL swizzle &operator=(const swizzle &o) { return *this = (V)o; }
    template <class T> GLSL swizzle &operator+=(const T &v) { return *this = (V)*this + v; }
    template <class T> GLSL swizzle &operator*=(const T &v) { return *this = (V)*this * v; }
};

template <int N, class V> GLSL auto &indexed(V &v, int i)
{
    if (i < 0 || i >= N) fault(TWIN_INDEX, "component", i, 0, 0), i = 0;
    if constexpr (N == 2) return i == 0 ? v.x : v.y;
    else if constexpr (N == 3) return i == 0 ? v.x : i == 1 ? v.y : v.z;
    else return i == 0 ? v.x : i == 1 ? v.y : i == 2 ? v.z : v.w;
}

struct vec2; struct vec3; struct vec4; struct ivec2; struct ivec3; struct ivec4; struct uvec2; struct uvec3; struct uvec4;
struct bvec2 { bool x, y; };
struct bvec3 { bool x, y, z; };
struct bvec4 { bool x, y, z, w; };

#define GLSL_COMMON(V, S, N) V() = default; \
    GLSL S &operator[](int i) { return indexed<N>(*this, i); } \
    GLSL const S &operator[](int i) const { return indexed<N>(*this, i); }
#define GLSL_VEC2(V, S, A, B) \
    struct V { \
        union { S x, r; swizzle<V, V, S, 0, 1> xy, rg; swizzle<V, V, S, 1, 0> yx; }; \
        union { S y, g; }; \
        GLSL_COMMON(V, S, 2) \
        GLSL V(const V &o) : x(o.x), y(o.y) {} \
        GLSL V &operator=(const V &o) { x = o.x; y = o.y; return *this; } \
        GLSL explicit V(S s) : x(s), y(s) {} \
        GLSL V(S x_, S y_) : x(x_), y(y_) {} \
        GLSL explicit V(bvec2 v) : x(S(v.x)), y(S(v.y)) {} \
        explicit V(const A &); explicit V(const B &); \
    };
#define GLSL_VEC3(V, S, V2, A, B) \
    struct V { \
        union { S x, r; swizzle<V2, V, S, 0, 1> xy, rg; swizzle<V2, V, S, 1, 0> yx; swizzle<V, V, S, 0, 1, 2> xyz, rgb; \
                swizzle<V, V, S, 0, 0, 0> rrr; }; \
        union { S y, g; }; \
        union { S z, b; }; \
        GLSL_COMMON(V, S, 3) \
        GLSL V(const V &o) : x(o.x), y(o.y), z(o.z) {} \
        GLSL V &operator=(const V &o) { x = o.x; y = o.y; z = o.z; return *this; } \
        GLSL explicit V(S s) : x(s), y(s), z(s) {} \
        GLSL V(S x_, S y_, S z_) : x(x_), y(y_), z(z_) {} \
        GLSL V(const V2 &v, S z_) : x(v.x), y(v.y), z(z_) {} \
        GLSL explicit V(bvec3 v) : x(S(v.x)), y(S(v.y)), z(S(v.z)) {} \
        explicit V(const A &); explicit V(const B &); \
    };
#define GLSL_VEC4(V, S, V2, V3, A, B) \
    struct V { \
        union { S x, r; swizzle<V2, V, S, 0, 1> xy, rg; swizzle<V2, V, S, 1, 0> yx; swizzle<V2, V, S, 2, 3> zw; \
                swizzle<V3, V, S, 0, 1, 2> xyz, rgb; swizzle<V3, V, S, 0, 0, 0> rrr; swizzle<V, V, S, 0, 0, 0, 0> rrrr; }; \
        union { S y, g; }; \
        union { S z, b; }; \
        union { S w, a; }; \
        GLSL_COMMON(V, S, 4) \
        GLSL V(const V &o) : x(o.x), y(o.y), z(o.z), w(o.w) {} \
        GLSL V &operator=(const V &o) { x = o.x; y = o.y; z = o.z; w = o.w; return *this; } \
        GLSL explicit V(S s) : x(s), y(s), z(s), w(s) {} \
        GLSL V(S x_, S y_, S z_, S w_) : x(x_), y(y_), z(z_), w(w_) {} \
        GLSL V(const V2 &u, const V2 &v) : x(u.x), y(u.y), z(v.x), w(v.y) {} \
        GLSL V(const V3 &v, S w_) : x(v.x), y(v.y), z(v.z), w(w_) {} \
        GLSL explicit V(bvec4 v) : x(S(v.x)), y(S(v.y)), z(S(v.z)), w(S(v.w)) {} \
        explicit V(const A &); explicit V(const B &); \
    };
GLSL_VEC2(vec2, real, ivec2, uvec2) GLSL_VEC2(ivec2, int, vec2, uvec2) GLSL_VEC2(uvec2, uint, vec2, ivec2)
GLSL_VEC3(vec3, real, vec2, ivec3, uvec3) GLSL_VEC3(ivec3, int, ivec2, vec3, uvec3) GLSL_VEC3(uvec3, uint, uvec2, vec3, ivec3)
GLSL_VEC4(vec4, real, vec2, vec3, ivec4, uvec4) GLSL_VEC4(ivec4, int, ivec2, ivec3, vec4, uvec4)
GLSL_VEC4(uvec4, uint, uvec2, uvec3, vec4, ivec4)

/* Component by component: e(x) says what x becomes. */
#define GLSL_2(V, e) V(e(x), e(y))
#define GLSL_3(V, e) V(e(x), e(y), e(z))
#define GLSL_4(V, e) V(e(x), e(y), e(z), e(w))

#define GLSL_CAST_real(k) real(v.k)
#define GLSL_CAST_int(k) int(v.k)
#define GLSL_CAST_uint(k) uint(v.k)
#define GLSL_FROM(N, V, S, A) GLSL V::V(const A &v) : V(GLSL_##N(V, GLSL_CAST_##S)) {}
GLSL_FROM(2, vec2, real, ivec2) GLSL_FROM(2, vec2, real, uvec2) GLSL_FROM(2, ivec2, int, vec2) GLSL_FROM(2, ivec2, int, uvec2)
GLSL_FROM(2, uvec2, uint, vec2) GLSL_FROM(2, uvec2, uint, ivec2)
GLSL_FROM(3, vec3, real, ivec3) GLSL_FROM(3, vec3, real, uvec3) GLSL_FROM(3, ivec3, int, vec3) GLSL_FROM(3, ivec3, int, uvec3)
GLSL_FROM(3, uvec3, uint, vec3) GLSL_FROM(3, uvec3, uint, ivec3)
GLSL_FROM(4, vec4, real, ivec4) GLSL_FROM(4, vec4, real, uvec4) GLSL_FROM(4, ivec4, int, vec4) GLSL_FROM(4, ivec4, int, uvec4)
GLSL_FROM(4, uvec4, uint, vec4) GLSL_FROM(4, uvec4, uint, ivec4)

#define GLSL_MAKE(N, V, S, name, op) \
    GLSL V operator op(const V &a, const V &b) { return GLSL_##N(V, GLSL_VV_##name); } \
    GLSL V operator op(const V &a, S b) { return GLSL_##N(V, GLSL_VS_##name); } \
    GLSL V operator op(S a, const V &b) { return GLSL_##N(V, GLSL_SV_##name); } \
    GLSL V &operator op##=(V &a, const V &b) { return a = a op b; } \
    GLSL V &operator op##=(V &a, S b) { return a = a op b; }
#define GLSL_VV_add(k) a.k + b.k
#define GLSL_VS_add(k) a.k + b
#define GLSL_SV_add(k) a + b.k
#define GLSL_VV_sub(k) a.k - b.k
#define GLSL_VS_sub(k) a.k - b
#define GLSL_SV_sub(k) a - b.k
#define GLSL_VV_mul(k) a.k * b.k
#define GLSL_VS_mul(k) a.k * b
#define GLSL_SV_mul(k) a * b.k
#define GLSL_VV_div(k) a.k / b.k
#define GLSL_VS_div(k) a.k / b
#define GLSL_SV_div(k) a / b.k
#define GLSL_VV_mod(k) a.k % b.k
#define GLSL_VS_mod(k) a.k % b
#define GLSL_SV_mod(k) a % b.k
#define GLSL_VV_and(k) a.k & b.k
#define GLSL_VS_and(k) a.k & b
#define GLSL_SV_and(k) a & b.k
#define GLSL_VV_or(k) a.k | b.k
#define GLSL_VS_or(k) a.k | b
#define GLSL_SV_or(k) a | b.k
#define GLSL_VV_left(k) a.k << b.k
#define GLSL_VS_left(k) a.k << b
#define GLSL_SV_left(k) a << b.k
#define GLSL_VV_right(k) a.k >> b.k
#define GLSL_VS_right(k) a.k >> b
#define GLSL_SV_right(k) a >> b.k
#define GLSL_MINUS(k) -a.k
#define GLSL_ARITHMETIC(N, V, S) GLSL_MAKE(N, V, S, add, +) GLSL_MAKE(N, V, S, sub, -) GLSL_MAKE(N, V, S, mul, *) GLSL_MAKE(N, V, S, div, /) \
    GLSL V operator-(const V &a) { return GLSL_##N(V, GLSL_MINUS); } \
    GLSL bool operator==(const V &a, const V &b) { return all(equal(a, b)); } \
    GLSL bool operator!=(const V &a, const V &b) { return any(notEqual(a, b)); }
#define GLSL_BITS(N, V, S) GLSL_MAKE(N, V, S, mod, %) GLSL_MAKE(N, V, S, and, &) GLSL_MAKE(N, V, S, or, |) \
    GLSL_MAKE(N, V, S, left, <<) GLSL_MAKE(N, V, S, right, >>)

#define GLSL_lt(k) a.k < b.k
#define GLSL_le(k) a.k <= b.k
#define GLSL_gt(k) a.k > b.k
#define GLSL_ge(k) a.k >= b.k
#define GLSL_eq(k) a.k == b.k
#define GLSL_ne(k) a.k != b.k
#define GLSL_COMPARE(N, V, name, op) GLSL bvec##N name(const V &a, const V &b) { return bvec##N{GLSL_LIST_##N(op)}; }
#define GLSL_LIST_2(e) e(x), e(y)
#define GLSL_LIST_3(e) e(x), e(y), e(z)
#define GLSL_LIST_4(e) e(x), e(y), e(z), e(w)
#define GLSL_COMPARES(N, V) GLSL_COMPARE(N, V, lessThan, GLSL_lt) GLSL_COMPARE(N, V, lessThanEqual, GLSL_le) \
    GLSL_COMPARE(N, V, greaterThan, GLSL_gt) GLSL_COMPARE(N, V, greaterThanEqual, GLSL_ge) GLSL_COMPARE(N, V, equal, GLSL_eq) \
    GLSL_COMPARE(N, V, notEqual, GLSL_ne)
GLSL bool any(bvec2 b) { return b.x || b.y; }
GLSL bool any(bvec3 b) { return b.x || b.y || b.z; }
GLSL bool any(bvec4 b) { return b.x || b.y || b.z || b.w; }
GLSL bool all(bvec2 b) { return b.x && b.y; }
GLSL bool all(bvec3 b) { return b.x && b.y && b.z; }
GLSL bool all(bvec4 b) { return b.x && b.y && b.z && b.w; }
GLSL_COMPARES(2, vec2) GLSL_COMPARES(3, vec3) GLSL_COMPARES(4, vec4) GLSL_COMPARES(2, ivec2) GLSL_COMPARES(3, ivec3)
GLSL_COMPARES(2, uvec2) GLSL_COMPARES(3, uvec3)
GLSL_ARITHMETIC(2, vec2, real) GLSL_ARITHMETIC(3, vec3, real) GLSL_ARITHMETIC(4, vec4, real)
GLSL_ARITHMETIC(2, ivec2, int) GLSL_ARITHMETIC(3, ivec3, int) GLSL_ARITHMETIC(2, uvec2, uint) GLSL_ARITHMETIC(3, uvec3, uint)
GLSL_BITS(2, ivec2, int) GLSL_BITS(3, ivec3, int) GLSL_BITS(2, uvec2, uint) GLSL_BITS(3, uvec3, uint)

#define GLSL_MIN(k) min(a.k, b.k)
#define GLSL_MAX(k) max(a.k, b.k)
#define GLSL_ABS(k) abs(a.k)
#define GLSL_RANGE(N, V, S) \
    GLSL V min(const V &a, const V &b) { return GLSL_##N(V, GLSL_MIN); } \
    GLSL V max(const V &a, const V &b) { return GLSL_##N(V, GLSL_MAX); } \
    GLSL V min(const V &a, S b) { return min(a, V(b)); } \
    GLSL V max(const V &a, S b) { return max(a, V(b)); } \
    GLSL V clamp(const V &x, const V &low, const V &high) { return min(max(x, low), high); } \
    GLSL V clamp(const V &x, S low, S high) { return min(max(x, low), high); } \
    GLSL V abs(const V &a) { return GLSL_##N(V, GLSL_ABS); }
GLSL_RANGE(2, vec2, real) GLSL_RANGE(3, vec3, real) GLSL_RANGE(4, vec4, real) GLSL_RANGE(2, ivec2, int) GLSL_RANGE(3, ivec3, int)
#define GLSL_floor(k) floor(a.k)
#define GLSL_fract(k) fract(a.k)
#define GLSL_sqrt(k) sqrt(a.k)
#define GLSL_inversesqrt(k) inversesqrt(a.k)
#define GLSL_sin(k) sin(a.k)
#define GLSL_cos(k) cos(a.k)
#define GLSL_MAP(N, V, name) GLSL V name(const V &a) { return GLSL_##N(V, GLSL_##name); }
#define GLSL_MIX(k) mix(a.k, b.k, t.k)
#define GLSL_MIX_ALL(k) mix(a.k, b.k, t)
#define GLSL_CHOOSE(k) t.k ? b.k : a.k
#define GLSL_FLOATS(N, V) GLSL_MAP(N, V, floor) GLSL_MAP(N, V, fract) GLSL_MAP(N, V, sqrt) GLSL_MAP(N, V, inversesqrt) \
    GLSL_MAP(N, V, sin) GLSL_MAP(N, V, cos) \
    GLSL V mix(const V &a, const V &b, const V &t) { return GLSL_##N(V, GLSL_MIX); } \
    GLSL V mix(const V &a, const V &b, real t) { return GLSL_##N(V, GLSL_MIX_ALL); } \
    GLSL V mix(const V &a, const V &b, bvec##N t) { return GLSL_##N(V, GLSL_CHOOSE); } \
    GLSL real length(const V &a) { return sqrt(dot(a, a)); } \
    GLSL V normalize(const V &a) { return a * inversesqrt(dot(a, a)); }
GLSL real dot(const vec2 &a, const vec2 &b) { return a.x * b.x + a.y * b.y; }
GLSL real dot(const vec3 &a, const vec3 &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
GLSL real dot(const vec4 &a, const vec4 &b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
GLSL_FLOATS(2, vec2) GLSL_FLOATS(3, vec3) GLSL_FLOATS(4, vec4)
GLSL vec3 cross(const vec3 &a, const vec3 &b)
{
    return vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
}
struct mat3 { vec3 column[3]; };
GLSL vec3 operator*(const mat3 &m, const vec3 &v) { return m.column[0] * v.x + m.column[1] * v.y + m.column[2] * v.z; }
GLSL vec3 operator*(const vec3 &v, const mat3 &m) { return vec3(dot(v, m.column[0]), dot(v, m.column[1]), dot(v, m.column[2])); }

GLSL uint snorm(real x) { return (uint)(int)::rint((clamp(x, -1, 1) * real(32767)).v) & 0xffffu; }
GLSL uint packSnorm2x16(const vec2 &v) { return snorm(v.x) | snorm(v.y) << 16; }
GLSL vec2 unpackSnorm2x16(uint code)
{
    return clamp(vec2(real((int16_t)(uint16_t)code), real((int16_t)(uint16_t)(code >> 16))) / real(32767), real(-1), real(1));
}

/* Arrays are passed by value, and converted element by element. */
template <class T, int N> struct array {
    T c[N];
    array() = default;
    template <class U> array(const array<U, N> &o) { for (int i = 0; i < N; ++i) c[i] = T(o.c[i]); }
    GLSL T &operator[](int i) { return c[in_range(i)]; }
    GLSL const T &operator[](int i) const { return c[in_range(i)]; }
    static int in_range(int i)
    {
        if (i >= 0 && i < N) return i;
        fault(TWIN_INDEX, "element", i, 0, 0);
        return 0;
    }
};

/* ---- mediump: every value rounded to IEEE half, the least that devices make of it */

inline number half(number x)
{
    float f = (float)x;
    uint bits;
    const float size = fabsf(f);
    if (!(size < 65520.0f)) return size > 0 ? (number)copysignf(INFINITY, f) : x; /* NaN stays */
    if (size < 6.103515625e-5f) return (number)copysignf((size + 0.5f) - 0.5f, f);
    memcpy(&bits, &f, sizeof bits);
    bits = (bits + 0xfffu + (bits >> 13 & 1u)) & ~0x1fffu;
    memcpy(&f, &bits, sizeof f);
    return (number)f;
}
struct mediump_float {
    real v;
    mediump_float() = default;
    mediump_float(real x) { v.v = half(x.v); }
    mediump_float(double x) : mediump_float(real(x)) {}
    operator real() const { return v; }
};
struct mediump_vec4 {
    vec4 v;
    mediump_vec4() = default;
    mediump_vec4(const vec4 &o) { v = vec4(real(half(o.x.v)), real(half(o.y.v)), real(half(o.z.v)), real(half(o.w.v))); }
    operator vec4() const { return v; }
};
inline mediump_vec4 operator+(const mediump_vec4 &a, const mediump_vec4 &b) { return a.v + b.v; }
inline mediump_vec4 operator-(const mediump_vec4 &a, const mediump_vec4 &b) { return a.v - b.v; }
inline mediump_vec4 operator*(mediump_float a, const mediump_vec4 &b) { return a.v * b.v; }
inline mediump_vec4 &operator+=(mediump_vec4 &a, const mediump_vec4 &b) { return a = a + b; }

/* ---- textures */

inline long texel_at(const twin_texture *t, int kind, int x, int y, int z)
{
    if (x >= 0 && y >= 0 && z >= 0 && x < t->bound[0] && y < t->bound[1] && z < t->depth) return ((long)z * t->height + y) * t->width + x;
    fault(kind, t->name, x, y, z);
    return -1;
}
inline long texel_to_read(const twin_texture *t, int x, int y, int z, int level)
{
    long i = texel_at(t, TWIN_FETCH, x, y, z);
    ++state->counts->reads;
    if (level != 0) fault(TWIN_FETCH, "level other than 0", level, 0, 0);
    if (i >= 0 && !t->written[i]) fault(TWIN_UNWRITTEN, t->name, x, y, z);
    return i;
}
GLSL vec4 fetch(const twin_texture *t, int x, int y, int z, int level)
{
    const long i = texel_to_read(t, x, y, z, level);
    const real *c = (const real *)t->texels + i * t->channels;
    if (i < 0) return vec4(real(NAN));
    return t->channels == 1 ? vec4(c[0], real(0), real(0), real(1)) : vec4(c[0], c[1], c[2], c[3]);
}
GLSL uvec4 fetch_uint(const twin_texture *t, int x, int y, int z, int level)
{
    const long i = texel_to_read(t, x, y, z, level);
    return i < 0 ? uvec4(0xffffffffu) : uvec4(((const uint *)t->texels)[i], 0u, 0u, 1u);
}
inline void put(twin_texture *t, int x, int y, int z, const vec4 &v)
{
    ++state->counts->writes;
    const long i = texel_at(t, TWIN_STORE, x, y, z);
    if (i < 0) return;
    real *c = (real *)t->texels + i * t->channels;
    for (int k = 0; k < t->channels; ++k) c[k].v = t->half && !GLSL_DOUBLE ? half(v[k].v) : v[k].v;
    t->written[i] = 1;
}
inline void put(twin_texture *t, int x, int y, int z, const uvec4 &v)
{
    ++state->counts->writes;
    const long i = texel_at(t, TWIN_STORE, x, y, z);
    if (i < 0) return;
    ((uint *)t->texels)[i] = v.x;
    t->written[i] = 1;
}

struct bound { twin_texture *t; };
struct sampler2D : bound {};
struct sampler2DMS : bound {};
struct sampler2DArray : bound {};
struct samplerCube : bound {};
struct sampler3D : bound {};
struct usampler2D : bound {};
struct usampler2DArray : bound {};
struct image2D : bound {};
struct image2DArray : bound {};
struct uimage2D : bound {};
struct uimage2DArray : bound {};

GLSL vec4 texelFetch(sampler2D s, const ivec2 &p, int level) { return fetch(s.t, p.x, p.y, 0, level); }
GLSL vec4 texelFetch(sampler2DMS s, const ivec2 &p, int sample)
{
    return fetch(s.t, p.x, p.y, 0, sample - s.t->sample); /* the others hold garbage */
}
GLSL vec4 texelFetch(sampler2DArray s, const ivec3 &p, int level) { return fetch(s.t, p.x, p.y, p.z, level); }
GLSL uvec4 texelFetch(usampler2D s, const ivec2 &p, int level) { return fetch_uint(s.t, p.x, p.y, 0, level); }
GLSL uvec4 texelFetch(usampler2DArray s, const ivec3 &p, int level) { return fetch_uint(s.t, p.x, p.y, p.z, level); }
GLSL uvec4 imageLoad(uimage2DArray s, const ivec3 &p) { return fetch_uint(s.t, p.x, p.y, p.z, 0); }
GLSL void imageStore(image2D s, const ivec2 &p, const vec4 &v) { put(s.t, p.x, p.y, 0, v); }
GLSL void imageStore(image2DArray s, const ivec3 &p, const vec4 &v) { put(s.t, p.x, p.y, p.z, v); }
GLSL void imageStore(uimage2D s, const ivec2 &p, const uvec4 &v) { put(s.t, p.x, p.y, 0, v); }
GLSL void imageStore(uimage2DArray s, const ivec3 &p, const uvec4 &v) { put(s.t, p.x, p.y, p.z, v); }
inline uint imageAtomicMin(uimage2D s, const ivec2 &p, uint value)
{
    const uint before = fetch_uint(s.t, p.x, p.y, 0, 0).x;
    if (texel_at(s.t, TWIN_STORE, p.x, p.y, 0) >= 0) put(s.t, p.x, p.y, 0, uvec4(min(before, value)));
    return before;
}
GLSL ivec3 textureSize(sampler3D s, int) { return ivec3(s.t->width, s.t->height, s.t->depth); }

/* Position on one axis of a linear, clamping sampler: the first of two texels, and the share of the second. */
inline void linear(real at, int size, int &low, int &high, real &share)
{
    const real p = clamp(at * real(size) - real(0.5), -1, size);
    low = int(floor(p));
    share = p - real(low);
    high = clamp(low + 1, 0, size - 1);
    low = clamp(low, 0, size - 1);
}
inline vec4 textureLod(sampler3D s, const vec3 &at, real)
{
    int x[2], y[2], z[2];
    real f[3];
    vec4 sum(real(0));
    linear(at.x, s.t->width, x[0], x[1], f[0]);
    linear(at.y, s.t->height, y[0], y[1], f[1]);
    linear(at.z, s.t->depth, z[0], z[1], f[2]);
    for (int i = 0; i < 8; ++i)
        sum += ((i & 1 ? f[0] : real(1) - f[0]) * (i & 2 ? f[1] : real(1) - f[1]) * (i & 4 ? f[2] : real(1) - f[2]))
             * fetch(s.t, x[i & 1], y[i >> 1 & 1], z[i >> 2], 0);
    return sum;
}

/* Face and place in [0, 1] of a direction: +X -X +Y -Y +Z -Z. */
inline int cube_face(const vec3 &d, vec2 &at)
{
    const vec3 a = abs(d);
    int face;
    real major, s, t;
    if (a.z >= a.x && a.z >= a.y) {
        face = d.z < real(0) ? 5 : 4, major = a.z, s = d.z < real(0) ? -d.x : d.x, t = -d.y;
    } else if (a.y >= a.x) {
        face = d.y < real(0) ? 3 : 2, major = a.y, s = d.x, t = d.y < real(0) ? -d.z : d.z;
    } else {
        face = d.x < real(0) ? 1 : 0, major = a.x, s = d.x < real(0) ? d.z : -d.z, t = -d.y;
    }
    at = (vec2(s, t) / major + real(1)) * real(0.5);
    return face;
}
inline vec3 cube_direction(int face, const vec2 &at)
{
    const real s = at.x * real(2) - real(1), t = at.y * real(2) - real(1), one = 1;
    switch (face) {
    case 0: return vec3(one, -t, -s);
    case 1: return vec3(-one, -t, s);
    case 2: return vec3(s, one, t);
    case 3: return vec3(s, -one, -t);
    case 4: return vec3(s, -t, one);
    default: return vec3(-s, -t, -one);
    }
}
/* Linear, seamless: a texel beyond an edge is the one of the next face, one beyond a corner does not count. */
inline vec4 textureLod(samplerCube s, const vec3 &direction, real)
{
    const int n = s.t->width;
    vec2 at;
    const int face = cube_face(direction, at);
    const vec2 p = clamp(at * real(n) - real(0.5), real(-1), real(n));
    const ivec2 first(floor(p));
    const vec2 f = p - vec2(first);
    vec4 sum(real(0));
    real all = 0;
    for (int i = 0; i < 4; ++i) {
        const ivec2 q = first + ivec2(i & 1, i >> 1);
        const bool beside = q.x < 0 || q.x >= n, above = q.y < 0 || q.y >= n;
        const real w = (i & 1 ? f.x : real(1) - f.x) * (i & 2 ? f.y : real(1) - f.y);
        ivec2 r = q;
        int there = face;
        if (beside && above) continue;
        if (beside || above) {
            vec2 place;
            there = cube_face(cube_direction(face, (vec2(q) + real(0.5)) / real(n)), place);
            r = clamp(ivec2(floor(place * real(n))), ivec2(0), ivec2(n - 1));
        }
        sum += w * fetch(s.t, r.x, r.y, there, 0);
        all += w;
    }
    return sum / all;
}

/* A target of a fragment shader. */
template <class V> struct target {
    V    value;
    bool written;
    target &operator=(const V &v) { value = v; written = true; return *this; }
};
template <class V> void begin(target<V> &t) { t.written = false; }
template <class V, int N> void begin(array<target<V>, N> &t) { for (int i = 0; i < N; ++i) t[i].written = false; }
template <class V> void end(twin_texture *to, int x, int y, const target<V> &t) { if (t.written) put(to, x, y, 0, t.value); }
template <class V, int N> void end(twin_texture *to, int x, int y, const array<target<V>, N> &t)
{
    for (int i = 0; i < N; ++i) if (t[i].written) put(to, x, y, i, t[i].value);
}

/* ---- the uniform block: members from their place in std140 */

inline void load(int &to, const unsigned char *from) { memcpy(&to, from, sizeof to); }
inline void load(uint &to, const unsigned char *from) { memcpy(&to, from, sizeof to); }
inline void load(real &to, const unsigned char *from) { float f; memcpy(&f, from, sizeof f); to = real(f); }
inline void load(ivec2 &to, const unsigned char *from) { load(to.x, from), load(to.y, from + 4); }
inline void load(vec2 &to, const unsigned char *from) { load(to.x, from), load(to.y, from + 4); }
inline void load(vec3 &to, const unsigned char *from) { load(to.x, from), load(to.y, from + 4), load(to.z, from + 8); }
inline void load(vec4 &to, const unsigned char *from) { for (int i = 0; i < 4; ++i) load(to[i], from + 4 * i); }
inline void load(mat3 &to, const unsigned char *from) { for (int i = 0; i < 3; ++i) load(to.column[i], from + 16 * i); }
template <int N> void load(array<vec4, N> &to, const unsigned char *from) { for (int i = 0; i < N; ++i) load(to[i], from + 16 * i); }

/* ---- invocations */

static uvec3 gl_GlobalInvocationID, gl_LocalInvocationID;
static vec4  gl_FragCoord;

/* A work group whose invocations wait for each other: each has a stack of its own. */
enum { GROUP = 64, STACK = 1 << 18 };
struct fiber { ucontext_t context; bool done; void *fake; uvec3 global, local; };
static fiber fibers[GROUP];
static ucontext_t scheduler;
static void *scheduler_fake;
static const void *scheduler_stack;
static size_t scheduler_size;
static int current;
static void (*fiber_main)();
static char *stacks;

/* AddressSanitizer has to be told of stacks that change; the calls are not there without it. */
extern "C" void __sanitizer_start_switch_fiber(void **, const void *, size_t) __attribute__((weak));
extern "C" void __sanitizer_finish_switch_fiber(void *, const void **, size_t *) __attribute__((weak));

inline void to_scheduler(bool last)
{
    fiber &f = fibers[current];
    if (__sanitizer_start_switch_fiber) __sanitizer_start_switch_fiber(last ? nullptr : &f.fake, scheduler_stack, scheduler_size);
    swapcontext(&f.context, &scheduler);
    if (__sanitizer_finish_switch_fiber) __sanitizer_finish_switch_fiber(f.fake, &scheduler_stack, &scheduler_size);
}
inline void fiber_start()
{
    if (__sanitizer_finish_switch_fiber) __sanitizer_finish_switch_fiber(nullptr, &scheduler_stack, &scheduler_size);
    fiber_main();
    fibers[current].done = true;
    to_scheduler(true);
}
inline void barrier() { to_scheduler(false); }

inline void enter(int i)
{
    fiber &f = fibers[i];
    current = i;
    gl_GlobalInvocationID = f.global;
    gl_LocalInvocationID = f.local;
    state->at[0] = (int)f.global.x, state->at[1] = (int)f.global.y;
    if (__sanitizer_start_switch_fiber) __sanitizer_start_switch_fiber(&scheduler_fake, stacks + (size_t)i * STACK, STACK);
    swapcontext(&scheduler, &f.context);
    if (__sanitizer_finish_switch_fiber) __sanitizer_finish_switch_fiber(scheduler_fake, nullptr, nullptr);
}
/* All invocations of a group up to their next barrier, in turns, until they have ended. */
inline void lockstep(int count, void (*shader)())
{
    bool going = true;
    if (!stacks) stacks = (char *)malloc((size_t)GROUP * STACK);
    fiber_main = shader;
    for (int i = 0; i < count; ++i) {
        getcontext(&fibers[i].context);
        fibers[i].context.uc_stack.ss_sp = stacks + (size_t)i * STACK;
        fibers[i].context.uc_stack.ss_size = STACK;
        fibers[i].done = false;
        fibers[i].fake = nullptr;
        makecontext(&fibers[i].context, fiber_start, 0);
    }
    while (going) {
        going = false;
        for (int i = 0; i < count; ++i) {
            if (!fibers[i].done) enter(i);
            going = going || !fibers[i].done;
        }
    }
}

/* group: its size; groups: how many. waits: the shader has a barrier. */
inline void compute(const int groups[2], const int group[2], bool waits, void (*shader)())
{
    for (int gy = 0; gy < groups[1]; ++gy)
        for (int gx = 0; gx < groups[0]; ++gx) {
            for (int i = 0; i < group[0] * group[1]; ++i) {
                const uvec3 local((uint)(i % group[0]), (uint)(i / group[0]), 0u);
                const uvec3 global((uint)(gx * group[0]) + local.x, (uint)(gy * group[1]) + local.y, 0u);
                if (waits) {
                    fibers[i].local = local, fibers[i].global = global;
                    continue;
                }
                gl_LocalInvocationID = local, gl_GlobalInvocationID = global;
                state->at[0] = (int)global.x, state->at[1] = (int)global.y;
                shader();
            }
            if (waits) lockstep(group[0] * group[1], shader);
        }
}
} /* namespace glsl */

#endif
