// SPDX-License-Identifier: MIT
#include "harness/ranks/hand_message.h"

#include "backends/described_device.h"
#include "harness/fields_json.h"
#include "harness/isolation/described.h"
#include "harness/isolation/request.h"

namespace tandem {

using nlohmann::json;

namespace {

/// How cells are measured, beside what options_json() has.
json measure_json(const RunOptions& options, std::uint64_t seed) {
    return {{"repeat", options.repeat},
            {"noise", options.noise},
            {"seconds", options.seconds},
            {"seed", seed},
            {"isolate", options.isolate},
            {"timeout", options.timeout},
            {"check", options.check},
            {"count", options.count},
            {"choose_seconds", options.choose_seconds},
            {"choose_afresh", options.choose_afresh}};
}

void take_measure(RunOptions& options, const json& from) {
    from.at("repeat").get_to(options.repeat);
    from.at("noise").get_to(options.noise);
    from.at("seconds").get_to(options.seconds);
    options.seed = from.at("seed").get<std::uint64_t>();
    from.at("isolate").get_to(options.isolate);
    from.at("timeout").get_to(options.timeout);
    from.at("check").get_to(options.check);
    from.at("count").get_to(options.count);
    from.at("choose_seconds").get_to(options.choose_seconds);
    from.at("choose_afresh").get_to(options.choose_afresh);
}

json state_json(const CellState& state) {
    if (!state.is_checked()) return nullptr;
    return {{"checked", checked_json(state)}, {"rounds", rounds_json(state, 0)}};
}

CellState state_of(const json& from, const Cell& cell) {
    CellState state;
    if (from.is_null()) return state;
    take_checked(state, from.at("checked"), cell);
    take_rounds(state, from.at("rounds"));
    return state;
}

} // namespace

json hand_json(const RunOptions& options, std::uint64_t seed, std::uint64_t digest,
               const DeviceGroup& devices, std::span<const DealtCell> cells) {
    json message{
        {"do", "hand"},     {"options", options_json(options)}, {"measure", measure_json(options, seed)},
        {"digest", digest}, {"devices", json::array()},         {"cells", json::array()}};
    for (const auto* device : devices) message["devices"].push_back(device_json(device->info()));
    for (const auto& dealt : cells)
        message["cells"].push_back({{"cell", cell_json(dealt.cell)}, {"state", state_json(dealt.state)}});
    return message;
}

DealtHand::DealtHand(const json& message) {
    take_options(options, message.at("options"));
    take_measure(options, message.at("measure"));
    message.at("digest").get_to(digest);
    DeviceGroup group;
    for (const auto& device : message.at("devices"))
        group.push_back(devices.emplace_back(described_device(device_of(device))).get());
    for (const auto& dealt : message.at("cells")) {
        auto cell = cell_of(dealt.at("cell"), group);
        auto state = state_of(dealt.at("state"), cell);
        cells.push_back({std::move(cell), std::move(state)});
    }
}

json ended_json(const CellResult& result, const nlohmann::ordered_json& record, const std::string& failure) {
    CellState state;
    state.measurement = result.measurement;
    const bool measured = failure.empty();
    return {{"is", "ended"},
            // As text, which keeps the order of its fields.
            {"record", record.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)},
            {"checked", measured ? checked_json(state) : json()},
            {"rounds", measured ? rounds_json(state, 0) : json()},
            {"failure", failure},
            {"converged", result.converged}};
}

CellResult ended_result(const json& message, const Cell& cell) {
    CellResult result;
    result.cell = &cell;
    result.measured = message.at("failure").get<std::string>().empty();
    CellState state;
    if (result.measured) {
        take_checked(state, message.at("checked"), cell);
        take_rounds(state, message.at("rounds"));
    }
    result.measurement = std::move(state.measurement);
    result.converged = message.at("converged").get<bool>();
    result.code = !result.measured ? 3 : result.measurement.agreement.ok() ? 0 : 1;
    return result;
}

} // namespace tandem
