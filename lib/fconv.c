/* FConv where another network's memory is: refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "model.h"

void edml__fconv_refuse(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                        const edml_model *model, float layer[2][EDML_LAYER_WIDEST])
{
    (void)edm, (void)model, (void)layer;
    for (int k = 0; k < EDML_PAIRS; k++) distance[k] = NAN;
}
