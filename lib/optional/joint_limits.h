/* Joint limits (section 3.3, as the paper has it): bones that point where people's do not.
 *
 * tools/learn_limits.py learns the maps; tools/reference.py has the same rule.
 *
 * SPDX-License-Identifier: MIT
 */

enum { OUTER_BONES = 9 };

/* Axes of the torso, unit vectors; all none if it has no front. */
typedef struct {
    point side, up, front; /* side: toward the subject's left */
} torso_axes;

typedef struct {
    int row, column;
} map_cell;

static torso_axes axes_of(const point x[EDML_JOINTS], int right, int left)
{
    const point front = forward(x, right, left);
    const point side = dot(front, front) > EPSILON ? direction(minus(x[left], x[right])) : front;
    const torso_axes axes = {side, cross(front, side), front};
    return axes;
}

/* Outward, up and forward.  A left bone is as its right one in a mirror, and a head that leans to the
 * right as one that leans to the left. */
static point in_axes(torso_axes axes, point bone, int n)
{
    const point left = {dot(axes.side, bone), dot(axes.up, bone), dot(axes.front, bone)};
    const point right = {-left.x, left.y, left.z};
    return n == 0 ? (left.x < 0 ? right : left) : n % 2 != 0 ? right : left;
}

static int points_nowhere(point bone) { return !(dot(bone, bone) > EPSILON); }

/* After the half turn that brings its parent outward, down and forward: a straight limb is there.  No
 * parent points the opposite way, where the turn is not smooth. */
static point unbent(point bone, point parent)
{
    const real third = REAL(0.57735026918962576); /* sqrt(1/3) */
    const point straight = {third, -third, third};
    const point axis = direction(plus(parent, straight));
    point turned = times(-REAL(1.0), bone);
    add_multiple(&turned, 2 * dot(axis, bone), axis);
    return turned;
}

/* Of -1 to 1, the cell: 0 to 15. */
static int cell_along(real a)
{
    int cell = 0;
    for (real edge = -REAL(0.875); cell < EDML_LIMIT_CELLS - 1 && a >= edge; edge += REAL(0.125)) cell++;
    return cell;
}

/* On the octahedral map: the sphere, pushed onto an octahedron whose back is folded outwards. */
static map_cell cell_of(point bone)
{
    const real sum = ABS(bone.x) + ABS(bone.y) + ABS(bone.z); /* 1 to 1.74 */
    const real x = DIV(bone.x, sum), y = DIV(bone.y, sum);
    const real beside_x = REAL(1.0) - ABS(y), beside_y = REAL(1.0) - ABS(x);
    const int back = bone.z < 0;
    const map_cell cell = {cell_along(!back ? y : y < 0 ? -beside_y : beside_y),
                           cell_along(!back ? x : x < 0 ? -beside_x : beside_x)};
    return cell;
}

/* Of a bone in the torso's axes; parent: NULL of those that hang on the torso itself. */
static int is_human(int kind, point bone, const point *parent)
{
    static const uint8_t first[] = {EDML_LIMIT_ARMS, EDML_LIMIT_FOREARMS, EDML_LIMIT_HEAD,
                                    EDML_LIMIT_THIGHS, EDML_LIMIT_SHINS};
    int map = first[kind];
    if (points_nowhere(bone)) return 0;
    if (parent != NULL) {
        if (points_nowhere(*parent)) return 0;
        const map_cell of = cell_of(*parent);
        map += of.row / 2 * EDML_LIMIT_PARENTS + of.column / 2;
        bone = unbent(bone, *parent);
    }
    const map_cell cell = cell_of(bone);
    return edml__limits[map][cell.row] >> cell.column & 1;
}

static int beyond_limits(const point x[EDML_JOINTS])
{
    const torso_axes chest = axes_of(x, EDML_R_SHOULDER, EDML_L_SHOULDER);
    const torso_axes pelvis = axes_of(x, EDML_R_HIP, EDML_L_HIP);
    point bone[OUTER_BONES];
    int beyond = 0;
    for (int n = 0; n < OUTER_BONES; n++) {
        const int kind = outer_bones[n].kind;
        const point points = direction(minus(x[outer_bones[n].to], x[outer_bones[n].from]));
        bone[n] = in_axes(kind < THIGHS ? chest : pelvis, points, n);
        beyond += !is_human(kind, bone[n], kind == FOREARMS || kind == SHINS ? &bone[n - 2] : NULL);
    }
    return beyond;
}

int NAME(edml_limits)(const pose *given)
{
    if (given == NULL || !is_pose(given)) return OUTER_BONES;
    point x[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = given_joint(given, j);
    return beyond_limits(x);
}

int NAME(edml_mirror_by_limits)(pose *given)
{
    if (given == NULL || !is_pose(given)) return 0;
    point x[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = given_joint(given, j);
    const int beyond = beyond_limits(x);
    for (int j = 0; j < EDML_JOINTS; j++) x[j].z = -x[j].z;
    const int mirrored = beyond_limits(x);
    if (mirrored >= beyond) return mirrored - beyond;
    for (int j = 0; j < EDML_JOINTS; j++) given->joint[j] = result(x[j]);
    given->mirror_margin = 0;
    return beyond - mirrored;
}
