// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace tandem {

/// Options of `tandem devices`.
struct DevicesOptions {
    bool json = false;                ///< one JSON document instead of lines
    bool measure = false;             ///< measure the ceilings of each device
    std::vector<std::string> devices; ///< measure only these; empty: all
    std::string out;                  ///< append records of ceilings to this file
    std::vector<std::string> require; ///< as in RunOptions
};

/// Options of `tandem algorithms`.
struct AlgorithmsOptions {
    std::vector<std::string> names; ///< explain these; empty: list all
    bool json = false;              ///< one JSON document instead of lines
};

/// Each prints what there is. Returns the exit code: 0 ok, 1 a check failed, 3 a device failed. Bad use
/// throws InputError.
int devices_command(const DevicesOptions& options);
int scenes_command(bool json);
int algorithms_command(const AlgorithmsOptions& options);

/// The names of the settings of all algorithms, each once.
std::vector<std::string> setting_names();
/// Prints what a setting does, its values, and those in the presets of each algorithm. Throws InputError for
/// an unknown name.
void explain_setting(const std::string& name);
/// Prints a line for each setting.
void list_settings();

} // namespace tandem
