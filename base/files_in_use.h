// SPDX-License-Identifier: MIT
// Files that this process reads and writes, so that no output overwrites an input or a file of records. Files
// are compared by device and inode, through symbolic and hard links.
#pragma once

#include <string>

namespace tandem {

/// Exists while a program runs a command; a program has one instance. Without one, the functions below know
/// no inputs and no outputs.
class FilesInUse {
public:
    FilesInUse();
    ~FilesInUse();
    FilesInUse(const FilesInUse&) = delete;
    FilesInUse& operator=(const FilesInUse&) = delete;
};

/// Every reader of a mesh, a description, a plan or a recording calls this, with the file that it has opened.
/// Throws InputError if that is an output of this process. Thread-safe.
void note_input(const std::string& path);
/// A writer that stays open while other files are read calls this once its file is open: records and dumps.
/// Thread-safe.
void note_output(const std::string& path);

/// For a file that is open for writing and not yet truncated. Throws InputError if it is an input or another
/// output of this process, or a file of records. Does nothing for anything but a regular file.
void refuse_overwriting(int descriptor, const std::string& path);
/// For a file of records that is open for appending: throws InputError if it is an input of this process.
void refuse_appending(int descriptor, const std::string& path);

/// For a file that is written later: refuses it as refuse_overwriting() does, and a name that is too long, a
/// missing folder and a place that cannot be written. Throws InputError.
void check_output(const std::string& path);

/// Throws InputError for a name that no file can have, such as one of more than 255 bytes. For files that are
/// made beside an output.
void check_name(const std::string& path);

} // namespace tandem
