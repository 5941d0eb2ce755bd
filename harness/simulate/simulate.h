// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/measurement.h"
#include "scenes/simulate/simulation.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// The counts and host times of the searches for contacts in one step.
struct ContactSearch {
    std::uint64_t body_pairs = 0, candidate_pairs = 0;
    std::int64_t broad_ns = 0;  ///< time to find body pairs, when the host finds them and stages are measured
    std::int64_t narrow_ns = 0; ///< time from transform to contacts, with all transfers and waits
    StageSamples stages{};      ///< stages of the searches, when they are measured
};

/// Finds the contacts of frames with one cell. `timed` measures device times of every stage, which takes some
/// time itself.
class ContactFinder {
public:
    /// Prepares a session and warms up: finds the contacts of `start` a few times, so that no timed step
    /// compiles kernels or grows buffers to the size for `start`. The warm-up is not part of any search.
    ContactFinder(const Cell& cell, const Scene& scene, const Frame& start, bool timed);

    /// Finds the contacts of a frame, for Simulation::step(). Adds counts and times until take() is called.
    void find(const Frame& frame, std::vector<ContactPoint>& contacts);
    /// Returns and resets the counts and times since the last call: all searches of one step.
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
    std::size_t first = 0, steps = 0; ///< first step and number of steps of this process
    std::int64_t warm_up_ns = 0;      ///< before the first step; not part of any other time
    std::int64_t wall_ns = 0, initialize_ns = 0, broad_ns = 0, narrow_ns = 0;
    std::int64_t reduce_ns = 0, assemble_ns = 0, solve_ns = 0, move_ns = 0;
    std::vector<std::size_t> found, kept; ///< number of contacts in each step
    double deepest = 0;
    std::size_t not_converged = 0; ///< number of steps whose contact solver did not converge
    StepReport worst;              ///< among these, the step with the largest residual
    StepReport last;
    std::uint64_t session = 0; ///< identifies the run; the same for all processes that continue a recording

    /// `wall_ns` is the time of the whole step, including the searches.
    void add(const StepReport& report, const ContactSearch& search, std::int64_t wall_ns);
};

/// Lines of results/simulation.schema.json: for one step, and for a run after its end. `failure` is the
/// reason why the run did not reach its last step; empty: it did.
nlohmann::ordered_json step_record(const StepReport& report, const ContactSearch& search,
                                   std::int64_t wall_ns, std::uint64_t session);
nlohmann::ordered_json run_record(const Cell& cell, const Scene& scene, const RunTotals& totals,
                                  const std::string& failure);

/// Prints on standard error that a step did not converge, and what to do. For the first such step of a run.
void warn_not_converged(const StepReport& report);
/// Prints the number of steps that did not converge, if there was more than one.
void warn_not_converged(const RunTotals& totals);

/// The paper's Table 3 for this run, with contacts and energies. Initialization has a row only when device
/// times were measured.
std::string run_table(const RunTotals& totals, bool timed);

} // namespace tandem
