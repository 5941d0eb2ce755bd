// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tandem {

/// Options of `tandem accuracy`, as given: the options of `tandem run`, applied to each scene.
struct AccuracyOptions {
    std::vector<std::string> scenes;
    RunOptions run;      ///< its scene is not used
    std::string figures; ///< the folder of the figures; empty: none are drawn
};

/// Options of `tandem profile`, as given: the options of `tandem run` for one scene, and these.
struct ProfileOptions {
    RunOptions run;
    std::string ceilings; ///< a file with records of ceilings; empty: they are measured
    bool all = false;     ///< one row for every kernel, however short
};

/// Options of `tandem devices`.
struct DevicesOptions {
    bool json = false;                ///< one JSON document instead of lines
    bool measure = false;             ///< measure the ceilings of each device
    std::vector<std::string> devices; ///< measure only these; empty: all
    std::string out;                  ///< append records of ceilings to this file
    std::vector<std::string> require; ///< as in RunOptions
};

/// Options of `tandem algorithms`.
struct AlgorithmsOptions {
    std::vector<std::string> names; ///< explain these; empty: list all
    bool json = false;              ///< one JSON document instead of lines
};

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
    std::string device = "host";
};

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

/// Each returns the exit code: 0 ok, 1 a check failed, 3 a device failed. Bad use throws InputError.
int run_command(const RunOptions& options);
int check_command(const RunOptions& options);
int accuracy_command(const AccuracyOptions& options);
int profile_command(const ProfileOptions& options);
int simulate_command(const SimulateOptions& options);
int export_command(const ExportOptions& options);
int devices_command(const DevicesOptions& options);
int scenes_command(bool json);
int algorithms_command(const AlgorithmsOptions& options);

} // namespace tandem
