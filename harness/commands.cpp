// SPDX-License-Identifier: MIT
#include "harness/commands.h"

#include "algorithms/broad/broad.h"
#include "harness/dumps.h"
#include "harness/record.h"
#include "harness/sampler.h"
#include "harness/table.h"
#include "scenes/error.h"

#include <algorithm>
#include <charconv>
#include <deque>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <unistd.h>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

Pose parse_pose(const std::string& text) {
    std::istringstream in(text);
    std::array<double, 7> v{};
    for (auto& value : v) in >> value;
    std::string rest;
    const double norm = v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6];
    if (!in || in >> rest || !(norm > 1e-300 && norm < 1e300))
        throw InputError(fmt::format(
            "--pose '{}': give seven numbers \"tx ty tz qw qx qy qz\" with a quaternion that is not 0",
            text));
    return {Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized(), Eigen::Vector3d(v[0], v[1], v[2])};
}

Scene open_scene(const RunOptions& options) {
    if (options.meshes.empty()) {
        if (options.scene.empty())
            throw InputError("no scene; name one (see 'tandem scenes') or give --mesh FILE");
        return make_scene(options.scene);
    }
    if (!options.scene.empty()) throw InputError("a scene and --mesh exclude each other; leave one out");
    std::vector<Pose> poses;
    for (const auto& text : options.poses) poses.push_back(parse_pose(text));
    if (poses.size() > options.meshes.size())
        throw InputError("more --pose than --mesh; give one pose a mesh at most");
    return scene_from_meshes(options.meshes, poses);
}

std::size_t parse_number(std::string_view text, const std::string& whole) {
    std::size_t value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc{} || result.ptr != text.data() + text.size())
        throw InputError(fmt::format("--frames {}: give FIRST:LAST, both inclusive, or one number", whole));
    return value;
}

FrameRange open_frames(const RunOptions& options, const Scene& scene) {
    if (options.frames.empty()) return make_frames(scene, 0, scene.frame_count - 1);
    const auto colon = options.frames.find(':');
    const auto text = std::string_view(options.frames);
    const auto first = parse_number(text.substr(0, colon), options.frames);
    const auto last =
        colon == std::string::npos ? first : parse_number(text.substr(colon + 1), options.frames);
    return make_frames(scene, first, last);
}

