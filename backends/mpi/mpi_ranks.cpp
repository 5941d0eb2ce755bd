// SPDX-License-Identifier: MIT
#include "backends/mpi/mpi_ranks.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <dlfcn.h>
#include <fmt/format.h>
#include <numeric>
#include <string_view>

namespace tandem {

namespace {

enum Tag { exchange_tag = 1, send_tag, device_tag };

void check(int code, std::string_view call) {
    if (code == MPI_SUCCESS) return;
    std::array<char, MPI_MAX_ERROR_STRING> text{};
    int length = 0;
    if (MPI_Error_string(code, text.data(), &length) != MPI_SUCCESS) length = 0;
    throw RanksError(fmt::format("MPI: {}: {}", call,
                                 length > 0 ? std::string_view(text.data(), static_cast<std::size_t>(length))
                                            : std::string_view("unknown error")));
}

/// Queried at run time, because the library may differ from the one at compile time. TANDEM_MPI_CUDA
/// overrides the answer of a library that does not report it, such as Open MPI over a UCX with GPU support.
bool is_cuda_aware() {
    if (const auto* setting = std::getenv("TANDEM_MPI_CUDA")) return std::string_view(setting) == "1";
    using Query = int (*)();
    const auto query = reinterpret_cast<Query>(dlsym(RTLD_DEFAULT, "MPIX_Query_cuda_support"));
    return query != nullptr && query() == 1;
}

class MpiRanks final : public Ranks {
public:
    MpiRanks(MPI_Comm communicator, std::size_t max_piece_bytes) : max_piece_bytes_(max_piece_bytes) {
        check(MPI_Comm_dup(communicator, &communicator_), "MPI_Comm_dup");
        check(MPI_Comm_set_errhandler(communicator_, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
        check(MPI_Comm_rank(communicator_, &rank_), "MPI_Comm_rank");
        check(MPI_Comm_size(communicator_, &size_), "MPI_Comm_size");
    }
    ~MpiRanks() override { MPI_Comm_free(&communicator_); }

    int rank() const override { return rank_; }
    int size() const override { return size_; }

    void broadcast(Bytes& bytes, int from) override;
    std::vector<Bytes> gather_to_all(std::span<const std::byte> own) override;
    std::vector<Bytes> exchange(const std::vector<Bytes>& out) override;
    bool is_gpu_aware(const DeviceInfo& info) const override;
    void exchange_device(std::span<const Piece> out, std::span<const Piece> in) override;
    void send(int to, std::span<const std::byte> bytes) override;
    Received receive() override;
    bool probe() override;
    [[noreturn]] void abort(int code) override {
        MPI_Abort(communicator_, code);
        std::_Exit(code); // MPI_Abort is not declared [[noreturn]]
    }

private:
    std::vector<std::uint64_t> exchange_sizes(const std::vector<Bytes>& out);

    /// Calls work(offset, count) for each piece of at most max_piece_bytes_ bytes.
    template<class Work>
    void in_pieces(std::size_t bytes, const Work& work) const {
        for (std::size_t offset = 0; offset < bytes; offset += max_piece_bytes_)
            work(offset, static_cast<int>(std::min(bytes - offset, max_piece_bytes_)));
    }

    const std::size_t max_piece_bytes_;
    MPI_Comm communicator_ = MPI_COMM_NULL;
    int rank_ = 0, size_ = 1;
};

void MpiRanks::broadcast(Bytes& bytes, int from) {
    std::uint64_t size = bytes.size();
    check(MPI_Bcast(&size, 1, MPI_UINT64_T, from, communicator_), "MPI_Bcast");
    bytes.resize(size);
    in_pieces(size, [&](std::size_t offset, int count) {
        check(MPI_Bcast(bytes.data() + offset, count, MPI_BYTE, from, communicator_), "MPI_Bcast");
    });
}

/// Gathers in several rounds when the total exceeds the counts of one call. Each round takes equally much of
/// every rank.
std::vector<Ranks::Bytes> MpiRanks::gather_to_all(std::span<const std::byte> own) {
    const auto ranks = static_cast<std::size_t>(size_);
    const std::uint64_t length = own.size();
    std::vector<std::uint64_t> lengths(ranks);
    check(MPI_Allgather(&length, 1, MPI_UINT64_T, lengths.data(), 1, MPI_UINT64_T, communicator_),
          "MPI_Allgather");
    const auto total = std::accumulate(lengths.begin(), lengths.end(), std::uint64_t{0});
    const auto longest = std::ranges::max(lengths);
    const auto piece =
        total <= max_piece_bytes_ ? longest : std::max<std::uint64_t>(max_piece_bytes_ / ranks, 1);
    std::vector<Bytes> parts(ranks);
    for (std::size_t i = 0; i < ranks; ++i) parts[i].reserve(lengths[i]);
    std::vector<int> counts(ranks), starts(ranks);
    Bytes all;
    for (std::uint64_t offset = 0; offset < longest; offset += piece) {
        std::size_t end = 0;
        for (std::size_t i = 0; i < ranks; ++i) {
            starts[i] = static_cast<int>(end);
            counts[i] = static_cast<int>(std::min(lengths[i] - std::min(lengths[i], offset), piece));
            end += static_cast<std::size_t>(counts[i]);
        }
        all.resize(end);
        const auto* from = own.data() + std::min(length, offset);
        check(MPI_Allgatherv(from, counts[static_cast<std::size_t>(rank_)], MPI_BYTE, all.data(),
                             counts.data(), starts.data(), MPI_BYTE, communicator_),
              "MPI_Allgatherv");
        for (std::size_t i = 0; i < ranks; ++i)
            parts[i].insert(parts[i].end(), all.begin() + starts[i], all.begin() + starts[i] + counts[i]);
    }
    return parts;
}

/// Exchanges the sizes of messages; returns the number of bytes that each rank sends to this one.
std::vector<std::uint64_t> MpiRanks::exchange_sizes(const std::vector<Bytes>& out) {
    std::vector<std::uint64_t> sizes(out.size()), incoming(out.size());
    for (std::size_t i = 0; i < out.size(); ++i) sizes[i] = out[i].size();
    check(MPI_Alltoall(sizes.data(), 1, MPI_UINT64_T, incoming.data(), 1, MPI_UINT64_T, communicator_),
          "MPI_Alltoall");
    return incoming;
}

std::vector<Ranks::Bytes> MpiRanks::exchange(const std::vector<Bytes>& out) {
    const auto incoming = exchange_sizes(out);
    std::vector<Bytes> in(out.size());
    std::vector<MPI_Request> requests;
    for (int other = 0; other < size_; ++other) {
        auto& bytes = in[static_cast<std::size_t>(other)];
        bytes.resize(incoming[static_cast<std::size_t>(other)]);
        in_pieces(bytes.size(), [&](std::size_t offset, int count) {
            check(MPI_Irecv(bytes.data() + offset, count, MPI_BYTE, other, exchange_tag, communicator_,
                            &requests.emplace_back()),
                  "MPI_Irecv");
        });
    }
    for (int other = 0; other < size_; ++other) {
        const auto& bytes = out[static_cast<std::size_t>(other)];
        in_pieces(bytes.size(), [&](std::size_t offset, int count) {
            check(MPI_Isend(bytes.data() + offset, count, MPI_BYTE, other, exchange_tag, communicator_,
                            &requests.emplace_back()),
                  "MPI_Isend");
        });
    }
    check(MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE),
          "MPI_Waitall");
    return in;
}

bool MpiRanks::is_gpu_aware(const DeviceInfo& info) const {
    return info.id.starts_with("host") || (info.id.starts_with("cuda") && is_cuda_aware());
}

void MpiRanks::exchange_device(std::span<const Piece> out, std::span<const Piece> in) {
    std::vector<MPI_Request> requests;
    const auto begin = [&](std::span<const Piece> pieces, auto call, std::string_view name) {
        for (const auto& piece : pieces)
            in_pieces(piece.bytes, [&](std::size_t offset, int count) {
                check(call(static_cast<std::byte*>(piece.memory) + offset, count, MPI_BYTE, piece.rank,
                           device_tag, communicator_, &requests.emplace_back()),
                      name);
            });
    };
    begin(in, MPI_Irecv, "MPI_Irecv");
    begin(out, MPI_Isend, "MPI_Isend");
    check(MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE),
          "MPI_Waitall");
}

void MpiRanks::send(int to, std::span<const std::byte> bytes) {
    if (bytes.size() > max_piece_bytes_)
        throw RanksError(fmt::format("MPI: a message of {} bytes is too long; the limit is {}", bytes.size(),
                                     max_piece_bytes_));
    check(MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, send_tag, communicator_),
          "MPI_Send");
}

Ranks::Received MpiRanks::receive() {
    MPI_Status status;
    check(MPI_Probe(MPI_ANY_SOURCE, send_tag, communicator_, &status), "MPI_Probe");
    int length = 0;
    check(MPI_Get_count(&status, MPI_BYTE, &length), "MPI_Get_count");
    Received message{status.MPI_SOURCE, Bytes(static_cast<std::size_t>(length))};
    check(MPI_Recv(message.bytes.data(), length, MPI_BYTE, message.from, send_tag, communicator_,
                   MPI_STATUS_IGNORE),
          "MPI_Recv");
    return message;
}

bool MpiRanks::probe() {
    int flag = 0;
    check(MPI_Iprobe(MPI_ANY_SOURCE, send_tag, communicator_, &flag, MPI_STATUS_IGNORE), "MPI_Iprobe");
    return flag != 0;
}

} // namespace

std::unique_ptr<Ranks> mpi_ranks(MPI_Comm communicator, std::size_t max_piece_bytes) {
    return std::make_unique<MpiRanks>(communicator, max_piece_bytes);
}

std::string mpi_version() {
    std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
    int length = 0;
    if (MPI_Get_library_version(text.data(), &length) != MPI_SUCCESS) return "unknown";
    const std::string_view all(text.data(), static_cast<std::size_t>(length));
    return std::string(all.substr(0, all.find_first_of(",\n")));
}

} // namespace tandem
