// SPDX-License-Identifier: MIT
#include "harness/commands.h"
#include "harness/frame_contacts.h"
#include "harness/report/against.h"
#include "harness/report/data.h"
#include "harness/report/page.h"
#include "harness/report/scene_data.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <cctype>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>

namespace tandem {

namespace {

using report::Page;

constexpr std::size_t most_page_bytes = 7'900'000;

struct ShownScene {
    std::string json, key;
    std::size_t frames = 0;
    std::string name;
};

ShownScene open_shown_scene(const ViewOptions& options) {
    RunOptions run;
    run.scene = options.scene;
    run.meshes = options.meshes;
    run.poses = options.poses;
    const auto scene = open_scene(run);
    const auto [first, last] = named_frames(options.frames, scene);
    std::vector<std::size_t> frames;
    for (auto i = first; i <= last; i += options.every) frames.push_back(i);
    std::optional<FrameContacts> finder;
    if (options.contacts) finder.emplace(options.device, scene);
    return {report::scene_data(scene, frames, finder ? &*finder : nullptr, {}), scene.key, frames.size(),
            scene.name};
}

void write(const std::string& path, const Page& page, const std::string& told) {
    const auto html = report::html_of(page);
    report::write_page(path, html);
    put("{}: {}, {:.1f} MB\n", path, told, static_cast<double>(html.size()) / 1e6);
}

/// "36 cells of 2 files", and what there is of others.
std::string told_of(std::size_t cells, const report::Records& records, std::size_t files) {
    std::vector<std::string> parts;
    const auto add = [&](std::size_t count, std::string_view one, std::string_view more) {
        if (count > 0) parts.push_back(fmt::format("{} {}", count, count == 1 ? one : more));
    };
    add(cells, "cell", "cells");
    add(records.profiles.size(), "profile", "profiles");
    add(records.simulations.size(), "simulation", "simulations");
    add(records.ceilings.size(), "device's ceilings", "devices' ceilings");
    return fmt::format("{} of {} {}", fmt::join(parts, ", "), files, files == 1 ? "file" : "files");
}

/// A name that any file system takes.
std::string file_name_of(std::string name) {
    for (auto& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '-';
    return (name.empty() ? "scene" : name) + ".html";
}

} // namespace

int report_command(const ReportOptions& options) {
    if (!options.against.empty() && options.files.size() != 1)
        throw InputError(fmt::format(
            "--against {}: two sets of records are compared; give one FILE beside it", options.against));
    Page page{.title = "Report of tandem", .has_scene = !options.scene.scene.empty(), .has_charts = true};
    report::check_libraries(page);
    auto records = report::read_records(options.files);
    auto bytes = report::empty_bytes(page);
    const auto add = [&](const char* id, std::string json) {
        bytes += json.size();
        page.data.emplace_back(id, std::move(json));
    };
    if (!options.against.empty())
        add("differences", report::differences(options.against, options.files.front()));
    std::string scene_told;
    if (page.has_scene) {
        auto scene = open_shown_scene(options.scene);
        add("scene", std::move(scene.json));
        scene_told = ", " + scene.key;
    }
    const auto room = most_page_bytes > bytes ? most_page_bytes - bytes : 0;
    auto data = report::data_of(records, room);
    add("records", std::move(data.json));
    write(options.output, page, told_of(data.cells, records, options.files.size()) + scene_told);
    for (const auto& note : data.notes) tell("tandem: {}\n", note);
    return 0;
}

int view_command(const ViewOptions& options) {
    Page page{.has_scene = true};
    report::check_libraries(page);
    auto scene = open_shown_scene(options);
    page.title = scene.name + ", a scene of tandem";
    page.data.emplace_back("scene", std::move(scene.json));
    write(options.output.empty() ? file_name_of(scene.name) : options.output, page,
          fmt::format("{} {} of {}", scene.frames, scene.frames == 1 ? "frame" : "frames", scene.key));
    return 0;
}

} // namespace tandem
