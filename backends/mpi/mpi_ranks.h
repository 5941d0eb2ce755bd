// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

// The bindings for C++, which the standard has given up, bring warnings and symbols of their own.
#ifndef OMPI_SKIP_MPICXX
#define OMPI_SKIP_MPICXX
#endif
#ifndef MPICH_SKIP_MPICXX
#define MPICH_SKIP_MPICXX
#endif

#include <memory>
#include <mpi.h>
#include <string>

namespace tandem {

/// The ranks of a communicator, which is duplicated, so that messages do not mix with the application's. MPI
/// has been initialised, by the thread that uses these or with MPI_THREAD_SERIALIZED; the ranks die before
/// MPI_Finalize. Counts of MPI's calls are ints: longer messages go in pieces of `most_at_once` bytes, less
/// than 2^31, those of send() aside, which throws. Throws RanksError.
std::unique_ptr<Ranks> mpi_ranks(MPI_Comm communicator, std::size_t most_at_once = std::size_t{1} << 30);

/// "Open MPI v4.1.4, ..." as the library calls itself, one line.
std::string mpi_version();

} // namespace tandem
