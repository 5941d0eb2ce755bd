// SPDX-License-Identifier: MIT
#include "harness/ranks/model_table.h"

#include "harness/device_models.h"
#include "harness/table/columns.h"
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

/// Without the device.
std::string cell_text(const Cell& cell) {
    const auto text = describe(cell);
    return text.substr(0, text.rfind(" on "));
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

Ratios ratios_of(const SweptGroup& group) {
    Ratios ratios;
    std::vector<Row> rows;
    for (std::size_t i = 0; i < group.cells.size(); ++i) {
        if (!group.results[i] || !group.results[i]->measured) continue;
        const Row row{&group.cells[i], &group.results[i]->measurement};
        const auto base =
            std::ranges::find_if(rows, [&](const Row& other) { return comparable(other, row); });
        if (base != rows.end())
            ratios.add(cell_text(*row.cell) + " / " + cell_text(*base->cell), model_text(row.cell->devices),
                       ratio_text(*row.measurement, *base->measurement));
        rows.push_back(row);
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
