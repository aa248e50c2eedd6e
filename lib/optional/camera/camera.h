/* The camera's frame: where a pose is, so that its joints are seen where they were, by orthogonal
 * iteration (Lu, Hager, Mjolsness, "Fast and globally convergent pose estimation from video images",
 * 2000).
 *
 * A joint p was seen along a line through the camera's centre; R p + t should lie on it.  What the
 * iteration lowers is the object-space error: the sum of the squared distances from the lines.  For
 * given R the best t is linear; for given R and t the nearest points of the lines are what R should
 * turn the joints onto, a problem of absolute orientation.  Alternating, the error never rises, but it
 * takes tens of steps, and sometimes hundreds.  So each step is Gauss and Newton's where that lowers
 * the error, and the alternation where not.  A person is nearly flat, and turned the other way looks
 * nearly the same: both are tried.  A few steps on the error in the image follow.
 *
 * The view is the frame of a camera at the same place that looks at the person.  Depths in it are
 * multiplied by `spread`, the tangent of the person's half angle: so all numbers are about 1, near
 * or far, and the orthographic camera is the limit of spread 0.
 *
 * SPDX-License-Identifier: MIT
 */

#define FEWEST 7                   /* from 6, one in some thousand finds another pose */
#define NEGLIGIBLE 1024            /* a joint with less of all confidence counts as not seen */
#define STEEPEST 2                 /* tangent, along x and along y, from the camera's axis */
#define NARROWEST REAL(0.001953125) /* least spread: 2^-9 */
#define FARTHEST REAL(100.0)       /* metres */
#define SMALLEST REAL(0.015625)    /* root of a pose's mean square, metres */

#define SINGULAR REAL(0.000244140625) /* 2^-12: pivots up to this are zero */
#define REACH 8                       /* solutions beyond it are none */
#define RIDGE REAL(0.01)              /* flat points stay solvable */

enum { STEPS = 24, LEAPS = 8, POLISH = 5 };
/* Angles of Newton's steps, radians, after which no other is needed: the next would be far smaller. */
#define NEAR REAL(0.0078125) /* 2^-7: near enough for the polish */
#define STILL REAL(0.0009765625) /* 2^-10 */

#define FITTING REAL(2.0)             /* a joint is off by no more, in units of spread */
#define NEAREST REAL(0.3333333333333) /* of the person's depth: no joint is nearer */

typedef struct {
    point *joint; /* [14] about their mean, in units of `size`: weighted squares add up to 1 */
    point *ray;   /* [14] x, y: where it was seen, at depth 1; z: root of its weight, 0 if not seen */
    point *a, *b; /* [14] two directions across the line of sight, with the weight's root */
    point mean;
    real size; /* metres */
    axes look;
    axes scatter; /* joints times joints */
    axes lines;   /* a times a and b times b */
    point across, down; /* joints times image */
    real spread;
    real depth; /* of the person, along the camera's axis, times spread: when the polish began */
} view;

typedef struct {
    axes turn;
    point shift; /* depth times spread */
    wide error;
} station;

/* ---- Least squares -------------------------------------------------------------------------- */

/* Solution of A x = b for a symmetric positive A, by elimination; 0 if there is none within REACH.
 * What is divided by a pivot d is below sqrt(d) times the root of A's largest entry, 9. */
static int solve(point *x, const axes *a, point b)
{
    if (!(a->x.x > SINGULAR)) return 0;
    const real yx = DIV(a->x.y, a->x.x), zx = DIV(a->x.z, a->x.x);
    const real yy = a->y.y - MUL(yx, a->x.y), yz = a->y.z - MUL(yx, a->x.z);
    if (!(yy > SINGULAR) || ABS(yz) / 64 >= yy) return 0;
    const real zy = DIV(yz, yy);
    const real zz = a->z.z - MUL(zx, a->x.z) - MUL(zy, yz);
    b.y -= MUL(yx, b.x);
    b.z -= MUL(zx, b.x) + MUL(zy, b.y);
    if (!(zz > SINGULAR) || ABS(b.z) / REACH >= zz || ABS(b.y) / REACH >= yy) return 0;
    x->z = DIV(b.z, zz);
    x->y = DIV(b.y, yy) - MUL(zy, x->z);
    x->x = DIV(b.x - MUL(a->x.y, x->y) - MUL(a->x.z, x->z), a->x.x);
    return 1;
}

