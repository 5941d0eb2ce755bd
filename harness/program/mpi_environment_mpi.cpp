// SPDX-License-Identifier: MIT
// For builds with MPI; see mpi_environment_absent.cpp for builds without.
#include "backends/mpi/mpi_ranks.h"
#include "harness/program/launcher.h"
#include "harness/program/mpi_environment.h"

namespace tandem {

namespace {

Ranks* running = nullptr;

} // namespace

MpiEnvironment::MpiEnvironment() {
    if (!has_launcher()) return;
    // Work-groups of the host device, and devices that share a frame, use further threads, which send no
    // messages.
    int provided = MPI_THREAD_SINGLE;
    if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided) != MPI_SUCCESS)
        throw RanksError("MPI: MPI_Init_thread failed; see the messages of the launcher");
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
