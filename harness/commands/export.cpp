// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/levels.h"
#include "algorithms/orders/order.h"
#include "algorithms/parameters/table.h"
#include "harness/commands/export.h"
#include "harness/commands/chunk_numbers.h"
#include "harness/commands/dump_file.h"
#include "harness/program/external.h"
#include "harness/simulate/frame_contacts.h"
#include "harness/plans/inputs.h"
#include "base/memory_reserve.h"
#include "base/standard_streams.h"
#include "base/error.h"
#include "base/files_in_use.h"
#include "scenes/export/geometry.h"
#include "scenes/export/glb.h"
#include "scenes/export/vtk.h"
#include "scenes/export/world.h"
#include "scenes/pressure_field.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <optional>

namespace tandem {

namespace {

/// Opens the scene by the rules of `tandem run`.
Scene open_scene(const ExportOptions& options) {
    RunOptions run;
    run.scene = options.scene;
    run.meshes = options.meshes;
    run.poses = options.poses;
    run.reading = options.reading;
    return open_scene(run);
}

/// The chunk number of each tetrahedron, body after body.
CellNumbers chunks_of(const Scene& scene) {
    std::vector<std::vector<std::uint32_t>> by_mesh;
    for (const auto& mesh : scene.meshes) by_mesh.push_back(chunk_numbers(mesh));
    CellNumbers numbers{"chunk", {}};
    for (const auto& body : scene.bodies)
        numbers.values.insert(numbers.values.end(), by_mesh[body.mesh].begin(), by_mesh[body.mesh].end());
    return numbers;
}

void make_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!std::filesystem::is_directory(folder))
        throw InputError(fmt::format("{}: cannot make this folder ({}); choose another", folder,
                                     error ? error.message() : "a file has this name"));
}

std::string bodies_file(std::size_t frame) { return fmt::format("bodies_{:06}.vtu", frame); }
std::string contacts_file(std::size_t frame) { return fmt::format("contacts_{:06}.vtp", frame); }
std::string surfaces_file(std::size_t frame) { return fmt::format("surfaces_{:06}.vtp", frame); }

/// Makes what frames have on the device beside bodies.
struct Finders {
    Finders(const ExportOptions& options, const Scene& scene) {
        if (!options.contacts && !options.surfaces) return;
        const std::vector<std::string> names{options.device.empty() ? default_device : options.device};
        backends = open_named(names, {});
        const auto devices = choose_devices(backends, names);
        if (devices.size() != 1)
            throw InputError(
                fmt::format("--device {}: contacts need one device; name exactly one", options.device));
        if (options.contacts) contacts.emplace(devices, scene);
        if (options.surfaces) surfaces.emplace(devices, scene, "pressure");
    }

    FindSurfaces find_surfaces() {
        if (!surfaces) return {};
        return [this](std::size_t number, const Frame& frame) { return surfaces->surfaces(number, frame); };
    }

    std::vector<BackendReport> backends; ///< own the device of the others
    std::optional<FrameContacts> contacts, surfaces;
};

/// Numbers of contacts and of polygons.
struct Exported {
    std::size_t contacts = 0, polygons = 0;
};

Exported export_vtu(const ExportOptions& options, const Scene& scene, std::span<const std::size_t> frames,
                    Finders& finders) {
    if (const auto without = bodies_without_field(scene); without > 0 && without < scene.bodies.size())
        print_message("tandem: scene {}: {} of {} bodies have no pressure field, so that --vtu writes none\n",
                      scene.name, without, scene.bodies.size());
    make_folder(options.vtu);
    const auto chunks = chunks_of(scene);
    std::vector<TimedFile> bodies, contacts, surfaces;
    Exported found;
    for (const auto i : frames) {
        MemoryReserve::refill();
        const auto frame = scene.frame(i);
        const double time = scene.time ? scene.time(i) : static_cast<double>(i);
        bodies.push_back({time, bodies_file(i)});
        write_vtu(options.vtu + "/" + bodies.back().file, scene, frame, {&chunks, 1});
        if (finders.contacts) {
            const auto points = finders.contacts->find(frame);
            found.contacts += points.size();
            contacts.push_back({time, contacts_file(i)});
            write_contacts_vtp(options.vtu + "/" + contacts.back().file, points);
        }
        if (finders.surfaces) {
            const auto polygons = finders.surfaces->surfaces(i, frame);
            found.polygons += polygons.rows.size();
            surfaces.push_back({time, surfaces_file(i)});
            exporting::write_file(options.vtu + "/" + surfaces.back().file, surfaces_vtp(polygons));
        }
    }
    write_pvd(options.vtu + "/bodies.pvd", bodies);
    if (finders.contacts) write_pvd(options.vtu + "/contacts.pvd", contacts);
    if (finders.surfaces) write_pvd(options.vtu + "/surfaces.pvd", surfaces);
    return found;
}

/// Refuses, before any work, outputs that would overwrite an input or a file of records. TANDEM_PAGE names
/// the page that `tandem view` and `tandem report` make of the geometry.
void check_outputs(const ExportOptions& options, std::span<const std::size_t> frames) {
    for (const auto& path : {options.chunks, options.glb, options.geometry})
        if (!path.empty()) check_output(path);
    if (const char* page = std::getenv("TANDEM_PAGE"); page != nullptr && !options.geometry.empty())
        check_output(page);
    if (!std::filesystem::is_directory(options.vtu)) return; // export_vtu() makes the folder
    for (const auto* name : {"bodies.pvd", "contacts.pvd", "surfaces.pvd"})
        check_output(options.vtu + "/" + name);
    for (const auto i : frames) {
        check_output(options.vtu + "/" + bodies_file(i));
        if (options.contacts) check_output(options.vtu + "/" + contacts_file(i));
        if (options.surfaces) check_output(options.vtu + "/" + surfaces_file(i));
    }
}

