/* What peers.cpp needs of the library, which is C: a stream of people, and the stages that have peers.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_BENCH_STREAM_H
#define EDML_BENCH_STREAM_H

#ifdef __cplusplus
extern "C" {
#endif

enum { STREAM_PAIRS = 91, STREAM_JOINTS = 14, STREAM_VALUES = 192 };

/* Of person n: what the network reads, and the distances that it predicts. */
void stream_values(float values[STREAM_VALUES], int n);
void stream_distances(float distance[STREAM_PAIRS], int n);

/* edml_mds(), and the network; returns the rows that it gives, and then their mirror rows. */
void stream_mds(float points[STREAM_JOINTS][3], const float distance[STREAM_PAIRS]);
const float *stream_network(const float values[STREAM_VALUES]);

/* How many layers and even inputs the network has. */
int stream_layers(void);
int stream_even_inputs(void);

/* A layer's weights and biases, row-major [outputs][inputs], if they are not NULL, and its size. */
void stream_layer(float *weight, float *bias, int layer, int *inputs, int *outputs);

#ifdef __cplusplus
}
#endif
#endif
