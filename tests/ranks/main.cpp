// SPDX-License-Identifier: MIT
#include "backends/mpi/mpi_ranks.h"
#include "tests/ranks/failures.h"
#include "tests/ranks/job.h"
#include "tests/support/test.h"

std::unique_ptr<tandem::Ranks> tandem::job;

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    MPI_Init(nullptr, nullptr);
    tandem::job = tandem::mpi_ranks(MPI_COMM_WORLD);
    if (!tandem::job->is_first()) { // one report, and the failures of the others
        auto& listeners = testing::UnitTest::GetInstance()->listeners();
        delete listeners.Release(listeners.default_result_printer());
        listeners.Append(new tandem::FailuresOfARank(tandem::job->rank()));
    }
    // All ranks have the same exit status, because Open MPI may block when only some ranks fail.
    const bool fails = RUN_ALL_TESTS() != 0;
    const auto all = tandem::job->gather_to_all(std::as_bytes(std::span(&fails, 1)));
    const bool any = std::ranges::any_of(all, [](const auto& one) { return one.front() != std::byte{0}; });
    tandem::job.reset();
    MPI_Finalize();
    return any ? 1 : 0;
}