/// One line on a terminal's standard error that is written over; silent elsewhere.
class Progress {
public:
    explicit Progress(bool quiet) : on_(!quiet && isatty(STDERR_FILENO) != 0) {}
    ~Progress() { clear(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::string_view text) const {
        if (on_) fmt::print(stderr, "\r\033[K{}", text);
    }
    void clear() const { show(""); }

private:
    bool on_;
};

void check_required(const std::vector<BackendReport>& backends, const std::vector<std::string>& require) {
    for (const auto& wanted : require) {
        bool found = false;
        std::string reason = "no such backend or device";
        for (const auto& backend : backends) {
            if (backend.name == wanted) {
                found = !backend.devices.empty();
                reason = backend.reason;
            }
            for (const auto& device : backend.devices) found = found || device->info().id == wanted;
        }
        if (!found) throw InputError(fmt::format("--require {}: {}", wanted, reason));
    }
}

std::vector<Device*> open_devices(const std::vector<BackendReport>& backends, const RunOptions& options) {
    check_required(backends, options.require);
    auto names = options.request.devices;
    if (names.empty()) names.emplace_back("opencl:0");
    return choose_devices(backends, names);
}

void dump(const Cell& cell, const Scene& scene, const FrameRange& range, DumpFile& pairs,
          DumpFile& contacts) {
    if (!pairs && !contacts) return;
    if (cell.settings.at("output") != "pairs")
        throw InputError("dumps need pairs; leave output out or set output=pairs");
    const std::array devices{cell.device};
    const auto session = cell.algorithm->prepare(devices, scene, cell.settings);
    const Broad broad(scene, geometry_of(session->settings()), broad_bound(session->settings()));
    for (std::size_t i = 0; i < range.frames.size(); ++i) {
        const auto result = session->run(range.frames[i], broad.pairs(range.frames[i]));
        if (pairs) pairs.pairs(range.first + i, session->download(result));
        if (contacts) contacts.contacts(range.first + i, session->download_contacts(result));
        cell.device->finish();
    }
}

/// Replays the frames and does nothing else, so that a profiler sees only the algorithm.
void profile(const Cell& cell, const Scene& scene, const FrameRange& range, std::size_t times) {
    const std::array devices{cell.device};
    const auto session = cell.algorithm->prepare(devices, scene, cell.settings);
    const Broad broad(scene, geometry_of(session->settings()), broad_bound(session->settings()));
    for (std::size_t i = 0; i < times; ++i) {
        for (const auto& frame : range.frames) session->run(frame, broad.pairs(frame));
        cell.device->finish();
    }
}

std::string verdict(const Measurement& m) {
    const auto& a = m.agreement;
    if (a.frames == 0) return "not checked";
    if (a.ok())
        return fmt::format("right: {} pairs in {} frames, 0 missing, 0 extra, contacts equal", a.digest.count,
                           a.frames);
    return fmt::format("WRONG: {} missing, {} extra, contacts differ in {} of {} frames", a.missing, a.extra,
                       a.contact_frames_wrong, a.frames);
}

/// Measures one cell and appends its record, also when the device fails on the way.
int run_cell(const Cell& cell, const Scene& scene, const FrameRange& range, References& references,
             const SampleOptions& sampling, RecordFile& file, Measurement& out) {
    std::string failure;
    try {
        out = measure(cell, scene, range, references, sampling);
    } catch (const DeviceError& error) {
        failure = error.what();
    }
    file.append(make_record(cell, scene, range, out, failure));
    if (!failure.empty()) {
        fmt::print(stderr, "\ntandem: {}: {}\n", describe(cell), failure);
        return 3;
    }
    return out.agreement.ok() ? 0 : 1;
}

void print_scene(const Scene& scene, const FrameRange& range) {
    fmt::print("scene {}: {} bodies, {} vertices, {} tetrahedra, frames {}:{}, digest {:016x}\n", scene.key,
               scene.bodies.size(), vertex_count(scene), tetrahedron_count(scene), range.first, range.last,
               scene.digest);
    std::size_t inverted = 0;
    std::size_t degenerate = 0;
    for (const auto& mesh : scene.meshes) {
        inverted += mesh.inverted;
        degenerate += mesh.degenerate;
    }
    if (inverted + degenerate > 0)
        fmt::print("its meshes have {} inverted and {} zero-volume tetrahedra; they are kept\n", inverted,
                   degenerate);
}

Json parameters_json(std::span<const Parameter> parameters) {
    Json json = Json::array();
    for (const auto& p : parameters) {
        Json row{{"name", p.name}, {"default", p.initial}, {"help", p.help}};
        if (p.choices.empty())
            row["range"] = {p.least, p.most};
        else
            row["choices"] = p.choices;
        json.push_back(row);
    }
    return json;
}

} // namespace

int run_command(const RunOptions& options) {
    const auto scene = open_scene(options);
    const auto range = open_frames(options, scene);
    const auto backends = discover();
    const auto cells = plan(options.request, open_devices(backends, options));
    RecordFile file(options.out);
    DumpFile pairs(options.dump_pairs, pairs_header);
    DumpFile contacts(options.dump_contacts, contacts_header);
    print_scene(scene, range);
    if (options.profile > 0) {
        for (const auto& cell : cells) profile(cell, scene, range, options.profile);
        return 0;
    }
    References references(scene, range);
    const Progress progress(options.quiet);
    SampleOptions sampling;
    sampling.repeat = options.repeat;
    sampling.check = options.check;
    std::deque<Measurement> measurements;
    std::vector<Row> rows;
    int code = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        sampling.progress = [&](std::string_view text) {
            progress.show(fmt::format("[{}/{}] {}", i + 1, cells.size(), text));
        };
        auto& measurement = measurements.emplace_back();
        const int own = run_cell(cells[i], scene, range, references, sampling, file, measurement);
        code = std::max(code, own);
        if (own != 3) rows.push_back({&cells[i], &measurement});
    }
    progress.clear();
    dump(cells.front(), scene, range, pairs, contacts);
    fmt::print("\n{}\n{}\n", stage_table(rows), speedup_table(rows));
    for (const auto& row : rows) fmt::print("{}: {}\n", describe(*row.cell), verdict(*row.measurement));
    if (!options.out.empty()) fmt::print("{} records appended to {}\n", cells.size(), options.out);
    return code;
}

