// SPDX-License-Identifier: MIT
#include "harness/ranks/model_table.h"

#include "harness/device_models.h"
#include "harness/table/columns.h"
#include "harness/table/labels.h"
#include "harness/table/table.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace tandem {

namespace {

/// "NVIDIA H100", "A+B".
std::string model_text(const DeviceGroup& devices) {
    std::string text;
    for (const auto* device : devices) text += (text.empty() ? "" : "+") + model_name(device->info());
    return text;
}

/// Ratios of a scene: by what is divided by what, then by model.
struct Ratios {
    std::vector<std::string> labels, models; ///< each once, in the order of the plan
    std::map<std::pair<std::string, std::string>, std::string> texts{};

    void add(const std::string& label, const std::string& model, const std::string& text) {
        if (std::ranges::find(labels, label) == labels.end()) labels.push_back(label);
        if (std::ranges::find(models, model) == models.end()) models.push_back(model);
        texts[{label, model}] = text;
    }
};

/// Labels have what tells cells apart on whatever model.
Ratios ratios_of(const SweptGroup& group) {
    std::vector<Row> rows;
    for (std::size_t i = 0; i < group.cells.size(); ++i)
        if (group.results[i] && group.results[i]->measured)
            rows.push_back({&group.cells[i], &group.results[i]->measurement, {}, "any"});
    const auto labels = row_labels(rows).of;
    Ratios ratios;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto* base = std::ranges::find_if(rows.data(), rows.data() + i,
                                                [&](const Row& other) { return comparable(other, rows[i]); });
        if (base != rows.data() + i)
            ratios.add(labels[i] + " / " + labels[static_cast<std::size_t>(base - rows.data())],
                       model_text(rows[i].cell->devices),
                       ratio_text(*rows[i].measurement, *base->measurement));
    }
    return ratios;
}

std::string table_of(const Ratios& ratios) {
    std::vector<Column> columns;
    for (const auto& model : ratios.models) {
        auto& column = columns.emplace_back(Column{model, {}});
        for (const auto& label : ratios.labels) {
            const auto found = ratios.texts.find({label, model});
            column.texts.push_back(found == ratios.texts.end() ? "-" : found->second);
        }
    }
    return in_columns(ratios.labels, "", columns);
}

} // namespace

std::string model_tables(std::span<const SweptGroup> groups) {
    std::string text;
    for (const auto& group : groups) {
        const auto ratios = ratios_of(group);
        if (ratios.models.size() > 1)
            text += fmt::format("\n{} {}: times as long, by model\n{}\n", group.options.scene,
                                group.options.frames, table_of(ratios));
    }
    return text;
}

} // namespace tandem
