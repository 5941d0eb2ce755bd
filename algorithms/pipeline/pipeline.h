// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/contact_reductions.h"
#include "algorithms/answer/order_stage.h"
#include "algorithms/answer/status.h"
#include "algorithms/broad_phase/body_pairs.h"
#include "algorithms/narrow_phase/contact_stage.h"
#include "algorithms/pipeline/stages.h"
#include "algorithms/traversal.h"

namespace tandem {

/// The settings of an algorithm whose sessions are pipelines: the common ones, then its own. `published`:
/// whether its walks support the paper's data path.
std::vector<const Parameter*> pipeline_parameters(std::span<const Parameter* const> own, bool published);

/// Throws InputError if work-groups of these settings need more local memory than the device has. `what`: the
/// setting that needs it, such as "schedule=group". `remedy`: what the user can do.
void check_local_memory(const Settings& settings, const DeviceInfo& info, std::uint64_t needed,
                        std::string_view what, std::string_view remedy);

/// The stages of a frame on one device: bodies, hierarchy, body pairs, walk, contacts, answer. Sessions run
/// them; see README.md of this folder.
struct Pipeline {
    /// Uploads constant data and compiles. `fitted`: Traversal::fitted. Throws OutOfMemory; the message has
    /// the required bytes if the memory limit is below them. `used`: the answer pool of an earlier pipeline
    /// on this device with these settings, or null.
    Pipeline(const Traversal& traversal, Device& on, const Scene& scene, Settings fitted,
             std::shared_ptr<AnswerPool> used = nullptr);

    /// Switches counting in walks on or off.
    void count(bool on);
    /// Compiles the walk. `windowed`: for a part of the items only.
    void compile(bool windowed);
    /// The task to walk the current body pairs.
    WalkTask task(const AnswerBuffers& answer, LaunchHook* launch_hook = nullptr);
    bool makes_contacts() const { return contacts != nullptr && !counting; }
    /// A result with the counts of a status, without parts.
    FrameResult counts(const Status::Words& words) const;
    /// Adds the part for pairs and contacts in `buffers` to the result.
    void add_part(FrameResult& result, std::shared_ptr<const AnswerBuffers> buffers) const;

    Device& device;
    Settings settings;
    LaunchShape shape;
    Output output;
    bool counting = false;
    std::optional<WalkBuild> built; ///< the current build of the walk
    std::shared_ptr<Bodies> bodies;
    AlgorithmStages stages;
    std::unique_ptr<BodyPairs> body_pairs;
    Status status;
    std::unique_ptr<ContactStage> contacts;      ///< null if no contacts are made
    std::unique_ptr<ContactReduction> reduction; ///< null for outputs that keep all contacts
    std::unique_ptr<OrderStage> order;           ///< null unless order=canonical
    std::shared_ptr<const AnswerTools> tools;
    std::shared_ptr<AnswerPool> answers;
};

} // namespace tandem
