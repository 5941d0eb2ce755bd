// SPDX-License-Identifier: MIT
// A profile as a table and as a record.
#pragma once

#include "harness/profile/kernels.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem::profile {

/// A cell and its kernels.
struct Profile {
    std::vector<KernelProfile> kernels;
    FrameFacts facts;
    Limits limits;
    nlohmann::ordered_json const* ceilings = nullptr; ///< the record that the limits are of
    std::string ceilings_from;                        ///< "measured", or the file
};

/// Lines of at most 100 columns, a row a kernel; those below 1 % of the device time are one row, unless
/// `all`. Under it, what was held against what.
std::string profile_table(const Profile& profile, bool all);

/// What the columns are.
std::string profile_legend();

/// One object of results/profile.schema.json, from the ordinary record of the same cell.
nlohmann::ordered_json profile_record(const nlohmann::ordered_json& record, const Profile& profile);

} // namespace tandem::profile