static const axes zero_matrix = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

/* Adds a b'. */
static void add_product(axes *sum, point a, point b)
{
    sum->x = plus(sum->x, times(a.x, b));
    sum->y = plus(sum->y, times(a.y, b));
    sum->z = plus(sum->z, times(a.z, b));
}

/* ---- Joints, rays and the view -------------------------------------------------------------- */

/* Roots of the weights, which add up to 1. */
static edml_status weigh(view *v, const keypoint in[EDML_JOINTS])
{
    uint16_t seen = seen_joints(in);
    if (!all_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    pixels total = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (seen >> j & 1) total += in[j].c;
    if (!FINITE(total)) return EDML_ERR_NOT_FINITE;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if ((seen >> j & 1) && in[j].c <= total / NEGLIGIBLE) seen = (uint16_t)(seen & ~(1U << j));
        v->ray[j].z = seen >> j & 1 ? SQRT(DIV(in[j].c, total)) : 0;
    }
    return count_bits(seen) < FEWEST ? EDML_ERR_TOO_FEW_JOINTS : EDML_OK;
}

/* Are these numbers that a camera can have? */
static int is_camera(const camera *by)
{
    return FINITE(by->fx) && FINITE(by->fy) && FINITE(by->cx) && FINITE(by->cy) && by->fx > 0 &&
           by->fy > 0;
}

static edml_status see(view *v, const keypoint in[EDML_JOINTS], const camera *by)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(v->ray[j].z > 0)) continue;
        const pixels x = in[j].x - by->cx, y = in[j].y - by->cy;
        if (ABS(x) / STEEPEST > by->fx || ABS(y) / STEEPEST > by->fy) return EDML_ERR_CAMERA;
        v->ray[j].x = DIV(x, by->fx);
        v->ray[j].y = DIV(y, by->fy);
    }
    return EDML_OK;
}

static real weight_of(const view *v, int j) { return MUL(v->ray[j].z, v->ray[j].z); }

/* Moves the joints to their mean and scales them; those that were not seen stay there. */
static edml_status centre(view *v, const pose *given)
{
    const point zero = {0, 0, 0};
    point sum = zero;
    real total = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        add_multiple(&sum, weight_of(v, j), given_joint(given, j));
        total += weight_of(v, j);
    }
    v->mean = over(sum, total);
    real squares = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point p = minus(given_joint(given, j), v->mean);
        const point weighted = times(v->ray[j].z, p); /* squares add up to 48 m^2 at most */
        v->joint[j] = v->ray[j].z > 0 ? p : zero;
        squares += dot(weighted, weighted);
    }
    v->size = SQRT(squares);
    if (v->size < SMALLEST) return EDML_ERR_DEGENERATE;
    v->scatter = zero_matrix;
    for (int j = 0; j < EDML_JOINTS; j++) {
        v->joint[j] = over(v->joint[j], v->size);
        const point p = times(v->ray[j].z, v->joint[j]);
        add_product(&v->scatter, p, p);
    }
    return EDML_OK;
}

/* Turns the view to the mean ray by the smallest rotation. */
static void look_at_rays(view *v)
{
    point sum = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point ray = {v->ray[j].x, v->ray[j].y, REAL(1.0)};
        if (v->ray[j].z > 0) add_multiple(&sum, weight_of(v, j), ray);
    }
    const point z = over(sum, norm(sum)); /* 1/3 < z.z <= 1, as no ray is steeper than 2 */
    const real share = DIV(REAL(1.0), REAL(1.0) + z.z);
    const real xy = MUL(share, MUL(z.x, z.y));
    const axes look = {{REAL(1.0) - MUL(share, MUL(z.x, z.x)), -xy, -z.x},
                       {-xy, REAL(1.0) - MUL(share, MUL(z.y, z.y)), -z.y},
                       z};
    v->look = look;
}

