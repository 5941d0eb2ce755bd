// SPDX-License-Identifier: MIT
#include "base/counted.h"
#include "harness/profile/ceilings.h"
#include "harness/commands/listings.h"
#include "harness/sampling/conditions.h"
#include "harness/program/cache_folder.h"
#include "harness/plans/inputs.h"
#include "harness/record/journal.h"
#include "base/standard_streams.h"
#include "scenes/dynamics_settings.h"
#include "scenes/hard/hard.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

/// The id of an earlier device in the list that is the same piece of hardware; empty when there is none.
std::string same_as(const std::vector<BackendReport>& backends, const DeviceInfo& info) {
    for (const auto& backend : backends) {
        for (const auto& device : backend.devices) {
            if (device->info().id == info.id) return {};
            if (!info.hardware.empty() && device->info().hardware == info.hardware) return device->info().id;
        }
    }
    return {};
}

/// The name of the clock that times commands. It is known only after clocks have been on.
std::string clock_of(Device& device) {
    try {
        device.set_clocks(Clocks::on);
        device.set_clocks(Clocks::off);
    } catch (const DeviceError&) {
        // The device is listed nevertheless; a measurement reports the error.
    }
    return device.clock();
}

/// What the listing says of a device beside its own properties.
struct DeviceFacts {
    bool is_default = false;
    std::string clock, same_as;
    GpuCondition now;
};

Json device_json(const DeviceInfo& info, const DeviceFacts& facts) {
    return {{"id", info.id},
            {"default", facts.is_default},
            {"name", info.name},
            {"driver", info.driver},
            {"compiler", info.compiler},
            {"kind", info.is_gpu ? "gpu" : "cpu"},
            {"compute_units", info.compute_units},
            {"memory_bytes", info.global_bytes},
            {"local_bytes", info.local_bytes},
            {"double", info.has_double},
            {"clock", facts.clock},
            {"hardware", info.hardware.empty() ? Json(nullptr) : Json(info.hardware)},
            {"same_as", facts.same_as.empty() ? Json(nullptr) : Json(facts.same_as)},
            {"now", gpu_condition_json(facts.now)}};
}

void print_device(const DeviceInfo& info, const DeviceFacts& facts) {
    put("{:<10} {} ({}), {} compute units, {:.1f} GB, {}; times by {}{}{}\n", info.id, info.name, info.driver,
        info.compute_units, static_cast<double>(info.global_bytes) * 1e-9, info.compiler, facts.clock,
        facts.same_as.empty() ? "" : fmt::format("; the same GPU as {}", facts.same_as),
        facts.is_default ? "; the default device" : "");
    if (const auto text = gpu_condition_text(facts.now); !text.empty()) put("           now: {}\n", text);
}

/// The registered drivers of a backend, as [{file, library, platforms: [{name, devices}], problem}].
Json drivers_json(const std::vector<DriverReport>& drivers) {
    const auto or_null = [](const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); };
    Json all = Json::array();
    for (const auto& driver : drivers) {
        Json platforms = Json::array();
        for (const auto& platform : driver.platforms)
            platforms.push_back({{"name", platform.name}, {"devices", platform.devices}});
        all.push_back({{"file", or_null(driver.file)},
                       {"library", or_null(driver.library)},
                       {"platforms", platforms},
                       {"problem", or_null(driver.problem)}});
    }
    return all;
}

/// One line for each driver that works; the backend's reason names the others.
void print_drivers(const std::vector<DriverReport>& drivers) {
    for (const auto& driver : drivers) {
        if (!driver.problem.empty()) continue;
        std::vector<std::string> platforms;
        for (const auto& platform : driver.platforms)
            platforms.push_back(
                fmt::format("platform '{}' with {}", platform.name, counted(platform.devices, "device")));
        put("{:<10} {} ({}): {}\n", "driver", driver.file.empty() ? "no file" : driver.file, driver.library,
            fmt::join(platforms, ", "));
    }
}

/// `tandem devices --measure`: the ceilings of the chosen devices.
int measure_devices(const DevicesOptions& options) {
    const auto names = options.devices.empty() ? std::vector<std::string>{"all"} : options.devices;
    const auto backends = open_named(names, options.require);
    const auto chosen = choose_devices(backends, names);
    RecordFile file(options.out);
    Json records = Json::array();
    for (const auto& group : chosen)
        for (auto* device : group) {
            const auto ceilings = measure_ceilings(*device);
            records.push_back(ceilings_record(*device, ceilings));
            if (!file.failed()) file.append_or_report(records.back());
            if (!options.json) put_text(ceilings_table(device->info(), ceilings));
        }
    if (options.json) put_text(records.dump(2) + "\n");
    return file.failed() ? 3 : 0;
}

void print_scene(const SceneKind& kind, const Scene& scene) {
    put("{}: {}\n", kind.name, kind.models);
    put("  {}\n", scene.dynamics
                      ? fmt::format("simulated: {} of {} s; its only frame is the start",
                                    counted(scene.dynamics->steps, "step"), scene.dynamics->stepping.step)
                      : fmt::format("scripted: {}", counted(scene.frame_count, "frame")));
    for (const auto& p : kind.parameters) put("    {:<12} {:<12} {}\n", p.name, p.value, p.help);
}

