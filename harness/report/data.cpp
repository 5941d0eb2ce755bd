// SPDX-License-Identifier: MIT
#include "harness/report/data.h"

#include "harness/environment.h"
#include "harness/report/groups.h"

#include <fmt/format.h>

namespace tandem::report {

namespace {

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// What cells share becomes numbers; null stays null.
void intern(Json& row, Interned& values) {
    for (std::size_t i = 0; i < row.size(); ++i)
        if (cell_fields[i].is_shared && !row[i].is_null()) row[i] = values.number(row[i]);
}

/// Cells beyond the room go, the last first, and a note says how many.
void leave_out_cells(Records& records, std::size_t room, Interned& values) {
    constexpr std::size_t label_and_group = 80;
    std::size_t bytes = 0;
    std::size_t kept = 0;
    for (auto& cell : records.cells) {
        intern(cell.row, values);
        bytes += dumped(cell.row).size() + label_and_group;
        if (bytes + values.bytes() > room) break;
        ++kept;
    }
    if (kept == records.cells.size()) return;
    records.notes.push_back(
        fmt::format("the last {} of {} cells are left out, so that the page stays small; give "
                    "fewer files, or the lines that matter",
                    records.cells.size() - kept, records.cells.size()));
    records.cells.erase(records.cells.begin() + static_cast<std::ptrdiff_t>(kept), records.cells.end());
}

Json group_json(const Group& group, const std::vector<ShownCell>& cells) {
    Json ranked = Json::array();
    for (const auto& place : group.ranked)
        ranked.push_back({place.cell, rounded(place.ratio.value), rounded(place.ratio.low),
                          rounded(place.ratio.high), place.is_told_apart});
    return {{"title", group.title},
            {"cells", group.cells},
            {"ranked", ranked},
            {"differ", group.answers_differ},
            {"words", words_of(group, cells)}};
}

/// A list with a value for each cell, nulls where there was no room left, and how many it holds.
template<class Member>
Json detail_of(const Records& records, Member member, std::size_t& room, std::size_t& missing) {
    Json all = Json::array();
    for (const auto& cell : records.cells) {
        const auto& value = cell.*member;
        const auto bytes = dumped(value).size() + 1;
        const bool fits = bytes <= room;
        if (fits) room -= bytes;
        missing += fits ? 0 : 1;
        all.push_back(fits ? value : Json());
    }
    return all;
}

Json field_names(bool only_shared) {
    Json names = Json::array();
    for (const auto& field : cell_fields)
        if (!only_shared || field.is_shared) names.push_back(field.name);
    return names;
}

void add_labels(Records& records, const std::vector<Group>& groups) {
    for (const auto& group : groups)
        for (std::size_t i = 0; i < group.cells.size(); ++i)
            records.cells[group.cells[i]].row.push_back(group.labels[i]);
}

} // namespace

PageData data_of(Records records, std::size_t most_bytes) {
    const auto others = dumped(records.profiles).size() + dumped(records.ceilings).size()
                        + dumped(records.simulations).size();
    auto room = most_bytes > others ? most_bytes - others : 0;
    Interned values;
    leave_out_cells(records, room, values);
    const auto groups = groups_of(records.cells);
    add_labels(records, groups);
    Json json{{"program", version_line()},    {"date", environment().date},
              {"fields", field_names(false)}, {"shared", field_names(true)},
              {"values", values.values()},    {"words", words_of(groups, records.cells)}};
    json["groups"] = Json::array();
    for (const auto& group : groups) json["groups"].push_back(group_json(group, records.cells));
    json["cells"] = Json::array();
    Json older = Json::array();
    for (std::size_t i = 0; i < records.cells.size(); ++i) {
        json["cells"].push_back(records.cells[i].row);
        if (records.cells[i].is_older) older.push_back(i);
    }
    json["older"] = older;
    const auto used = dumped(json["cells"]).size() + dumped(json["groups"]).size() + values.bytes();
    room = room > used ? room - used : 0;
    std::size_t missing = 0;
    json["curves"] = detail_of(records, &ShownCell::curve, room, missing);
    json["rounds"] = detail_of(records, &ShownCell::rounds, room, missing);
    if (missing > 0)
        records.notes.push_back(
            fmt::format("times by frame or by round of some cells are left out ({} lists), so that "
                        "the page stays small",
                        missing));
    for (auto* part : {&records.profiles, &records.ceilings, &records.simulations, &records.files})
        if (part->is_null()) *part = Json::array();
    json["profiles"] = std::move(records.profiles);
    json["ceilings"] = std::move(records.ceilings);
    json["simulations"] = std::move(records.simulations);
    json["files"] = std::move(records.files);
    json["cell_records"] = records.cell_records;
    json["notes"] = records.notes;
    return {dumped(json), records.cells.size(), std::move(records.notes)};
}

} // namespace tandem::report
