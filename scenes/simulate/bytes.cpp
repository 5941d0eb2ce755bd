// SPDX-License-Identifier: MIT
#include "scenes/simulate/bytes.h"

#include "base/error.h"

#include <cstring>
#include <fmt/format.h>

namespace tandem::simulate {

namespace {

constexpr std::uint64_t version = 0x74616e64656d0001; ///< "tandem", 1; also identifies the byte order

class Writer {
public:
    template<class Value>
    void operator()(const Value& value) {
        static_assert(std::is_arithmetic_v<Value>);
        const auto offset = bytes_.size();
        bytes_.resize(offset + sizeof value);
        std::memcpy(bytes_.data() + offset, &value, sizeof value);
    }

    std::vector<std::byte> take() { return std::move(bytes_); }

private:
    std::vector<std::byte> bytes_;
};

class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    template<class Value>
    void operator()(Value& value) {
        static_assert(std::is_arithmetic_v<Value>);
        require(sizeof value);
        std::memcpy(&value, bytes_.data(), sizeof value);
        bytes_ = bytes_.subspan(sizeof value);
    }

    void require(std::size_t count) const {
        if (bytes_.size() < count) throw InputError("the saved state of the simulation ends too early");
    }
    std::size_t remaining() const { return bytes_.size(); }

private:
    std::span<const std::byte> bytes_;
};

// One list of fields defines both directions: Visitor is a Writer of const state or a Reader of mutable
// state.

template<class Visitor, class Vector>
void vector3(Visitor& visit, Vector& v) {
    for (int i = 0; i < 3; ++i) visit(v[i]);
}

template<class Visitor, class State>
void rigid_state(Visitor& visit, State& state) {
    for (int i = 0; i < 4; ++i) visit(state.rotation.coeffs()[i]);
    vector3(visit, state.centre);
    vector3(visit, state.velocity);
    vector3(visit, state.angular);
}

template<class Visitor, class State>
void soft_state(Visitor& visit, State& state) {
    for (auto& position : state.positions) vector3(visit, position);
    for (auto& velocity : state.velocities) vector3(visit, velocity);
}

template<class Visitor, class Kept>
void impulse(Visitor& visit, Kept& kept) {
    visit(kept.pair.body_a);
    visit(kept.pair.tet_a);
    visit(kept.pair.body_b);
    visit(kept.pair.tet_b);
    visit(kept.feature);
    vector3(visit, kept.value);
}

constexpr std::size_t impulse_bytes = 5 * sizeof(std::uint32_t) + 3 * sizeof(double);

template<class Visitor, class Time>
void clock_state(Visitor& visit, Time& clock) {
    visit(clock.steps);
    visit(clock.time);
    visit(clock.length);
    visit(clock.passes);
}

/// Fixed bodies have no state. The model defines the sizes of all other states, so that no lengths are
/// stored.
template<class Visitor, class Moving>
void bodies(Visitor& visit, const Model& model, Moving& motion) {
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        if (model.bodies[i].kind == BodyKind::rigid) rigid_state(visit, motion.rigid[i]);
        if (model.bodies[i].kind == BodyKind::soft) soft_state(visit, motion.soft[i]);
    }
    visit(motion.length);
}

} // namespace

std::vector<std::byte> to_bytes(const Model& model, const MotionState& motion, const Clock& clock) {
    Writer write;
    write(version);
    write(model.scene->digest);
    clock_state(write, clock);
    bodies(write, model, motion);
    write(static_cast<std::uint64_t>(motion.impulses.size()));
    for (const auto& kept : motion.impulses) impulse(write, kept);
    return write.take();
}

void from_bytes(const Model& model, std::span<const std::byte> bytes, MotionState& motion, Clock& clock) {
    Reader read(bytes);
    std::uint64_t found = 0, digest = 0, impulses = 0;
    read(found);
    read(digest);
    if (found != version) throw InputError("the saved state is of another version or byte order of tandem");
    if (digest != model.scene->digest)
        throw InputError(
            fmt::format("the saved state belongs to a scene of digest {:016x}, not to '{}' ({:016x})", digest,
                        model.scene->name, model.scene->digest));
    // Allocates the states. The arguments change only when everything was read.
    MotionState result = starting_motion(model);
    Clock time;
    clock_state(read, time);
    bodies(read, model, result);
    read(impulses);
    if (read.remaining() % impulse_bytes != 0 || read.remaining() / impulse_bytes != impulses)
        throw InputError(fmt::format("the saved state has {} bytes for {} impulses of {}", read.remaining(),
                                     impulses, impulse_bytes));
    result.impulses.resize(impulses);
    for (auto& kept : result.impulses) impulse(read, kept);
    motion = std::move(result);
    clock = time;
}

} // namespace tandem::simulate
