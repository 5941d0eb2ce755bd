// SPDX-License-Identifier: MIT
#include "harness/record/journal.h"

#include "tests/support/folder.h"
#include "tests/support/test.h"

#include <csignal>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;
using Line = nlohmann::ordered_json;

/// Records of different lengths, some of several pages.
Line numbered(int writer, int number) {
    return {{"writer", writer},
            {"number", number},
            {"text", std::string(static_cast<std::size_t>(number % 7) * 2000, 'x')}};
}

/// Runs `act` in a child process, which exits with 0 unless `act` exits otherwise.
template<class Act>
pid_t start(Act act) {
    const auto child = fork();
    if (child == 0) {
        act();
        _exit(0);
    }
    return child;
}

int end_of(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return status;
}

class JournalFile : public FolderTest {
protected:
    std::string file() const { return path("run.jsonl"); }
    std::string torn() const { return file() + ".torn"; }

    /// Standard error output from opening a file with these bytes and appending {"new":1}.
    std::string after_appending(std::string_view bytes) const {
        write_bytes(file(), bytes);
        testing::internal::CaptureStderr();
        RecordFile(file()).append({{"new", 1}});
        return testing::internal::GetCapturedStderr();
    }
    std::string refusal(std::string_view bytes) const {
        write_bytes(file(), bytes);
        auto text = message_of([&] { RecordFile{file()}; });
        EXPECT_EQ(bytes_of(file()), bytes);
        EXPECT_FALSE(std::filesystem::exists(torn()));
        return text;
    }
};

TEST_F(JournalFile, SetsATornLineAside) {
    const auto message = after_appending("{\"a\":1}\n{\"b\":2}\n{\"c\":\"3");
    EXPECT_EQ(bytes_of(file()), "{\"a\":1}\n{\"b\":2}\n{\"new\":1}\n");
    EXPECT_EQ(bytes_of(torn()), "{\"c\":\"3\n");
    EXPECT_EQ(message,
              "tandem: " + file() + ": the last line was torn; its 7 bytes were moved to " + torn() + "\n");
    after_appending("{\"a\":1}\n" + std::string(200000, '\0'));
    EXPECT_EQ(bytes_of(file()), "{\"a\":1}\n{\"new\":1}\n");
    EXPECT_EQ(bytes_of(torn()), "{\"c\":\"3\n" + std::string(200000, '\0') + "\n");
}

TEST_F(JournalFile, SetsATornFirstLineAside) {
    const std::string zeros(200, '\0'); // content of unsynced bytes after a loss of power
    for (const auto& part :
         {std::string("{"), std::string("{\"a\":"), std::string("{\"a\":tru"), std::string("{\"a\":\"\xc3"),
          std::string("{\"a\":{\"b\":[1,"), zeros, "{\"a\":\"b" + zeros, "{\"a\":1}" + zeros}) {
        std::filesystem::remove(torn());
        after_appending(part);
        EXPECT_EQ(bytes_of(file()), "{\"new\":1}\n") << part;
        EXPECT_EQ(bytes_of(torn()), part + "\n");
    }
}

TEST_F(JournalFile, CompletesALineThatLacksOnlyItsEnd) {
    for (const std::string before : {"", "{\"a\":1}\n"}) {
        EXPECT_EQ(after_appending(before + "{\"b\":\"{\"}"), "");
        EXPECT_EQ(bytes_of(file()), before + "{\"b\":\"{\"}\n{\"new\":1}\n");
    }
    EXPECT_FALSE(std::filesystem::exists(torn()));
}

TEST_F(JournalFile, KeepsAFileWithoutATornLine) {
    for (const std::string before : {"", "{\"a\":1}\n", "{\"a\":1}\nnoise\n\n"}) {
        EXPECT_EQ(after_appending(before), "");
        EXPECT_EQ(bytes_of(file()), before + "{\"new\":1}\n");
    }
}

