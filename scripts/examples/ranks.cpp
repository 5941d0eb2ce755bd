// SPDX-License-Identifier: MIT
// mpirun -n 2 ranks: a program of several processes that lets tandem divide its frames between them. Each
// process owns some of the bodies, has only their poses, and finds some of the pairs. Prints the pairs of
// every rank and their sum, which does not depend on the number of ranks.
#include <tandem/algorithms/traversal.h>
#include <tandem/backends/host/host_device.h>
#include <tandem/backends/mpi/mpi_ranks.h>

#include <cstdio>
#include <exception>

namespace {

/// The frame with the poses of this rank's own bodies. The other poses are not read.
tandem::Frame own_part(const tandem::Scene& scene, const tandem::Session& session, std::size_t number) {
    const auto whole = scene.frame(number); // in an application, a simulation computes the poses
    tandem::Frame frame;
    frame.poses.resize(scene.bodies.size());
    frame.deformed.resize(scene.bodies.size());
    const auto own = session.owned().value();
    for (const auto body : own) frame.poses[body] = whole.poses[body];
    return frame;
}

void run(tandem::Ranks& ranks) {
    const auto device = tandem::host::make_device(); // or the rank's GPU
    device->set_threads(1);
    const auto scene = tandem::make_scene("pile:bodies=40,mesh=grain1,frames=3");
    const auto& tiled = tandem::algorithm("tiled");
    const auto settings =
        tandem::resolve(tiled.parameters(), tiled.presets().front().values, {{"k", "18"}}, tiled.name());
    const auto session = tiled.prepare(*device, scene, settings, ranks);
    for (std::size_t i = 0; i < scene.frame_count; ++i) {
        // owned() is called for every frame: a run may repartition the bodies (FrameResult::repartitions).
        const auto result = session->run(own_part(scene, *session, i));
        if (!ranks.is_first()) continue;
        std::uint64_t all = 0;
        for (std::size_t rank = 0; rank < result.shared.size(); ++rank) {
            const auto& work = result.shared[rank];
            std::fprintf(stderr, "frame %zu, rank %zu: %llu bodies, %llu pairs, %llu bytes sent\n", i, rank,
                         static_cast<unsigned long long>(work.bodies),
                         static_cast<unsigned long long>(work.pairs),
                         static_cast<unsigned long long>(work.exchange_bytes));
            all += work.pairs;
        }
        std::printf("frame %zu: %llu candidate pairs\n", i, static_cast<unsigned long long>(all));
    }
}

} // namespace

int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    int code = 0;
    {
        const auto ranks = tandem::mpi_ranks(MPI_COMM_WORLD);
        try {
            run(*ranks);
        } catch (const std::exception& error) { // thrown on all ranks
            if (ranks->is_first()) std::fprintf(stderr, "ranks: %s\n", error.what());
            code = 1;
        }
    }
    MPI_Finalize();
    return code;
}
