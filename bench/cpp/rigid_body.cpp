// The rigid body of sim/models/rigid by hand in C++: what the compiled Python is measured against.
//
// The same arithmetic in the same order, on vectors of eight doubles; a lane per vehicle, a row per number (struct of
// arrays). Built without contraction of a*b+c, it agrees with Python to the last bits; how: loop.py.

#include <cstddef>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace {

constexpr std::size_t kWide = 8, kMany = 2, kBlock = kWide * kMany;
typedef double V __attribute__((vector_size(8 * kWide)));

V all(double value) { return V{} + value; }

// Rows need not begin on a boundary.
V load(const double* from) {
    V v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}

void store(double* to, V v) { __builtin_memcpy(to, &v, sizeof v); }

#ifdef __AVX512F__

V root(V a) { return (V)_mm512_sqrt_pd((__m512d)a); }

// Of a NaN and a number these return their second argument, as Python's clip does.
V clip(V a, V low, V high) {
    return (V)_mm512_min_pd((__m512d)high, _mm512_max_pd((__m512d)low, (__m512d)a));
}

V size_of(V a) { return (V)_mm512_abs_pd((__m512d)a); }

#else

V root(V a) {
    V r{};
    for (std::size_t i = 0; i < kWide; ++i) r[i] = __builtin_sqrt(a[i]);
    return r;
}

V clip(V a, V low, V high) {
    a = a < low ? low : a;
    return a > high ? high : a;
}

V size_of(V a) { return a < 0.0 ? -a : a; }

#endif

struct Gains {
    double kp_h, kp_v, ki_h, ki_v, most_i, g, a_h, a_down, a_up, k_tilt, tilt_rate, yaw_rate, k_p, k_q, k_r, lead,
        per_g, least, most, share;
};

struct Rotors {
    double dt, up_half, up, down_half, down, c_t, c_p, c_q, c_r;
};

struct Body {
    double j_p, j_q, j_r, d_h, d_v, g, quarter, mount, least;
};

struct Constants {
    Gains gains;
    Rotors rotors;
    Body body;
};

struct Moving {
    V ux, uy, uz, w, x, y, z, p, q, r;
};

struct Four {
    V a, b, c, d;
};

struct State {
    V px, py, pz, vx, vy, vz, w, x, y, z, p, q, r, n1, n2, n3, n4;
};

struct Three {
    V x, y, z;
};

