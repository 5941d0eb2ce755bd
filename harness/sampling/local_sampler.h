// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/cell_sampler.h"
#include "harness/sampling/replays.h"

namespace tandem {

/// Measures a cell in this process.
class LocalSampler : public CellSampler {
public:
    /// All arguments except `state` must outlive this object.
    LocalSampler(const Cell& cell, const Scene& scene, const FrameRange& range, References& references,
                 CellState state = {});

private:
    void do_check(const CheckOptions& options) override;
    void do_round(std::size_t samples) override;
    void do_count_work() override;
    void do_release() override { replays_.reset(); }

    void begin_session();
    void compile();
    void warm_up();
    void sample();
    void compare(std::size_t index, const FrameResult& result, const Digest& digest, const Digest& contacts);
    ReferenceDigests expected_digests(std::size_t index);
    void add_dropped(std::size_t index);
    void find_deep_contact(std::size_t index, const FrameResult& result, const Digest& digest);
    void check_answer(std::size_t index, const FrameResult& result, const CheckOptions& options);
    void add_errors(Truths& truths, std::size_t index, const FrameResult& result, const Digest& digest,
                    const Digest& contacts, const Report& report);
    bool has_truth(const Truths& truths) const;
    void add_counts(const FrameResult& result);
    void take_kernels();

    const Scene& scene_;
    const FrameRange& range_;
    References& references_;
    std::string name_;
    Measurement& out_; ///< the measurement in `state_`
    std::optional<Replays> replays_;
    ConditionReader conditions_;
    Geometry geometry_;
    bool is_compiled_ = false; ///< whether a replay of this process has compiled the kernels
};

} // namespace tandem
