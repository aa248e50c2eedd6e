/* A detector's keypoints to the 14 joints.
 *
 * Limbs are copied.  Head and neck are put where the models were trained to have them, which is
 * where CMU's skeletons do: the head at the height of the ears, the neck below the line of the
 * shoulders.  What detectors call head and neck are three points and four, and none of these; so
 * a detector's neck is not looked at, and its head only as a hint.
 *
 * tools/fit_adapters.py fits these numbers; it models heads, so trust the second digit little.
 * In fixed point they must be under 1.5, for |s + k (e - s)| < (1 + 2 k) 2^29 then fits 31 bits.
 *
 * SPDX-License-Identifier: MIT
 */

/* Head = s + k (e - s), from between the shoulders past the evidence e. */
#define EARS REAL(1.00)
#define CROWN REAL(0.64)
#define CENTRE REAL(1.02)
#define EAR REAL(0.97)
#define FACE REAL(0.95)

/* Neck = s + k (h - s), from between the shoulders towards between the hips. */
#define TRUNK REAL(0.12)

static const keypoint not_seen = {0, 0, 0};

/* Is it sound?  A keypoint that is not must reach edml_lift(), which refuses it. */
static int is_finite(keypoint p)
{
    return FINITE((real)p.c) && (!(p.c > 0) || (FINITE(p.x) && FINITE(p.y)));
}

static confidence least(confidence a, confidence b) { return a < b ? a : b; }

/* Mean of those of up to three keypoints that were seen, with the least of their confidences;
 * not_seen if fewer than `fewest` were; the first that is not finite, if there is one. */
static keypoint mean_of(const keypoint in[], const uint8_t index[], int count, int fewest)
{
    keypoint sum = not_seen; /* |x| < 3 * 2^29 */
    int seen = 0;
    for (int n = 0; n < count; n++) {
        if (index[n] == EDML_NO_KEYPOINT) continue;
        const keypoint p = in[index[n]];
        if (!is_finite(p)) return p;
        if (!(p.c > 0)) continue;
        sum.c = seen == 0 ? p.c : least(sum.c, p.c);
        sum.x += p.x;
        sum.y += p.y;
        seen++;
    }
    if (seen == 0 || seen < fewest) return not_seen;
    sum.x /= (pixels)seen;
    sum.y /= (pixels)seen;
    return sum;
}

/* s + k (e - s), with half the lesser confidence: it is a guess.  Both were seen. */
static keypoint beyond(keypoint s, keypoint e, real k)
{
    if (!is_finite(s)) return s;
    if (!is_finite(e)) return e;
    keypoint p = {s.x + MUL(k, e.x - s.x), s.y + MUL(k, e.y - s.y), least(s.c, e.c)};
    p.c = (confidence)(p.c - p.c / 2); /* the least confidence stays one */
    return p;
}

/* From the best evidence there is, in the order of its error. */
static keypoint head_of(const keypoint in[], const edml_format *format, keypoint s)
{
    const struct {
        const uint8_t *index;
        int count, fewest;
        real k;
    } evidence[] = {
        {format->ears, 2, 2, EARS}, {&format->crown, 1, 1, CROWN}, {&format->centre, 1, 1, CENTRE},
        {format->ears, 2, 1, EAR},  {format->face, 3, 1, FACE},
    };
    for (unsigned n = 0; n < sizeof evidence / sizeof *evidence; n++) {
        const keypoint e = mean_of(in, evidence[n].index, evidence[n].count, evidence[n].fewest);
        if (e.c != 0) return beyond(s, e, evidence[n].k);
    }
    return not_seen;
}

void NAME(edml_adapt)(keypoint out[EDML_JOINTS], const keypoint in[], const edml_format *format)
{
    static const uint8_t shoulders[] = {EDML_R_SHOULDER, EDML_L_SHOULDER};
    static const uint8_t hips[] = {EDML_R_HIP, EDML_L_HIP};
    for (int j = EDML_R_SHOULDER; j < EDML_JOINTS; j++) {
        const uint8_t from = format->limb[j - EDML_R_SHOULDER];
        out[j] = from != EDML_NO_KEYPOINT ? in[from] : not_seen;
    }
    const keypoint s = mean_of(out, shoulders, 2, 2), h = mean_of(out, hips, 2, 2);
    out[EDML_HEAD_TOP] = s.c != 0 ? head_of(in, format, s) : not_seen;
    out[EDML_NECK] = s.c != 0 ? beyond(s, h.c != 0 ? h : s, TRUNK) : not_seen;
}
