// SPDX-License-Identifier: MIT
#pragma once

#include "harness/verify/accuracy/truths.h"
#include "harness/verify/flaws.h"
#include "harness/plans/plan_file.h"
#include "harness/plans/shard.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tandem {

/// Options of `tandem run` and `tandem check`, as given.
struct RunOptions {
    std::string scene;
    std::vector<std::string> scenes; ///< `tandem run` only: measured one after another
    std::optional<PlanFile>
        plan; ///< `tandem run` only: replaces `scenes`; `request` and `frames` override its fields
    std::vector<std::string> meshes; ///< --mesh: replaces the scene
    std::vector<std::string> poses;  ///< --pose "tx ty tz qw qx qy qz", in the order of the meshes
    Request request;
    std::string frames;                     ///< "FIRST:LAST" or "N"; empty: all frames of the scene
    double choose_seconds = 10;             ///< limit on the replays that auto makes to choose for a cell
    bool choose_afresh = false;             ///< auto: ignore the stored choice
    std::optional<std::size_t> repeat;      ///< samples of each cell; none: the stopping criterion decides
    std::optional<double> noise;            ///< stop at this relative width of the median's interval
    double seconds = 10;                    ///< stop after this time of a cell's rounds
    std::optional<std::uint64_t> seed;      ///< seed of the order of cells in a round; none: random
    std::size_t profile = 0;                ///< number of plain replays for a profiler; 0: measure instead
    bool dry_run = false;                   ///< list the cells and measure none
    bool resume = false;                    ///< skip the cells that `out` already has
    bool isolate = false;                   ///< run each check and each round of a cell in its own process
    Shard shard;                            ///< which groups of the plan are measured
    double timeout = 0;                     ///< seconds that such a process may take; 0: no limit
    std::string out;                        ///< append records to this file; empty: none are written
    std::string dump_pairs, dump_contacts;  ///< CSV files of the first finished cell; empty: none
    std::string trace;                      ///< timeline of one frame of the first finished cell; empty: none
    std::vector<std::string> require;       ///< devices or backends whose absence is a failure
    bool check = true;                      ///< compare answers with the reference
    bool check_afresh = false;              ///< compute references and truths again, ignore stored ones
    bool count = true;                      ///< replay once more with kernels that count their work
    TruthAmount truth = TruthAmount::pairs; ///< compare answers with the exact truth
    std::size_t truth_contacts = 0;         ///< exact contacts of at most this many pairs a frame; 0: all
    Degenerate degenerate = Degenerate::flat; ///< how flawed tetrahedra are handled
    std::optional<std::size_t> threads;       ///< threads of device host, as setting threads
    std::size_t memory = 0;                   ///< memory limit of each device in bytes; 0: none
    bool quiet = false;
};

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
