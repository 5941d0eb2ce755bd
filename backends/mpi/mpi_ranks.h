// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

// The C++ bindings, which the standard has removed, add warnings and symbols of their own.
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
/// must be initialised by the thread that uses them, or with MPI_THREAD_SERIALIZED. Destroy the ranks before
/// MPI_Finalize. Longer messages are split into pieces of `max_piece_bytes` bytes, less than 2^31, because
/// MPI counts in int. send() does not split and throws instead. Throws RanksError.
std::unique_ptr<Ranks> mpi_ranks(MPI_Comm communicator, std::size_t max_piece_bytes = std::size_t{1} << 30);

/// The library's own name and version in one line, such as "Open MPI v4.1.4".
std::string mpi_version();

} // namespace tandem
