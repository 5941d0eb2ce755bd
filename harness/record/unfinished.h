// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/frames.h"
#include "harness/record/journal.h"
#include "harness/sampling/cell_state.h"

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

namespace tandem {

/// Rounds of cells that have no record yet, in a file FILE.unfinished beside that of the records: what a kill
/// costs is the round that it falls into. A line of it is what checking a cell gave, or one round.
class Unfinished {
public:
    /// Keeps nothing.
    Unfinished() = default;
    /// Beside a file of records at `path`; nowhere where that is none that lines can be taken from again.
    /// With `go_on` it reads what is there of this program's sources. Throws InputError when that cannot be
    /// read.
    Unfinished(const std::string& path, bool go_on);

    /// What is there of a cell, by the key of what was asked for; nothing for a cell that was not begun.
    CellState state(const Cell& cell, const std::string& key);
    /// The whole state, or its last round. That it cannot be written is told, and costs nothing else.
    void keep(const std::string& key, const CellState& state, bool whole);
    /// A cell of this run that has a record already.
    void forget(const std::string& key) { own_.insert(key); }
    /// Once all cells have a record: those of other cells, as of another plan that was killed, stay.
    void remove();

private:
    void append(nlohmann::ordered_json line);
    std::vector<nlohmann::ordered_json> of_others() const;

    std::string path_;
    std::unique_ptr<RecordFile> file_;
    std::map<std::string, std::vector<nlohmann::ordered_json>> lines_; ///< by key, from the last check on
    std::set<std::string> own_;                                        ///< keys of cells of this run
};

} // namespace tandem
