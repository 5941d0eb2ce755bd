// SPDX-License-Identifier: MIT
#include "algorithms/pipeline/pipeline.h"

#include "algorithms/parameters/table.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

LaunchShape shape_of(const Settings& settings, const DeviceInfo& info) {
    const auto group_size = static_cast<std::uint32_t>(settings[parameters::group_size]);
    // With groups of one work-item there are enough groups for any number of cores.
    const auto units = info.max_group_size == 1 ? 1 : info.compute_units;
    const auto items = static_cast<std::uint64_t>(settings[parameters::work_items]) * units;
    return {group_size, static_cast<std::uint32_t>(std::max<std::uint64_t>(1, items / group_size))};
}

Status::Writes writes_of(const Settings& settings) {
    return is_published(settings) ? Status::Writes::blocking : Status::Writes::queued;
}

/// Bodies, and the stages that an algorithm builds over them.
struct Foundation {
    std::shared_ptr<Bodies> bodies;
    AlgorithmStages stages;
};

Foundation build(const Traversal& traversal, Device& device, const Scene& scene, const Settings& settings,
                 LaunchShape shape) {
    const auto sharing = is_published(settings) ? Bodies::Sharing::none : Bodies::Sharing::by_mesh;
    Foundation built{std::make_shared<Bodies>(device, scene, geometry_of(settings), sharing,
                                              MeshOrder{settings[parameters::builder], walked_of(settings)},
                                              settings[parameters::pair_layout]),
                     {}};
    built.stages = traversal.build({device, scene, settings, *built.bodies, shape});
    return built;
}

/// Builds the foundation. If the memory limit is too low, builds it again without limit to report the bytes
/// it needs.
Foundation build_within(const Traversal& traversal, Device& device, const Scene& scene,
                        const Settings& settings, LaunchShape shape) {
    try {
        return build(traversal, device, scene, settings, shape);
    } catch (const OutOfMemory&) {
        const auto limit = device.memory_limit();
        if (limit == Device::no_memory_limit) throw;
        device.set_memory_limit(Device::no_memory_limit);
        std::size_t bytes = 0;
        try {
            const auto built = build(traversal, device, scene, settings, shape);
            bytes = built.bodies->bytes() + built.stages.hierarchy->bytes();
        } catch (const OutOfMemory&) {
            device.set_memory_limit(limit);
            throw;
        }
        device.set_memory_limit(limit);
        throw OutOfMemory(fmt::format("{}: bodies and hierarchy of scene {} need {} bytes, but the limit of "
                                      "its memory is {}; raise --memory, or use fewer bodies",
                                      device.info().id, scene.name, bytes, limit));
    }
}

} // namespace

std::vector<const Parameter*> pipeline_parameters(std::span<const Parameter* const> own, bool published) {
    const auto geometry = geometry_parameters();
    std::vector<const Parameter*> all(geometry.begin(), geometry.end());
    all.insert(all.end(), {&parameters::builder, &parameters::contact_rule, &parameters::decision,
                           &parameters::broad, &parameters::self, &parameters::body_pair_capacity});
    if (published)
        all.insert(all.end(), {&parameters::residency, &parameters::convert, &parameters::copies,
                               &parameters::first_body_pair, &parameters::most_body_pairs});
    all.insert(all.end(), {&parameters::submission, &parameters::output, &parameters::order,
                           &parameters::pair_layout, &parameters::group_size, &parameters::work_items,
                           &parameters::threads, &parameters::pair_capacity, &parameters::contact_capacity});
    all.insert(all.end(), own.begin(), own.end());
    return all;
}

void check_local_memory(const Settings& settings, const DeviceInfo& info, std::uint64_t needed,
                        std::string_view what, std::string_view remedy) {
    if (needed > info.local_bytes)
        throw InputError(
            fmt::format("setting group_size={} needs {} bytes of local memory with {} and {} has {}; {}",
                        settings[parameters::group_size], needed, what, info.id, info.local_bytes, remedy));
}

Pipeline::Pipeline(const Traversal& traversal, Device& on, const Scene& scene, Settings fitted,
                   std::shared_ptr<AnswerPool> used)
    : device(on),
      settings(std::move(fitted)),
      shape(shape_of(settings, on.info())),
      output(settings[parameters::output]),
      status(on, writes_of(settings)),
      answers(std::move(used)) {
    auto foundation = build_within(traversal, on, scene, settings, shape);
    bodies = std::move(foundation.bodies);
    stages = std::move(foundation.stages);
    settings.set(parameters::pair_layout(bodies->pair_layout()));
    body_pairs = std::make_unique<BodyPairs>(BuildContext{on, scene, settings, *bodies, shape},
                                             *stages.hierarchy, writes_of(settings));
    const bool contacting = tandem::makes_contacts(settings);
    const auto launches =
        is_published(settings) ? ContactStage::Launches::at_once : ContactStage::Launches::apart;
    if (contacting)
        contacts = std::make_unique<ContactStage>(*bodies, contact_settings_of(settings), shape, launches);
    if (contacting) reduction = contact_reduction(output, *bodies, shape);
    if (settings[parameters::order] == AnswerOrder::canonical)
        order = std::make_unique<OrderStage>(*bodies, shape, contacting);
    tools = std::make_shared<AnswerTools>(bodies, shape, contacting);
    if (!answers || !answers->fits(bodies->pair_layout()))
        answers = std::make_shared<AnswerPool>(on, bodies->pair_layout(), real_bytes(bodies->geometry()),
                                               has_pairs(output) ? settings[parameters::pair_capacity] : 1,
                                               contacting ? settings[parameters::contact_capacity] : 0);
    compile(false);
}

void Pipeline::count(bool on) {
    counting = on;
    compile(false);
}

void Pipeline::compile(bool windowed) {
    const WalkBuild wanted{output, bodies->pair_layout(), counting, windowed,
                           settings[parameters::self] != SelfPairs::off};
    if (built == wanted) return;
    stages.walker->compile(wanted);
    built = wanted;
}

WalkTask Pipeline::task(const AnswerBuffers& answer, LaunchHook* launch_hook) {
    return {body_pairs->rows().buffer(),
            body_pairs->rows().capacity(),
            body_pairs->searched(),
            body_pairs->complete(),
            body_pairs->on_host(),
            answer,
            status,
            launch_hook};
}

FrameResult Pipeline::counts(const Status::Words& words) const {
    FrameResult result;
#define TANDEM_READ(member, word) result.member = Status::counter_in(words, word);
#define TANDEM_KEEP(member)
    TANDEM_FRAME_COUNTS(TANDEM_READ, TANDEM_KEEP)
#undef TANDEM_READ
#undef TANDEM_KEEP
    result.batches = 1;
    if (output == Output::digest)
        result.summed = Digest{result.count, Status::counter_in(words, STATUS_DIGEST_A),
                               Status::counter_in(words, STATUS_DIGEST_B)};
    return result;
}

void Pipeline::add_part(FrameResult& result, std::shared_ptr<const AnswerBuffers> buffers) const {
    if (has_pairs(output))
        result.parts.push_back(device_part(tools, std::move(buffers), result.count, result.contacts));
}

} // namespace tandem