/* Where the rays pass depth 1 of the view, in a; and `spread`, the root of the mean of the squares. */
static edml_status measure_spread(view *v)
{
    real squares = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point ray = {v->ray[j].x, v->ray[j].y, REAL(1.0)}, zero = {0, 0, 0};
        v->a[j] = zero;
        if (!(v->ray[j].z > 0)) continue;
        const point seen = turned(&v->look, ray);
        if (2 * seen.z < norm(ray)) return EDML_ERR_CAMERA; /* 60 degrees off: tangents to 1.8 */
        v->a[j].x = DIV(seen.x, seen.z);
        v->a[j].y = DIV(seen.y, seen.z);
        const point weighted = times(v->ray[j].z, v->a[j]);
        squares += dot(weighted, weighted);
    }
    v->spread = SQRT(squares);
    return v->spread < NARROWEST ? EDML_ERR_DEGENERATE : EDML_OK;
}

/* Unit vectors across each line of sight, (u, v, 1) in the view: b = (0, 1, -v) / |...| and
 * a = b x (u, v, 1) / |...|, with depth divided by `spread`, times the weight's root. */
static void cross_lines(view *v)
{
    const point zero = {0, 0, 0};
    v->across = v->down = zero;
    v->lines = zero_matrix;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const real x = v->a[j].x, y = v->a[j].y, root = v->ray[j].z;
        const real wide_x = DIV(x, v->spread), wide_y = DIV(y, v->spread); /* weighted, <= 1 */
        const point weighted = times(root, v->joint[j]);
        add_multiple(&v->across, MUL(root, wide_x), weighted);
        add_multiple(&v->down, MUL(root, wide_y), weighted);

        const real height = HYPOT(REAL(1.0), y);
        const real root_b = DIV(root, height), root_a = DIV(root_b, HYPOT(height, x));
        const point b = {0, root_b, -MUL(root_b, wide_y)};
        const point a = {MUL(root_a, REAL(1.0) + MUL(y, y)), -MUL(root_a, MUL(x, y)),
                         -MUL(root_a, wide_x)};
        v->a[j] = a;
        v->b[j] = b;
        add_product(&v->lines, a, a);
        add_product(&v->lines, b, b);
    }
}

/* ---- Stations ------------------------------------------------------------------------------- */

static point stretched(const view *v, point p)
{
    const point q = {p.x, p.y, MUL(v->spread, p.z)};
    return q;
}

static point joint_at(const view *v, const station *s, int j)
{
    return plus(stretched(v, turned(&s->turn, v->joint[j])), s->shift);
}

/* What joint j at a station misses along two directions, and these. */
typedef struct {
    point a, b;
    real miss_a, miss_b;
} sight;

typedef int sight_of(sight *out, const view *v, const station *s, int j);

/* In space: distance from the line of sight. */
static int miss_of_line(sight *out, const view *v, const station *s, int j)
{
    const point at = joint_at(v, s, j);
    out->a = v->a[j];
    out->b = v->b[j];
    out->miss_a = dot(out->a, at);
    out->miss_b = dot(out->b, at);
    return s->shift.z > 0;
}

/* In the camera's frame, times spread. */
static point in_camera(const view *v, point at)
{
    const point flat = {MUL(v->spread, at.x), MUL(v->spread, at.y), at.z};
    return turned_back(&v->look, flat);
}

/* In the image: distance from where the joint was seen, in units of spread, times the person's depth;
 * and its derivatives.  0 if the joint is too near or behind, or far from where it was seen. */
static int miss_in_image(sight *out, const view *v, const station *s, int j)
{
    const sight none = {{0, 0, 0}, {0, 0, 0}, 0, 0};
    const real root = v->ray[j].z;
    const point p = in_camera(v, joint_at(v, s, j));
    *out = none;
    if (!(root > 0)) return 1;
    if (p.z < MUL(NEAREST, v->depth) || p.z <= EPSILON) return 0;
    if (ABS(p.x) / 8 > p.z || ABS(p.y) / 8 > p.z) return 0;
    const real x = DIV(p.x, p.z), y = DIV(p.y, p.z);
    if (HYPOT(x - v->ray[j].x, y - v->ray[j].y) > MUL(FITTING, v->spread)) return 0;
    const real share = MUL(root, DIV(v->depth, p.z)); /* <= 3 */
    const axes *look = &v->look;
    const point a = {look->x.x - MUL(x, look->x.z), look->y.x - MUL(x, look->y.z),
                     DIV(look->z.x - MUL(x, look->z.z), v->spread)};
    const point b = {look->x.y - MUL(y, look->x.z), look->y.y - MUL(y, look->y.z),
                     DIV(look->z.y - MUL(y, look->z.z), v->spread)};
    out->a = times(share, a);
    out->b = times(share, b);
    out->miss_a = MUL(MUL(root, v->depth), DIV(x - v->ray[j].x, v->spread));
    out->miss_b = MUL(MUL(root, v->depth), DIV(y - v->ray[j].y, v->spread));
    return 1;
}

