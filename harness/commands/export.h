// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tandem {

/// Options of `tandem export`.
struct ExportOptions {
    std::string scene;
    std::vector<std::string> meshes, poses; ///< as in RunOptions
    MeshReading reading{};                  ///< as in RunOptions
    std::string frames;                     ///< "FIRST:LAST" or "N"; empty: all
    std::size_t every = 1;                  ///< export every Nth frame only
    std::string vtu, glb, geometry;         ///< a folder and two files
    bool to_csv = false;                    ///< `scene` is a file of records; then nothing else is given
    std::string csv;                        ///< a file; empty: standard output
    std::string chunks;                     ///< a file for the chunks of the meshes
    std::string builder = "morton";         ///< order of the tetrahedra in chunks, as the setting
    std::uint64_t chunk_bytes = 8000;       ///< size of the chunks by the paper's equations 1 to 3, with `k`
    std::string k = "8";                    ///< as the setting
    bool contacts = false;                  ///< also export the contacts, found on `device`
    bool surfaces = false;                  ///< also export the contact surfaces, found on `device`
    std::string device;                     ///< empty: default_device
};

/// Returns the exit code: 0 ok, 1 a check failed, 3 a device failed. Bad use throws InputError.
int export_command(const ExportOptions& options);

} // namespace tandem
