// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"
#include "harness/ranks/roster.h"

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace tandem {

/// Cells that go to a rank together and take turns there, so that drift of its machine is shared by them.
struct Hand {
    std::size_t group = 0;          ///< of the plan: its scene and frames
    std::vector<std::size_t> cells; ///< of that group
    Models models;                  ///< of the devices that they ask for
    std::set<int> refused_by{};     ///< ranks that could not open the scene
    std::string refusal{};          ///< the last one's reason
};

/// The cells of a group in hands: those whose times are compared, being on the same models with the same
/// bounds and output, in one; or each in one of its own.
std::vector<Hand> hands_of(std::size_t group, std::span<const Cell> cells, bool each_by_itself);

/// Which hand goes to whom next.
class Dealer {
public:
    explicit Dealer(const Roster& roster) : roster_(roster) {}

    void add(Hand hand) { waiting_.push_back(std::move(hand)); }
    /// The first that waits and that the rank has the devices for; none when there is none.
    std::optional<Hand> next(int rank);
    /// The rank takes none any more.
    void leave_out(int rank) { left_out_.insert(rank); }
    /// Those that no rank can take any more; they wait no longer.
    std::vector<Hand> take_undealable();
    bool is_empty() const { return waiting_.empty(); }

private:
    bool fits(const Hand& hand, int rank) const;

    const Roster& roster_;
    std::vector<Hand> waiting_;
    std::set<int> left_out_;
};

} // namespace tandem
