// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/status.h"
#include "algorithms/broad_phase/body_pairs.h"
#include "algorithms/narrow_phase/contact_stage.h"
#include "algorithms/stages.h"

namespace tandem {

/// The settings of an algorithm whose sessions are pipelines: the common ones, then its own. `published`:
/// whether its walks know the paper's data path as well.
std::vector<const Parameter*> pipeline_parameters(std::span<const Parameter* const> own, bool published);

/// Whether these settings ask for the paper's data path.
bool is_published(const Settings& settings);

/// Throws InputError when the work-groups that `settings` ask for need more local memory than the device has.
/// `what`: whose they are, "schedule=group"; `remedy`: what to do.
void check_local_memory(const Settings& settings, const DeviceInfo& info, std::uint64_t needed,
                        std::string_view what, std::string_view remedy);

/// A frame on one device as a row of steps, each with one job: bodies, hierarchy, body pairs, walk, contacts,
/// answer. Sessions run them; README.md here has the picture.
struct Pipeline {
    /// Uploads what is static and compiles. `fitted`: Traversal::fitted. Throws OutOfMemory that says what
    /// bodies and hierarchy take when a memory limit is below that.
    /// `used`: a pool of a pipeline before it on this device with these settings, or null.
    Pipeline(const Traversal& traversal, Device& on, const Scene& scene, Settings fitted,
             std::shared_ptr<AnswerPool> used = nullptr);

    /// The hierarchy's walks count from now on, or do not.
    void count(bool on);
    /// The kernels of a walk of part of the items, or of all.
    void compile(bool windowed);
    /// What the walk of the body pairs at hand works on.
    WalkTask task(const AnswerBuffers& answer, LaunchHook* launch_hook = nullptr);
    bool makes_contacts() const { return contacts != nullptr && !counting; }
    /// What the status counts; pairs and contacts are the caller's to add.
    FrameResult counts() const;
    /// An answer's part for pairs and contacts that lie in `buffers`.
    void add_part(FrameResult& result, std::shared_ptr<AnswerBuffers> buffers) const;

    Device& device;
    Settings settings;
    LaunchShape shape;
    Output output;
    bool counting = false;
    std::optional<WalkBuild> built; ///< what the walk is compiled for
    std::shared_ptr<Bodies> bodies;
    AlgorithmStages stages;
    std::unique_ptr<BodyPairs> body_pairs;
    Status status;
    std::unique_ptr<ContactStage> contacts; ///< none when there are to be none
    std::shared_ptr<const AnswerTools> tools;
    std::shared_ptr<AnswerPool> answers;
};

} // namespace tandem