Four control(const State& s, Three& integral, const Four& v_ref, const Gains& k) {
    const V w = s.w, x = s.x, y = s.y, z = s.z;
    V ix = integral.x, iy = integral.y, iz = integral.z;
    const V xx = 1.0 - 2.0 * (y * y + z * z), xy = 2.0 * (x * y + w * z), xz = 2.0 * (x * z - w * y);
    const V yx = 2.0 * (x * y - w * z), yy = 1.0 - 2.0 * (x * x + z * z), yz = 2.0 * (y * z + w * x);
    const V zx = 2.0 * (x * z + w * y), zy = 2.0 * (y * z - w * x), zz = 1.0 - 2.0 * (x * x + y * y);

    const V level = 1.0 / root(clip(xx * xx + xy * xy, all(1e-12), all(2.0)));
    const V c = xx * level, sine = xy * level;
    const V ex = c * v_ref.a - sine * v_ref.b - s.vx, ey = sine * v_ref.a + c * v_ref.b - s.vy, ez = v_ref.c - s.vz;
    const V ax = k.kp_h * ex + ix, ay = k.kp_h * ey + iy, az = k.kp_v * ez + iz;
    const V size = root(ax * ax + ay * ay);
    V inside = k.a_h / clip(size, all(k.a_h), all(1e9));
    const V bx = ax * inside, by = ay * inside, bz = clip(az, all(k.a_down), all(k.a_up));
    const V wait = k.ki_h * clip(1.0 + k.a_h - size, all(0.0), all(1.0));
    ix = clip(ix + wait * ex, all(-k.most_i), all(k.most_i));
    iy = clip(iy + wait * ey, all(-k.most_i), all(k.most_i));
    iz = clip(iz + k.ki_v * clip(1.0 - size_of(az - bz), all(0.0), all(1.0)) * ez, all(-k.most_i), all(k.most_i));
    integral = {ix, iy, iz};

    const V length = root(bx * bx + by * by + k.g * k.g);
    const V unit = 1.0 / length;
    const V tx = unit * (bx * xx + by * xy + k.g * xz);
    const V ty = unit * (bx * yx + by * yy + k.g * yz);
    const V tz = unit * (bx * zx + by * zy + k.g * zz);
    const V turn = k.k_tilt / root(clip(0.5 + 0.5 * tz, all(1e-6), all(1.0)));
    const V heading = clip(v_ref.d, all(-k.yaw_rate), all(k.yaw_rate));
    const V p_ref = clip(-ty * turn, all(-k.tilt_rate), all(k.tilt_rate)) + heading * xz;
    const V q_ref = clip(tx * turn, all(-k.tilt_rate), all(k.tilt_rate)) + heading * yz;
    const V r_ref = heading * zz;

    const V s1 = s.n1 * s.n1, s2 = s.n2 * s.n2, s3 = s.n3 * s.n3, s4 = s.n4 * s.n4;
    V roll = k.k_p * (p_ref - s.p) - k.lead * (s2 + s3 - s1 - s4);
    V pitch = k.k_q * (q_ref - s.q) - k.lead * (s2 + s4 - s1 - s3);
    V yaw = k.k_r * (r_ref - s.r) - k.lead * (s3 + s4 - s1 - s2);
    inside = k.share / clip(size_of(roll) + size_of(pitch), all(k.share), all(1e9));
    roll = roll * inside;
    pitch = pitch * inside;
    const V tilting = clip(size_of(roll) + size_of(pitch), all(0.0), all(k.share));
    const V asked = clip(k.per_g * (k.g + bz) * tz * length, all(k.least), all(k.most));
    const V thrust = clip(asked, tilting, 1.0 - tilting);
    const V room = clip(clip(1.0 - thrust - tilting, all(0.0), all(1.0)), all(0.0), thrust - tilting);
    yaw = clip(yaw, -room, room);
    const V none = all(0.0), one = all(1.0);
    return {
        root(clip(thrust - roll - pitch - yaw, none, one)),
        root(clip(thrust + roll + pitch - yaw, none, one)),
        root(clip(thrust + roll - pitch + yaw, none, one)),
        root(clip(thrust - roll + pitch + yaw, none, one)),
    };
}

Moving derivative(V height, const Moving& m, const Four& forces, const Body& k) {
    const V above = clip(height + k.mount, all(k.least), all(1e9));
    const V square = above * above;
    const V ground = square / (square - k.quarter);
    const V zx = 2.0 * (m.x * m.z + m.w * m.y), zy = 2.0 * (m.y * m.z - m.w * m.x);
    const V zz = 1.0 - 2.0 * (m.x * m.x + m.y * m.y);
    const V along = forces.a * ground - k.d_v * (m.ux * zx + m.uy * zy + m.uz * zz);
    const V a = 0.5 * m.p, b = 0.5 * m.q, c = 0.5 * m.r;
    return {
        along * zx - k.d_h * m.ux,
        along * zy - k.d_h * m.uy,
        along * zz - k.d_h * m.uz - k.g,
        -a * m.x - b * m.y - c * m.z,
        a * m.w + c * m.y - b * m.z,
        b * m.w - c * m.x + a * m.z,
        c * m.w + b * m.x - a * m.y,
        forces.b * ground + k.j_p * m.q * m.r,
        forces.c * ground + k.j_q * m.r * m.p,
        forces.d + k.j_r * m.p * m.q,
    };
}

Four pulls(const Four& n, const Rotors& k) {
    const V a = n.a * n.a, b = n.b * n.b, c = n.c * n.c, d = n.d * n.d;
    return {k.c_t * (a + b + c + d), k.c_p * (b + c - a - d), k.c_q * (b + d - a - c), k.c_r * (c + d - a - b)};
}

Moving along(const Moving& m, const Moving& rate, double step) {
    return {
        m.ux + step * rate.ux, m.uy + step * rate.uy, m.uz + step * rate.uz, m.w + step * rate.w,
        m.x + step * rate.x, m.y + step * rate.y, m.z + step * rate.z,
        m.p + step * rate.p, m.q + step * rate.q, m.r + step * rate.r,
    };
}

V turned(V n, V command, double up, double down) {
    const V d = command - n;
    const V u = clip(d, all(0.0), all(1.0));
    return n + up * u + down * (d - u);
}

Four turned(const Four& n, const Four& command, double up, double down) {
    return {
        turned(n.a, command.a, up, down), turned(n.b, command.b, up, down),
        turned(n.c, command.c, up, down), turned(n.d, command.d, up, down),
    };
}

