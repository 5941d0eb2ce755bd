// SPDX-License-Identifier: MIT
#include "harness/ranks/roster.h"

#include "harness/device_models.h"
#include "harness/key.h"
#include "scenes/error.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace tandem {

namespace {

/// One piece of hardware, whichever back end shows it.
using Card = std::pair<std::string, std::string>; ///< machine, card

Card card_of(const Member& member, const DeviceInfo& info) {
    return {member.machine, info.hardware.empty() ? info.id : info.hardware};
}

template<class Each>
void each_device(const Member& member, const Each& each) {
    for (const auto& backend : member.backends)
        for (const auto& device : backend.devices) each(device->info());
}

/// Which rank each GPU belongs to: of those that see it the one with the fewest so far.
std::map<Card, std::size_t> owners_of_cards(const std::vector<Member>& members) {
    std::map<Card, std::vector<std::size_t>> seen;
    std::vector<Card> in_order;
    for (std::size_t rank = 0; rank < members.size(); ++rank)
        each_device(members[rank], [&](const DeviceInfo& info) {
            if (!info.is_gpu) return;
            auto& ranks = seen[card_of(members[rank], info)];
            if (ranks.empty()) in_order.push_back(card_of(members[rank], info));
            if (ranks.empty() || ranks.back() != rank) ranks.push_back(rank);
        });
    std::map<Card, std::size_t> owners;
    std::vector<std::size_t> cards(members.size());
    for (const auto& card : in_order) {
        const auto owner = *std::ranges::min_element(seen[card], {}, [&](auto rank) { return cards[rank]; });
        owners[card] = owner;
        ++cards[owner];
    }
    return owners;
}

/// Which ranks have a processor of their own: no core of which an earlier one has.
std::vector<bool> have_processors(const std::vector<Member>& members) {
    std::vector<bool> have;
    std::map<std::string, std::set<int>> taken;
    for (const auto& member : members) {
        auto& cores = taken[member.machine];
        const bool is_first = cores.empty();
        const bool is_free =
            std::ranges::none_of(member.cores, [&](int core) { return cores.contains(core); });
        have.push_back(is_first || (is_free && !member.cores.empty()));
        if (have.back()) cores.insert(member.cores.begin(), member.cores.end());
    }
    return have;
}

std::size_t device_count(const Member& member) {
    std::size_t count = 0;
    each_device(member, [&](const DeviceInfo&) { ++count; });
    return count;
}

/// Leaves every rank its own.
void share_out(std::vector<Member>& members, std::set<std::string>& notes) {
    const auto owners = owners_of_cards(members);
    const auto processors = have_processors(members);
    for (std::size_t rank = 0; rank < members.size(); ++rank) {
        auto& member = members[rank];
        const bool had_some = device_count(member) > 0;
        for (auto& backend : member.backends)
            std::erase_if(backend.devices, [&](const auto& device) {
                const auto& info = device->info();
                return info.is_gpu ? owners.at(card_of(member, info)) != rank : !processors[rank];
            });
        if (!member.failure.empty())
            notes.insert(fmt::format("rank {}: {}", rank, member.failure));
        else if (had_some && device_count(member) == 0)
            notes.insert(fmt::format(
                "rank {} has no device of its own and measures nothing: other ranks of its machine "
                "have them; start one rank a GPU, or bind ranks to cores of their own",
                rank));
    }
}

/// "cuda:1" of a rank: the second of its own.
std::string own_name(const Member& member, std::string_view part) {
    const auto colon = part.find(':');
    std::size_t number = 0;
    if (colon == std::string_view::npos
        || std::from_chars(part.data() + colon + 1, part.data() + part.size(), number).ptr
               != part.data() + part.size())
        return std::string(part);
    for (const auto& backend : member.backends)
        if (backend.name == backend_of(part) && number < backend.devices.size())
            return backend.devices[number]->info().id;
    return std::string(part) + ":"; // none, whatever its number in the machine
}

/// "D+E+..." with the rank's own names.
std::string own_names(const Member& member, std::string_view name) {
    std::string own;
    for (std::size_t begin = 0; begin <= name.size();) {
        const auto end = std::min(name.find('+', begin), name.size());
        own += (begin == 0 ? "" : "+") + own_name(member, name.substr(begin, end - begin));
        begin = end + 1;
    }
    return own;
}

std::string list_of(const Member& member) {
    std::vector<std::string> texts;
    each_device(member, [&](const DeviceInfo& info) {
        texts.push_back(fmt::format("{} ({}{})", info.id, model_name(info),
                                    info.is_gpu ? "" : fmt::format(" x{}", info.compute_units)));
    });
    return texts.empty() ? "no device" : fmt::to_string(fmt::join(texts, ", "));
}

void add_once(std::vector<DeviceGroup>& groups, DeviceGroup group) {
    const auto same = [&](const DeviceGroup& other) { return models_of(other) == models_of(group); };
    if (std::ranges::none_of(groups, same)) groups.push_back(std::move(group));
}

} // namespace

