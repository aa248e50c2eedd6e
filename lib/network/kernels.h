/* Declares a network's kernel, which a generated weight header names:
 *
 *   EDML_KERNEL(equivariant, w16);  edml__equivariant_w16() and edml__equivariant_checksum_w16()
 *
 * Not part of the public interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_KERNELS_H
#define EDML_KERNELS_H

#include "model.h"

#define EDML_KERNEL(network, weights) EDML_KERNEL_##weights(network)
#define EDML_KERNEL_f32(network) EDML_KERNEL_OF(network, f32, float)
#define EDML_KERNEL_w16(network) EDML_KERNEL_OF(network, w16, int32_t)
#define EDML_KERNEL_w8(network) EDML_KERNEL_OF(network, w8, int32_t)

#define EDML_KERNEL_OF(network, weights, value)                                                            \
    EDML_INTERNAL void edml__##network##_##weights(value *out, const value *in, const edml_model *model,   \
                                                   void *scratch);                                         \
    EDML_INTERNAL uint32_t edml__##network##_checksum_##weights(const edml_model *model)

/* lift/scale.h.  A model names one in both arithmetics, and links that whose lift is linked. */
EDML_INTERNAL EDML_WEAK edml_status edml__scale_and_align(edml_work *work, const edml_model *model);
EDML_INTERNAL EDML_WEAK edml_status edml__scale_and_align_q(edml_work_q *work, const edml_model *model);
EDML_INTERNAL EDML_WEAK edml_status edml__scale_and_orient(edml_work *work, const edml_model *model);
EDML_INTERNAL EDML_WEAK edml_status edml__scale_and_orient_q(edml_work_q *work, const edml_model *model);

#endif
