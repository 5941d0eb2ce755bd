// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/scene.h"

#include <functional>
#include <memory>
#include <span>

namespace tandem {

/// Fills in the contacts of a frame in ascending order of (pair, feature).
using Detect = std::function<void(const Frame& frame, std::vector<ContactPoint>& contacts)>;

/// What one step did and how long each part of it took.
struct StepReport {
    std::size_t step = 0;                           ///< 0 is the first
    double time = 0;                                ///< s, at the end of the step
    double length = 0;                              ///< s
    std::size_t found = 0, kept = 0;                ///< contacts before and after reduction
    double deepest = 0;                             ///< largest penetration among them, >= 0
    double kinetic = 0, potential = 0, elastic = 0; ///< J, at the end of the step
    double energy_change = 0;                       ///< J, of their sum, in this step
    double lifted = 0;          ///< J, of that what corrections of positions added by lifting bodies
    std::size_t iterations = 0; ///< of the contact solver
    double residual = 0;        ///< N s, its last, as it tests it
    double tolerance = 0;       ///< N s, that the residual is to be below
    bool converged = true;      ///< it ended by a tolerance, not at its last iteration
    std::size_t inverted = 0;   ///< elements turned inside out
    std::int64_t detect_ns = 0, reduce_ns = 0, assemble_ns = 0, solve_ns = 0, move_ns = 0;

    /// s, that Simulation::midway() is of.
    double midway_time() const { return time - 0.5 * length; }
};

/// A scene with dynamics, in motion. State in double. Deterministic: the same scene and the same contacts
/// give the same bits, on any number of threads.
class Simulation {
public:
    /// `scene` must outlive the simulation. Throws InputError when its dynamics are impossible.
    explicit Simulation(const Scene& scene);
    ~Simulation();
    Simulation(Simulation&&) noexcept;
    Simulation& operator=(Simulation&&) noexcept;

    /// One time step; `detect` is called once with the frame of midway() (for deformables more often when a
    /// step is repeated). Throws InputError naming step, body and values when the motion diverges.
    StepReport step(const Detect& detect);
    std::size_t steps_done() const;

    /// The frame whose contacts the last step used: the one to record and measure.
    const Frame& midway() const;
    /// The frame at the end of the last step, or the start.
    Frame frame() const;

    /// Everything that the next step depends on, as bytes; restore() of them in a simulation of the same
    /// scene continues with the same bits. restore() throws InputError when they do not fit.
    std::vector<std::byte> state() const;
    void restore(std::span<const std::byte> bytes);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace tandem
