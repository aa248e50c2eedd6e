// Two stages of the lift beside libraries that are made for the same, on one core, in one run, of a stream of
// people who differ: classical scaling by the eigenvectors of Eigen and of LAPACK, and the float network by
// Eigen's matrix products.  What a peer gives is first compared with what the library gives.
//
// SPDX-License-Identifier: MIT
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "stream.h"

extern "C" void ssyevr_(const char *jobz, const char *range, const char *uplo, const int *n, float *a,
                        const int *lda, const float *vl, const float *vu, const int *il, const int *iu,
                        const float *tolerance, int *found, float *value, float *vector, const int *ldz,
                        int *support, float *work, const int *lwork, int *iwork, const int *liwork,
                        int *info);

namespace
{

enum { PEOPLE = 20000, ROUNDS = 5 };
using Matrix14 = Eigen::Matrix<float, STREAM_JOINTS, STREAM_JOINTS>;
using Points = Eigen::Matrix<float, STREAM_JOINTS, 3>;
using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::vector<float> distances(PEOPLE *STREAM_PAIRS), values(PEOPLE *STREAM_VALUES);

// ---- Classical scaling ------------------------------------------------------------------------------

Matrix14 gram(const float *distance)
{
    Matrix14 squares = Matrix14::Zero();
    for (int i = 0; i < STREAM_JOINTS; i++)
        for (int j = i + 1; j < STREAM_JOINTS; j++, distance++)
            squares(i, j) = squares(j, i) = -0.5F * *distance * *distance;
    const Matrix14 centring = Matrix14::Identity() - Matrix14::Constant(1.0F / STREAM_JOINTS);
    return centring * squares * centring;
}

void scale_by_edmlift(Points &points, const float *distance)
{
    float at[STREAM_JOINTS][3];
    stream_mds(at, distance);
    for (int j = 0; j < STREAM_JOINTS; j++) points.row(j) << at[j][0], at[j][1], at[j][2];
}

void scale_by_eigen(Points &points, const float *distance)
{
    const Eigen::SelfAdjointEigenSolver<Matrix14> solver(gram(distance));
    for (int k = 0; k < 3; k++) {
        const int from = STREAM_JOINTS - 1 - k;
        points.col(k) = solver.eigenvectors().col(from) *
                        std::sqrt(std::max(solver.eigenvalues()[from], 0.0F));
    }
}

void scale_by_lapack(Points &points, const float *distance)
{
    const int n = STREAM_JOINTS, first = n - 2, last = n, lwork = 26 * n, liwork = 10 * n;
    const float none = 0, tolerance = 0;
    Matrix14 a = gram(distance);
    float value[STREAM_JOINTS], vector[3 * STREAM_JOINTS], work[26 * STREAM_JOINTS];
    int found, info, support[6], iwork[10 * STREAM_JOINTS];
    ssyevr_("V", "I", "U", &n, a.data(), &n, &none, &none, &first, &last, &tolerance, &found, value, vector,
            &n, support, work, &lwork, iwork, &liwork, &info);
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < n; j++)
            points(j, k) = vector[(2 - k) * n + j] * std::sqrt(std::max(value[2 - k], 0.0F));
}

// ---- The network ------------------------------------------------------------------------------------

struct Layer {
    Rows even, odd;
    Eigen::VectorXf bias;
};
std::vector<Layer> layers;

void read_layers()
{
    int even = stream_even_inputs();
    for (int n = 0; n < stream_layers(); n++) {
        int inputs, outputs;
        stream_layer(nullptr, nullptr, n, &inputs, &outputs);
        Rows weight(outputs, inputs);
        Layer layer;
        layer.bias.resize(outputs);
        stream_layer(weight.data(), layer.bias.data(), n, &inputs, &outputs);
        layer.even = weight.leftCols(even);
        layer.odd = weight.rightCols(inputs - even);
        layers.push_back(layer);
        even = outputs;
    }
}