/// The first columns of the paper's Table 1, for the default parameters.
void print_scene_table(const Json& scenes) {
    put("\n{:<10} {:>7} {:>10} {:>11}\n", "scene", "bodies", "vertices", "tetrahedra");
    for (const auto& row : scenes)
        put("{:<10} {:>7} {:>10} {:>11}\n", row["name"].get<std::string>(), row["bodies"].get<std::size_t>(),
            row["vertices"].get<std::size_t>(), row["tetrahedra"].get<std::size_t>());
}

/// The dynamics settings with the values of this scene; null when its motion is scripted.
Json dynamics_json(const Scene& scene) {
    if (!scene.dynamics) return nullptr;
    Json json = Json::object();
    for (const auto& setting : dynamics_settings())
        json[std::string(setting.name)] = {{"default", setting.value(*scene.dynamics)},
                                           {"help", setting.help}};
    return json;
}

Json scene_json(const SceneKind& kind, const Scene& scene) {
    Json parameters = Json::object();
    for (const auto& p : kind.parameters) parameters[p.name] = {{"default", p.value}, {"help", p.help}};
    return {{"name", kind.name},
            {"models", kind.models},
            {"parameters", parameters},
            {"bodies", scene.bodies.size()},
            {"vertices", vertex_count(scene)},
            {"tetrahedra", tetrahedron_count(scene)},
            {"frames", scene.frame_count},
            {"steps", scene.dynamics ? Json(scene.dynamics->steps) : Json(nullptr)},
            {"dynamics", dynamics_json(scene)}};
}

/// The additional fields of a family of hard cases.
Json hard_json(const HardFamily& family) {
    return {{"row", family.row},
            {"group", std::string(1, family.group)},
            {"summary", family.summary},
            {"difficulty", family.knob.meaning},
            {"range", {family.knob.least, family.knob.most}},
            {"truth", name_of(family.truth)},
            {"metric", family.metric},
            {"fails", family.fails},
            {"self", family.self},
            {"motion", family.motion}};
}

void print_hard() {
    put("\nhard cases, hard:NAME:difficulty=X,seed=N,pairs=N,together=N; 'tandem check hard:all' "
        "checks all\n");
    for (const auto& family : hard_families())
        put("    {} {:<20} {}\n      {:<20} difficulty {}: {}, {}..{}\n", family.group, family.name,
            family.summary, "", family.knob.initial, family.knob.meaning, family.knob.least,
            family.knob.most);
}

void print_dynamics() {
    put("\nsettings of simulated motion, --dynamics NAME=VALUE; a scene may have other defaults (--json)\n");
    for (const auto& setting : dynamics_settings())
        put("    {:<20} {:<13} {}\n", setting.name, setting.value(Dynamics{}), setting.help);
    for (const auto& preset : dynamics_presets())
        put("    {:<20} {:<13} {}: {}\n", preset.name, "(preset)", preset.help,
            fmt::join(preset.assignments, ", "));
}

} // namespace

/// Backends without devices are listed with the reason. --require is checked last, so that the list is
/// printed before the error.
int devices_command(const DevicesOptions& options) {
    if (options.measure) return measure_devices(options);
    if (const auto cache = find_cache_folder(); !cache.problem.empty() && !cache.is_refused)
        print_message("tandem: {}\n", cache.problem);
    const auto backends = discover();
    const bool json = options.json;
    Json all = Json::array();
    for (const auto& backend : backends) {
        Json entry{{"backend", backend.name},
                   {"reason", backend.reason.empty() ? Json(nullptr) : Json(backend.reason)}};
        entry["devices"] = Json::array();
        for (const auto& device : backend.devices) {
            const auto& info = device->info();
            const DeviceFacts facts{device.get() == default_of(backends), clock_of(*device),
                                    same_as(backends, info), GpuGauge(info).read()};
            entry["devices"].push_back(device_json(info, facts));
            if (!json) print_device(info, facts);
        }
        entry["drivers"] = drivers_json(backend.drivers);
        if (!json) print_drivers(backend.drivers);
        if (!json && !backend.reason.empty()) put_text(backend.reason + "\n");
        all.push_back(entry);
    }
    if (json) put_text(all.dump(2) + "\n");
    check_required(backends, options.require);
    return 0;
}

int scenes_command(bool json) {
    Json all = Json::array();
    for (const auto& kind : scene_kinds()) {
        const auto scene = make_scene(kind.name);
        all.push_back(scene_json(kind, scene));
        if (!json) print_scene(kind, scene);
    }
    if (json) {
        for (const auto& kind : hard_kinds()) {
            all.push_back(scene_json(kind, make_scene(kind.name)));
            all.back()["hard"] = hard_json(hard_family(kind.name.substr(5)));
        }
        put_text(all.dump(2) + "\n");
        return 0;
    }
    print_scene_table(all);
    print_hard();
    print_dynamics();
    return 0;
}

} // namespace tandem