TEST_F(JournalFile, RefusesFilesThatAreNotJsonLines) {
    for (const std::string_view bytes :
         {"text\n", "text", "[1]\n", "12\n", "\n", "{\"a\":1} {\n", "{\n  \"a\": 1\n}\n", "{\"a\":1e999}\n",
          "{\"a\":x", "frame,body_a\n{\"a\":1}\n"}) {
        EXPECT_EQ(refusal(bytes),
                  file()
                      + ": its first line is not a JSON object, so no records are appended; choose "
                        "another --out");
    }
    EXPECT_THAT(refusal(std::string("\x7f\x45LF\0\0\0{\n", 9)), HasSubstr("not a JSON object"));
    EXPECT_THAT(refusal(std::string("{\0\0\0\n", 5)), HasSubstr("not a JSON object"));
}

TEST_F(JournalFile, RefusesFilesThatCannotBeWritten) {
    EXPECT_EQ(message_of([&] { RecordFile{path("")}; }),
              path("") + ": cannot be written (Is a directory); choose another --out");
    EXPECT_THAT(message_of([&] { RecordFile{path("no/file")}; }), HasSubstr("No such file"));
    EXPECT_THAT(message_of([&] { RecordFile{"/dev/fd/987"}; }), HasSubstr("Bad file descriptor"));
    write_bytes(file(), "{\"a\":1}\n");
    chmod(file().c_str(), 0444);
    const auto child = start([&] {
        if (getuid() == 0 && setuid(65534) != 0) _exit(2);
        _exit(message_of([&] { RecordFile{file()}; }).find("Permission denied") == std::string::npos ? 1 : 0);
    });
    EXPECT_EQ(end_of(child), 0);
    EXPECT_EQ(bytes_of(file()), "{\"a\":1}\n");
}

TEST_F(JournalFile, DoesNotFollowLinks) {
    write_bytes(path("else"), "mine");
    for (const bool dangling : {false, true}) {
        std::filesystem::remove(torn());
        std::filesystem::create_symlink(path(dangling ? "new" : "else"), torn());
        write_bytes(file(), "{\"a\":1}\n{");
        EXPECT_THAT(message_of([&] { RecordFile{file()}; }), HasSubstr(torn() + ": cannot be written"));
        EXPECT_EQ(bytes_of(file()), "{\"a\":1}\n{");
    }
    EXPECT_EQ(bytes_of(path("else")), "mine");
    EXPECT_FALSE(std::filesystem::exists(path("new")));
    std::filesystem::remove(torn());
    ASSERT_EQ(mkfifo(torn().c_str(), 0600), 0);
    EXPECT_NE(message_of([&] { RecordFile{file()}; }), "no error");
}

TEST_F(JournalFile, FullDevice) {
    RecordFile full("/dev/full");
    EXPECT_THROW(full.append({{"a", 1}}), OutputError);
    EXPECT_TRUE(full.failed());
    testing::internal::CaptureStderr();
    EXPECT_FALSE(full.append_or_report({{"a", 1}}));
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "tandem: /dev/full: writing failed (No space left on device); earlier records are complete\n");
    EXPECT_EQ(full.appended(), 0u);
}

TEST_F(JournalFile, RemovesAShortWrite) {
    const auto child = start([&] {
        std::signal(SIGXFSZ, SIG_IGN);
        RecordFile records(file());
        records.append(numbered(0, 1));
        const rlimit limit{3000, 3000};
        setrlimit(RLIMIT_FSIZE, &limit);
        try {
            records.append(numbered(0, 2));
        } catch (const OutputError& error) {
            const std::string_view what = error.what();
            records.append({{"small", 1}});
            _exit(what.find("File too large") == std::string_view::npos ? 1 : 0);
        }
        _exit(2);
    });
    EXPECT_EQ(end_of(child), 0);
    EXPECT_EQ(bytes_of(file()), numbered(0, 1).dump() + "\n{\"small\":1}\n");
    EXPECT_FALSE(std::filesystem::exists(torn()));
}