void export_geometry(const ExportOptions& options, const Scene& scene, std::span<const std::size_t> frames,
                     Finders& finders) {
    GeometryParts parts{.chunks = chunk_numbers, .surfaces = finders.find_surfaces()};
    if (finders.contacts) parts.contacts = [&](const Frame& frame) { return finders.contacts->find(frame); };
    write_geometry(options.geometry, scene, frames, parts);
}

/// Chunks depend on the meshes only, so frames do not matter.
void export_chunks(const ExportOptions& options, const Scene& scene) {
    const auto builder = static_cast<Builder>(parameters::builder.parse(options.builder));
    const auto k = static_cast<int>(parameters::k.parse(options.k));
    const auto leaves = leaves_of_chunk_bytes(options.chunk_bytes, k);
    DumpFile file(options.chunks, chunks_header);
    std::size_t tetrahedra = 0, chunks = 0;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        const auto order = ordered(scene.meshes[i], {builder}).ids;
        file.chunks(i, scene.meshes[i], order, leaves);
        tetrahedra += order.size();
        chunks += chunk_levels(static_cast<std::uint32_t>(order.size()), leaves).front().chunks;
    }
    file.finish();
    put("{}: {} mesh{}, {} tetrahedra in {} chunks of up to {}, builder={}, of {}\n", options.chunks,
        scene.meshes.size(), scene.meshes.size() == 1 ? "" : "es", tetrahedra, chunks, leaves,
        options.builder, scene.key);
}

int export_csv(const ExportOptions& options) {
    if (!options.vtu.empty() || !options.glb.empty() || !options.geometry.empty() || !options.meshes.empty()
        || !options.poses.empty() || !options.frames.empty())
        throw InputError("--csv makes a table of a file of records; leave out --vtu, --glb, --geometry, "
                         "--mesh, --pose and --frames, which need a scene");
    if (options.scene.empty()) throw InputError("--csv: no file of records; name it before --csv");
    std::vector<std::string> words{"--records=" + options.scene};
    if (!options.csv.empty()) words.push_back("--output=" + options.csv);
    return run_external("export-csv", words);
}

/// Refuses contacts and surfaces without a file for them, and a device that finds neither.
void check_finders(const ExportOptions& options, bool exports_frames) {
    if (options.contacts && options.vtu.empty() && options.geometry.empty())
        throw InputError("--contacts requires --vtu FOLDER or --geometry FILE; a .glb file has no points");
    if (options.surfaces && !exports_frames)
        throw InputError("--surfaces requires --vtu FOLDER, --glb FILE or --geometry FILE; chunks have none");
    if (!options.device.empty() && !options.contacts && !options.surfaces)
        throw InputError("--device requires --contacts or --surfaces; the device finds them");
}

/// Refuses options that name no output, or the same file twice.
void check_outputs(const ExportOptions& options) {
    const bool exports_frames = !options.vtu.empty() || !options.glb.empty() || !options.geometry.empty();
    if (!exports_frames && options.chunks.empty())
        throw InputError("no output; give at least one of --vtu FOLDER, --glb FILE, --geometry FILE and "
                         "--chunks FILE, or --csv for a file of records");
    if (!exports_frames && (!options.frames.empty() || options.every != 1))
        throw InputError("--frames and --every require --vtu FOLDER, --glb FILE or --geometry FILE; chunks "
                         "are the same in every frame");
    check_finders(options, exports_frames);
    const std::pair<const char*, std::string> files[] = {
        {"--chunks", options.chunks}, {"--glb", options.glb}, {"--geometry", options.geometry}};
    for (const auto& one : files)
        for (const auto& other : files)
            if (&one < &other && !one.second.empty() && one.second == other.second)
                throw InputError(fmt::format("{} and {} name the same file, {}; choose another file",
                                             one.first, other.first, one.second));
}

} // namespace

int export_command(const ExportOptions& options) {
    if (options.to_csv) return export_csv(options);
    check_outputs(options);
    const auto scene = open_scene(options);
    report_findings(scene);
    const auto [first, last] = named_frames(options.frames, scene);
    std::vector<std::size_t> frames;
    for (auto i = first; i <= last; i += options.every) frames.push_back(i);
    check_outputs(options, frames);
    Finders finders(options, scene);
    if (!options.chunks.empty()) export_chunks(options, scene);
    const auto summary = fmt::format("{} of frames {}:{} of {}", frames.size(), first, last, scene.key);
    if (!options.glb.empty()) {
        const auto polygons = write_glb(options.glb, scene, frames, finders.find_surfaces());
        const auto also = options.surfaces ? fmt::format(", {} polygons", polygons) : std::string();
        put("{}: {}{}\n", options.glb, summary, also);
    }
    if (!options.geometry.empty()) {
        export_geometry(options, scene, frames, finders);
        put("{}: {}\n", options.geometry, summary);
    }
    if (options.vtu.empty()) return 0;
    const auto [contacts, polygons] = export_vtu(options, scene, frames, finders);
    put("{}/bodies.pvd: {}\n", options.vtu, summary);
    if (options.contacts) put("{}/contacts.pvd: {} contacts\n", options.vtu, contacts);
    if (options.surfaces) put("{}/surfaces.pvd: {} polygons\n", options.vtu, polygons);
    return 0;
}

} // namespace tandem
