/* The networks' kernels, which generated weight headers name.  Not part of the public interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_KERNELS_H
#define EDML_KERNELS_H

#include "model.h"

#define EDML_KERNEL_F32(network)                                                                           \
    EDML_INTERNAL void edml__##network##_f32(float *out, const float *in, const edml_model *model,         \
                                             void *scratch);                                               \
    EDML_INTERNAL uint32_t edml__##network##_checksum_f32(const edml_model *model)
#define EDML_KERNEL_INTEGER(network, weights)                                                              \
    EDML_INTERNAL void edml__##network##_##weights(int32_t *out, const int32_t *in,                        \
                                                   const edml_model *model, void *scratch);                \
    EDML_INTERNAL uint32_t edml__##network##_checksum_##weights(const edml_model *model)

EDML_KERNEL_F32(fconn);
EDML_KERNEL_INTEGER(fconn, w16);
EDML_KERNEL_INTEGER(fconn, w8);
EDML_KERNEL_F32(equivariant);
EDML_KERNEL_INTEGER(equivariant, w16);
EDML_KERNEL_INTEGER(equivariant, w8);
EDML_KERNEL_F32(fconv);
EDML_KERNEL_INTEGER(fconv, w8);

#endif
