// SPDX-License-Identifier: MIT
// Built where there is an MPI; launched_absent.cpp is built where there is none.
#include "backends/mpi/mpi_ranks.h"
#include "harness/sampling/ranks/environment.h"
#include "harness/sampling/ranks/mpi_environment.h"

namespace tandem {

namespace {

Ranks* running = nullptr;

} // namespace

MpiEnvironment::MpiEnvironment() {
    if (!has_launcher()) return;
    // Work-groups of device host and devices that share a frame run on threads of their own, which pass no
    // messages.
    int given = MPI_THREAD_SINGLE;
    if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &given) != MPI_SUCCESS)
        throw RanksError("MPI: MPI_Init_thread failed; see what the launcher says");
    ranks_ = mpi_ranks(MPI_COMM_WORLD);
    if (ranks_->size() > 1) running = ranks_.get();
}

MpiEnvironment::~MpiEnvironment() {
    if (!ranks_) return;
    running = nullptr;
    ranks_.reset();
    MPI_Finalize();
}

Ranks* job_ranks() { return running; }

std::string mpi_library_version() { return mpi_version(); }

} // namespace tandem
