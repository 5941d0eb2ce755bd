// SPDX-License-Identifier: MIT
#include "harness/simulate/session.h"

#include "harness/plans/cell_session.h"
#include "base/digest.h"
#include "scenes/dynamics_settings.h"
#include "base/error.h"

#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <random>
#include <string_view>

namespace tandem {

namespace {

/// Follows the digest in a checkpoint and precedes the number. Checkpoints of earlier programs have neither.
constexpr std::string_view session_mark = "session:";

std::uint64_t new_number() {
    std::random_device random;
    return std::uint64_t{random()} << 32 | random();
}

void append_bytes(std::vector<std::byte>& bytes, const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
}

} // namespace

SimulationSession::SimulationSession(const SimulateOptions& options, const Scene& scene, const Cell& cell)
    : settings_(describe(*scene.dynamics)), number_(new_number()) {
    // The settings that contacts depend on. Devices and schedules do not change them.
    const auto used = session_settings(cell, scene);
    for (const auto* name :
         {"k", "axes", "precision", "rounding", "placement", "origin", "contact_rule", "decision"})
        settings_ += fmt::format(" {}={}", name, used.text(name));
    if (options.recording.empty()) return;
    const auto header = recording_of(options.scene, scene, scene.dynamics->stepping.step);
    writer_.emplace(options.resume ? RecordingWriter::resume(options.recording, header)
                                   : RecordingWriter::create(options.recording, header));
}

void SimulationSession::restore(Simulation& simulation) {
    if (!writer_) return;
    const auto checkpoint = writer_->restore();
    // A new recording starts with a checkpoint of the state before the first step.
    if (!checkpoint) {
        save(simulation);
        return;
    }
    const auto own = digest_of(settings_);
    if (checkpoint->state.size() < sizeof own || std::memcmp(checkpoint->state.data(), &own, sizeof own) != 0)
        throw InputError(fmt::format("{}: was simulated with other settings than {}; resume it with its "
                                     "original settings",
                                     writer_->path(), settings_));
    simulation.restore(read_number(std::span(checkpoint->state).subspan(sizeof own)));
}

/// Reads the number at the beginning of a state and returns the rest, the state of the simulation.
std::span<const std::byte> SimulationSession::read_number(std::span<const std::byte> state) {
    constexpr auto bytes = session_mark.size() + sizeof number_;
    if (state.size() < bytes || std::memcmp(state.data(), session_mark.data(), session_mark.size()) != 0)
        return state;
    std::memcpy(&number_, state.data() + session_mark.size(), sizeof number_);
    return state.subspan(bytes);
}

void SimulationSession::append(const StepReport& report, const Frame& frame) {
    if (writer_) writer_->append(report.step, report.midway_time(), frame);
}

void SimulationSession::save(const Simulation& simulation) {
    if (!writer_) return;
    const auto own = digest_of(settings_);
    std::vector<std::byte> state;
    append_bytes(state, &own, sizeof own);
    append_bytes(state, session_mark.data(), session_mark.size());
    append_bytes(state, &number_, sizeof number_);
    const auto rest = simulation.state();
    state.insert(state.end(), rest.begin(), rest.end());
    writer_->checkpoint(simulation.steps_done(), state);
}

std::string session_name(std::uint64_t number) { return fmt::format("{:016x}", number); }

std::set<std::size_t> steps_recorded(const RecordFile& file, std::uint64_t session) {
    std::set<std::size_t> steps;
    const auto name = session_name(session);
    file.for_each([&](const nlohmann::ordered_json& line) {
        const auto found = line.find("session");
        if (found != line.end() && *found == name && line.value("kind", "") == "step")
            steps.insert(line.at("step").get<std::size_t>());
    });
    return steps;
}

} // namespace tandem
