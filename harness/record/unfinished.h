// SPDX-License-Identifier: MIT
#pragma once

#include "harness/frames/frames.h"
#include "harness/record/journal.h"
#include "harness/sampling/cell_state.h"

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

namespace tandem {

/// Rounds of cells that have no record yet, in FILE.unfinished beside the record file FILE. A killed run
/// loses only its current round. Each line contains the result of checking a cell, or one round.
class Unfinished {
public:
    /// Stores nothing.
    Unfinished() = default;
    /// Uses the file beside the records at `path`; stores nothing when that is not a regular file. With
    /// `resume` it reads the lines that a program of the same sources has written, and throws InputError when
    /// that fails.
    Unfinished(const std::string& path, bool resume);

    /// The stored state of a cell, by the key of its requested settings; an empty state when there is none.
    CellState state(const Cell& cell, const std::string& key);
    /// Stores the whole state, or its last round. A failed write only prints a message and stops storing.
    void keep(const std::string& key, const CellState& state, bool whole);
    /// Marks a cell of this run that already has a record.
    void forget(const std::string& key) { own_.insert(key); }
    /// Removes the rounds of this run's cells; call it once all have a record. Rounds of other cells, such as
    /// those of another plan that was killed, stay.
    void remove();

private:
    void append(nlohmann::ordered_json line);
    std::vector<nlohmann::ordered_json> lines_of_other_cells() const;

    std::string path_;
    std::unique_ptr<RecordFile> file_;
    std::map<std::string, std::vector<nlohmann::ordered_json>> lines_; ///< by key, from the last check on
    std::set<std::string> own_;                                        ///< keys of this run's cells
};

} // namespace tandem
