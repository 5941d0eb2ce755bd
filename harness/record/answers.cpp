// SPDX-License-Identifier: MIT
#include "harness/record/parts.h"
#include "harness/sampling/measurement_fields.h"

namespace tandem::record_parts {

namespace {

const Fields<Digest>& digest_fields() {
    static const Fields<Digest> fields{
        {"count", count(), "elements", &Digest::count},
        {"a", hex(), "first wrapping 64-bit sum of a mix of the elements",
         [](auto& d) { return hex_text(d.a); }},
        {"b", hex(), "second wrapping 64-bit sum", [](auto& d) { return hex_text(d.b); }}};
    return fields;
}

Type digest_type() { return definition("digest", digest_fields().type("order-free digest of a set")); }

/// Values by the names that the algorithm declares; null for a counter without a value.
Json counters_json(const CellRecord& r) {
    Json json = Json::object();
    for (const auto& counter : r.cell.algorithm->counters()) {
        const auto found = r.m.work.find(counter.name);
        json[std::string(counter.name)] = found == r.m.work.end() ? Json() : Json(found->second);
    }
    return json;
}

Json rebuilds_json(const CellRecord& r) { return r.m.samples.empty() ? 0 : r.m.samples.back().rebuilds; }

const Measurement& measurement_of(const CellRecord& r) { return r.m; }

const FrameCounts& counts_of(const CellRecord& r) { return r.m.counts; }

/// Digests of what was found.
Fields<CellRecord> found_digests() {
    return {{"digest",
             digest_type(),
             "of the candidate pairs, summed over frames, compared with a reference or not; a and b are 0 "
             "with output=count",
             [](auto& r) { return digest_fields().write(r.m.agreement.digest); },
             {.since = 4}},
            {"contact_digest",
             digest_type(),
             "of the contacts, summed over frames",
             [](auto& r) { return digest_fields().write(r.m.agreement.contact_digest); },
             {.since = 4}}};
}

/// Counts that are not of the checking replay.
Fields<CellRecord> other_counts() {
    return {{"counters", map_of(known_count().with("description", "one counter"), "^[a-z][a-z0-9_]*$"),
             "what the algorithm counts of its own work, over all frames, from a counting build; 'tandem "
             "algorithms' has the unit and the meaning of each; null where it was not counted (--no-count)",
             counters_json},
            {"rebuilds",
             count(),
             "trees that the last sample built because none was kept (leaf_query with tree=scene), over all "
             "frames and devices; 0 for other walks; older records also count lists of pairs that were not "
             "kept",
             rebuilds_json,
             {.since = 4}},
            {"submissions",
             count(),
             "calls that handed transfers and kernels to the devices, over the frames of the last sample: "
             "one a command, and one for all that went together (submission=one); stages.*.launches counts "
             "kernels",
             [](auto& r) { return r.m.submissions; },
             {.since = 4}}};
}

const Fields<CellRecord>& work_fields() {
    static const auto fields = found_counts()
                                   .of(measurement_of)
                                   .with(found_digests())
                                   .with(effort_counts().of(counts_of))
                                   .with(other_counts());
    return fields;
}

const Fields<KernelFacts>& kernel_fields() {
    static const Fields<KernelFacts> fields{
        {"entry", text(), "entry point", &KernelFacts::entry},
        {"defines", map_of(any_text().with("description", "value of the define"), "^[A-Z][A-Z0-9_]*$"),
         "compile-time parameters, by name", &KernelFacts::defines},
        {"compile_ms", number_from(0), "milliseconds of compilation; 0 when it was compiled before",
         &KernelFacts::compile_ms},
        {"registers", known_count(), "registers a work-item; null when the backend does not tell",
         [](auto& k) { return known_or_null(k.registers); }},
        {"local_bytes", known_count(),
         "bytes of local memory a work-group; null when the backend does not tell",
         [](auto& k) { return known_or_null(k.local_bytes); }},
        {"spill_bytes", known_count(), "bytes spilled a work-item; null when the backend does not tell",
         [](auto& k) { return known_or_null(k.spill_bytes); }},
        {"stack_bytes",
         known_count(),
         "bytes of a work-item's private arrays in device memory; null when the backend does not tell",
         [](auto& k) { return known_or_null(k.stack_bytes); },
         {.since = 4}}};
    return fields;
}

const Fields<Measurement>& preparation_fields() {
    static const Fields<Measurement> fields{{"host_ns", count(),
                                             "nanoseconds of building, upload of static data and compilation",
                                             &Measurement::prepare_ns},
                                            {"device_bytes",
                                             count(),
                                             "bytes of device memory held after the checking replay",
                                             &Measurement::device_bytes,
                                             {.column = "device_bytes"}}};
    return fields;
}

std::string reference_of(const CellRecord& r) {
    return reference_method(r.scene) == Method::brute_force ? "brute force" : "sweep";
}

const Fields<CellRecord>& agreement_fields() {
    static const Fields<CellRecord> fields{
        {"reference", one_of({"brute force", "sweep"}),
         "how the reference found its answer; both do the cell's own arithmetic", reference_of},
        {"frames", integer_from(1), "frames compared", [](auto& r) { return r.m.agreement.frames; }},
        {"missing",
         count(),
         "candidate pairs of the reference that the cell lacks, over all frames",
         [](auto& r) { return r.m.agreement.missing; },
         {.column = "missing"}},
        {"extra",
         count(),
         "candidate pairs of the cell that the reference lacks, over all frames, and timed frames that gave "
         "another answer than the checked one",
         [](auto& r) { return r.m.agreement.extra; },
         {.column = "extra"}},
        {"contact_frames_wrong",
         count(),
         "frames whose contacts differ from the reference's in any bit",
         [](auto& r) { return r.m.agreement.contact_frames_wrong; },
         {.column = "contact_frames_wrong"}},
        {"digest", digest_type(),
         "of the candidate pairs, summed over frames; equal for equal scene, frames, k, axes, precision, "
         "rounding and truth",
         [](auto& r) { return digest_fields().write(r.m.agreement.digest); }},
        {"contact_digest", digest_type(), "of the contacts, summed over frames",
         [](auto& r) { return digest_fields().write(r.m.agreement.contact_digest); }}};
    return fields;
}

} // namespace

Fields<CellRecord> answer_fields() {
    return {{"work",
             nullable(work_fields().type(
                 "what was found and how much work it took; from replays that are never timed")),
             "", [](auto& r) { return r.is_measured() ? work_fields().write(r) : Json(); }},
            {"kernels", array_of(kernel_fields().type("one kernel")),
             "kernels that the cell asked for, each once",
             [](auto& r) { return array_json(kernel_fields(), r.m.kernels); }},
            {"preparation",
             nullable(preparation_fields().type("what comes before the first frame and is in no sample")), "",
             [](auto& r) { return r.is_measured() ? preparation_fields().write(r.m) : Json(); }},
            {"agreement",
             nullable(agreement_fields().type(
                 "the answers against the reference; null when not compared (--no-check, failed)")),
             "", [](auto& r) { return r.m.agreement.frames == 0 ? Json() : agreement_fields().write(r); }}};
}

} // namespace tandem::record_parts
