// SPDX-License-Identifier: MIT
#include "base/counted.h"
#include "harness/program/cache_folder.h"
#include "harness/plans/task.h"

#include "algorithms/bodies/nothing_meets.h"
#include "algorithms/bodies/range.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/parameters/table.h"
#include "harness/plans/cell_session.h"
#include "harness/plans/inputs.h"
#include "harness/plans/key.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"
#include "base/error.h"
#include "scenes/pressure_field.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace tandem {

namespace {

/// Removes cells whose precision cannot represent the coordinates of a frame. Each range of numbers is
/// checked once.
void fit_coordinates(Task& task, const Unfit& unfit) {
    std::map<double, std::optional<InputError>> known; // by the largest coordinate
    std::erase_if(task.cells, [&](const Cell& cell) {
        const auto [found, is_new] = known.try_emplace(largest_coordinate(geometry_of(cell.settings)));
        if (is_new) try {
                check_coordinates(cell, task.scene, task.range);
            } catch (const InputError& error) {
                found->second = error;
            }
        if (found->second) unfit(*found->second);
        return found->second.has_value();
    });
}

/// Removes cells whose sessions have the settings of an earlier cell, because some have no effect on its
/// device, such as group_size on host, or name what another value means, such as slabs=usual. Their records
/// would have equal keys.
void drop_equal_sessions(Task& task) {
    std::map<std::string, std::string> first; // descriptions by key
    std::erase_if(task.cells, [&](const Cell& cell) {
        if (!cell.candidates.empty()) return false; // of auto: its key is that of the choice
        std::string key;
        try {
            key = key_of(cell, session_settings(cell, task.scene), task.scene, task.range);
            for (const auto& info : infos_of(cell)) key += "|" + info.id; // keys have models only
        } catch (const InputError&) {
            return false; // reported where the cell is prepared
        }
        const auto [found, is_new] = first.try_emplace(key, describe(cell));
        if (!is_new)
            print_message("tandem: skipped a cell: {} has the settings of {}\n", describe(cell),
                          found->second);
        return !is_new;
    });
}

} // namespace

Task open_task(const RunOptions& options, std::vector<Cell> cells, const Unfit& unfit) {
    return Task(open_scene(options), options, std::move(cells), unfit);
}

Task::Task(Scene opened, const RunOptions& given, std::vector<Cell> planned, const Unfit& unfit)
    : options(given),
      scene(std::move(opened)),
      range(open_frames(options, scene, bounds_motion(planned))),
      cells(std::move(planned)) {
    check_outputs(options, cells);
    fit_coordinates(*this, unfit);
    drop_equal_sessions(*this);
}

std::filesystem::path checks_folder(const RunOptions& options) {
    return options.check_afresh ? std::filesystem::path() : cache_folder();
}

std::string scene_text(const Scene& scene, const FrameRange& range) {
    auto text =
        fmt::format("scene {}: {}, {} vertices, {} tetrahedra, frames {}:{}, digest {:016x}\n",
                    visible(scene.key), counted(scene.bodies.size(), "body", "bodies"), vertex_count(scene),
                    tetrahedron_count(scene), range.first(), range.last(), scene.digest);
    std::size_t inverted = 0;
    for (const auto& mesh : scene.meshes) inverted += mesh.inverted;
    if (inverted > 0)
        text += fmt::format("its meshes have {} inverted tetrahedra; they are kept\n", inverted);
    if (range.flaws().any())
        text += fmt::format("tetrahedra {}; they {}\n", visible(describe(range.flaws(), scene)),
                            range.flaws().handling == Degenerate::skip ? "take no part"
                                                                       : "take part as flat sets");
    if (range.has_successor())
        text += fmt::format("motion=linear: frame {} is only the successor of frame {}\n", range.last() + 1,
                            range.last());
    return text;
}

namespace {

/// Says how many bodies make no polygons of equal pressure, if a cell asks for these and they can be: a scene
/// without any field is an error of each cell.
void report_missing_fields(const Task& task) {
    const auto without = bodies_without_field(task.scene);
    const auto has_field = [](const Mesh& mesh) { return !mesh.pressures.empty(); };
    const auto asks = [](const Cell& cell) { return has_polygons(cell.settings); };
    if (without > 0 && std::ranges::any_of(task.scene.meshes, has_field)
        && std::ranges::any_of(task.cells, asks))
        print_message("tandem: scene {}: {} of {} bodies have no pressure field and make no polygons "
                      "(--pressure MODULUS gives them one)\n",
                      task.scene.name, without, task.scene.bodies.size());
}

} // namespace

void print_scene(const Task& task) {
    put_text(scene_text(task.scene, task.range));
    report_findings(task.scene);
    report_missing_fields(task);
    std::set<std::string> reasons;
    for (const auto& cell : task.cells)
        reasons.insert(why_nothing_meets(task.scene, cell.settings[parameters::self]));
    reasons.erase(std::string());
    for (const auto& reason : reasons)
        print_message("tandem: scene {}: nothing can meet: {}\n", visible(task.scene.name), reason);
    const auto far = std::ranges::count_if(task.cells, [](const Cell& cell) {
        return cell.candidates.empty() && cell.settings[parameters::origin] == Origin::automatic
               && geometry_of(cell.settings).origin == Origin::world;
    });
    if (far > 0 && task.range.origin(Origin::automatic) != Eigen::Vector3d::Zero())
        print_message(
            "tandem: {} cell{} with placement=exact and precision=double: coordinates count from the world's "
            "origin, which is far from the scene; choose precision=float, or move the scene\n",
            far, far == 1 ? "" : "s");
}

} // namespace tandem
