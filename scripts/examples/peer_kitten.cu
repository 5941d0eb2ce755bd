// SPDX-License-Identifier: MIT
// KittenGpuLBVH (https://github.com/jerry060599/KittenGpuLBVH, written against 8964555) for scripts/peers:
// peer_kitten bodies|scene BOXES BODIES DEVICE ROUNDS. Needs nvcc, GLM and a clone of the library in $KITTEN:
//   nvcc -O3 -arch=native --extended-lambda -I$KITTEN peer_kitten.cu $KITTEN/lbvh.cu -o peer_kitten
// With `bodies` each body has a tree, and there is a query for each two bodies whose boxes meet. With `scene`
// one tree has all boxes, and pairs of one body are removed from its answer, as the library has no filter.
#include <lbvh.cuh>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thrust/device_vector.h>
#include <thrust/remove.h>

using Box = Kitten::LBVH::aabb;
static_assert(sizeof(Box) == 24, "the file has six floats for each box");

std::vector<char> bytes_of(const char* path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class Peer {
public:
    Peer(bool is_scene, std::vector<Box> boxes, const std::vector<std::uint32_t>& bodies)
        : is_scene_(is_scene), bodies_(bodies), pairs_(1u << 20) {
        // The library's overlap is open. With the next larger numbers as upper bounds it is closed.
        for (auto& box : boxes)
            for (int i = 0; i < 3; ++i) box.max[i] = std::nextafterf(box.max[i], INFINITY);
        boxes_ = boxes;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            if (i == 0 || (!is_scene && bodies[i] != bodies[i - 1])) first_.push_back(i);
        trees_ = std::vector<Kitten::LBVH>(first_.size());
        first_.push_back(bodies.size());
        build();
        while (query() == pairs_.size()) pairs_.resize(2 * pairs_.size()); // pairs were left out
    }

    void build() {
        for (std::size_t i = 0; i < trees_.size(); ++i)
            trees_[i].compute(boxes_.data().get() + first_[i], first_[i + 1] - first_[i]);
    }

    void refit() {
        for (auto& tree : trees_) tree.refit();
    }

    std::size_t query() {
        if (is_scene_) {
            const auto count = trees_[0].query(pairs_.data().get(), pairs_.size());
            if (count == pairs_.size()) return count;
            const auto body = bodies_.data().get();
            const auto is_own = [body] __device__(glm::ivec2 pair) { return body[pair.x] == body[pair.y]; };
            return thrust::remove_if(pairs_.begin(), pairs_.begin() + count, is_own) - pairs_.begin();
        }
        std::size_t count = 0;
        for (std::size_t a = 0; a < trees_.size(); ++a)
            for (std::size_t b = a + 1; b < trees_.size(); ++b)
                if (trees_[a].bounds().intersects(trees_[b].bounds()))
                    count += trees_[a].query(pairs_.data().get() + count, pairs_.size() - count, &trees_[b]);
        return count;
    }

private:
    bool is_scene_;
    thrust::device_vector<Box> boxes_;
    thrust::device_vector<std::uint32_t> bodies_;
    thrust::device_vector<glm::ivec2> pairs_;
    std::vector<std::size_t> first_; // box of each tree, and the end
    std::vector<Kitten::LBVH> trees_;
};

template<class Call>
double milliseconds(Call call) {
    cudaDeviceSynchronize();
    const auto begin = std::chrono::steady_clock::now();
    call();
    cudaDeviceSynchronize();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

int main(int count, char** words) {
    const std::string tree = count == 6 ? words[1] : "", device = count == 6 ? words[4] : "";
    if ((tree != "bodies" && tree != "scene") || device.rfind("cuda:", 0) != 0)
        return std::fprintf(stderr, "usage: peer_kitten bodies|scene BOXES BODIES cuda:N ROUNDS\n"), 2;
    const int number = std::atoi(device.c_str() + 5);
    cudaDeviceProp properties;
    checkCudaErrors(cudaSetDevice(number));
    checkCudaErrors(cudaGetDeviceProperties(&properties, number));
    const auto boxes = bytes_of(words[2]), bodies = bytes_of(words[3]);
    const auto first = reinterpret_cast<const Box*>(boxes.data());
    const auto first_body = reinterpret_cast<const std::uint32_t*>(bodies.data());
    Peer peer(tree == "scene", {first, first + boxes.size() / 24},
              {first_body, first_body + bodies.size() / 4});
    std::size_t pairs = 0;
    std::string build, refit, query;
    for (int i = 0; i < std::atoi(words[5]); ++i) {
        const char* comma = i ? ", " : "";
        build += comma + std::to_string(milliseconds([&] { peer.build(); }));
        refit += comma + std::to_string(milliseconds([&] { peer.refit(); }));
        query += comma + std::to_string(milliseconds([&] { pairs = peer.query(); }));
    }
    std::printf("{\"name\": \"KittenGpuLBVH, tree=%s\", \"version\": \"KittenGpuLBVH\", \"device\": \"%s\", "
                "\"pairs\": %zu, \"build_ms\": [%s], \"refit_ms\": [%s], \"query_ms\": [%s]}\n",
                tree.c_str(), properties.name, pairs, build.c_str(), refit.c_str(), query.c_str());
}
