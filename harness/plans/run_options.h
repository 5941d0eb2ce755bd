// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/plan_file.h"
#include "harness/plans/shard.h"
#include "base/columns.h"
#include "harness/verify/accuracy/truths.h"
#include "harness/frames/flaws.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tandem {

/// Options of `tandem run` and `tandem check`, as given.
struct RunOptions { // NOLINT(clang-analyzer-optin.performance.Padding): in the order of readers
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
    bool keys = false;                      ///< with dry_run: also list the keys of the records
    bool resume = false;                    ///< skip the cells that `out` already has
    bool isolate = false;                   ///< run each check and each round of a cell in its own process
    Shard shard;                            ///< which groups of the plan are measured
    double timeout = 0;                     ///< seconds that such a process may take; 0: no limit
    std::string out;                        ///< append records to this file; empty: none are written
    std::string dump_pairs, dump_contacts;  ///< CSV files of the first finished cell; empty: none
    std::string dump_distances;             ///< the same
    std::string dump_surfaces;              ///< VTK file of the first finished cell; empty: none
    std::string trace;                      ///< timeline of one frame of the first finished cell; empty: none
    std::vector<std::string> require;       ///< devices or backends whose absence is a failure
    bool check = true;                      ///< compare answers with the reference
    bool check_afresh = false;              ///< compute references and truths again, ignore stored ones
    bool count = true;                      ///< replay once more with kernels that count their work
    TruthAmount truth = TruthAmount::pairs; ///< compare answers with the exact truth
    bool truth_is_given = false;            ///< whether `truth` is not the default
    std::size_t truth_contacts = 0;         ///< exact contacts of at most this many pairs per frame; 0: all
    MeshReading reading{};                  ///< how mesh files are read and meshes connected
    Degenerate degenerate = Degenerate::flat; ///< how flawed tetrahedra are handled
    std::size_t memory = 0;                   ///< memory limit of each device in bytes; 0: none
    std::string filter;                       ///< only cells whose names match; empty: all (cell_filter.h)
    TableFormat format = TableFormat::text;   ///< of printed tables
    std::vector<std::string> columns;         ///< columns of throughput in printed tables (throughput.h)
    bool quiet = false;

    bool has_dumps() const {
        return !(dump_pairs.empty() && dump_contacts.empty() && dump_distances.empty()
                 && dump_surfaces.empty());
    }
};

/// The plan of the options, or one of a single product.
PlanFile plan_of(const RunOptions& options);

} // namespace tandem