Models models_of(const DeviceGroup& devices) {
    Models models;
    for (const auto* device : devices) models.push_back(model_of(device->info()));
    return models;
}

Roster::Roster(std::vector<Member> members) : members_(std::move(members)) { share_out(members_, notes_); }

std::string Roster::text() const {
    std::string text;
    for (std::size_t rank = 0; rank < members_.size(); ++rank)
        text += fmt::format("rank {}: {}\n", rank, list_of(members_[rank]));
    return text;
}

std::vector<DeviceGroup> Roster::choose_each(const std::string& name) const {
    std::vector<DeviceGroup> chosen;
    for (const auto& member : members_)
        for (const auto& backend : member.backends)
            for (const auto& device : backend.devices)
                if (name == "all" || is_among(device->info(), name)) add_once(chosen, {device.get()});
    return chosen;
}

/// Of the first rank that has it; other ranks may have other models under the name.
DeviceGroup Roster::choose_one(const std::string& name) {
    std::vector<DeviceGroup> found;
    for (const auto& member : members_) try {
            const std::array own{own_names(member, name)};
            add_once(found, choose_devices(member.backends, own).front());
        } catch (const InputError&) {
            continue; // another may have it
        }
    if (found.empty()) return {};
    if (found.size() > 1)
        notes_.insert(fmt::format(
            "{} is {} on some ranks and {} on others; cells go to the first; name a model, or each", name,
            fmt::join(models_of(found[0]), "+"), fmt::join(models_of(found[1]), "+")));
    return found.front();
}

std::vector<DeviceGroup> Roster::choose(const std::vector<std::string>& names) {
    std::vector<DeviceGroup> chosen;
    for (const auto& name : names) {
        const auto found = name == "all" || asks_for_each(name) ? choose_each(name)
                                                                : std::vector<DeviceGroup>{choose_one(name)};
        if (found.empty() || found.front().empty()) {
            std::vector<std::string> have;
            for (std::size_t rank = 0; rank < members_.size(); ++rank)
                have.push_back(fmt::format("rank {}: {}", rank, list_of(members_[rank])));
            throw InputError(fmt::format("no rank has a device {}; {}", name, fmt::join(have, "; ")));
        }
        for (const auto& group : found) add_once(chosen, standing_for(group));
    }
    return chosen;
}

/// Devices of like models are one cell's, whatever they were called.
DeviceGroup Roster::standing_for(const DeviceGroup& group) {
    return stand_for_.try_emplace(models_of(group), group).first->second;
}

DeviceGroup Roster::devices_of(int rank, const Models& models) const {
    DeviceGroup group;
    const auto& member = members_[static_cast<std::size_t>(rank)];
    for (const auto& model : models)
        for (const auto& backend : member.backends)
            for (const auto& device : backend.devices)
                if (group.size() < static_cast<std::size_t>(&model - models.data()) + 1
                    && model_of(device->info()) == model
                    && std::ranges::find(group, device.get()) == group.end())
                    group.push_back(device.get());
    return group.size() == models.size() ? group : DeviceGroup{};
}

std::vector<int> Roster::ranks_with(const Models& models) const {
    std::vector<int> ranks;
    for (int rank = 0; rank < static_cast<int>(members_.size()); ++rank)
        if (!devices_of(rank, models).empty()) ranks.push_back(rank);
    return ranks;
}

} // namespace tandem
