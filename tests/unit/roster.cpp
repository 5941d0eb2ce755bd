// SPDX-License-Identifier: MIT
#include "harness/ranks/hands.h"

#include "backends/described_device.h"
#include "scenes/error.h"

#include <gmock/gmock.h>

namespace tandem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Gpu {
    std::string name, hardware;
};

/// A rank of a machine with these cores: device host and CUDA devices, numbered in the machine.
Member member(std::string machine, std::set<int> cores, const std::vector<Gpu>& gpus) {
    Member result{std::move(machine), std::move(cores)};
    DeviceInfo host;
    host.id = "host";
    host.processor = "EPYC";
    result.backends.push_back({"host", {}, ""});
    result.backends.back().devices.push_back(described_device(host));
    result.backends.push_back({"cuda", {}, gpus.empty() ? "no driver" : ""});
    for (const auto& gpu : gpus) {
        DeviceInfo info;
        info.id = fmt::format("cuda:{}", result.backends.back().devices.size());
        info.name = gpu.name;
        info.hardware = gpu.hardware;
        info.is_gpu = true;
        result.backends.back().devices.push_back(described_device(info));
    }
    return result;
}

template<class... Each>
Roster roster(Each... each) {
    std::vector<Member> members;
    (members.push_back(std::move(each)), ...);
    return Roster(std::move(members));
}

std::vector<std::string> ids(const Roster& all, int rank) {
    std::vector<std::string> found;
    for (const auto& backend : all.members()[static_cast<std::size_t>(rank)].backends)
        for (const auto& device : backend.devices) found.push_back(device->info().id);
    return found;
}

std::vector<Gpu> cards(int count, const std::string& name) {
    std::vector<Gpu> all;
    for (int i = 0; i < count; ++i) all.push_back({name, fmt::format("GPU-{}-{}", name, i)});
    return all;
}

TEST(Roster, GpusOfAMachineGoRoundItsRanks) {
    const auto four = cards(4, "H100");
    const auto all = roster(member("a", {0}, four), member("a", {1}, four), member("b", {0}, four));
    EXPECT_THAT(ids(all, 0), ElementsAre("host", "cuda:0", "cuda:2"));
    EXPECT_THAT(ids(all, 1), ElementsAre("host", "cuda:1", "cuda:3"));
    EXPECT_THAT(ids(all, 2), ElementsAre("host", "cuda:0", "cuda:1", "cuda:2", "cuda:3"));
}

/// As launchers do that give every rank a GPU: each sees its own as cuda:0.
TEST(Roster, GpusThatOneRankSeesAreItsOwn) {
    const auto all = roster(member("a", {0}, {{"H100", "GPU-1"}}), member("a", {1}, {{"H100", "GPU-2"}}));
    EXPECT_THAT(ids(all, 0), ElementsAre("host", "cuda:0"));
    EXPECT_THAT(ids(all, 1), ElementsAre("host", "cuda:0"));
}

TEST(Roster, SurplusRanksHaveNothingAndAreTold) {
    const auto one = cards(1, "H100");
    const auto all = roster(member("a", {0, 1}, one), member("a", {0, 1}, one), member("b", {0, 1}, {}));
    EXPECT_THAT(ids(all, 0), ElementsAre("host", "cuda:0"));
    EXPECT_THAT(ids(all, 1), IsEmpty());
    EXPECT_THAT(ids(all, 2), ElementsAre("host"));
    EXPECT_THAT(all.notes(), ElementsAre(HasSubstr("rank 1 has no device of its own and measures nothing")));
}

TEST(Roster, EveryModelIsAskedForOnce) {
    auto all = roster(member("a", {0}, cards(2, "NVIDIA H100")), member("b", {0}, cards(1, "NVIDIA A100")),
                      member("c", {0}, cards(1, "NVIDIA H100")));
    const auto each = all.choose({"cuda:each"});
    ASSERT_EQ(each.size(), 2u);
    EXPECT_EQ(each[0].front()->info().name, "NVIDIA H100");
    EXPECT_EQ(each[1].front()->info().name, "NVIDIA A100");
    EXPECT_THAT(all.ranks_with(models_of(each[0])), ElementsAre(0, 2));
    EXPECT_THAT(all.ranks_with(models_of(each[1])), ElementsAre(1));
    // One cell, whatever it is called.
    EXPECT_EQ(all.choose({"cuda:h100"}).front(), each[0]);
    EXPECT_EQ(all.choose({"cuda:1"}).front(), each[0]);
    EXPECT_THAT(all.notes(), IsEmpty());
}

TEST(Roster, ANumberIsOfTheFirstModelAndThatIsSaid) {
    auto all = roster(member("a", {0}, cards(1, "A100")), member("b", {0}, cards(1, "H100")));
    EXPECT_EQ(all.choose({"cuda:0"}).front().front()->info().name, "A100");
    EXPECT_THAT(all.notes(), ElementsAre(HasSubstr("cuda:0 is cuda:A100")));
}

TEST(Roster, SeveralDevicesOfACellAreOfOneRank) {
    auto all = roster(member("a", {0}, cards(1, "H100")), member("b", {0}, cards(2, "H100")));
    const auto both = all.choose({"cuda:H100+cuda:H100"}).front();
    EXPECT_THAT(all.ranks_with(models_of(both)), ElementsAre(1));
    EXPECT_EQ(all.devices_of(1, models_of(both)).size(), 2u);
    EXPECT_THROW(all.choose({"cuda:0+cuda:2"}), InputError);
}

TEST(Roster, AbsenceNamesWhatThereIs) {
    auto all = roster(member("a", {0}, cards(1, "H100")), member("b", {0}, {}));
    try {
        all.choose({"cuda:B200"});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(),
                    HasSubstr("no rank has a device cuda:B200; rank 0: host (EPYC x1), cuda:0 (H100); "
                              "rank 1: host (EPYC x1)"));
    }
}

TEST(Dealer, HandsGoToWhoHasTheModelAndPastWhoRefused) {
    auto all = roster(member("a", {0}, cards(1, "H100")), member("b", {0}, cards(1, "A100")),
                      member("c", {0}, cards(1, "H100")));
    const auto h100 = models_of(all.choose({"cuda:H100"}).front());
    const auto a100 = models_of(all.choose({"cuda:A100"}).front());
    Dealer dealer(all);
    dealer.add({0, {0}, h100});
    dealer.add({1, {0}, a100});
    dealer.add({2, {0}, h100});
    EXPECT_EQ(dealer.next(1)->group, 1u);
    EXPECT_FALSE(dealer.next(1));
    auto hand = *dealer.next(0);
    EXPECT_EQ(hand.group, 0u);
    hand.refused_by.insert(0);
    dealer.add(hand);
    EXPECT_EQ(dealer.next(0)->group, 2u);
    EXPECT_FALSE(dealer.next(0));
    EXPECT_THAT(dealer.take_undealable(), IsEmpty());
    dealer.leave_out(2);
    EXPECT_EQ(dealer.take_undealable().size(), 1u);
    EXPECT_TRUE(dealer.is_empty());
}

} // namespace
} // namespace tandem
