// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace tandem {

/// The folder of choices of `auto`, of cached checks, and of compiled kernels if the user names it.
struct CacheFolder {
    std::filesystem::path path; ///< empty: nothing is stored
    std::string problem;        ///< why a folder that is named or usual is not used; empty when it is
    bool is_refused = false;    ///< the user named it, and other users may have written to it
};

/// $TANDEM_KERNEL_CACHE, else $XDG_CACHE_HOME/tandem, else ~/.cache/tandem. Creates it, and tries to write in
/// it. A usual folder that other users can write to is not used and no problem: nobody named it.
CacheFolder find_cache_folder();

/// The path of find_cache_folder(). Throws InputError when the folder is refused.
std::filesystem::path cache_folder();

/// Prints the problem, if there is one, the first time that a process calls it: commands go on without the
/// folder. Throws InputError when the folder is refused.
void report_cache_folder();

} // namespace tandem
