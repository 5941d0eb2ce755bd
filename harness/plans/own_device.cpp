// SPDX-License-Identifier: MIT
#include "harness/plans/own_device.h"

#include "algorithms/distributed/bytes.h"
#include "harness/plans/device_groups.h"
#include "harness/program/machine.h"
#include "base/error.h"

#include <fmt/format.h>
#include <map>

namespace tandem {

LocalRank local_rank(Ranks& ranks) {
    const auto name = this_machine();
    const auto all = ranks.gather_to_all(std::as_bytes(std::span(name)));
    const auto& own = all[static_cast<std::size_t>(ranks.rank())];
    LocalRank result;
    for (std::size_t rank = 0; rank < all.size(); ++rank) {
        if (all[rank] != own) continue;
        ++result.count;
        result.before += rank < static_cast<std::size_t>(ranks.rank()) ? 1 : 0;
    }
    return result;
}

std::string device_of_rank(const std::string& names, const LocalRank& local) {
    const auto count = local.count;
    const auto parts = parts_of(names);
    if (parts.size() > count)
        throw InputError(
            fmt::format("--device {} names {} devices for {} rank{} on this machine, but each rank uses one "
                        "device; start as many ranks as devices",
                        names, parts.size(), count, count == 1 ? "" : "s"));
    return parts[local.before % parts.size()];
}

std::string shared_gpu(Ranks& ranks, const DeviceInfo& own) {
    Ranks::Bytes message;
    append_text(message, own.is_gpu ? this_machine() : "");
    append_text(message, own.hardware.empty() ? own.id : own.hardware);
    std::map<std::pair<std::string, std::string>, std::size_t> rank_of;
    const auto all = ranks.gather_to_all(message);
    for (std::size_t rank = 0; rank < all.size(); ++rank) {
        MessageReader reader(all[rank]);
        auto machine = reader.read_text();
        auto card = reader.read_text();
        if (machine.empty()) continue;
        const auto [first, is_new] = rank_of.try_emplace({std::move(machine), std::move(card)}, rank);
        if (!is_new)
            return fmt::format(
                "ranks {} and {} share one GPU, {}; name one GPU for each rank of a machine, as "
                "in --device cuda:0+cuda:1, or start one rank per GPU",
                first->second, rank, first->first.second);
    }
    return {};
}

std::vector<DeviceInfo> devices_of_ranks(Ranks& ranks, const DeviceInfo& own) {
    Ranks::Bytes message;
    for (const auto& text : {own.id, own.name, own.driver, own.compiler, own.hardware})
        append_text(message, text);
    append(message, std::span(&own.is_gpu, 1));
    append(message, std::span(&own.compute_units, 1));
    append(message, std::span(&own.global_bytes, 1));
    std::vector<DeviceInfo> all;
    for (const auto& bytes : ranks.gather_to_all(message)) {
        MessageReader reader(bytes);
        auto& info = all.emplace_back();
        for (auto* text : {&info.id, &info.name, &info.driver, &info.compiler, &info.hardware})
            *text = reader.read_text();
        info.is_gpu = reader.read<bool>();
        reader.read(std::span(&info.compute_units, 1));
        reader.read(std::span(&info.global_bytes, 1));
    }
    return all;
}

} // namespace tandem