/* 0 where there is no error, the person being behind the camera or so. */
static int measure(station *s, const view *v, sight_of *misses)
{
    s->error = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        sight of;
        if (!misses(&of, v, s, j)) return 0;
        s->error += PRODUCT(of.miss_a, of.miss_a) + PRODUCT(of.miss_b, of.miss_b);
    }
    return 1;
}

/* The best place for a given rotation, and its error in space. */
static int place(station *s, const view *v)
{
    point pull = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point at = stretched(v, turned(&s->turn, v->joint[j]));
        pull = minus(pull, times(dot(v->a[j], at), v->a[j]));
        pull = minus(pull, times(dot(v->b[j], at), v->b[j]));
    }
    return solve(&s->shift, &v->lines, pull) && measure(s, v, miss_of_line);
}

/* ---- Steps ---------------------------------------------------------------------------------- */

/* Normal equations of a shift and a turn. */
typedef struct {
    axes shift, both, turn; /* both: turn times shift */
    point to_shift, to_turn;
} equations;

/* Adds a a', upper triangle. */
static void add_square(axes *sum, point a)
{
    sum->x = plus(sum->x, times(a.x, a));
    sum->y.y += MUL(a.y, a.y);
    sum->y.z += MUL(a.y, a.z);
    sum->z.z += MUL(a.z, a.z);
}

/* Adds the square of what one direction misses. */
static void add_miss(equations *n, point across, point lever, real miss)
{
    add_square(&n->shift, across);
    add_product(&n->both, lever, across);
    add_square(&n->turn, lever);
    n->to_shift = minus(n->to_shift, times(miss, across));
    n->to_turn = minus(n->to_turn, times(miss, lever));
}

/* The shift is eliminated first. */
static int solve_both(point *shift, point *turn, equations *n)
{
    point still;
    axes k;
    if (!solve(&still, &n->shift, n->to_shift) || !solve(&k.x, &n->shift, n->both.x) ||
        !solve(&k.y, &n->shift, n->both.y) || !solve(&k.z, &n->shift, n->both.z))
        return 0;
    n->turn.x = minus(n->turn.x, turned(&k, n->both.x));
    n->turn.y = minus(n->turn.y, turned(&k, n->both.y));
    n->turn.z = minus(n->turn.z, turned(&k, n->both.z));
    if (!solve(turn, &n->turn, minus(n->to_turn, turned(&n->both, still)))) return 0;
    *shift = minus(still, turned_back(&k, *turn));
    return 1;
}

/* Gauss and Newton's step from a station; 0 if it has none.  Also its angle, radians, or nearly. */
static int newton(station *next, real *angle, const view *v, const station *s, sight_of *misses)
{
    const point zero = {0, 0, 0};
    equations n = {zero_matrix, zero_matrix, zero_matrix, zero, zero};
    for (int j = 0; j < EDML_JOINTS; j++) {
        sight of;
        if (!misses(&of, v, s, j)) return 0;
        const point arm = turned(&s->turn, v->joint[j]);
        add_miss(&n, of.a, cross(arm, stretched(v, of.a)), of.miss_a);
        add_miss(&n, of.b, cross(arm, stretched(v, of.b)), of.miss_b);
    }
    point shift, by;
    if (!solve_both(&shift, &by, &n)) return 0;
    *angle = norm(by);
    if (*angle > REAL(1.0)) return 0;
    const point half = {by.x / 2, by.y / 2, by.z / 2};
    const axes turn = rotation_of(REAL(1.0), half);
    next->turn = after(&turn, &s->turn);
    next->shift = plus(s->shift, shift);
    return 1;
}

/* The step of orthogonal iteration.  With the joints' weighted mean at 0, sum q p' is R times their
 * scatter less what the joints miss their lines by. */
