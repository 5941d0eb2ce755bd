// SPDX-License-Identifier: MIT
#pragma once

#include "harness/verify/accuracy/truths.h"
#include "harness/verify/references.h"
#include "harness/sampling/cell_state.h"

#include <functional>

namespace tandem {

/// How a cell's answers are checked, and which additional replays it has.
struct CheckOptions {
    bool check = true;        ///< compare with the reference
    bool count_work = true;   ///< run a replay with the counting kernels
    Truths* truths = nullptr; ///< for the same scene and frames; null: no comparison with the truth
    /// Called with what runs, and the fraction of the check that is done.
    std::function<void(std::string_view, double)> progress = [](std::string_view, double) {};
};

/// Measures one cell: a check of every answer, then rounds. A round prepares a new session, so that effects
/// of memory allocation are part of the noise. It warms up until replays stop getting faster, takes samples,
/// each compared with the checked answers, and ends with one instrumented replay. Every function may throw
/// DeviceError, and Interrupted, which drops the check or the round; earlier measurements stay valid.
class CellSampler {
public:
    /// Continues from `state`. The cell must outlive this object.
    explicit CellSampler(const Cell& cell, CellState state = {}) : cell_(cell), state_(std::move(state)) {
        // A cell that fails before its first session records the requested settings.
        if (state_.measurement.settings.empty()) state_.measurement.settings = cell.settings;
    }
    virtual ~CellSampler() = default;

    /// Checks and rounds end with Interrupted between two frames where `stop` returns true. For a cell of
    /// several ranks it is collective.
    void stop_when(std::function<bool()> stop) { stop_ = std::move(stop); }
    /// The first session: compares every answer with the reference and the truth.
    void check(const CheckOptions& options);
    /// A round with `samples` samples, which may be 0.
    void round(std::size_t samples);
    /// Counts work once, in a separate session with the counting kernels.
    void count_work() {
        if (!state_.counted) do_count_work();
        state_.counted = true;
    }
    /// Frees the session; the next round prepares a new one.
    void release() { do_release(); }

    /// Sets the number of the next round; earlier rounds are from a previous run of the program.
    void resume_at(std::uint32_t round) {
        state_.rounds = round;
        if (state_.is_checked()) state_.measurement.continued.push_back(round);
    }

    const Cell& cell() const { return cell_; }
    const CellState& state() const { return state_; }
    const Measurement& measurement() const { return state_.measurement; }
    /// Number of samples that last a quarter of a preparation, limited to 1..32.
    std::size_t samples_a_round() const;
    /// Whether a preparation lasts over 2 s, so that one for every sample is too expensive.
    bool preparation_is_long() const { return state_.prepare_ns > 2'000'000'000; }

    CellSampler(const CellSampler&) = delete;
    CellSampler& operator=(const CellSampler&) = delete;

protected:
    const Cell& cell_;
    CellState state_;
    std::function<bool()> stop_ = [] { return false; };

private:
    void drop_round();

    virtual void do_check(const CheckOptions& options) = 0;
    virtual void do_round(std::size_t samples) = 0;
    virtual void do_count_work() = 0;
    virtual void do_release() = 0;
};

} // namespace tandem