State advance(const State& s, const Four& command, const Three& wind, const Rotors& k, const Body& body) {
    const double dt = k.dt, half = 0.5 * dt, sixth = dt / 6.0;
    const Four begin = {s.n1, s.n2, s.n3, s.n4};
    const Four end = turned(begin, command, k.up, k.down);
    const Four middle = pulls(turned(begin, command, k.up_half, k.down_half), k);
    const Moving moving = {s.vx - wind.x, s.vy - wind.y, s.vz - wind.z, s.w, s.x, s.y, s.z, s.p, s.q, s.r};
    const Moving k1 = derivative(s.pz, moving, pulls(begin, k), body);
    const Moving k2 = derivative(s.pz + half * s.vz, along(moving, k1, half), middle, body);
    const Moving k3 = derivative(s.pz + half * (s.vz + half * k1.uz), along(moving, k2, half), middle, body);
    const Moving k4 = derivative(s.pz + dt * (s.vz + half * k2.uz), along(moving, k3, dt), pulls(end, k), body);

    const Moving both = along(k2, k3, 1.0);
    const V w = s.w + sixth * (k1.w + 2.0 * both.w + k4.w), x = s.x + sixth * (k1.x + 2.0 * both.x + k4.x);
    const V y = s.y + sixth * (k1.y + 2.0 * both.y + k4.y), z = s.z + sixth * (k1.z + 2.0 * both.z + k4.z);
    const V unit = 1.0 / root(w * w + x * x + y * y + z * z);
    return {
        s.px + dt * (s.vx + sixth * (k1.ux + both.ux)),
        s.py + dt * (s.vy + sixth * (k1.uy + both.uy)),
        s.pz + dt * (s.vz + sixth * (k1.uz + both.uz)),
        s.vx + sixth * (k1.ux + 2.0 * both.ux + k4.ux),
        s.vy + sixth * (k1.uy + 2.0 * both.uy + k4.uy),
        s.vz + sixth * (k1.uz + 2.0 * both.uz + k4.uz),
        w * unit, x * unit, y * unit, z * unit,
        s.p + sixth * (k1.p + 2.0 * both.p + k4.p),
        s.q + sixth * (k1.q + 2.0 * both.q + k4.q),
        s.r + sixth * (k1.r + 2.0 * both.r + k4.r),
        end.a, end.b, end.c, end.d,
    };
}

}  // namespace

// state: 20 rows of `n` lanes, the vehicle's 17 numbers and its velocity loop's integral; v_ref: 4 rows; wind: 3.
// n is a multiple of kBlock.
extern "C" void fly(
    double* state, const double* v_ref, const double* wind, const Constants* constants, std::size_t n,
    std::size_t steps
) {
    const Constants k = *constants;
    for (std::size_t block = 0; block < n; block += kBlock) {
        // A block stays in the nearest cache; each loop over it is short enough to overlap with its own next round.
        State s[kMany];
        Three integral[kMany], air[kMany];
        Four asked[kMany], command[kMany];
        for (std::size_t i = 0; i < kMany; ++i) {
            const auto lane = [&](const double* rows, std::size_t row) {
                return load(rows + row * n + block + i * kWide);
            };
            V* numbers = &s[i].px;
            for (std::size_t row = 0; row < 17; ++row) numbers[row] = lane(state, row);
            integral[i] = {lane(state, 17), lane(state, 18), lane(state, 19)};
            asked[i] = {lane(v_ref, 0), lane(v_ref, 1), lane(v_ref, 2), lane(v_ref, 3)};
            air[i] = {lane(wind, 0), lane(wind, 1), lane(wind, 2)};
        }
        for (std::size_t step = 0; step < steps; ++step) {
            for (std::size_t i = 0; i < kMany; ++i) command[i] = control(s[i], integral[i], asked[i], k.gains);
            for (std::size_t i = 0; i < kMany; ++i) s[i] = advance(s[i], command[i], air[i], k.rotors, k.body);
        }
        for (std::size_t i = 0; i < kMany; ++i) {
            const auto put = [&](std::size_t row, V v) { store(state + row * n + block + i * kWide, v); };
            const V* numbers = &s[i].px;
            for (std::size_t row = 0; row < 17; ++row) put(row, numbers[row]);
            put(17, integral[i].x);
            put(18, integral[i].y);
            put(19, integral[i].z);
        }
    }
}