static int alternate(station *next, const view *v, const station *s)
{
    const point zero = {0, 0, 0};
    axes m = {turned(&v->scatter, s->turn.x), turned(&v->scatter, s->turn.y),
              turned(&v->scatter, s->turn.z)};
    for (int j = 0; j < EDML_JOINTS; j++) {
        sight of;
        miss_of_line(&of, v, s, j);
        const point miss = stretched(v, plus(times(of.miss_a, of.a), times(of.miss_b, of.b)));
        add_product(&m, minus(zero, miss), v->joint[j]);
    }
    if (!best_rotation(&next->turn, &m) || !place(next, v)) return 0;
    return next->error < s->error;
}

/* Where steps are short, many more would point the same way: goes on while doubling lowers the error. */
static void leap(station *next, const view *v, const station *s)
{
    const axes back = transposed(&s->turn);
    axes step = after(&next->turn, &back);
    for (int n = 0; n < LEAPS; n++) {
        station far;
        far.turn = after(&step, &next->turn);
        if (!place(&far, v) || !(far.error < next->error)) return;
        *next = far;
        step = after(&step, &step);
    }
}

/* Downhill from a rotation, in at most STEPS steps; returns how many, or -1 if it leads nowhere. */
static int descend(station *s, const view *v)
{
    if (!place(s, v)) return -1;
    int steps = 0, still = 0;
    while (steps < STEPS && !still) {
        station next;
        real angle = 0;
        const int stepped = newton(&next, &angle, v, s, miss_of_line);
        still = stepped && angle < NEAR;
        int lower = stepped && place(&next, v) && next.error < s->error;
        if (!lower && !still) {
            lower = alternate(&next, v, s);
            if (lower) leap(&next, v, s);
        }
        if (!lower) break;
        *s = next;
        steps++;
    }
    return steps;
}

/* The same on the error in the image; -1 if there is none. */
static int polish(station *s, const view *v)
{
    if (!measure(s, v, miss_in_image)) return -1;
    int steps = 0, still = 0;
    while (steps < POLISH && !still) {
        station next;
        real angle;
        if (!newton(&next, &angle, v, s, miss_in_image)) break;
        if (!measure(&next, v, miss_in_image) || !(next.error < s->error)) break;
        still = angle < STILL;
        *s = next;
        steps++;
    }
    return steps;
}

/* ---- Starts --------------------------------------------------------------------------------- */

/* Scaled orthographic: two rows that map joints to the image best in the least squares, a third
 * across them, and the rotation nearest to the three. */
static int start(station *s, const view *v)
{
    axes scatter = v->scatter, m;
    scatter.x.x += RIDGE;
    scatter.y.y += RIDGE;
    scatter.z.z += RIDGE;
    if (!solve(&m.x, &scatter, v->across) || !solve(&m.y, &scatter, v->down)) return 0;
    m.z = cross(m.x, m.y);
    const real length = norm(m.z);
    if (!(length > MUL(RIDGE, MUL(norm(m.x), norm(m.y))) + EPSILON)) return 0;
    m.z = over(m.z, SQRT(length));
    return best_rotation(&s->turn, &m);
}

/* The rotation nearest to a station's with its depths reversed. */
static int reverse(station *twin, const view *v, const station *s)
{
    const point away = turned(&v->scatter, s->turn.z);
    const axes m = {turned(&v->scatter, s->turn.x), turned(&v->scatter, s->turn.y),
                    {-away.x, -away.y, -away.z}};
    return best_rotation(&twin->turn, &m);
}

/* ---- The result ----------------------------------------------------------------------------- */

/* Root of the weighted mean of the squared distances in the image, pixels. */
static pixels reprojection_of(const view *v, const station *s, const camera *by)
{
    pixels root = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(v->ray[j].z > 0)) continue;
        const point p = in_camera(v, joint_at(v, s, j));
        const pixels x = MUL(by->fx, DIV(p.x, p.z) - v->ray[j].x);
        const pixels y = MUL(by->fy, DIV(p.y, p.z) - v->ray[j].y);
        root = HYPOT(root, MUL(v->ray[j].z, HYPOT(x, y)));
    }
    return root;
}

