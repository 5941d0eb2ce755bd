// SPDX-License-Identifier: MIT
// Message passing between ranks; mpirun starts it with 1, 2 and 4 processes.
#include "backends/mpi/mpi_ranks.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using Bytes = Ranks::Bytes;

std::unique_ptr<Ranks> ranks;

/// `size` bytes that depend on the sender's rank.
Bytes bytes_of(int rank, std::size_t size) {
    Bytes bytes(size);
    for (std::size_t i = 0; i < size; ++i)
        bytes[i] = static_cast<std::byte>((i * 31 + static_cast<std::size_t>(rank)) % 251);
    return bytes;
}

TEST(Ranks, RankAndSizeMatchTheJob) {
    EXPECT_GE(ranks->rank(), 0);
    EXPECT_LT(ranks->rank(), ranks->size());
    EXPECT_EQ(ranks->is_first(), ranks->rank() == 0);
    if (const auto* size = std::getenv("EXPECTED_RANKS")) {
        EXPECT_EQ(ranks->size(), std::atoi(size));
    }
}

TEST(Ranks, BroadcastCopiesTheBytesOfOneRank) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{5'000'000}})
        for (int from = 0; from < ranks->size(); ++from) {
            auto bytes = ranks->rank() == from ? bytes_of(from, size) : Bytes(3);
            ranks->broadcast(bytes, from);
            EXPECT_EQ(bytes, bytes_of(from, size));
        }
}

TEST(Ranks, GatherReturnsTheBytesOfEveryRank) {
    const auto size_of = [](int rank) {
        return static_cast<std::size_t>(rank) * 70'000;
    }; // rank 0 sends nothing
    const auto all = ranks->gather_to_all(bytes_of(ranks->rank(), size_of(ranks->rank())));
    ASSERT_EQ(all.size(), static_cast<std::size_t>(ranks->size()));
    for (int rank = 0; rank < ranks->size(); ++rank)
        EXPECT_EQ(all[static_cast<std::size_t>(rank)], bytes_of(rank, size_of(rank)));
}

/// Messages longer than MPI's counts allow: they are sent in pieces, and pieces end both within a message and
/// at its end.
TEST(Ranks, LongMessagesAreSentInPieces) {
    const auto in_pieces = mpi_ranks(MPI_COMM_WORLD, 100);
    const auto rank = ranks->rank(), size = ranks->size();
    const auto size_of = [](int from, int to) { return static_cast<std::size_t>(100 * from + 37 * to); };
    const auto all = in_pieces->gather_to_all(bytes_of(rank, size_of(rank, 7)));
    ASSERT_EQ(all.size(), static_cast<std::size_t>(size));
    for (int from = 0; from < size; ++from)
        EXPECT_EQ(all[static_cast<std::size_t>(from)], bytes_of(from, size_of(from, 7)));
    for (const auto& nothing : in_pieces->gather_to_all({})) EXPECT_TRUE(nothing.empty());

    auto bytes = rank == 0 ? bytes_of(0, 1000) : Bytes();
    in_pieces->broadcast(bytes, 0);
    EXPECT_EQ(bytes, bytes_of(0, 1000));

    std::vector<Bytes> out;
    for (int to = 0; to < size; ++to) out.push_back(bytes_of(rank + to, size_of(rank + 1, to)));
    const auto in = in_pieces->exchange(out);
    for (int from = 0; from < size; ++from)
        EXPECT_EQ(in[static_cast<std::size_t>(from)], bytes_of(from + rank, size_of(from + 1, rank)));

    EXPECT_THROW(in_pieces->send(0, Bytes(101)), RanksError);
}

/// Several pieces between the same two ranks, in order; empty ones are allowed.
TEST(Ranks, PiecesArriveAtTheGivenAddresses) {
    std::vector<Bytes> memory;
    std::vector<Ranks::Piece> out, in;
    const auto size_of = [](int from, int to, int i) {
        return static_cast<std::size_t>(100 * from + 10 * to + i);
    };
    const auto rank = ranks->rank();
    memory.reserve(static_cast<std::size_t>(ranks->size()) * 6);
    for (int other = 0; other < ranks->size(); ++other)
        for (int i = 0; i < 3; ++i) {
            auto& sent = memory.emplace_back(bytes_of(rank + i, size_of(rank, other, i)));
            out.push_back({other, sent.data(), sent.size()});
            auto& received = memory.emplace_back(size_of(other, rank, i));
            in.push_back({other, received.data(), received.size()});
        }
    ranks->exchange_device(out, in);
    for (int other = 0; other < ranks->size(); ++other)
        for (int i = 0; i < 3; ++i)
            EXPECT_EQ(memory[static_cast<std::size_t>(other * 6 + i * 2 + 1)],
                      bytes_of(other + i, size_of(other, rank, i)));
}

