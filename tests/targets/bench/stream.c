/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "stages.h"
#include "stream.h"

void stream_values(float values[STREAM_VALUES], int n)
{
    make_pose(n);
    stage_frame();
    stage_inputs();
    memcpy(values, lift_work()->of.network.io.values, MODEL.inputs * sizeof *values);
}

void stream_distances(float distance[STREAM_PAIRS], int n)
{
    make_pose(n);
    stage_frame();
    stage_predict();
    memcpy(distance, said.distance, STREAM_PAIRS * sizeof *distance);
}

void stream_mds(float points[STREAM_JOINTS][3], const float distance[STREAM_PAIRS])
{
    edml_mds((point *)points, distance, lift_work());
}

const float *stream_network(const float values[STREAM_VALUES])
{
    memcpy(lift_work()->of.network.io.values, values, MODEL.inputs * sizeof *values);
    stage_network();
    return lift_work()->of.network.io.values;
}

int stream_layers(void) { return MODEL.layer_count; }

int stream_even_inputs(void) { return MODEL.even_inputs; }

void stream_layer(float *weight, float *bias, int layer, int *inputs, int *outputs)
{
    const edml_dense_f32 *const of = (const edml_dense_f32 *)MODEL.layers + layer;
    *inputs = of->inputs;
    *outputs = EDML_ROWS * EDML_GROUPS(of->outputs);
    if (weight == NULL) return;
    for (int row = 0; row < *outputs; row++) {
        const float *const group = of->weight + row / EDML_ROWS * EDML_ROWS * *inputs;
        for (int i = 0; i < *inputs; i++)
            weight[row * *inputs + i] = group[i * EDML_ROWS + row % EDML_ROWS];
        bias[row] = of->bias[row];
    }
}
