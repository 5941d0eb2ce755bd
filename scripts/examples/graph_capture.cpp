// SPDX-License-Identifier: MIT
// graph_capture [SCENE [REPLAYS]]: captures a frame into a CUDA graph of the application, replays it with
// other poses and vertices in the same arrays, and compares every replay with the frame that Session::run
// finds. Prints the time of a replay, of run(), and of the host in a call of enqueue(). Needs no toolkit.
// With the stub of the driver, which runs no kernels, it checks the calls only.
#include "driver_calls.h"

#include <tandem/backends/cuda/cuda_device.h>
#include <tandem/tandem.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point begin, int calls) {
    return std::chrono::duration<double, std::micro>(Clock::now() - begin).count() / calls;
}

/// A frame in memory of the device, which the application overwrites before each replay.
class Arrays {
public:
    Arrays(tandem::Device& device, const tandem::Scene& scene) : device_(device), scene_(scene) {
        const auto rows = [&](std::size_t numbers) {
            return tandem::DeviceRows{device.allocate(numbers * sizeof(double), "the application's"),
                                      tandem::Precision::fp64};
        };
        frame_.poses = rows(7 * scene.bodies.size());
        for (const auto& body : scene.bodies)
            frame_.deformed.push_back(body.deformable ? rows(3 * scene.meshes[body.mesh].vertices.size())
                                                      : tandem::DeviceRows{});
    }

    /// Enqueues the poses and vertices of a step.
    void set(int step) {
        const auto from = scene_.frame(static_cast<std::size_t>(step) % scene_.frame_count);
        std::vector<double> poses;
        for (const auto& [q, t] : from.poses)
            poses.insert(poses.end(), {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()});
        upload(frame_.poses, poses);
        for (std::size_t body = 0; body < from.deformed.size(); ++body) {
            std::vector<double> vertices;
            for (const auto& vertex : from.deformed[body])
                vertices.insert(vertices.end(), vertex.begin(), vertex.end());
            if (!vertices.empty()) upload(frame_.deformed[body], vertices);
        }
    }
    const tandem::DeviceFrame& frame() const { return frame_; }

private:
    void upload(const tandem::DeviceRows& to, const std::vector<double>& rows) {
        const tandem::StageScope scope(device_, tandem::Stage::write);
        device_.upload(to.buffer, std::as_bytes(std::span(rows)));
    }

    tandem::Device& device_;
    const tandem::Scene& scene_;
    tandem::DeviceFrame frame_;
};

/// The application's graph of one frame, and what it needs as long as it lives.
struct Graph {
    Handle executable = nullptr; ///< null if a call has failed
    tandem::QueuedFrame frame;
};

Graph captured(tandem::Session& session, const tandem::DeviceFrame& frame, Handle stream) {
    Graph graph;
    Handle recorded = nullptr;
    if (!call("cuStreamBeginCapture_v2", stream, 0)) return graph;
    graph.frame = session.enqueue(frame); // and commands of the application, before it and after it
    if (!call("cuStreamEndCapture", stream, &recorded)) return graph;
    call("cuGraphInstantiateWithFlags", &graph.executable, recorded, 0ull);
    call("cuGraphDestroy", recorded);
    return graph;
}

std::uint64_t flag_of(tandem::Device& device, const tandem::QueuedFrame& queued) {
    std::array<std::uint64_t, QUEUED_WORDS / 2> counts{};
    const tandem::StageScope scope(device, tandem::Stage::read);
    device.download(queued.counts, std::as_writable_bytes(std::span(counts))); // waits
    return counts[QUEUED_FLAG / 2];
}

/// Replays the graph with the poses of successive steps. Returns how many answers differ from those of run().
int differing(tandem::Session& session, tandem::Session& other, Arrays& arrays, const Graph& graph,
              Handle stream, int replays) {
    int different = 0;
    for (int step = 0; step < replays; ++step) {
        arrays.set(step);
        call("cuGraphLaunch", graph.executable, stream);
        const bool fits = flag_of(*session.devices().front(), graph.frame) == 0;
        const auto found = session.collect();
        const auto right = other.run(arrays.frame());
        const bool same = fits && found && found->digest() == right.digest()
                          && found->contact_digest() == right.contact_digest();
        different += same ? 0 : 1;
    }
    return different;
}

template<class Work>
double time_of(int calls, Handle stream, const Work& work) {
    call("cuStreamSynchronize", stream);
    const auto begin = Clock::now();
    for (int i = 0; i < calls; ++i) work();
    call("cuStreamSynchronize", stream);
    return microseconds_since(begin, calls);
}

bool run(tandem::Device& device, const std::string& name, Handle stream, int replays) {
    const auto scene = tandem::make_scene(name);
    const auto& tiled = tandem::algorithm("tiled");
    const std::array devices{&device};
    const auto settings = tiled.settings({{"contact_rule", "opposing"}, {"decision", "fp32"}});
    const auto session = tiled.prepare(devices, scene, settings);
    const auto other = tiled.prepare(devices, scene, settings);
    Arrays arrays(device, scene);
    arrays.set(0);
    const auto first = session->run(arrays.frame()); // grows the buffers, with an eighth to spare
    session->enqueue(arrays.frame());                // prepares
    const auto graph = captured(*session, arrays.frame(), stream);
    if (!check(graph.executable != nullptr, "no graph")) return false;
    const int different = differing(*session, *other, arrays, graph, stream, replays);
    std::printf("%d replays of %s, %llu pairs in the first: %d differ from run()%s\n", replays, name.c_str(),
                static_cast<unsigned long long>(first.count), different,
                is_stub() ? " (no kernels ran)" : "");
    const auto replay = time_of(replays, stream, [&] { call("cuGraphLaunch", graph.executable, stream); });
    const auto whole = time_of(replays, stream, [&] { session->run(arrays.frame()); });
    const auto enqueue_some = [&] {
        for (int i = 0; i < 10; ++i) session->enqueue(arrays.frame());
    };
    enqueue_some(); // the session makes a graph of its own
    device.finish();
    const auto begin = Clock::now();
    enqueue_some();
    const auto host = microseconds_since(begin, 10);
    std::printf("replay %.1f us, run() %.1f us; the host needs %.1f us for enqueue()\n", replay, whole, host);
    device.finish();
    return call("cuGraphExecDestroy", graph.executable) && different == 0;
}

} // namespace

int main(int count, char** arguments) {
    const std::string name = count > 1 ? arguments[1] : "plates";
    const int replays = count > 2 ? std::atoi(arguments[2]) : 1000;
    Handle context = nullptr;
    Handle stream = nullptr;
    if (!check(library() != nullptr, "no driver (looked for libcuda.so.1)")) return 77;
    if (!call("cuInit", 0u) || !create(context) || !create_stream(context, stream)) return 1;
    call("cuCtxSetCurrent", context);
    auto device = tandem::cuda::adopt(context, stream);
    const bool good = run(*device, name, stream, replays);
    device.reset();
    call("cuStreamDestroy_v2", stream);
    call("cuCtxDestroy_v2", context);
    return good ? 0 : 1;
}
