// SPDX-License-Identifier: MIT
// record_schema FOLDER: writes the committed files that are made of the declarations of fields below the
// folder, which is the root of the tree for scripts/schema.
#include "harness/record/schema.h"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace {

void write(const std::filesystem::path& path, const std::string& text) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

} // namespace

int main(int count, char** arguments) {
    using namespace tandem::record_parts;
    try {
        if (count != 2) throw std::runtime_error("usage: record_schema FOLDER");
        const std::filesystem::path root = arguments[1];
        write(root / "results/record.schema.json", record_schema_text());
        write(root / "results/verdict.schema.json", verdict_schema_text());
        write(root / "python/tandem/fields.json", columns_text(record_type()));
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "record_schema: {}\n", error.what());
        return 2;
    }
}
