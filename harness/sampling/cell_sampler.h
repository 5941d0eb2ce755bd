// SPDX-License-Identifier: MIT
#pragma once

#include "harness/verify/accuracy/truths.h"
#include "harness/verify/references.h"
#include "harness/sampling/cell_state.h"

#include <functional>

namespace tandem {

/// How answers are looked at, and what else a cell is replayed for.
struct CheckOptions {
    bool check = true;        ///< against the reference
    bool count_work = true;   ///< by kernels that count
    Truths* truths = nullptr; ///< of the same scene and frames; null: no comparison with the truth
    std::function<void(std::string_view)> progress = [](std::string_view) {};
};

/// One cell as it is measured: a check of every answer, then rounds. A round prepares a session anew, so that
/// the luck of an allocation is part of the noise; warms up until replays stop falling; takes samples, each
/// held against the checked answers; and one replay with a clock around every command.
/// Every function may throw DeviceError; what was measured before stays.
class CellSampler {
public:
    /// The cell must outlive this; it goes on with the state.
    explicit CellSampler(const Cell& cell, CellState state = {}) : cell_(cell), state_(std::move(state)) {
        // Of a cell that fails before it has begun those that were asked for are said.
        if (state_.measurement.settings.empty()) state_.measurement.settings = cell.settings;
    }
    virtual ~CellSampler() = default;

    /// The first session: every answer against the reference and the truth.
    void check(const CheckOptions& options) { do_check(options); }
    /// A round of so many samples, which may be 0.
    void round(std::size_t samples) { do_round(samples); }
    /// With a session of its own, which has the kernels that count.
    void count_work() {
        if (!state_.counted) do_count_work();
        state_.counted = true;
    }
    /// Frees the session, which the next round prepares anew.
    void release() { do_release(); }

    /// The next round is this one, of another run of the program than those before it.
    void go_on_from(std::uint32_t round) {
        state_.rounds = round;
        if (state_.is_checked()) state_.measurement.continued.push_back(round);
    }

    const Cell& cell() const { return cell_; }
    const CellState& state() const { return state_; }
    const Measurement& measurement() const { return state_.measurement; }
    /// How many samples of it take a quarter of the time that a preparation does; 1 to 32.
    std::size_t samples_a_round() const;
    /// Of seconds, so that every sample had better not have its own.
    bool preparation_is_long() const { return state_.prepare_ns > 2'000'000'000; }

    CellSampler(const CellSampler&) = delete;
    CellSampler& operator=(const CellSampler&) = delete;

protected:
    const Cell& cell_;
    CellState state_;

private:
    virtual void do_check(const CheckOptions& options) = 0;
    virtual void do_round(std::size_t samples) = 0;
    virtual void do_count_work() = 0;
    virtual void do_release() = 0;
};

} // namespace tandem
