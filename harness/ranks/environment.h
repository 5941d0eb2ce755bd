// SPDX-License-Identifier: MIT
#pragma once

namespace tandem {

/// Whether the environment is one that a launcher of MPI made for the processes it starts.
bool has_launcher();

} // namespace tandem
