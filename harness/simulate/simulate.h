// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/measurement.h"
#include "scenes/simulate/simulation.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// One search for contacts: what was found and host nanoseconds it took.
struct ContactSearch {
    std::uint64_t body_pairs = 0, candidate_pairs = 0;
    std::int64_t broad_ns = 0;  ///< body pairs, where the host finds them and stages are measured
    std::int64_t narrow_ns = 0; ///< transform to contacts, with all transfers and waits
    StageSamples stages{};      ///< of the searches only where they are measured
};

/// Finds the contacts of frames with one cell. `timed`: with device times of every stage, which cost some
/// time themselves.
class ContactFinder {
public:
    /// Warms up: prepares a session and finds the contacts of `start` a few times, so that no step is timed
    /// that compiles or makes buffers grow to what `start` needs. Nothing of it is part of a search.
    ContactFinder(const Cell& cell, const Scene& scene, const Frame& start, bool timed);

    /// A Detect; what it did is added to search() until that is taken.
    void find(const Frame& frame, std::vector<ContactPoint>& contacts);
    /// What was done since the last call: all searches of one step.
    ContactSearch take();
    std::int64_t warm_up_ns() const { return warm_up_ns_; }

private:
    std::unique_ptr<Session> session_;
    bool host_broad_;
    std::int64_t warm_up_ns_ = 0;
    ContactSearch search_;
};

/// Sums over the steps of a run.
struct RunTotals {
    std::size_t first = 0, steps = 0; ///< of this process, which may have gone on from a checkpoint
    std::int64_t warm_up_ns = 0;      ///< before the first step, in no other time
    std::int64_t wall_ns = 0, initialize_ns = 0, broad_ns = 0, narrow_ns = 0;
    std::int64_t reduce_ns = 0, assemble_ns = 0, solve_ns = 0, move_ns = 0;
    std::vector<std::size_t> found, kept; ///< by step
    double deepest = 0;
    std::size_t not_converged = 0; ///< steps
    StepReport worst;              ///< of these the one of the largest residual
    StepReport last;
    std::uint64_t session = 0; ///< the same for all processes that went on with a recording

    /// `wall_ns`: of the whole step, searches included.
    void add(const StepReport& report, const ContactSearch& search, std::int64_t wall_ns);
};

/// Lines of results/simulation.schema.json: of one step, and of a run once it has ended, with `failure` when
/// it did not reach its last step.
nlohmann::ordered_json step_record(const StepReport& report, const ContactSearch& search,
                                   std::int64_t wall_ns, std::uint64_t session);
nlohmann::ordered_json run_record(const Cell& cell, const Scene& scene, const RunTotals& totals,
                                  const std::string& failure);

/// Says on standard error, the first time that a step of a run does not converge, what and what to do.
void tell_not_converged(const StepReport& report);
/// Says how many did not, where there was more than that one.
void tell_not_converged(const RunTotals& totals);

/// The paper's Table 3 for this run, contacts and energies; initialization only when device times were
/// measured.
std::string run_table(const RunTotals& totals, bool timed);

} // namespace tandem
