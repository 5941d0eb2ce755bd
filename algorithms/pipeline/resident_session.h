// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/pack_stage.h"
#include "algorithms/bodies/pose_stage.h"
#include "algorithms/pipeline/pipeline.h"
#include "algorithms/bodies/subdomain.h"

#include <array>

namespace tandem {

/// A session on one device with resident data: a frame is a fixed sequence of commands with one wait. If a
/// buffer overflows, its counter continues, the buffer grows and the walk runs again. A frame that does not
/// fit into memory runs in batches.
class ResidentSession final : public Session {
public:
    /// `fitted`: Traversal::fitted. `answers`: the answer pool of an earlier session on this device with
    /// these settings, to reuse its buffers; or null.
    ResidentSession(const Traversal& traversal, Device& device, const Scene& scene, Settings fitted,
                    std::shared_ptr<AnswerPool> answers = nullptr)
        : scene_(scene),
          pipeline_(traversal, device, scene, std::move(fitted), std::move(answers)),
          poses_(PoseStage::make(*pipeline_.bodies, pipeline_.shape)),
          devices_{&device} {}
    const std::shared_ptr<AnswerPool>& answers() const { return pipeline_.answers; }
    /// Sets the expected size of the next answer, so that its buffers are large enough for a single run.
    void expect(std::uint64_t pairs, double contacts_a_pair) {
        pipeline_.answers->expect(pairs, contacts_a_pair);
    }

    /// The next frame also places and bounds fixed bodies.
    void forget_places() { stale_ = true; }

    // For vertices that do not come from the host's memory (DeviceVertexExchange):

    /// From the next frame on, other code writes the vertices of these deformable bodies on the device,
    /// between upload_vertices() and run(). A frame in batches needs them in the host's memory: run() throws
    /// OutOfMemory.
    void set_received(std::span<const std::uint32_t> bodies);
    /// Uploads the vertices of the remaining deformable bodies for the next run(), and waits.
    void upload_vertices(const Frame& frame);

    /// From the next frame on, reads the bodies of this subdomain only and finds its pairs. Body pairs passed
    /// to run() must have bodies of the subdomain.
    void set_subdomain(const Subdomain& subdomain);

private:
    /// The arguments of run(): a frame in the host's memory or in the device's, and body pairs.
    struct Input {
        const FrameInput* host = nullptr;
        const DeviceFrameInput* device = nullptr;
        std::optional<std::span<const BodyPair>> body_pairs{};

        /// A bit for each combination of memory and origin of the body pairs.
        unsigned kind() const { return 1u << (2 * (device != nullptr ? 1 : 0) + (body_pairs ? 1 : 0)); }
    };

    void do_reset() override;
    void do_move_origin() override { forget_places(); }
    FrameResult do_run(const FrameInput& input,
                       std::optional<std::span<const BodyPair>> body_pairs) override {
        return run_input({.host = &input, .body_pairs = body_pairs});
    }
    FrameResult do_run_device_input(const DeviceFrameInput& input,
                                    std::optional<std::span<const BodyPair>> body_pairs) override;
    QueuedFrame do_enqueue(const FrameInput* host, const DeviceFrameInput* device,
                           std::optional<std::span<const BodyPair>> body_pairs) override;
    std::optional<FrameResult> do_collect() override;
    void do_count_work(bool on) override {
        pipeline_.count(on);
        queued_.reset();
    }
    std::span<Device* const> do_devices() const override { return devices_; }
    const Settings& do_settings() const override { return pipeline_.settings; }
    const Bodies* do_bodies() const override { return pipeline_.bodies.get(); }

    void refresh(const Input& input);
    void find_body_pairs(const Input& input);
    bool waits_within_frame(const Input& input) const;
    void reject_flaws(const Input& input);
    void launch(const AnswerBuffers& answer);
    void walk(const AnswerBuffers& answer);
    template<class End>
    void submit(const Input& input, const AnswerBuffers& answer, const End& end);
    void begin(const Input& input, const AnswerBuffers& answer);
    std::vector<Limit> limits() const;
    void prepare_queued(const Input& input);
    std::shared_ptr<const void> hold_and_submit(const Input& input);
    bool grow(AnswerBuffers& answer);
    FrameResult run_whole(const Input& input);
    FrameResult run_parts(const Input& input);
    FrameResult run_input(const Input& input);

    const Scene& scene_;
    Pipeline pipeline_;
    std::unique_ptr<PoseStage> poses_; ///< null: the host packs poses
    std::array<Device*, 1> devices_;
    std::unique_ptr<PackStage> pack_; ///< created by the first frame in the device's memory
    std::uint64_t batches_ = 1;       ///< initial number for the next frame
    bool stale_ = true;               ///< poses and bounds on the device may be out of date
    bool is_uploaded_ = false;        ///< upload_vertices() has uploaded the next frame's vertices
    bool has_received_ = false;       ///< set_received() has bodies

    /// What frames of enqueue() share.
    struct QueuedFrames {
        explicit QueuedFrames(std::shared_ptr<const AnswerBuffers> buffers) : answer(std::move(buffers)) {}
        std::shared_ptr<const AnswerBuffers> answer;
        std::unique_ptr<QueuedStage> end;
        unsigned kinds = 0;                 ///< prepared ones: bits of Input::kind()
        std::shared_ptr<const void> memory; ///< of the last frame that was prepared; null: not known yet
    };
    std::optional<QueuedFrames> queued_; ///< none before the first, and after a frame that has grown buffers
};

} // namespace tandem
