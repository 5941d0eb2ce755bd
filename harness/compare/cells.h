// SPDX-License-Identifier: MIT
// Files of records, as far as they are compared: results/record.schema.json says what the fields mean.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tandem::compare {

/// Samples that were taken after one preparation of the session.
struct Round {
    std::int64_t number = 0;
    double ns = 0; ///< the median of its samples, above 0
};

/// A digest of pairs or contacts as it stands in a record; nothing where the record has none.
struct Answer {
    std::uint64_t count = 0;
    std::string a, b;
    bool operator==(const Answer&) const = default;
};

/// A record of one cell.
struct RecordedCell {
    std::size_t line = 0; ///< in its file, from 1
    int schema = 0;
    std::string key, status, failure;
    /// What names it, the most telling first: algorithm, preset, devices, their models and drivers, scene,
    /// frames, handling of flawed tetrahedra, digest of the scene; {what it is, as it is shown}.
    std::vector<std::pair<std::string, std::string>> names;
    std::map<std::string, std::string> settings; ///< and parameters of the scene
    bool on_gpus = false;                        ///< all its devices are
    std::string session;                         ///< empty: not known
    std::optional<std::uint64_t> seed;           ///< of the order of its samples
    std::size_t samples = 0;
    std::vector<Round> rounds; ///< ascending; with schema 2 every sample is one
    std::optional<Answer> pairs, contacts;
    std::string commit, processor; ///< empty: not known
    bool dirty = false;            ///< built from more than the commit
};

/// The record that is the text of one line. Throws InputError: PATH:LINE, what it is instead and what to do.
RecordedCell read_cell(const std::string& text, const std::string& path, std::size_t line);
/// Likewise of a line that has been parsed.
RecordedCell read_parsed_cell(const nlohmann::json& record, const std::string& path, std::size_t line);

/// The records of one file, or of one commit in it.
struct RecordedCells {
    std::string path, commit;           ///< commit: the whole one, where one was asked for
    std::vector<RecordedCell> cells;    ///< one a key, the last one that is ok, in order of first lines
    std::vector<RecordedCell> left_out; ///< failed, wrong, or without samples
    std::vector<std::string> commits;   ///< of `cells`, in order
    std::size_t records = 0;
    std::size_t repeated = 0; ///< keys with several records that are ok
    bool torn = false;        ///< the last line had no end and was ignored
};

/// Reads `file`: a path, or PATH@COMMIT where no such file exists; `commit`, or what stands behind the @, is
/// the beginning of the one commit whose records count; empty: all do. Throws InputError.
RecordedCells read_cells(const std::string& file, const std::string& commit);

} // namespace tandem::compare
