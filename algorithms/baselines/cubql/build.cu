// SPDX-License-Identifier: MIT
#include "algorithms/baselines/cubql/build.h"

#define CUBQL_GPU_BUILDER_IMPLEMENTATION 1
#include <cuBQL/bvh.h>

#include <cuBQL/builder/cuda.h>

#include <stdexcept>
#include <string>

namespace tandem::cubql_trees {

namespace {

static_assert(sizeof(Box) == sizeof(cuBQL::box3f) && sizeof(Node) == sizeof(cuBQL::bvh3f::Node));

void check(cudaError_t code) {
    if (code != cudaSuccess) throw std::runtime_error(std::string("cuBQL's builder: ") + cudaGetErrorString(code));
}

template<class Row>
std::vector<Row> downloaded(const void* rows, std::size_t count) {
    std::vector<Row> all(count);
    check(cudaMemcpy(all.data(), rows, count * sizeof(Row), cudaMemcpyDeviceToHost));
    return all;
}

} // namespace

Tree build(int device, const std::vector<Box>& boxes, int leaf_size) {
    check(cudaSetDevice(device));
    cuBQL::box3f* on_device = nullptr;
    check(cudaMalloc(&on_device, boxes.size() * sizeof(Box)));
    check(cudaMemcpy(on_device, boxes.data(), boxes.size() * sizeof(Box), cudaMemcpyHostToDevice));
    cuBQL::BuildConfig how;
    how.makeLeafThreshold = leaf_size;
    how.maxAllowedLeafSize = leaf_size;
    how.enableSAH();
    cuBQL::DeviceMemoryResource memory;
    cuBQL::bvh3f bvh;
    cuBQL::gpuBuilder(bvh, on_device, static_cast<std::uint32_t>(boxes.size()), how, nullptr, memory);
    check(cudaDeviceSynchronize());
    Tree tree{downloaded<Node>(bvh.nodes, bvh.numNodes), downloaded<std::uint32_t>(bvh.primIDs, bvh.numPrims)};
    cuBQL::cuda::free(bvh, nullptr, memory);
    check(cudaFree(on_device));
    return tree;
}

} // namespace tandem::cubql_trees
