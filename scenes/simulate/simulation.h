// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/scene.h"

#include <functional>
#include <memory>
#include <span>

namespace tandem {

/// Callback that fills `contacts` with the contacts of `frame`, in ascending order of (pair, feature).
using Detect = std::function<void(const Frame& frame, std::vector<ContactPoint>& contacts)>;

/// Results and host times (ns) of one step. The times include all tries of an adaptive step.
struct StepReport {
    std::size_t step = 0;       ///< number of the step, from 0
    double time = 0;            ///< s, at the end of the step
    double length = 0;          ///< s
    std::size_t found = 0,      ///< contacts from Detect
        kept = 0;               ///< contacts after reduction
    double deepest = 0;         ///< m, largest penetration of kept contacts, >= 0
    double kinetic = 0,         ///< J, at the end of the step
        potential = 0,          ///< J, at the end of the step; 0 at the world's origin
        elastic = 0;            ///< J, at the end of the step
    double energy_change = 0;   ///< J, change of their sum in this step
    double lifted = 0;          ///< J, part of energy_change from corrections of positions
    std::size_t iterations = 0; ///< iterations of the contact solver
    double residual = 0;        ///< N s, residual that the solver compares with `tolerance`, at its end
    double tolerance = 0;       ///< N s, absolute tolerance of the solver
    bool converged = true;      ///< false: the solver reached its maximum of iterations
    std::size_t inverted = 0;   ///< number of inverted elements
    std::int64_t detect_ns = 0, ///< Detect, and checks of its contacts
        reduce_ns = 0,          ///< surface normals and reduction of contacts
        assemble_ns = 0,        ///< forces without contacts, and the solver's input
        solve_ns = 0,           ///< solution for contact forces
        move_ns = 0;            ///< motion, frames and corrections of positions

    /// Time (s) of Simulation::midway().
    double midway_time() const { return time - 0.5 * length; }
};

/// Simulates a scene with dynamics in double precision. Deterministic: the same scene and contacts give the
/// same bits on any number of threads.
class Simulation {
public:
    /// `scene` must outlive the simulation. Throws InputError when its dynamics are impossible.
    explicit Simulation(const Scene& scene);
    ~Simulation();
    /// Moves the state. Afterwards the argument can only be assigned to or destroyed.
    Simulation(Simulation&&) noexcept;
    /// As the move constructor; the previous state is lost.
    Simulation& operator=(Simulation&&) noexcept;

    /// Runs one time step. Calls `detect` with the frame of midway(): once, or several times when an adaptive
    /// step of deformables is repeated. Throws InputError with step, body and values when the motion
    /// diverges.
    StepReport step(const Detect& detect);
    /// Number of completed steps, with those before a restored state.
    std::size_t steps_done() const;

    /// The frame whose contacts the last step used; record and measure this one.
    const Frame& midway() const;
    /// The frame at the end of the last step, or the initial frame.
    Frame frame() const;

    /// The complete input of the next step as bytes. After restore() in a simulation of the same scene,
    /// results have the same bits.
    std::vector<std::byte> state() const;
    /// Continues from the bytes of state(); midway() is then frame(). Throws InputError when version, scene
    /// or size differ.
    void restore(std::span<const std::byte> bytes);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace tandem