int check_command(const RunOptions& options) {
    const auto scene = open_scene(options);
    const auto range = open_frames(options, scene);
    const auto backends = discover();
    check_required(backends, options.require);
    auto request = options.request;
    if (request.devices.empty()) request.devices.emplace_back("all");
    if (request.presets.empty())
        for (const auto* traversal : algorithms())
            for (const auto& candidate : traversal->presets()) request.presets.push_back(candidate.name);
    std::sort(request.presets.begin(), request.presets.end());
    request.presets.erase(std::unique(request.presets.begin(), request.presets.end()), request.presets.end());
    const auto cells = plan(request, choose_devices(backends, request.devices));
    RecordFile file(options.out);
    print_scene(scene, range);
    References references(scene, range);
    const Progress progress(options.quiet);
    SampleOptions sampling;
    sampling.repeat = 0;
    sampling.progress = [&](std::string_view text) { progress.show(text); };
    int code = 0;
    fmt::print("{:<10} {:<12} {:<18} {:>10} {:>9} {:>8} {:>6} {:>9} {}\n", "device", "algorithm", "preset",
               "pairs", "missing", "extra", "retry", "contacts", "contacts equal");
    for (const auto& cell : cells) {
        Measurement m;
        const int own = run_cell(cell, scene, range, references, sampling, file, m);
        code = std::max(code, own);
        progress.clear();
        if (own == 3) continue;
        std::uint64_t contacts = 0;
        for (const auto count : m.contacts) contacts += count;
        fmt::print("{:<10} {:<12} {:<18} {:>10} {:>9} {:>8} {:>6} {:>9} {}\n", cell.device->info().id,
                   cell.algorithm->name(), cell.preset, m.agreement.digest.count, m.agreement.missing,
                   m.agreement.extra, m.retries, contacts,
                   m.agreement.contact_frames_wrong == 0 ? "yes" : "NO");
    }
    fmt::print("{}\n", code == 0 ? "all agree with the reference" : "NOT all agree with the reference");
    return code;
}

int devices_command(bool json, const std::vector<std::string>& require) {
    const auto backends = discover();
    Json all = Json::array();
    for (const auto& backend : backends) {
        Json entry{{"backend", backend.name},
                   {"reason", backend.reason.empty() ? Json(nullptr) : Json(backend.reason)}};
        entry["devices"] = Json::array();
        for (const auto& device : backend.devices) {
            const auto& info = device->info();
            entry["devices"].push_back({{"id", info.id},
                                        {"name", info.name},
                                        {"driver", info.driver},
                                        {"compiler", info.compiler},
                                        {"compute_units", info.compute_units},
                                        {"memory_bytes", info.global_bytes},
                                        {"local_bytes", info.local_bytes},
                                        {"double", info.has_double}});
            if (!json)
                fmt::print("{:<10} {} ({}), {} compute units, {:.1f} GB, {}\n", info.id, info.name,
                           info.driver, info.compute_units, static_cast<double>(info.global_bytes) * 1e-9,
                           info.compiler);
        }
        if (!json && !backend.reason.empty()) fmt::print("{}\n", backend.reason);
        all.push_back(entry);
    }
    if (json) fmt::print("{}\n", all.dump(2));
    check_required(backends, require);
    return 0;
}

int scenes_command(bool json) {
    Json all = Json::array();
    for (const auto& kind : scene_kinds()) {
        Json parameters = Json::object();
        for (const auto& p : kind.parameters) parameters[p.name] = {{"default", p.value}, {"help", p.help}};
        all.push_back({{"name", kind.name}, {"models", kind.models}, {"parameters", parameters}});
        if (json) continue;
        const auto scene = make_scene(kind.name);
        fmt::print("{}: {}\n  {} bodies, {} vertices, {} tetrahedra, {} frames\n", kind.name, kind.models,
                   scene.bodies.size(), vertex_count(scene), tetrahedron_count(scene), scene.frame_count);
        for (const auto& p : kind.parameters) fmt::print("    {:<10} {:<12} {}\n", p.name, p.value, p.help);
    }
    if (json) fmt::print("{}\n", all.dump(2));
    return 0;
}

int algorithms_command(bool json) {
    Json all = Json::array();
    for (const auto* traversal : algorithms()) {
        Json presets = Json::array();
        for (const auto& p : traversal->presets())
            presets.push_back({{"name", p.name}, {"help", p.help}, {"values", p.values}});
        all.push_back({{"name", traversal->name()},
                       {"summary", traversal->summary()},
                       {"parameters", parameters_json(traversal->parameters())},
                       {"presets", presets}});
        if (json) continue;
        fmt::print("{}: {}\n  presets\n", traversal->name(), traversal->summary());
        for (const auto& p : traversal->presets()) fmt::print("    {:<18} {}\n", p.name, p.help);
        fmt::print("  settings\n");
        for (const auto& p : traversal->parameters())
            fmt::print("    {:<18} {:<10} {} [{}]\n", p.name, p.initial, p.help,
                       p.choices.empty() ? fmt::format("{}..{}", p.least, p.most)
                                         : fmt::format("{}", fmt::join(p.choices, ", ")));
    }
    if (json) fmt::print("{}\n", all.dump(2));
    return 0;
}

} // namespace tandem