/// The MPI library's own report, unless the environment overrides it.
TEST(Ranks, GpuAwarenessFollowsDeviceAndEnvironment) {
    const auto is_gpu_aware = [](const char* id) {
        DeviceInfo info;
        info.id = id;
        return ranks->is_gpu_aware(info);
    };
    EXPECT_TRUE(is_gpu_aware("host"));
    EXPECT_FALSE(is_gpu_aware("opencl:0"));
    setenv("TANDEM_MPI_CUDA", "1", 1);
    EXPECT_TRUE(is_gpu_aware("cuda:0"));
    setenv("TANDEM_MPI_CUDA", "0", 1);
    EXPECT_FALSE(is_gpu_aware("cuda:0"));
    unsetenv("TANDEM_MPI_CUDA");
}

/// Includes the rank itself; every third message is empty and one has megabytes.
TEST(Ranks, ExchangeDeliversEachMessageToItsRank) {
    const auto size_of = [](int from, int to) {
        const auto number = from * 4 + to;
        return number % 3 == 0 ? std::size_t{0}
               : number == 1   ? std::size_t{8'000'001}
                               : static_cast<std::size_t>(number);
    };
    std::vector<Bytes> out;
    for (int to = 0; to < ranks->size(); ++to)
        out.push_back(bytes_of(ranks->rank() * 4 + to, size_of(ranks->rank(), to)));
    for (int time = 0; time < 3; ++time) {
        const auto in = ranks->exchange(out);
        ASSERT_EQ(in.size(), out.size());
        for (int from = 0; from < ranks->size(); ++from)
            EXPECT_EQ(in[static_cast<std::size_t>(from)],
                      bytes_of(from * 4 + ranks->rank(), size_of(from, ranks->rank())));
    }
}

/// Messages of one sender stay in order, including an empty and a large one.
TEST(Ranks, MessagesArriveWholeAndInOrder) {
    const std::vector<std::size_t> sizes{4, 0, 3'000'000, 1};
    if (!ranks->is_first()) {
        for (const auto size : sizes) ranks->send(0, bytes_of(ranks->rank(), size));
    } else {
        std::vector<std::size_t> next(static_cast<std::size_t>(ranks->size()));
        for (std::size_t left = sizes.size() * (next.size() - 1); left > 0; --left) {
            const auto message = ranks->receive();
            auto& number = next[static_cast<std::size_t>(message.from)];
            ASSERT_LT(number, sizes.size());
            EXPECT_EQ(message.bytes, bytes_of(message.from, sizes[number++]));
        }
    }
    Bytes together(1);
    ranks->broadcast(together, 0);
    EXPECT_FALSE(ranks->probe());
}

TEST(Ranks, AMessageIsAvailableAfterItWasSent) {
    if (ranks->size() == 1) GTEST_SKIP() << "no other rank to send to";
    EXPECT_FALSE(ranks->probe());
    ranks->gather_to_all({});
    if (ranks->rank() == 1) ranks->send(0, bytes_of(1, 9));
    if (!ranks->is_first()) return;
    while (!ranks->probe()) {}
    const auto message = ranks->receive();
    EXPECT_EQ(message.from, 1);
    EXPECT_EQ(message.bytes, bytes_of(1, 9));
    EXPECT_FALSE(ranks->probe());
}

} // namespace
} // namespace tandem

int main(int argc, char** argv) {
    int given = MPI_THREAD_SINGLE;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &given);
    testing::InitGoogleTest(&argc, argv);
    tandem::ranks = tandem::mpi_ranks(MPI_COMM_WORLD);
    const int code = RUN_ALL_TESTS();
    tandem::ranks.reset();
    MPI_Finalize();
    return code;
}
