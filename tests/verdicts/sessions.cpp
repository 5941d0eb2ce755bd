// SPDX-License-Identifier: MIT
// made_up_sessions COUNT: prints sessions with made-up times, one JSON object a line: their cells, and the
// lines of kind verdict that the program records on them. tests/verdicts.py computes the same from the cells.
#include "algorithms/traversal.h"
#include "backends/registry.h"
#include "harness/plans/cells.h"
#include "harness/plans/frames.h"
#include "harness/record/verdict.h"
#include "scenes/scene.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <random>

namespace tandem {
namespace {

using Json = nlohmann::ordered_json;

/// Draws that are the same on every machine.
class Draws {
public:
    explicit Draws(std::uint64_t seed) : random_(seed) {}
    std::uint64_t below(std::uint64_t end) { return random_() % end; }
    bool one_in(std::uint64_t n) { return below(n) == 0; }

private:
    std::mt19937_64 random_;
};

/// Times around a median that several cells of a session share, so that some are not told apart and some are
/// equal.
Measurement made_up(Draws& draws) {
    Measurement m;
    const auto base = 1'000'000 * (1 + draws.below(3));
    const auto noise = draws.one_in(4) ? 1 : 1 + draws.below(base / 5);
    const auto rounds = draws.one_in(5) ? 1 : 1 + draws.below(14);
    const auto first = draws.one_in(6) ? draws.below(4) : 0;
    for (std::uint32_t round = 0; round < rounds; ++round)
        for (std::uint64_t sample = 0; sample < 1 + draws.below(3); ++sample)
            m.samples.push_back({.round = static_cast<std::uint32_t>(first) + round,
                                 .frame_ns = {static_cast<std::int64_t>(base + draws.below(noise)), 1000}});
    m.candidate_pairs = {draws.one_in(9) ? 0u : 5u, 0u};
    m.agreement.missing = draws.one_in(8) ? 1 : 0;
    m.agreement.digest.count = 5;
    m.agreement.digest.a = draws.one_in(12) ? 2 : 1;
    return m;
}

Json digest_of(const Digest& digest) { return fmt::format("{} {} {}", digest.count, digest.a, digest.b); }

Json session(std::uint64_t seed, Device& device, const Scene& scene, const FrameRange& range) {
    Draws draws(seed);
    const auto& chosen = algorithm("tiled");
    std::vector<Cell> cells;
    std::vector<Measurement> measurements;
    for (std::uint64_t i = 0; i < 1 + draws.below(6); ++i) {
        measurements.push_back(made_up(draws));
        cells.push_back(
            make_cell(chosen, chosen.presets().front(), {{"k", draws.one_in(4) ? "18" : "8"}}, {&device}));
        measurements.back().settings = cells.back().settings;
    }
    std::vector<Row> rows;
    Json json{{"cells", Json::array()}, {"verdicts", Json::array()}, {"sentences", Json::array()}};
    std::vector<std::string> labels;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto& m = measurements[i];
        labels.push_back(fmt::format("cell {}", i));
        rows.push_back({&cells[i], &m, fmt::format("key {}", cells.size() - i)});
        json["cells"].push_back({{"key", rows.back().key},
                                 {"k", m.settings.texts().at("k")},
                                 {"ok", m.agreement.ok()},
                                 {"pairs", m.candidate_pairs[0] + m.candidate_pairs[1]},
                                 {"digest", digest_of(m.agreement.digest)},
                                 {"samples", m.totals()},
                                 {"rounds", m.rounds()}});
    }
    for (const auto& verdict : verdicts_of(rows)) {
        json["verdicts"].push_back(verdict_record(verdict, rows, scene, range));
        json["sentences"].push_back(verdict_sentence(verdict, rows, labels));
    }
    return json;
}

} // namespace
} // namespace tandem

int main(int, char** arguments) {
    using namespace tandem;
    const auto scene = make_scene("plates");
    const FrameRange range(scene, 0, 1);
    const std::vector<std::string> wanted{"host"};
    const auto backends = discover(wanted);
    for (std::uint64_t seed = 0; seed < std::stoull(arguments[1]); ++seed)
        fmt::print("{}\n", session(seed, *backends.front().devices.front(), scene, range).dump());
}
