/* Eight rows of a fully connected layer, and a ReLU; or, with SUMS_ALONE, eight sums and no ReLU, for
 * who adds them up in parts: y may be b.
 *
 * SPDX-License-Identifier: MIT
 */

#ifdef SUMS_ALONE
#define RELU(sum) (sum)
#else
#define RELU(sum) ((sum) > 0 ? (sum) : 0)
#endif

/* Eight rows at a time, in eight registers, each summed in the order of the inputs: the compiler may
 * use vector instructions, and the bits are the same without them.  A function of its own, for the
 * loop needs all of a Cortex-M's registers. */
static EDML_APART void multiply_rows(value y[EDML_ROWS], const activation *x, const weight *w,
                                     const value *b, int inputs)
{
    value s0 = b[0], s1 = b[1], s2 = b[2], s3 = b[3], s4 = b[4], s5 = b[5], s6 = b[6], s7 = b[7];
    for (const activation *const end = x + inputs; x < end; x++, w += EDML_ROWS) {
        const activation xi = *x;
        if (xi == 0) continue; /* as most are, usually */
        s0 += (value)w[0] * xi;
        s1 += (value)w[1] * xi;
        s2 += (value)w[2] * xi;
        s3 += (value)w[3] * xi;
        s4 += (value)w[4] * xi;
        s5 += (value)w[5] * xi;
        s6 += (value)w[6] * xi;
        s7 += (value)w[7] * xi;
    }
    y[0] = RELU(s0);
    y[1] = RELU(s1);
    y[2] = RELU(s2);
    y[3] = RELU(s3);
    y[4] = RELU(s4);
    y[5] = RELU(s5);
    y[6] = RELU(s6);
    y[7] = RELU(s7);
}