// Rows, then their mirror rows.
void run_by_eigen(Eigen::VectorXf &out, const float *value)
{
    const long evens = layers[0].even.cols(), odds = layers[0].odd.cols();
    Eigen::VectorXf even = Eigen::Map<const Eigen::VectorXf>(value, evens);
    Eigen::VectorXf odd = Eigen::Map<const Eigen::VectorXf>(value + evens, odds), p, q;
    for (size_t n = 0; n < layers.size(); n++) {
        p.noalias() = layers[n].even * even;
        p += layers[n].bias;
        q.noalias() = layers[n].odd * odd;
        if (n + 1 == layers.size()) break;
        const Eigen::VectorXf first = (p + q).cwiseMax(0.0F), second = (p - q).cwiseMax(0.0F);
        even = first + second;
        odd = first - second;
    }
    out.resize(2 * p.size());
    out << p + q, p - q;
}

// ---- Time -------------------------------------------------------------------------------------------

volatile float sink; // so that nothing is left out

template <typename Work> double rate(Work work)
{
    double best = 0;
    for (int round = 0; round < ROUNDS; round++) {
        const std::clock_t start = std::clock();
        for (int n = 0; n < PEOPLE; n++) sink = work(n);
        best = std::max(best, PEOPLE / (double(std::clock() - start) / CLOCKS_PER_SEC));
    }
    return best;
}

template <typename Scale> double scaling_rate(Scale scale)
{
    return rate([&](int n) {
        Points points;
        scale(points, &distances[size_t(n) * STREAM_PAIRS]);
        return points(0, 0);
    });
}

void print(const char *what, double found, double ours)
{
    std::printf("| %s | %.0f | %.2f |\n", what, found, found / ours);
}

// Points of one scaling differ from the other's by the signs of the axes alone.
bool are_alike(const Points &a, const Points &b)
{
    for (int k = 0; k < 3; k++)
        if ((a.col(k).cwiseAbs() - b.col(k).cwiseAbs()).cwiseAbs().maxCoeff() > 1e-3F) return false;
    return true;
}

} // namespace

int main()
{
    for (int n = 0; n < PEOPLE; n++) {
        stream_values(&values[size_t(n) * STREAM_VALUES], n);
        stream_distances(&distances[size_t(n) * STREAM_PAIRS], n);
    }
    read_layers();
    for (int n = 0; n < 100; n++) {
        Points ours, eigen, lapack;
        scale_by_edmlift(ours, &distances[size_t(n) * STREAM_PAIRS]);
        scale_by_eigen(eigen, &distances[size_t(n) * STREAM_PAIRS]);
        scale_by_lapack(lapack, &distances[size_t(n) * STREAM_PAIRS]);
        Eigen::VectorXf theirs;
        run_by_eigen(theirs, &values[size_t(n) * STREAM_VALUES]);
        const Eigen::Map<const Eigen::VectorXf> rows(stream_network(&values[size_t(n) * STREAM_VALUES]),
                                                     theirs.size());
        if (!are_alike(ours, eigen) || !are_alike(ours, lapack) ||
            (rows - theirs).cwiseAbs().maxCoeff() > 1e-4F) {
            std::fprintf(stderr, "bench_peers: a peer gives something else, for person %d\n", n);
            return EXIT_FAILURE;
        }
    }
    const double mds = scaling_rate(scale_by_edmlift);
    std::printf("| classical scaling | a second | of edmlift's |\n|---|--:|--:|\n");
    print("edml_mds", mds, mds);
    print("Eigen, SelfAdjointEigenSolver of 14 x 14", scaling_rate(scale_by_eigen), mds);
    print("LAPACK, ssyevr, the three largest", scaling_rate(scale_by_lapack), mds);
    const double network = rate([](int n) { return *stream_network(&values[size_t(n) * STREAM_VALUES]); });
    Eigen::VectorXf out;
    const double eigen = rate([&](int n) {
        run_by_eigen(out, &values[size_t(n) * STREAM_VALUES]);
        return out[0];
    });
    std::printf("\n| the network of distances, in float | a second | of edmlift's |\n|---|--:|--:|\n");
    print("edmlift", network, network);
    print("Eigen, products of a matrix and a vector", eigen, network);
    return EXIT_SUCCESS;
}