TEST_F(JournalFile, LinesOfProcessesDoNotMix) {
    constexpr int lines = 500;
    pid_t children[2];
    for (int writer = 0; writer < 2; ++writer)
        children[writer] = start([&] {
            RecordFile records(file());
            for (int i = 0; i < lines; ++i) records.append(numbered(writer, i));
        });
    for (const auto child : children) EXPECT_EQ(end_of(child), 0);
    int next[2] = {0, 0};
    RecordFile(file()).for_each([&](const Line& line) {
        const int writer = line["writer"];
        EXPECT_EQ(line, numbered(writer, next[writer]++));
    });
    EXPECT_EQ(next[0], lines);
    EXPECT_EQ(next[1], lines);
    EXPECT_FALSE(std::filesystem::exists(torn()));
}

/// An incomplete line is not torn while its process has the lock.
TEST_F(JournalFile, WaitsForTheLockOfAnotherProcess) {
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    const auto child = start([&] {
        const int other = open(file().c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
        flock(other, LOCK_EX);
        bool good = write(other, "{\"half\":", 8) == 8 && write(ready[1], "x", 1) == 1;
        usleep(200000);
        good = good && write(other, "1}\n", 3) == 3;
        _exit(good ? 0 : 1);
    });
    char byte = 0;
    ASSERT_EQ(read(ready[0], &byte, 1), 1);
    RecordFile(file()).append({{"new", 1}});
    EXPECT_EQ(end_of(child), 0);
    EXPECT_EQ(bytes_of(file()), "{\"half\":1}\n{\"new\":1}\n");
    for (const int end : ready) close(end);
}

TEST_F(JournalFile, RemovesATornLineOfAnotherProcess) {
    RecordFile records(file());
    records.append({{"a", 1}});
    std::ofstream(file(), std::ios::app) << "{\"b\":";
    testing::internal::CaptureStderr();
    records.append({{"c", 3}});
    testing::internal::GetCapturedStderr();
    EXPECT_EQ(bytes_of(file()), "{\"a\":1}\n{\"c\":3}\n");
    EXPECT_EQ(bytes_of(torn()), "{\"b\":\n");
}

TEST_F(JournalFile, KilledAtAnyMoment) {
    int next = 0;
    for (int round = 0; round < 50; ++round) {
        int reported[2];
        ASSERT_EQ(pipe(reported), 0);
        const auto child = start([&] {
            RecordFile records(file());
            for (int i = next;; ++i) {
                records.append(numbered(round, i));
                if (write(reported[1], &i, sizeof i) != sizeof i) _exit(1);
            }
        });
        // Kill after the first line, at a varying moment.
        int last = 0;
        ASSERT_EQ(read(reported[0], &last, sizeof last), static_cast<ssize_t>(sizeof last));
        usleep(static_cast<useconds_t>(round * 37 % 500));
        kill(child, SIGKILL);
        EXPECT_TRUE(WIFSIGNALED(end_of(child)));
        close(reported[1]);
        while (read(reported[0], &last, sizeof last) == static_cast<ssize_t>(sizeof last)) {}
        close(reported[0]);
        // Every record for which append() returned is in the file, in order.
        int found = 0;
        RecordFile(file()).for_each([&](const Line& line) {
            EXPECT_EQ(line, numbered(line["writer"], found));
            ++found;
        });
        EXPECT_GT(found, last);
        EXPECT_LE(found, last + 2);
        next = found;
    }
}

TEST_F(JournalFile, PipesAndDescriptorsAreWrittenUnchanged) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    RecordFile(fmt::format("/dev/fd/{}", ends[1])).append({{"a", 1}});
    char text[20] = {};
    EXPECT_EQ(read(ends[0], text, sizeof text), 8);
    EXPECT_STREQ(text, "{\"a\":1}\n");
    for (const int end : ends) close(end);
    // Writing starts at the descriptor's own file offset.
    const int own = open(file().c_str(), O_WRONLY | O_CREAT, 0644);
    EXPECT_EQ(write(own, "head\n", 5), 5);
    RecordFile(fmt::format("/dev/fd/{}", own)).append({{"a", 1}});
    EXPECT_EQ(write(own, "tail\n", 5), 5);
    close(own);
    EXPECT_EQ(bytes_of(file()), "head\n{\"a\":1}\ntail\n");
}

} // namespace
} // namespace tandem
