/* lift/align.h: the points of the MDS onto those of the network, and their mean.
 *
 * SPDX-License-Identifier: MIT
 */
#include "as_float.h"
#include "network/model.h"

static edml_point person[EDML_JOINTS], x[EDML_JOINTS], y[EDML_JOINTS];
static edml_model model;

static void set_share(float share)
{
    model = edml_distances_f32;
    model.mds_share.f32 = share;
    model.mds_share.q24 = (int32_t)(share * 16777216.0F);
}

static void centre(edml_point p[EDML_JOINTS])
{
    double sum[3] = {0};
    for (int k = 0; k < 3 * EDML_JOINTS; k++) sum[k % 3] += (double)(&p->x)[k] / EDML_JOINTS;
    for (int k = 0; k < 3 * EDML_JOINTS; k++) (&p->x)[k] -= (float)sum[k % 3];
}

static void someone(rng *r)
{
    random_human(r, person);
    rotate_points(person, random_rotation(r), person);
    centre(person);
}

/* In other axes, mirrored or not: exactly the same body. */
static void the_same_body_comes_back_whichever_way_it_was_turned(void)
{
    rng r = rng_seed(1);
    set_share(1);
    for (int n = 0; n < 200; n++) {
        someone(&r);
        memcpy(x, person, sizeof x);
        if (n % 2) reflect(x, person);
        rotate_points(x, random_rotation(&r), x);
        edml_align(x, person, &model);
        TEST_ASSERT_ERROR_UP_TO(ALIGN_TOLERANCE, worst_joint_error(x, person));
    }
}

/* As people who stand straight are: the other two singular values are a hundredth of the first.  What comes back has
 * the distances of x, and not those of the person. */
static void thin_bodies_are_turned_as_well(void)
{
    rng r = rng_seed(5);
    set_share(1);
    for (int n = 0; n < 200; n++) {
        float distance[EDML_PAIRS];
        random_human(&r, person);
        for (int j = 0; j < EDML_JOINTS; j++) {
            person[j].x *= 0.4F;
            person[j].y = 0.12F * (float)j;
            person[j].z *= n % 2 ? 0.4F : 0.2F;
        }
        rotate_points(person, random_rotation(&r), person);
        centre(person);
        memcpy(x, person, sizeof x);
        for (int k = 0; k < 3 * EDML_JOINTS; k++) (&x->x)[k] += 0.01F * gauss(&r);
        if (n % 4 == 1) reflect(x, x);
        rotate_points(x, random_rotation(&r), x);
        centre(x);
        pair_distances(distance, x);
        edml_align(x, person, &model);
        TEST_ASSERT_ERROR_UP_TO(ALIGN_TOLERANCE, worst_distance_error(x, distance));
        TEST_ASSERT_ERROR_UP_TO(0.05F, worst_joint_error(x, person));
    }
}

static double squares(const edml_point a[EDML_JOINTS], const edml_point b[EDML_JOINTS])
{
    double sum = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        sum += distance_between(a[j], b[j]) * distance_between(a[j], b[j]);
    return sum;
}

static void no_rotation_nearby_and_no_mirror_image_is_nearer(void)
{
    rng r = rng_seed(2);
    set_share(1);
    for (int n = 0; n < 200; n++) {
        float distance[EDML_PAIRS];
        someone(&r);
        memcpy(y, person, sizeof y);
        for (int k = 0; k < 3 * EDML_JOINTS; k++) (&y->x)[k] += 0.15F * gauss(&r);
        centre(y);
        pair_distances(distance, y);
        memcpy(x, y, sizeof x);
        rotate_points(x, random_rotation(&r), x);
        edml_align(x, person, &model);
        TEST_ASSERT_ERROR_UP_TO(ALIGN_TOLERANCE, worst_distance_error(x, distance));
        const double least = squares(x, person);
        for (int k = 0; k < 20; k++) {
            const double s = k < 10 ? 0.01 : -0.01, c = sqrt(1 - s * s);
            const int a = k % 3, b = (a + 1) % 3;
            rotation3 by = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
            by.at[a][a] = by.at[b][b] = c;
            by.at[a][b] = -s;
            by.at[b][a] = s;
            rotate_points(y, by, x);
            TEST_ASSERT_TRUE(squares(y, person) > least - 1e-5);
        }
        set_share(1);
        reflect(y, x); /* the best of the other handedness comes back */
        rotate_points(y, random_rotation(&r), y);
        edml_align(y, person, &model);
        TEST_ASSERT_ERROR_UP_TO(10 * ALIGN_TOLERANCE, worst_joint_error(x, y));
    }
}

static void the_share_is_that_of_the_mds(void)
{
    rng r = rng_seed(3);
    for (int n = 0; n < 50; n++) {
        someone(&r);
        edml_point turned[EDML_JOINTS];
        memcpy(y, person, sizeof y);
        for (int k = 0; k < 3 * EDML_JOINTS; k++) (&y->x)[k] += 0.1F * gauss(&r);
        centre(y);
        memcpy(turned, y, sizeof turned);
        set_share(1);
        edml_align(turned, person, &model);
        memcpy(x, y, sizeof x);
        set_share(0);
        edml_align(x, person, &model);
        TEST_ASSERT_ERROR_UP_TO(ALIGN_TOLERANCE, worst_joint_error(x, person));
        set_share(0.25F);
        edml_align(y, person, &model);
        for (int k = 0; k < 3 * EDML_JOINTS; k++)
            TEST_ASSERT_FLOAT_WITHIN(ALIGN_TOLERANCE, 0.25F * (&turned->x)[k] + 0.75F * (&person->x)[k],
                                     (&y->x)[k]);
    }
}

/* Where there is nothing to turn by, the network's points are taken. */
static void points_without_a_shape_are_the_networks(void)
{
    rng r = rng_seed(4);
    set_share(0.5F);
    someone(&r);
    equal_points(x, 0, 0, 0);
    edml_align(x, person, &model);
    TEST_ASSERT_ERROR_UP_TO(ALIGN_TOLERANCE, worst_joint_error(x, person));
    for (int j = 0; j < EDML_JOINTS; j++) { /* on a line, in a plane: something finite */
        x[j].x = (float)j / 10;
        y[j].x = (float)(j % 3) / 10;
        y[j].y = (float)(j % 5) / 10;
        x[j].y = x[j].z = y[j].z = 0;
    }
    centre(x);
    centre(y);
    edml_align(x, person, &model);
    edml_align(y, person, &model);
    TEST_ASSERT_ERROR_UP_TO(ALIGN_TOLERANCE, worst_joint_error(x, person)); /* there is no one rotation */
    TEST_ASSERT_TRUE(all_finite(x, 3 * EDML_JOINTS) && all_finite(y, 3 * EDML_JOINTS));
    for (int k = 0; k < 3 * EDML_JOINTS; k++)
        TEST_ASSERT_TRUE(fabsf((&x->x)[k]) < 4 && fabsf((&y->x)[k]) < 4);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_same_body_comes_back_whichever_way_it_was_turned);
    RUN_TEST(thin_bodies_are_turned_as_well);
    RUN_TEST(no_rotation_nearby_and_no_mirror_image_is_nearer);
    RUN_TEST(the_share_is_that_of_the_mds);
    RUN_TEST(points_without_a_shape_are_the_networks);
    return UNITY_END();
}