static edml_status write_placement(placement *out, const view *v, const station *s,
                                   const pose *given, const camera *by, int steps)
{
    const real far = MUL(s->shift.z, v->size);
    if (far / 128 >= MUL(FARTHEST / 128, v->spread)) return EDML_ERR_CAMERA;
    const point shift = {MUL(s->shift.x, v->size), MUL(s->shift.y, v->size), DIV(far, v->spread)};
    const axes back = transposed(&v->look), turn = after(&back, &s->turn);
    const point origin = minus(turned_back(&v->look, shift), turned(&turn, v->mean));
    for (int j = 0; j < EDML_JOINTS; j++)
        if (dot(turn.z, given_joint(given, j)) + origin.z <= 0) return EDML_ERR_CAMERA;
    for (int j = 0; j < EDML_JOINTS; j++)
        out->joint[j] = result(plus(turned(&turn, given_joint(given, j)), origin));
    out->rotation[0] = result(turn.x);
    out->rotation[1] = result(turn.y);
    out->rotation[2] = result(turn.z);
    out->translation = result(origin);
    out->reprojection = reprojection_of(v, s, by);
    out->steps = (uint16_t)steps;
    return EDML_OK;
}

static edml_status prepare(view *v, const pose *given, const keypoint in[EDML_JOINTS],
                           const camera *by)
{
    if (!is_camera(by)) return EDML_ERR_CAMERA;
    if (!is_pose(given)) return EDML_ERR_NOT_FINITE;
    edml_status status = weigh(v, in);
    if (status == EDML_OK) status = see(v, in, by);
    if (status == EDML_OK) status = centre(v, given);
    if (status != EDML_OK) return status;
    look_at_rays(v);
    status = measure_spread(v);
    if (status == EDML_OK) cross_lines(v);
    return status;
}

/* From two starts to the station of less error in space, and from there to that of least in the
 * image.  Counts the steps. */
static edml_status find_station(station *s, int *steps, view *v)
{
    if (!start(s, v)) return EDML_ERR_DEGENERATE;
    station twin;
    const int first = descend(s, v);
    const int second = reverse(&twin, v, s) ? descend(&twin, v) : -1;
    if (first < 0 && second < 0) return EDML_ERR_CAMERA;
    if (first < 0 || (second >= 0 && twin.error < s->error)) *s = twin;
    v->depth = in_camera(v, s->shift).z;
    const int third = polish(s, v);
    if (third < 0) return EDML_ERR_CAMERA;
    *steps = (first > 0 ? first : 0) + (second > 0 ? second : 0) + third;
    return EDML_OK;
}

edml_status NAME(edml_place)(placement *out, const pose *given, const keypoint in[EDML_JOINTS],
                             const camera *by, work_memory *work)
{
    if (out == NULL || given == NULL || in == NULL || by == NULL || work == NULL)
        return EDML_ERR_ARGUMENT;
    view v;
    v.joint = work->use.step[0];
    v.ray = work->use.step[1];
    v.a = work->use.step[2];
    v.b = work->use.step[3];
    edml_status status = prepare(&v, given, in, by);
    if (status != EDML_OK) return status;
    station s;
    int steps = 0;
    status = find_station(&s, &steps, &v);
    if (status != EDML_OK) return status;
    return write_placement(out, &v, &s, given, by, steps);
}

edml_status NAME(edml_place_sweep)(placement *out, camera *found, const pose *given,
                                   const keypoint in[EDML_JOINTS], pixels width, pixels height,
                                   work_memory *work)
{
    /* 0.5 to 4 in 11 equal steps of the logarithm */
    static const real focal[12] = {
        REAL(0.5),      REAL(0.604045), REAL(0.72974),  REAL(0.881591),
        REAL(1.065041), REAL(1.286665), REAL(1.554406), REAL(1.877862),
        REAL(2.268625), REAL(2.740702), REAL(3.311013), REAL(4.0)};
    if (out == NULL || found == NULL || given == NULL || in == NULL || work == NULL)
        return EDML_ERR_ARGUMENT;
    if (!(FINITE(width) && FINITE(height) && width > 0 && height > 0)) return EDML_ERR_CAMERA;
    edml_status best = EDML_ERR_CAMERA;
    for (int n = 0; n < 12; n++) {
        const pixels eighth = MUL(height, focal[n] / 8);
        if (!FINITE(4 * eighth)) continue; /* nor would the whole be */
        const pixels f = 8 * eighth;
        const camera tried = {f, f, width / 2, height / 2};
        placement placed;
        const edml_status status = NAME(edml_place)(&placed, given, in, &tried, work);
        if (status == EDML_OK && (best != EDML_OK || placed.reprojection < out->reprojection)) {
            *out = placed;
            *found = tried;
        }
        if (best != EDML_OK) best = status;
    }
    return best;
}
