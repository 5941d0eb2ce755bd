// SPDX-License-Identifier: MIT
// Records as text, with what the comparison reads of them and nothing else.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <unistd.h>
#include <vector>

namespace tandem::compare {

using Records = std::vector<nlohmann::json>;

/// A record of schema 2 with these samples, in nanoseconds.
inline nlohmann::json record(const std::string& key, const std::vector<double>& samples) {
    const nlohmann::json device{{"id", "cuda:0"}, {"name", "GPU"}, {"driver", "1"}, {"kind", "gpu"}};
    const nlohmann::json digest{{"count", 3}, {"a", "0a"}, {"b", "0b"}};
    return {{"schema", 2},
            {"key", key},
            {"status", "ok"},
            {"failure", nullptr},
            {"algorithm", "chunked"},
            {"preset", "resident"},
            {"settings", {{"k", key}, {"rounding", "safe"}}},
            {"scene", {{"key", "pile:bodies=2,density=0.4"}, {"digest", "00ff"}}},
            {"frames", {{"first", 0}, {"last", 9}}},
            {"devices", {device}},
            {"total_ns", {{"samples", samples}}},
            {"work", {{"digest", digest}, {"contact_digest", digest}}},
            {"agreement", nullptr},
            {"error", nullptr},
            {"environment", {{"commit", "abc1"}, {"dirty", false}, {"processor", nullptr}}}};
}

/// One of schema 3: rounds of the samples, and the session.
inline nlohmann::json record(const std::string& key, const std::vector<double>& samples,
                             const std::vector<int>& rounds, const std::string& session) {
    auto json = record(key, samples);
    json["schema"] = 3;
    json["total_ns"]["rounds"] = rounds;
    json["session"] = session;
    json["sampling"] = {{"seed", 7}};
    return json;
}

/// A file that is there as long as this is.
class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& text) {
        auto name =
            (std::filesystem::temp_directory_path() / "tandem-compare-").string() + std::string(6, 'X');
        close(mkstemp(name.data()));
        path_ = name;
        std::ofstream(path_) << text;
    }
    explicit TemporaryFile(const Records& records) : TemporaryFile(lines(records)) {}
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    std::string path() const { return path_; }

    static std::string lines(const Records& records) {
        std::string text;
        for (const auto& one : records) text += one.dump() + "\n";
        return text;
    }

private:
    std::string path_;
};

} // namespace tandem::compare
