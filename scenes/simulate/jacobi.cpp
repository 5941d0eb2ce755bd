// SPDX-License-Identifier: MIT
#include "scenes/simulate/solve.h"

#include "scenes/simulate/algebra.h"

#include <barrier>
#include <thread>

namespace tandem::simulate {

namespace {

/// One end of a contact at a node.
struct Touch {
    std::uint32_t row = 0;
    double weight = 0; ///< negative on side a
    Eigen::Vector3d arm;
};

/// Touches by node, in the order of rows, which fixes the order in which a node's impulses are added.
struct Touches {
    std::vector<std::size_t> first; ///< nodes + 1 elements
    std::vector<Touch> all;
};

/// Visits both ends of every contact. Impulses act on b, and in the opposite direction on a.
template<class Visit>
void for_each_touch(const Problem& problem, Visit visit) {
    for (std::uint32_t i = 0; i < problem.rows.size(); ++i) {
        const auto& row = problem.rows[i];
        for_each_node(problem, row.a, row.arm_a,
                      [&](std::uint32_t node, double weight, const Eigen::Vector3d& arm) {
                          visit(node, Touch{i, -weight, arm});
                      });
        for_each_node(problem, row.b, row.arm_b,
                      [&](std::uint32_t node, double weight, const Eigen::Vector3d& arm) {
                          visit(node, Touch{i, weight, arm});
                      });
    }
}

/// Counting sort of touches by node. Nodes that no impulse moves have none.
Touches gather(const Problem& problem) {
    Touches touches;
    touches.first.assign(problem.nodes.size() + 1, 0);
    const auto is_movable = [&](std::uint32_t node) { return problem.nodes[node].inverse_mass > 0; };
    for_each_touch(problem, [&](std::uint32_t node, const Touch&) {
        if (is_movable(node)) ++touches.first[node + 1];
    });
    for (std::size_t i = 1; i < touches.first.size(); ++i) touches.first[i] += touches.first[i - 1];
    touches.all.resize(touches.first.back());
    auto next = touches.first;
    for_each_touch(problem, [&](std::uint32_t node, const Touch& touch) {
        if (is_movable(node)) touches.all[next[node]++] = touch;
    });
    return touches;
}

/// A solve on several threads with barriers between phases. In a phase each thread writes only its own range.
class Jacobi {
public:
    Jacobi(Problem& problem, const SolverSettings& settings, unsigned threads)
        : problem_(problem),
          settings_(settings),
          convergence_(settings),
          touches_(gather(problem)),
          free_(problem.nodes),
          changes_(threads),
          barrier_(threads) {}

    SolveReport run() {
        std::vector<std::thread> workers;
        for (std::size_t i = 1; i < changes_.size(); ++i) workers.emplace_back([this, i] { work(i); });
        work(0);
        for (auto& thread : workers) thread.join();
        return report_;
    }

private:
    struct IndexRange {
        std::size_t begin, end;
    };

    /// Equal ranges by index, so that results do not depend on the schedule of threads.
    IndexRange range_of(std::size_t count, std::size_t thread) const {
        return {count * thread / changes_.size(), count * (thread + 1) / changes_.size()};
    }

    /// Main loop of every thread. A phase writes rows and reads nodes, or the reverse. Thread 0 tests
    /// convergence.
    void work(std::size_t thread) {
        move_nodes(thread);
        barrier_.arrive_and_wait();
        while (report_.iterations < settings_.iterations && !report_.converged) {
            changes_[thread] = update_rows(thread);
            barrier_.arrive_and_wait();
            if (thread == 0) judge();
            barrier_.arrive_and_wait();
            if (diverged_) undo(thread);
            if (diverged_) barrier_.arrive_and_wait();
            move_nodes(thread);
            barrier_.arrive_and_wait();
        }
    }

    double update_rows(std::size_t thread) {
        const auto range = range_of(problem_.rows.size(), thread);
        double change = 0;
        for (auto i = range.begin; i < range.end; ++i) {
            auto& row = problem_.rows[i];
            row.previous = row.impulse;
            row.impulse = proximal(row, problem_.velocity(row), convergence_.scale());
            change = std::max(change, (row.impulse - row.previous).cwiseAbs().maxCoeff());
        }
        return change;
    }

    void judge() {
        const auto verdict = convergence_.judge(*std::max_element(changes_.begin(), changes_.end()));
        report_.residual = convergence_.residual();
        ++report_.iterations;
        report_.converged = verdict == Convergence::Verdict::converged;
        diverged_ = verdict == Convergence::Verdict::diverged;
    }

    void undo(std::size_t thread) {
        const auto range = range_of(problem_.rows.size(), thread);
        for (auto i = range.begin; i < range.end; ++i) problem_.rows[i].impulse = problem_.rows[i].previous;
    }

    /// Computes velocities from the free velocities and all impulses, so that errors do not accumulate.
    void move_nodes(std::size_t thread) {
        const auto range = range_of(problem_.nodes.size(), thread);
        for (auto i = range.begin; i < range.end; ++i) {
            Eigen::Vector3d linear = Eigen::Vector3d::Zero();
            Eigen::Vector3d angular = Eigen::Vector3d::Zero();
            for (auto t = touches_.first[i]; t < touches_.first[i + 1]; ++t) {
                const auto& touch = touches_.all[t];
                const auto& row = problem_.rows[touch.row];
                const Eigen::Vector3d impulse = touch.weight * world(row, row.impulse);
                linear += impulse;
                angular += cross(touch.arm, impulse);
            }
            auto& node = problem_.nodes[i];
            node.velocity = free_[i].velocity + node.inverse_mass * linear;
            node.spin = free_[i].spin + apply(node.inverse_inertia, angular);
        }
    }

    Problem& problem_;
    const SolverSettings& settings_;
    Convergence convergence_;
    Touches touches_;
    std::vector<MovedNode> free_;
    std::vector<double> changes_; ///< one a thread
    std::barrier<> barrier_;
    SolveReport report_{.converged = false};
    bool diverged_ = false;
};

constexpr std::size_t rows_per_thread = 1000; ///< below this a thread costs more than it saves

} // namespace

SolveReport jacobi(Problem& problem, const SolverSettings& settings, unsigned threads) {
    const auto useful = std::max<std::size_t>(1, problem.rows.size() / rows_per_thread);
    return Jacobi(problem, settings, static_cast<unsigned>(std::min<std::size_t>(threads, useful))).run();
}

} // namespace tandem::simulate
