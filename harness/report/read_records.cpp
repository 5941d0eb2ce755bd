// SPDX-License-Identifier: MIT
#include "harness/compare/each_line.h"
#include "harness/report/records.h"
#include "scenes/error.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <map>

namespace tandem::report {

namespace {

using Record = nlohmann::json;

enum class Kind { cell, profile, simulation, ceilings };

constexpr std::string_view what_writes_them =
    "give files that 'tandem run --out', 'profile --out', 'simulate --record' or 'devices --measure --out' "
    "wrote";

Kind kind_of(const Record& record, const std::string& path, std::size_t line) {
    if (record.is_object()) {
        const auto kind = record.value("kind", Record());
        if (kind == "step" || kind == "run") return Kind::simulation;
        if (record.contains("profile_of")) return Kind::profile;
        if (record.contains("key")) return Kind::cell;
        if (record.contains("copy_bytes_per_s")) return Kind::ceilings;
    }
    throw InputError(fmt::format("{}:{}: is {}; {}", path, line,
                                 record.is_discarded() ? "not JSON" : "no record of tandem",
                                 what_writes_them));
}

/// Cells are checked by who reads them.
void check_version(Kind kind, const Record& record, const std::string& path, std::size_t line) {
    const int known = kind == Kind::simulation ? 2 : 1;
    const auto schema = record.value("schema", Record());
    if (kind != Kind::cell && schema != known)
        throw InputError(fmt::format("{}:{}: a record of schema {}, and this program knows {}; bring it to "
                                     "that with scripts/convert_records",
                                     path, line, schema.dump(), known));
}

/// Reads file after file.
class Reader {
public:
    explicit Reader(std::size_t most) : most_(most) {}

    void read(const std::string& path);
    Records finish();

private:
    void take(const Record& record, const std::string& path, std::size_t line);
    void take_cell(ShownCell cell);
    void keep_newest();

    static constexpr std::size_t most_others = 200; ///< profiles, and records of ceilings

    std::size_t most_;
    Records records_;
    Simulations simulations_;
    std::map<std::string, std::size_t> newest_; ///< of each key the record that stands for it
    bool one_a_key_ = false;
    std::size_t older_ = 0, others_ = 0, left_out_wrong_ = 0, left_out_ = 0;
};

void Reader::read(const std::string& path) {
    records_.files.push_back({{"name", std::filesystem::path(path).filename().string()},
                              {"cells", 0},
                              {"profiles", 0},
                              {"simulations", 0},
                              {"ceilings", 0}});
    std::size_t lines = 0;
    const bool torn = compare::each_line(path, [&](const std::string& text, std::size_t line) {
        if (line == 1
            && text.starts_with("\xfd"
                                "7zXZ"))
            throw InputError(fmt::format("{}: is packed; unpack it first: xz -dk {}", path, path));
        lines = line;
        take(Record::parse(text, nullptr, false), path, line);
    });
    if (lines == 0)
        throw InputError(fmt::format("{}: {}; name a file of records", path,
                                     torn ? "its only line has no end" : "is empty"));
    if (torn)
        records_.notes.push_back(
            fmt::format("{}:{}: the last line has no end, being cut off or still written: it is ignored",
                        path, lines + 1));
}

void Reader::take(const Record& record, const std::string& path, std::size_t line) {
    constexpr std::array names{"cells", "profiles", "simulations", "ceilings"};
    const auto kind = kind_of(record, path, line);
    check_version(kind, record, path, line);
    auto& count = records_.files.back()[names[static_cast<std::size_t>(kind)]];
    count = count.get<std::size_t>() + 1;
    try {
        if (kind == Kind::cell) return take_cell(shown_cell(record, path, line, records_.files.size() - 1));
        if (kind == Kind::simulation) return simulations_.add(record, path);
        auto& into = kind == Kind::profile ? records_.profiles : records_.ceilings;
        if (into.size() == most_others)
            ++others_;
        else
            into.push_back(kind == Kind::profile ? shown_profile(record, path) : shown_ceilings(record));
    } catch (const Record::exception&) {
        throw InputError(
            fmt::format("{}:{}: a record that lacks fields of its schema; {}", path, line, what_writes_them));
    }
}

void Reader::take_cell(ShownCell cell) {
    ++records_.cell_records;
    const auto found = newest_.find(cell.recorded.key);
    if (!one_a_key_ && records_.cells.size() == most_) keep_newest();
    if (one_a_key_ && found != newest_.end()) {
        ++older_;
        auto& known = records_.cells[newest_.at(cell.recorded.key)];
        if (cell.recorded.status == "ok" || known.recorded.status != "ok") known = std::move(cell);
        return;
    }
    if (records_.cells.size() == most_) {
        ++left_out_;
        left_out_wrong_ += cell.recorded.status == "ok" ? 0 : 1;
        return;
    }
    const auto index = records_.cells.size();
    const bool is_ok = cell.recorded.status == "ok";
    if (found == newest_.end()) {
        newest_.emplace(cell.recorded.key, index);
    } else if (is_ok || records_.cells[found->second].recorded.status != "ok") {
        records_.cells[found->second].is_older = true;
        found->second = index;
    } else {
        cell.is_older = true;
    }
    records_.cells.push_back(std::move(cell));
}

/// From now on one record a key.
void Reader::keep_newest() {
    one_a_key_ = true;
    const auto before = records_.cells.size();
    std::erase_if(records_.cells, [](const auto& cell) { return cell.is_older; });
    older_ += before - records_.cells.size();
    for (std::size_t i = 0; i < records_.cells.size(); ++i) newest_[records_.cells[i].recorded.key] = i;
}

Records Reader::finish() {
    auto& notes = records_.notes;
    if (older_ > 0)
        notes.push_back(
            fmt::format("{} older records of cells that were recorded again are left out", older_));
    if (left_out_ > 0)
        notes.push_back(
            fmt::format("{} of {} records of cells are left out, {} of them failed or wrong: a page "
                        "has room for {}; give fewer files, or the lines that matter",
                        left_out_, records_.cell_records, left_out_wrong_, most_));
    if (others_ > 0)
        notes.push_back(
            fmt::format("{} profiles or records of ceilings are left out: there is room for {} of "
                        "each",
                        others_, most_others));
    if (simulations_.left_out() > 0)
        notes.push_back(fmt::format("the last {} simulations are left out", simulations_.left_out()));
    records_.simulations = simulations_.shown();
    return std::move(records_);
}

} // namespace

Records read_records(const std::vector<std::string>& files, std::size_t most) {
    Reader reader(most);
    for (const auto& file : files) reader.read(file);
    return reader.finish();
}

} // namespace tandem::report
