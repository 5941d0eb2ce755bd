// SPDX-License-Identifier: MIT
#include "harness/ranks/companions.h"

#include "algorithms/parameters/table.h"
#include "algorithms/ranks/bytes.h"
#include "harness/ranks/remote_part.h"
#include "harness/run_parts.h"
#include "scenes/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <thread>
#include <unistd.h>

namespace tandem {

namespace {

using nlohmann::json;

Companions* current = nullptr;

/// The first rank's session, which has the others run theirs.
class SharedSession final : public Session {
public:
    SharedSession(Ranks& ranks, std::unique_ptr<Session> own) : ranks_(ranks), own_(std::move(own)) {}
    ~SharedSession() override { give_order(ranks_, {Order::release}); }

private:
    void do_reset() override {
        give_order(ranks_, {Order::reset});
        own_->reset();
    }
    FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) override {
        if (body_pairs) throw InputError("run() was given body pairs, which ranks of a job find themselves");
        const auto number = answers_++;
        give_order(ranks_, {Order::run, number});
        auto result = own_->run(frame);
        add_remote_parts(result, ranks_, number);
        return result;
    }
    void do_count_work(bool on) override {
        give_order(ranks_, {Order::count, on ? 1u : 0u});
        own_->count_work(on);
    }
    std::span<Device* const> do_devices() const override { return own_->devices(); }
    const Settings& do_settings() const override { return own_->settings(); }

    Ranks& ranks_;
    std::unique_ptr<Session> own_;
    std::uint64_t answers_ = 0;
};

/// A processor that ranks share is not everyone's whole, unless the launcher has bound each to a part.
std::int64_t threads_of_a_rank(const PlaceOnMachine& place) {
    const auto usable = static_cast<std::int64_t>(std::thread::hardware_concurrency());
    const bool is_bound = usable < sysconf(_SC_NPROCESSORS_ONLN);
    return std::max<std::int64_t>(1, is_bound ? usable : usable / static_cast<std::int64_t>(place.count));
}

void refuse_what_ranks_cannot(const RunOptions& options) {
    if (options.isolate)
        throw InputError("--isolate makes a process of each cell, and ranks share one; leave it out");
    if (!options.trace.empty()) throw InputError("--trace shows one process; run it without the launcher");
    for (const auto& product : plan_of(options).products)
        for (const auto& name : product.request.algorithms)
            if (name == automatic)
                throw InputError("--algorithm auto chooses on one process; name what it chose there");
}

} // namespace

Companions* companions() { return current; }

Companions::Companions(Ranks& ranks, const RunOptions& options) : ranks_(ranks) {
    refuse_what_ranks_cannot(options);
    const auto call = json{{"do", "share"}}.dump();
    for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, std::as_bytes(std::span(call)));
    current = this;
}

Companions::~Companions() {
    current = nullptr;
    try {
        give_order(ranks_, {Order::leave});
    } catch (const RanksError&) {
        ranks_.abort(3); // they would wait for ever
    }
}

RunOptions Companions::own_options(const RunOptions& options) {
    const auto devices = devices_of(plan_of(options));
    if (devices.size() > 1)
        throw InputError(fmt::format(
            "{} are devices of several cells, and all ranks share each cell; name one by --device, "
            "or one for each rank of a machine joined by +",
            fmt::join(devices, ", ")));
    auto own = options;
    names_ = devices.front();
    if (names_ == "all")
        throw InputError("--device all makes several cells; ranks share one, name their devices");
    own.request.devices = {
        names_.substr(0, names_.find('+'))}; // no rank of the machine comes before this one
    return own;
}

void Companions::open(const RunOptions& options, const Device& own) {
    const json asked{{"scene", options.scene},   {"meshes", options.meshes},
                     {"poses", options.poses},   {"frames", options.frames},
                     {"memory", options.memory}, {"degenerate", static_cast<int>(options.degenerate)},
                     {"devices", names_}};
    devices_.clear();
    give_order(ranks_, {Order::open, 0, asked.dump()});
    place_ = place_on_machine(ranks_);
    std::string wrong;
    try {
        device_of_rank(names_, place_);
    } catch (const InputError& error) {
        wrong = error.what();
    }
    if (const auto text = first_complaint(ranks_, wrong); !text.empty()) throw InputError(text);
    if (const auto text = shared_gpu(ranks_, own.info()); !text.empty()) throw InputError(text);
    devices_ = devices_of_ranks(ranks_, own.info());
}

std::unique_ptr<Session> Companions::prepare(const Cell& cell, const Scene& scene) {
    auto settings = cell.settings;
    if (settings[parameters::threads] == 0 && cell.devices.front()->info().id == "host")
        settings.set(parameters::threads(threads_of_a_rank(place_)));
    const json asked{{"algorithm", cell.algorithm->name()},
                     {"preset", cell.preset},
                     {"settings", settings.texts()},
                     {"scene", scene.digest}};
    give_order(ranks_, {Order::prepare, 0, asked.dump()});
    std::string own;
    try {
        cell.algorithm->check(cell.devices, settings);
    } catch (const InputError& error) {
        own = error.what();
    }
    if (const auto text = first_complaint(ranks_, own); !text.empty()) throw InputError(text);
    return std::make_unique<SharedSession>(
        ranks_, cell.algorithm->prepare(*cell.devices.front(), scene, settings, ranks_));
}

void Companions::next(std::size_t index) {
    give_order(ranks_, {Order::next, index});
    if (const auto text = first_complaint(ranks_, ""); !text.empty()) throw DeviceError(text);
}

void Companions::set_clocks(Clocks clocks) {
    give_order(ranks_, {Order::clocks, clocks == Clocks::on ? 1u : 0u});
}

std::vector<StageSamples> Companions::stages() {
    give_order(ranks_, {Order::stages});
    std::vector<StageSamples> all;
    for (const auto& bytes : ranks_.gather_to_all({}))
        all.push_back(bytes.empty() ? StageSamples{} : MessageReader(bytes).read<StageSamples>());
    return all;
}

std::unique_ptr<Session> prepare_session(const Cell& cell, const Scene& scene) {
    return current != nullptr ? current->prepare(cell, scene)
                              : cell.algorithm->prepare(cell.devices, scene, cell.settings);
}

void announce_frame(std::size_t index) {
    if (current != nullptr) current->next(index);
}

std::vector<DeviceInfo> infos_of(const DeviceGroup& devices) {
    if (current != nullptr && !current->devices().empty()) return current->devices();
    std::vector<DeviceInfo> infos;
    for (const auto* device : devices) infos.push_back(device->info());
    return infos;
}

} // namespace tandem
