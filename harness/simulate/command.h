// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"
#include "scenes/mesh_reading.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tandem {

/// Options of `tandem simulate`.
struct SimulateOptions {
    std::string scene;
    MeshReading reading{};  ///< as in RunOptions
    std::string recording;  ///< -o: the file for recorded frames; empty: none
    std::string record;     ///< append one JSON line a step and one for the run to this file
    std::string pictures;   ///< OUT: draw the recording as OUT-0.png, ...; empty: no pictures
    std::size_t steps = 0;  ///< number of steps; 0: the scene's own number
    std::size_t every = 10; ///< steps between two checkpoints
    bool resume = false;
    std::vector<std::string> dynamics; ///< NAME=VALUE, overrides the scene's own setting
    Request request;                   ///< the one cell that finds contacts
    std::vector<std::string> require;  ///< as in RunOptions
    bool quiet = false;
};

/// Returns the exit code: 0 ok, 1 a check failed, 3 a device failed. Bad use throws InputError.
int simulate_command(const SimulateOptions& options);

} // namespace tandem
