// SPDX-License-Identifier: MIT
// Records of every kind as the page shows them.
#pragma once

#include "harness/compare/cells.h"
#include "harness/report/interned.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tandem::report {

/// A record of one cell.
struct ShownCell {
    compare::RecordedCell recorded;
    std::string scene{}, scene_name{}, scene_digest{}; ///< key, name and digest of the scene
    double frames = 1;                                 ///< that a sample replays
    bool is_older = false;                             ///< a later record of its key is ok and stands for it
    Json row{};             ///< by cell_fields, the last but the label, which says what differs
    Json curve{}, rounds{}; ///< ms of each frame, and of a frame in each round; shown where there is room
};

/// What the columns of ShownCell::row are, and whether cells share values of it.
struct CellField {
    const char* name;
    bool is_shared = false;
};
extern const std::vector<CellField> cell_fields;

/// Everything that was read.
struct Records {
    std::vector<ShownCell> cells;
    std::size_t cell_records = 0; ///< records of cells that there were, shown or not
    Json profiles = Json::array(), ceilings = Json::array(), simulations = Json::array();
    Json files = Json::array();     ///< {name, cells, profiles, ceilings, simulations}
    std::vector<std::string> notes; ///< what a reader has to know: what was left out, lines that were cut off
};

/// At most so many cells are read; of more, one a key.
constexpr std::size_t most_cells = 6000;

/// Reads files of records of any kinds. Throws InputError: a file that is none, lines of other schemas.
Records read_records(const std::vector<std::string>& files, std::size_t most = most_cells);

/// A cell as its record has it; `line` and `file` say where that stands. Throws InputError.
ShownCell shown_cell(const nlohmann::json& record, const std::string& path, std::size_t line,
                     std::size_t file);

/// What the machine was like while a cell was sampled, and how its samples are to be taken, in words.
std::string conditions_text(const nlohmann::json& record);
std::string sampling_text(const nlohmann::json& record);

/// As the page draws them; `path` is where they are from.
Json shown_profile(const nlohmann::json& record, const std::string& path);
Json shown_ceilings(const nlohmann::json& record);

/// Lines of one simulation become curves of bounded length.
class Simulations {
public:
    void add(const nlohmann::json& line, const std::string& path);
    Json shown() const; ///< the first `most_runs`
    std::size_t left_out() const { return runs_.size() > most_runs ? runs_.size() - most_runs : 0; }

private:
    static constexpr std::size_t most_runs = 40;
    struct Run;
    std::vector<std::shared_ptr<Run>> runs_;
};

} // namespace tandem::report
