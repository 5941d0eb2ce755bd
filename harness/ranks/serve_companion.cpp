// SPDX-License-Identifier: MIT
// The side of the ranks that are told what to do.
#include "algorithms/ranks/bytes.h"
#include "harness/inputs.h"
#include "harness/ranks/companions.h"
#include "harness/ranks/remote_part.h"
#include "harness/sampling/measurement.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <array>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

namespace tandem {

namespace {

using nlohmann::json;

/// A scene as this rank has opened it; it stays in its place, since its frames are made of it.
struct Opened {
    Opened(const RunOptions& options, std::vector<BackendReport> found, const std::string& device)
        : backends(std::move(found)),
          devices(open_devices(options, backends, std::array{device}).front()),
          scene(open_scene(options)),
          range(open_frames(options, scene)) {}

    std::vector<BackendReport> backends;
    DeviceGroup devices;
    Scene scene;
    FrameRange range;
};

class Companion {
public:
    explicit Companion(Ranks& ranks) : ranks_(ranks) {}

    /// False: it was told to leave.
    bool follow(const Told& told);

private:
    std::string open(const json& asked);
    void prepare(const json& asked);
    void run(std::uint64_t number);
    void tell_stages();
    void tell_of(std::uint64_t number, Order order);
    Device& device() const { return *opened_->devices.front(); }

    Ranks& ranks_;
    std::optional<Opened> opened_;
    std::unique_ptr<Session> session_;
    std::shared_ptr<const Frame> frame_;
    std::map<std::uint64_t, FrameResult> answers_;
};

/// What is wrong; empty when nothing is.
template<class Work>
std::string complaint(const Work& work) {
    try {
        work();
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

std::string Companion::open(const json& asked) {
    session_.reset();
    answers_.clear();
    opened_.reset();
    const auto place = place_on_machine(ranks_); // by all together, whatever comes after
    return complaint([&] {
        const auto device = device_of_rank(asked.at("devices").get<std::string>(), place);
        RunOptions options;
        asked.at("scene").get_to(options.scene);
        asked.at("meshes").get_to(options.meshes);
        asked.at("poses").get_to(options.poses);
        asked.at("frames").get_to(options.frames);
        asked.at("memory").get_to(options.memory);
        options.degenerate = static_cast<Degenerate>(asked.at("degenerate").get<int>());
        opened_.emplace(options, open_backends(std::array{device}, {}), device);
    });
}

void Companion::prepare(const json& asked) {
    session_.reset();
    const auto& traversal = algorithm(asked.at("algorithm").get<std::string>());
    const auto& values = preset(traversal, asked.at("preset").get<std::string>()).values;
    const auto settings =
        resolve(traversal.parameters(), values, asked.at("settings").get<SettingTexts>(), traversal.name());
    const auto own = complaint([&] {
        if (opened_->scene.digest != asked.at("scene").get<std::uint64_t>())
            throw InputError(
                fmt::format("scene {} is another one here than on rank 0; give all ranks the same files",
                            opened_->scene.name));
        device().set_clocks(Clocks::off);
        traversal.check(opened_->devices, settings);
    });
    if (!first_complaint(ranks_, own).empty()) return;
    try {
        session_ = traversal.prepare(device(), opened_->scene, settings, ranks_);
        device().finish();
    } catch (const DeviceError&) { // what fails on one rank fails on all: the first one says so
    } catch (const InputError&) {}
}

/// What fails on one rank fails on all, so that nothing need be said of it here.
void Companion::run(std::uint64_t number) {
    try {
        auto result = session_->run(*frame_);
        ranks_.gather_to_all(totals_of(result));
        answers_.emplace(number, std::move(result));
    } catch (const DeviceError&) {
        return;
    }
}

void Companion::tell_stages() {
    const auto stages = by_stage(device().finish());
    ranks_.gather_to_all(std::as_bytes(std::span(stages)));
}

void Companion::tell_of(std::uint64_t number, Order order) {
    std::vector<Ranks::Bytes> out(static_cast<std::size_t>(ranks_.size()));
    out.front() = said_of(answers_.at(number), order);
    ranks_.exchange(out);
}

bool Companion::follow(const Told& told) {
    switch (told.order) {
    case Order::open:
        if (first_complaint(ranks_, open(json::parse(told.text))).empty()
            && shared_gpu(ranks_, device().info()).empty())
            devices_of_ranks(ranks_, device().info());
        return true;
    case Order::prepare:
        prepare(json::parse(told.text));
        return true;
    case Order::next:
        first_complaint(ranks_, complaint([&] {
                            frame_ = opened_->range.frame(told.number);
                            device().finish();
                        }));
        return true;
    case Order::run:
        run(told.number);
        return true;
    case Order::reset:
        session_->reset();
        return true;
    case Order::count:
        session_->count_work(told.number != 0);
        return true;
    case Order::clocks:
        device().set_clocks(told.number != 0 ? Clocks::on : Clocks::off);
        return true;
    case Order::stages:
        tell_stages();
        return true;
    case Order::digests:
    case Order::pairs:
    case Order::contacts:
    case Order::counts:
        tell_of(told.number, told.order);
        return true;
    case Order::forget:
        answers_.erase(told.number);
        return true;
    case Order::release:
        session_.reset();
        return true;
    case Order::leave:
        return false;
    }
    return false;
}

} // namespace

void serve_companion(Ranks& ranks) {
    try {
        Companion companion(ranks);
        while (companion.follow(receive_order(ranks))) {}
        return;
    } catch (const std::exception& error) {
        tell("tandem: rank {}: {}; it ends the job\n", ranks.rank(), error.what());
    }
    ranks.abort(3); // the others would wait for it for ever
}

} // namespace tandem
