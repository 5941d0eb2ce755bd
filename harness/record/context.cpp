// SPDX-License-Identifier: MIT
// The scene, the devices and the environment of a record.
#include "harness/record/parts.h"

#include "backends/hardware.h"
#include "harness/record/record.h"

#include <array>

namespace tandem::record_parts {

namespace {

/// A count of the meshes, summed over the bodies.
std::size_t over_bodies(const Scene& scene, std::size_t Mesh::*member) {
    std::size_t sum = 0;
    for (const auto& body : scene.bodies) sum += scene.meshes[body.mesh].*member;
    return sum;
}

/// A finding of the meshes, summed over the bodies.
auto found(std::size_t MeshFindings::*member) {
    return [member](const Scene& scene) {
        std::size_t sum = 0;
        for (const auto& body : scene.bodies) sum += scene.meshes[body.mesh].findings.*member;
        return sum;
    };
}

const Fields<Scene>& reading_fields() {
    static const Fields<Scene> fields{
        {"handling", one_of(Json(duplicates_names)),
         "--duplicates. merge: duplicates take no part; keep: they take part; reject: there are none",
         [](auto& s) { return duplicates_names.at(static_cast<std::size_t>(s.reading.duplicates)); }},
        {"duplicates", count(), "tetrahedra with the four vertices of an earlier one",
         found(&MeshFindings::duplicates)},
        {"weld", nullable(number_from(0)),
         "--weld: vertices at most this far apart are one for boundary faces, duplicates and setting self; "
         "null: no welding",
         [](auto& s) { return s.reading.weld ? Json(*s.reading.weld) : Json(); }},
        {"pressure",
         nullable(number_from(0)),
         "--pressure: modulus of the pressure fields that meshes without one got; null: none",
         [](auto& s) { return s.reading.pressure ? Json(*s.reading.pressure) : Json(); },
         {.since = 4}},
        {"welded", count(), "vertices that were welded to an earlier one", found(&MeshFindings::welded)},
        {"coincident", count(), "vertices of mesh files at the position of an earlier one",
         found(&MeshFindings::coincident)},
        {"ghosts", count(), "tetrahedra that files mark as duplicate or hidden ghost cells; left out",
         found(&MeshFindings::ghosts)},
        {"reduced", count(), "tetrahedra of higher order, read by their corners",
         found(&MeshFindings::reduced)},
        {"other_cells", count(), "volume cells that are not tetrahedra; left out",
         found(&MeshFindings::other_cells)}};
    return fields;
}

} // namespace

const Fields<Scene>& scene_fields() {
    static const Fields<Scene> fields{
        {"name", any_text(), "name of the scene without parameters", &Scene::name},
        {"key", text(), "name and every parameter", &Scene::key, {.column = "scene"}},
        {"digest",
         hex(),
         "64-bit digest of meshes, bodies and motion; equal on every machine",
         [](auto& s) { return hex_text(s.digest); },
         {.column = "scene_digest"}},
        {"units", any_text(), "unit of length", &Scene::units},
        {"bodies",
         count(),
         "number of bodies",
         [](auto& s) { return s.bodies.size(); },
         {.column = "bodies"}},
        {"vertices", count(), "vertices, summed over bodies", vertex_count},
        {"tetrahedra",
         count(),
         "tetrahedra, summed over bodies",
         tetrahedron_count,
         {.column = "tetrahedra"}},
        {"inverted", count(), "tetrahedra of negative volume at rest, summed over bodies; kept",
         [](auto& s) { return over_bodies(s, &Mesh::inverted); }},
        {"degenerate", count(), "tetrahedra of zero volume at rest, summed over bodies; kept",
         [](auto& s) { return over_bodies(s, &Mesh::degenerate); }},
        {"reading",
         reading_fields().type(
             "how the meshes were read and connected, decided before the first frame; counts "
             "are sums over bodies"),
         "",
         [](auto& s) { return reading_fields().write(s); },
         {.since = 4}}};
    return fields;
}

const Fields<RecordedDevice>& device_fields() {
    static const Fields<RecordedDevice> fields{
        {"id", text_like("^(host|(opencl|cuda):[0-9]+)$"), "tandem's name for it on that machine",
         [](auto& d) { return d.info.id; }},
        {"name", any_text(), "as the vendor calls it", [](auto& d) { return d.info.name; }},
        {"driver", any_text(), "version of the driver or runtime", [](auto& d) { return d.info.driver; }},
        {"compiler", any_text(), "what compiled the kernels", [](auto& d) { return d.info.compiler; }},
        {"hardware", nullable(pattern_of_digest()),
         "which piece of hardware, never its UUID in clear: FNV-1a of 64 bits over the characters of its "
         "UUID (GPU-...) or PCI address; null when the backend does not tell",
         [](auto& d) { return d.info.hardware.empty() ? Json() : Json(hardware_digest(d.info.hardware)); }},
        {"kind", one_of({"cpu", "gpu"}), "cpu: for regression and checking only",
         [](auto& d) { return d.info.is_gpu ? "gpu" : "cpu"; }},
        {"compute_units", integer_from(1), "compute units", [](auto& d) { return d.info.compute_units; }},
        {"memory_bytes", count(), "device memory in bytes", [](auto& d) { return d.info.global_bytes; }},
        {"clock",
         text(),
         "by what its times in breakdown_ns, device_span_ns, stages and kernel_times were taken: CUPTI ... "
         "activity records (nothing but the commands), CUDA events (with what an event takes, in parentheses "
         "why not by CUPTI), OpenCL profiling, steady clock; several joined by ; where the rounds differ",
         [](auto& d) { return d.clock ? Json(*d.clock) : absent(); },
         {.since = 4}}};
    return fields;
}

const Fields<Environment>& environment_fields() {
    static const Fields<Environment> fields{
        {"commit",
         nullable(text()),
         "commit the program was built from; null when unknown",
         [](auto& e) { return known_or_null(e.commit); },
         {.column = "commit"}},
        {"dirty",
         boolean(),
         "the tree had changes that are not in the commit",
         &Environment::dirty,
         {.column = "dirty"}},
        {"date",
         text_like("^[0-9]{4}-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-5][0-9]:[0-6][0-9]Z$"),
         "when the record was written, UTC, ISO 8601",
         &Environment::date,
         {.column = "date"}},
        {"processor", nullable(text()), "host processor; null when unknown",
         [](auto& e) { return known_or_null(e.processor); }},
        {"cores", count(), "host cores; 0 when unknown", &Environment::cores},
        {"memory_bytes", count(), "host memory in bytes", &Environment::memory},
        {"compiler", text(), "compiler of the program", &Environment::compiler},
        {"sources",
         nullable(hex()),
         "digest of the sources of the program and its kernels",
         [](auto&) { return sources_digest(); },
         {.since = 3}}};
    return fields;
}

} // namespace tandem::record_parts

namespace tandem {

nlohmann::ordered_json record_scene(const Scene& scene) { return record_parts::scene_fields().write(scene); }

nlohmann::ordered_json record_device(const DeviceInfo& info) {
    return record_parts::device_fields().write({info, {}});
}

nlohmann::ordered_json record_timed_device(const Device& device) {
    return record_parts::device_fields().write({device.info(), device.clock()});
}

nlohmann::ordered_json record_devices(const DeviceGroup& devices) {
    auto json = nlohmann::ordered_json::array();
    for (const auto* device : devices) json.push_back(record_timed_device(*device));
    return json;
}

nlohmann::ordered_json record_environment() {
    return record_parts::environment_fields().write(environment());
}

} // namespace tandem
