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
    std::vector<std::string> scenes; ///< of `tandem run`: one after the other
    std::optional<PlanFile>
        plan; ///< of `tandem run`: for scenes; what `request` and `frames` have goes first
    std::vector<std::string> meshes; ///< --mesh: instead of a scene
    std::vector<std::string> poses;  ///< --pose "tx ty tz qw qx qy qz", in the order of the meshes
    Request request;
    std::string frames;                    ///< "FIRST:LAST" or "N"; empty: all frames of the scene
    double choose_seconds = 10;            ///< of replays that auto may take to choose for a cell
    bool choose_afresh = false;            ///< auto: look for no choice that was kept
    std::optional<std::size_t> repeat;     ///< samples of each cell; none: until they suffice
    std::optional<double> noise;           ///< what suffices: this width of the median's interval, relative
    double seconds = 10;                   ///< or so many seconds of a cell
    std::optional<std::uint64_t> seed;     ///< of the order of cells in a round; none: by chance
    std::size_t profile = 0;               ///< replay so often, with nothing else, for a profiler
    bool dry_run = false;                  ///< list the cells and measure none
    bool resume = false;                   ///< leave out what `out` has
    bool isolate = false;                  ///< a process of its own for each cell's check and each round
    Shard shard;                           ///< which groups of the plan are measured
    double timeout = 0;                    ///< seconds of such a process; 0: no limit
    std::string out;                       ///< append records to this file; empty: none are written
    std::string dump_pairs, dump_contacts; ///< CSV files of the first cell that finishes; empty: none
    std::string trace;                ///< timeline of a frame of the first cell that finishes; empty: none
    std::vector<std::string> require; ///< devices or backends whose absence is a failure
    bool check = true;                ///< compare answers with the reference
    bool check_afresh = false;        ///< with what is computed now, not with what was kept
    bool count = true;                ///< replay once more with kernels that count their work
    TruthAmount truth = TruthAmount::pairs;   ///< compare answers with the exact truth
    std::size_t truth_contacts = 0;           ///< of this many pairs a frame at most; 0: all
    Degenerate degenerate = Degenerate::flat; ///< what becomes of flawed tetrahedra
    std::optional<std::size_t> threads;       ///< of device host, as setting threads
    std::size_t memory = 0;                   ///< bytes that each device may give; 0: what it has
    bool quiet = false;
};

/// Options of `tandem accuracy`, as given: those of `tandem run` for every one of several scenes.
struct AccuracyOptions {
    std::vector<std::string> scenes;
    RunOptions run;      ///< its scene is not used
    std::string figures; ///< the folder of the figures; empty: none are drawn
};

/// Options of `tandem profile`, as given: those of `tandem run` for one scene, and
struct ProfileOptions {
    RunOptions run;
    std::string ceilings; ///< a file of records of ceilings; empty: they are measured
    bool all = false;     ///< a row for every kernel, however short
};

/// Options of `tandem devices`.
struct DevicesOptions {
    bool json = false;                ///< one JSON document instead of lines
    bool measure = false;             ///< measure the ceilings of each
    std::vector<std::string> devices; ///< of these only; empty: all
    std::string out;                  ///< append records of ceilings
    std::vector<std::string> require; ///< as of RunOptions
};

/// Options of `tandem algorithms`.
struct AlgorithmsOptions {
    std::vector<std::string> names; ///< explain these; empty: list all
    bool json = false;              ///< one JSON document instead of lines
};

/// Options of `tandem export`.
struct ExportOptions {
    std::string scene;
    std::vector<std::string> meshes, poses; ///< as of RunOptions
    std::string frames;                     ///< "FIRST:LAST" or "N"; empty: all
    std::size_t every = 1;                  ///< leave out frames between every so many
    std::string vtu, glb, geometry;         ///< a folder and two files
    bool to_csv = false;                    ///< `scene` is a file of records; then nothing else is given
    std::string csv;                        ///< a file; empty: standard output
    std::string chunks;                     ///< a file of the meshes' chunks
    std::string builder = "morton";         ///< their order; as of the setting
    std::uint64_t chunk_bytes = 8000;       ///< their size by equations 1 to 3, with `k`
    std::string k = "8";                    ///< as of the setting
    bool contacts = false;                  ///< beside the .vtu and in the geometry, found on `device`
    std::string device = "host";
};

/// Options of `tandem simulate`.
struct SimulateOptions {
    std::string scene;
    std::string recording;  ///< -o: the file of recorded frames; empty: none
    std::string record;     ///< append one line a step and one for the run
    std::string pictures;   ///< OUT: draw the recording as OUT-0.png, ...; empty: no pictures
    std::size_t steps = 0;  ///< 0: those of the scene
    std::size_t every = 10; ///< steps from checkpoint to checkpoint
    bool resume = false;
    std::vector<std::string> dynamics; ///< NAME=VALUE over the scene's
    Request request;                   ///< how contacts are found: one cell
    std::vector<std::string> require;  ///< as of RunOptions
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
