// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/pack_stage.h"
#include "algorithms/pipeline.h"
#include "algorithms/distributed/subdomain.h"

#include <array>

namespace tandem {

/// A session on one device whose data stay there: a frame is a fixed sequence of commands and one wait. Past
/// capacity counters count on, buffers grow and the walk runs again; a frame that does not fit into memory
/// runs in batches.
class ResidentSession final : public Session {
public:
    /// `fitted`: Traversal::fitted.
    /// `answers`: of a session before it on this device with these settings, whose room for answers it
    /// goes on with; null: none.
    ResidentSession(const Traversal& traversal, Device& device, const Scene& scene, Settings fitted,
                    std::shared_ptr<AnswerPool> answers = nullptr)
        : scene_(scene),
          pipeline_(traversal, device, scene, std::move(fitted), std::move(answers)),
          devices_{&device} {}
    const std::shared_ptr<AnswerPool>& answers() const { return pipeline_.answers; }
    /// What the next frame is going to find, as far as anybody knows: with room for it it need not run twice.
    void expect(std::uint64_t pairs, double contacts_a_pair) {
        pipeline_.answers->expect(pairs, contacts_a_pair);
    }

    // Where vertices come by another way than from the host's memory:

    /// From now on somebody else writes the vertices of these deformable bodies, between upload_vertices()
    /// and run(), which throws OutOfMemory where it needs them in the host's: a frame in batches.
    void receive(std::span<const std::uint32_t> bodies);
    /// Puts the other deformable bodies' vertices of the next frame that is run to the device, and waits.
    void upload_vertices(const Frame& frame);
    const Bodies& bodies() const { return *pipeline_.bodies; }

    /// From now on finds the pairs of a share of each frame, and looks at nothing else of it. Body pairs that
    /// run() is given are of bodies that have a part in the share.
    void take(const Subdomain& share);

private:
    /// A frame in the host's memory or in the device's, and the body pairs that were given with it.
    struct Given {
        const Frame* here = nullptr;
        const DeviceFrame* there = nullptr;
        std::optional<std::span<const BodyPair>> body_pairs{};
    };

    void do_reset() override;
    FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) override {
        return run_given({.here = &frame, .body_pairs = body_pairs});
    }
    FrameResult do_run_device_input(const DeviceFrame& frame,
                                    std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override { pipeline_.count(on); }
    std::span<Device* const> do_devices() const override { return devices_; }
    const Settings& do_settings() const override { return pipeline_.settings; }

    void refresh(const Given& given);
    void find_body_pairs(const Given& given);
    bool waits_within_frame(const Given& given) const;
    void refuse_flaws(const Given& given);
    void launch(const AnswerBuffers& answer);
    void walk(const AnswerBuffers& answer);
    void begin(const Given& given, const AnswerBuffers& answer);
    bool grow(AnswerBuffers& answer);
    FrameResult run_whole(const Given& given);
    FrameResult run_parts(const Given& given);
    FrameResult run_given(const Given& given);

    const Scene& scene_;
    Pipeline pipeline_;
    std::array<Device*, 1> devices_;
    std::unique_ptr<PackStage> pack_; ///< from the first frame in the device's memory on
    std::uint64_t batches_ = 1;       ///< to begin a frame with
    bool stale_ = true;               ///< whether all commands so far have run is not known
    bool is_placed_ = false;          ///< the next frame's vertices are there
    bool receives_ = false;           ///< some come by another way
};

} // namespace tandem
